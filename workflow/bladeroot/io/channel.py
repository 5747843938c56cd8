"""One channel of a raw file as the file itself tells it, and how one of several is chosen."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from numpy import ndarray

from bladeroot.io.units import USUAL, normal_unit, quantity_of, seconds
from bladeroot.signal.recording import SI

FEWEST_SAMPLES = 64  # of a record
_MOST_LISTED = 12  # channels that a message names
# A header that claims more bytes than these times the file's is refused. Deflate reaches about a
# thousand; a large record that shrinks a hundred times is zeros that would fill the memory.
_MOST_COMPRESSION = 1100
_LARGE_BYTES = 1 << 28  # above which a claim is large
_MOST_LARGE_COMPRESSION = 100
# Largest relative difference of two statements of the same thing.
RATE_TOLERANCE = 1e-4  # of a sampling frequency
FORCE_TOLERANCE = 1e-2
# Names that are a time's where their unit is.
_TIME_AXES = ("x", "x-axis", "x axis", "index")
# What a channel t is in where it is no time.
_TEMPERATURE = ("°c", "degc", "celsius", "c", "k", "kelvin", "°f", "degf", "f")


@dataclass(frozen=True)
class Channel:
    """Numbers as they stand in the file, and what the file says of them.

    A number of `samples` times `scale` is in `unit`. `sampling_error` is what the digits of
    `sampling_Hz` leave open, relative. `facts` holds what else the file states and
    records.csv may contradict: mode, force_N. `clock` says what looks like times and may be none.
    """

    name: str
    samples: ndarray
    unit: str | None = None
    scale: float = 1.0
    quantity: str | None = None
    time: ndarray | None = None
    sampling_Hz: float | None = None
    sampling_error: float = 0.0
    start_s: float = 0.0
    facts: dict[str, str | float] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    clock: str = ""


@dataclass(frozen=True)
class Entry:
    """What is known of a channel before its numbers are read; `number` as a person counts."""

    number: int
    name: str
    unit: str | None = None
    quantity: str | None = None
    timelike: bool = False

    @property
    def shown(self) -> str:
        """`laser [mm/s]`, the name with its unit."""
        unit = f" [{self.unit}]" if self.unit and f"{self.unit}" not in self.name else ""
        return f"{self.name}{unit}"

    def __str__(self) -> str:
        """`2: laser [mm/s]`, as messages list it."""
        return f"{self.number}: {self.shown}"


def moving(entries: Sequence[Entry]) -> tuple[Entry, ...]:
    """The channels whose unit or name is one of motion; all, where none is."""
    shown = tuple(e for e in entries if (e.quantity or quantity_of(e.name, e.unit)) in SI)
    return shown or tuple(entries)


class ChannelError(ValueError):
    """No channel, or none alone, is meant: a line, and the file's channels (`entries`)."""

    @property
    def entries(self) -> Sequence[Entry]:
        """The channels of the file."""
        return self.args[1]

    def __str__(self) -> str:
        """The line."""
        return self.args[0]


def pick(entries: Sequence[Entry], channel: str | None, quantity: str | None, path: str) -> Entry:
    """The one channel that is meant.

    A `channel` is a name, with or without its unit, the last part of a name with parts, or a
    number. Without it: the only channel of motion (of `quantity`, if given), or the only one.

    Raises:
        ChannelError: none or several; the line lists the channels.
    """
    motion = [entry for entry in entries if not entry.timelike]
    if channel:
        wanted = f"channel {channel!r}"
        fits = [entry for entry in entries if channel in (entry.name, entry.shown)]
        fits = fits or [entry for entry in motion if bare(entry.name) == channel]
        ends = (f"/{channel}", f".{channel}")
        fits = fits or [entry for entry in motion if entry.name.endswith(ends)]
        if not fits and channel.isdecimal():
            fits = [entry for entry in entries if entry.number == int(channel)]
    else:
        kinds = (quantity,) if quantity else tuple(SI)
        wanted = f"one channel of {' or '.join(kinds)}"
        found = {entry: entry.quantity or quantity_of(entry.name, entry.unit) for entry in motion}
        fits = [entry for entry in motion if found[entry] in kinds]
        if not fits and len(motion) == 1 and found[motion[0]] is None:
            fits = motion
    if len(fits) == 1:
        return fits[0]
    if not entries:
        raise ChannelError(f"expected {wanted}, got no vector of real numbers ({path})", entries)
    those = fits or entries
    listed = ", ".join(map(str, those[:_MOST_LISTED]))
    more = f" and {len(those) - _MOST_LISTED} more" if len(those) > _MOST_LISTED else ""
    raise ChannelError(
        f"expected {wanted}, got {'several' if fits else 'none'} of {listed}{more}; channel names "
        f"one, by its name or number ({path})",
        entries,
    )


def bare(name: str) -> str:
    """A name without its unit."""
    return split_name(name)[0]


def split_name(name: str) -> tuple[str, str | None]:
    """A name and its unit: velocity_m/s, velocity [m/s], velocity (m/s), velocity / m/s, t/s."""
    match = re.fullmatch(r"([^\[(]*?)\s*[\[(]\s*(.+?)\s*[\])]", name)
    if match:
        return match[1].strip(), match[2]
    match = re.fullmatch(r"(.+?)(?:\s+(?:/|in)\s+|/)(\S+)", name)
    if match and (seconds(match[2]) if _is_time(match[1]) else quantity_of("", match[2])):
        return match[1], match[2]
    base, _, tail = name.rpartition("_")
    motion = normal_unit(tail) in USUAL or ("/" in tail and quantity_of("", tail))
    known = motion or (_is_time(base) and seconds(tail))
    return (base, tail) if base and known else (name, None)


def time_factor(name: str, unit: str | None, path: str) -> float | None:
    """Seconds in a unit of a time channel (time, t, time_ms, Time [s]); None if it is none.

    Raises:
        ValueError: a time in a unit that is not known.
    """
    base, own = split_name(name)
    if base.strip().lower() in _TIME_AXES and seconds(unit or own or ""):
        return seconds(unit or own)
    unit = unit or own or "s"
    if not _is_time(base) or (base.strip().lower() == "t" and unit.strip().lower() in _TEMPERATURE):
        return None
    factor = seconds(unit)
    if factor is None:
        raise ValueError(
            f"expected times in s, ms, us, ns, min or h, got {unit!r} in {name!r} ({path})"
        )
    return factor


def _is_time(base: str) -> bool:
    return base.strip().lower() in ("time", "t", "zeit", "elapsed time", "seconds", "x_value")


def check_claim(count: int, width: int, path: str) -> None:
    """Refuse a header that claims more numbers than the file can hold.

    Raises:
        ValueError: `count` numbers of `width` bytes cannot come out of the file.
    """
    size = Path(path).stat().st_size
    claimed = count * width
    if claimed > _MOST_COMPRESSION * size or claimed > max(
        _LARGE_BYTES, _MOST_LARGE_COMPRESSION * size
    ):
        raise ValueError(
            f"the header claims {count} samples of {width} bytes, the file has {size} ({path})"
        )
