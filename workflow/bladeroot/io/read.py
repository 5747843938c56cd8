"""Read a raw record, by its suffix, and check what it says against what the sheet says."""

import dataclasses
import importlib
import pkgutil
import re
import warnings
from functools import cache
from pathlib import Path

from bladeroot.io import readers
from bladeroot.io.channel import (
    FORCE_TOLERANCE,
    RATE_TOLERANCE,
    Channel,
    ChannelError,
    Entry,
    split_name,
)
from bladeroot.io.recording import recording
from bladeroot.io.responses import undoing
from bladeroot.io.sampling import usual_rate
from bladeroot.io.units import NO_UNIT, motion, normal_unit, one_unit, quantity_of, same
from bladeroot.signal.recording import SI, Recording

# Relative difference of a file's sampling frequency from the sheet's from which on it is told; from
# `RATE_TOLERANCE` on it is a contradiction.
TOLD_RATE_DIFFERENCE = 1e-7


@cache
def formats() -> dict[str, str]:
    """Module of every known suffix; a new file in `readers` is found by itself."""
    known = {}
    for module in pkgutil.iter_modules(readers.__path__):
        name = f"{readers.__name__}.{module.name}"
        known.update(dict.fromkeys(importlib.import_module(name).SUFFIXES, name))
    return known


def read(
    path: str | Path,
    quantity: str | None = None,
    unit: str | None = None,
    channel: str | None = None,
    sampling_Hz: float | None = None,
    sensitivity: str | None = None,
    mode: str | None = None,
    force_N: float | None = None,
    response: str | None = None,
) -> Recording:
    """One record in SI units; what the sheet says is checked against what the file says.

    Args:
        path: the raw file.
        quantity: velocity, displacement or acceleration; by default what the file says.
        unit: unit of the file's numbers; by default what the file says.
        channel: name or number of the channel, where the file holds several.
        sampling_Hz: for files that do not say; must agree with those that do.
        sensitivity: of the sensor, such as `125 mm/s/V`; or a factor.
        mode: the record's mode; must agree with a file that states one.
        force_N: the record's force; must agree with a file that states one.
        response: of the sensor, such as `high-pass 0.5 Hz`.

    Raises:
        ValueError: no such file, an unknown suffix, anything wrong in the file, or a
            contradiction between file and sheet; always in one line.
    """
    path = Path(path)
    found = as_stated(path, channel, quantity)
    where = f"{path}, channel {found.name!r}"
    notes = list(found.notes)
    unit = _unit(found, unit, quantity, sensitivity, where, notes)
    _agree(found, mode, force_N, where, notes)
    own = found.sampling_Hz
    hints = [*found.notes, *([found.clock] if found.clock else [])]
    if own is None and sampling_Hz is None and found.time is None and hints:
        raise ValueError(f"expected a sampling frequency; {'; '.join(hints)} ({where})")
    record = recording(
        found.samples,
        unit,
        where,
        found.time,
        sampling_Hz if own is None else own,
        quantity or found.quantity,
        sensitivity,
        found.start_s,
        found.scale,
    )
    rate = record.sampling_Hz
    error = found.sampling_error
    if own is not None and not abs(own / rate - 1.0) <= RATE_TOLERANCE + error:
        raise ValueError(f"the file says {own:.9g} Hz, its times {rate:.9g} Hz ({where})")
    if own is not None or found.time is not None:
        # times tell the frequency better than a statement's few digits
        error = error if found.time is None else 0.0
        rate = _sampling(rate, sampling_Hz, error, where, notes)
    notes += record.notes
    undone = undoing(response) if response else None
    return dataclasses.replace(record, sampling_Hz=rate, notes=tuple(notes), undone=undone)


def as_stated(path: str | Path, channel: str | None = None, quantity: str | None = None) -> Channel:
    """One channel as the file tells it, whatever it leaves open.

    Raises:
        ValueError: no such file, an unknown suffix, a damaged file, or not one channel, in one
            line.
    """
    path, known = Path(path), formats()
    if path.suffix.lower() not in known:
        raise ValueError(
            f"expected a file ending in {', '.join(sorted(known))}, got {path.suffix!r} ({path})"
        )
    if not path.is_file():
        raise ValueError(f"expected a record file, got none at {path}")
    if path.stat().st_size == 0:
        raise ValueError(f"expected a record, got an empty file ({path})")
    return _channel(known[path.suffix.lower()], path, channel, quantity)


def stated_unit(found: Channel, where: str) -> str | None:
    """The unit that a file gives a channel, None if none; of a list, as `s, m/s^2`, the motion's.

    Raises:
        ValueError: the channel's name contradicts it.
    """
    own = found.unit if found.unit and found.unit.strip().lower() not in NO_UNIT else None
    listed = [text.strip() for text in re.split("[,;]", own or "") if quantity_of("", text)]
    own = listed[0] if len(listed) == 1 else own
    return one_unit({"of the channel": own, "in its name": _unit_in(found.name)}, where)


def channels(path: str | Path) -> tuple[Entry, ...]:
    """What channels of motion or signal a file has, times left out.

    Raises:
        ValueError: no such file, an unknown suffix or a damaged file, in one line.
    """
    try:
        # no channel has that name: whatever the file holds is listed
        as_stated(path, channel="\0")
    except ChannelError as error:
        return tuple(entry for entry in error.entries if not entry.timelike)
    raise AssertionError("a reader takes a channel that is not there")


def _channel(reader: str, path: Path, channel: str | None, quantity: str | None) -> Channel:
    """What the reader finds; whatever a library throws becomes one line that names the file."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return importlib.import_module(reader).read(str(path), channel, quantity)
    except (ImportError, ChannelError):
        raise
    except MemoryError as error:
        raise ValueError(f"the file claims more data than the memory holds ({path})") from error
    except Exception as error:
        text = " ".join(str(error).split())[:400]
        if isinstance(error, ValueError) and str(path) in text:
            raise ValueError(text) from error
        kind = f"a sound {path.suffix} file"
        raise ValueError(f"expected {kind}, got {type(error).__name__}: {text} ({path})") from error


def _unit(
    found: Channel,
    unit: str | None,
    quantity: str | None,
    sensitivity: str | None,
    where: str,
    notes: list[str],
) -> str:
    """The unit that sheet and file agree on."""
    own = stated_unit(found, where)
    if own and unit:
        try:
            agree = same(own, unit)
        except ValueError:
            notes.append(f"the file's unit {own!r} is not known; {unit} as stated is taken")
            own, agree = None, True
        if not agree:
            hint = "" if sensitivity else "; a sensitivity or a factor can convert"
            raise ValueError(
                f"unit contradicts: {unit!r} stated, {own!r} in the file{hint} ({where})"
            )
    chosen = own or unit
    if chosen is None:
        raise ValueError(f"expected a unit, got none from the file; `unit` can state it ({where})")
    named = quantity_of(split_name(found.name)[0], None)
    if named and quantity is None and found.quantity is None:
        try:
            means = motion(chosen, sensitivity)[0]
        except ValueError as error:
            raise ValueError(f"{error} ({where})") from error
        if means != named:
            raise ValueError(
                f"the channel is called {named}, its unit {normal_unit(chosen)} is one of {means} "
                f"({SI[means]}); quantity can decide ({where})"
            )
    if quantity and found.quantity and quantity != found.quantity:
        raise ValueError(
            f"quantity contradicts: {quantity} stated, {found.quantity} in the file ({where})"
        )
    return chosen


def _unit_in(name: str) -> str | None:
    """The unit of motion at the end of a channel's name, None if what stands there is none."""
    unit = split_name(name)[1]
    return unit if unit and quantity_of("", unit) else None


def _sampling(
    own: float, sampling_Hz: float | None, error: float, where: str, notes: list[str]
) -> float:
    """The sampling frequency of file and sheet; the sheet's where they differ by rounding.

    error: what the file's digits leave open, relative, as of a rounded time step.
    """
    if sampling_Hz is None:
        if error > RATE_TOLERANCE:
            notes.append(
                "the file's digits leave the sampling frequency open between "
                f"{own / (1.0 + error):.6g} and {own / (1.0 - error):.6g} Hz, {own:.9g} Hz is "
                "taken; sampling_Hz settles it"
            )
        elif usual_rate(own) is None:
            notes.append(
                f"the file's sampling frequency {own:.9g} Hz is an unusual one; sampling_Hz "
                "can confirm it"
            )
        return own
    apart = abs(own / sampling_Hz - 1.0)
    if not apart <= RATE_TOLERANCE + error:
        raise ValueError(
            f"sampling_Hz contradicts: {sampling_Hz:.9g} stated, {own:.9g} in the file ({where})"
        )
    if apart > TOLD_RATE_DIFFERENCE:
        notes.append(f"sampling_Hz {sampling_Hz:.9g} as stated is taken, not {own:.9g} Hz")
    return sampling_Hz


def _agree(
    found: Channel, mode: str | None, force_N: float | None, where: str, notes: list[str]
) -> None:
    """Mode and force, where the file states them, are the sheet's.

    What a file calls its mode may be the instrument's (`continuous`): only a name of the same
    form as the sheet's, such as 2B for 1B, contradicts it.
    """
    own = found.facts.get("mode")
    if own is not None and mode is not None and str(own) != mode:
        if _form(str(own)) == _form(mode):
            raise ValueError(
                f"mode contradicts: {mode} in records.csv, {own} in the file ({where})"
            )
        notes.append(f"the file's mode {str(own)[:40]!r} is no name like {mode} and is not judged")
    force = found.facts.get("force_N")
    if (
        force is not None
        and force_N is not None
        and not (abs(force - force_N) <= FORCE_TOLERANCE * force_N)
    ):
        raise ValueError(
            f"force_N contradicts: {force_N:g} in records.csv, {force:g} in the file ({where})"
        )


def _form(name: str) -> str:
    """A name with 9 for its numbers and A for its words: 9A for 1B."""
    return re.sub(r"[^\W\d_]+", "A", re.sub(r"\d+", "9", name))
