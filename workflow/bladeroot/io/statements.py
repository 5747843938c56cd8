"""What a file says of a record beside its numbers: sampling frequency, force and mode.

A file may say a thing more than once (`fs`, `dt`, `sampling rate [kHz]`); all must agree.
"""

import math
import re
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
from numpy import ndarray

from bladeroot.io.channel import FORCE_TOLERANCE, RATE_TOLERANCE
from bladeroot.io.units import seconds

# A sampling frequency below this that is no whole number needs its unit: 25.6 may be kHz.
UNSURE_HZ = 1000.0
_RATES = ("fs", "fsample", "sampling", "samplingrate", "samplerate", "samplingfrequency",
          "samplefrequency")  # fmt: skip
_STEPS = ("dt", "deltat", "timestep", "samplinginterval", "wfincrement")
_FORCES = ("force", "axialforce")
_HERTZ = {"hz": 1.0, "khz": 1e3, "mhz": 1e6, "1/s": 1.0, "s/s": 1.0, "sps": 1.0, "samples/s": 1.0}
_NEWTON = {"n": 1.0, "kn": 1e3}
_AMOUNT = re.compile(r"([-+]?(?:\d+(?:[.,]\d+)*[.,]?|\.\d+)(?:e[-+]?\d+)?)[\s;,]*(.*)", re.I)


@dataclass(frozen=True)
class Statements:
    """What a file states, None or missing where it does not; `notes` on what is not understood.

    `sampling_error` is what the digits given leave open, relative.
    """

    sampling_Hz: float | None = None
    sampling_error: float = 0.0
    facts: dict[str, str | float] = field(default_factory=dict)
    notes: tuple[str, ...] = ()


def statements(
    said: Iterable[tuple[str, object]], path: str, steps: tuple[str, ...] = ()
) -> Statements:
    """Sampling frequency, force and mode among a file's own properties.

    Args:
        said: names and values as they stand in the file; the mode said last counts.
        path: what to name in messages.
        steps: further names of a time step, in small letters without blanks or underscores.

    Raises:
        ValueError: a frequency or force that is none, or two of them that differ.
    """
    rates, errors, forces, facts, notes = {}, {}, {}, {}, []
    for name, value in said:
        key, unit = _key(str(name))
        text = _text(value)
        stated = f"{name} {text}"
        if key == "mode" and text:
            facts["mode"] = text
        try:
            if key in _RATES:
                rate = _amount(text, unit or "hz", _HERTZ)
                if not unit and _bare(text) and 0.0 < rate < UNSURE_HZ and rate != round(rate):
                    raise ValueError("without a unit it may be in Hz or in kHz")
                exact = _round(rate) or not isinstance(value, str)
                errors[stated] = 0.0 if exact else _open(text)
                rates[stated] = rate
            elif key in (*_STEPS, *steps):
                rate = 1.0 / _amount(text, unit or "s", None)
                # a step in text is a rounded one; a number is, where its frequency is an odd one
                exact = _round(rate) and not isinstance(value, str)
                errors[stated] = 0.0 if exact else _open(text)
                rates[stated] = rate
            elif key in _FORCES:
                forces[stated] = _amount(text, unit, _NEWTON)
        except (ValueError, ZeroDivisionError) as error:
            notes.append(f"{name} {text[:40]!r} of the file is not taken: {error}")
    for stated, rate in rates.items():
        if not 0.0 < rate < math.inf:
            raise ValueError(f"expected a positive sampling frequency, got {stated} ({path})")
    # the one with the most digits is taken
    rates = dict(sorted(rates.items(), key=lambda one: errors[one[0]]))
    sampling_Hz = _one(rates, RATE_TOLERANCE, "sampling_Hz", path, errors)
    force = _one(forces, FORCE_TOLERANCE, "force_N", path)
    if force is not None:
        facts["force_N"] = force
    error = min(errors.values(), default=0.0)
    return Statements(sampling_Hz, error, facts, tuple(notes))


def one_time(times: dict[str, ndarray], path: str) -> ndarray | None:
    """The times in seconds that all time channels of a record agree on; None if there is none.

    Raises:
        ValueError: they take different spans.
    """
    spans = {name: float(time[-1]) - float(time[0]) for name, time in times.items()}
    _one(spans, RATE_TOLERANCE, "the span of the times (s)", path)
    return next(iter(times.values()), None)


def _one(
    stated: dict[str, float],
    apart: float,
    what: str,
    path: str,
    errors: dict[str, float] | None = None,
) -> float | None:
    """The first of several numbers that must be the same, as far as their digits tell."""
    first = next(iter(stated.values()), None)
    errors = errors or dict.fromkeys(stated, 0.0)
    room = apart + min(errors.values(), default=0.0)
    if first is not None and any(
        abs(one - first) > (room + errors[name]) * abs(first) for name, one in stated.items()
    ):
        listed = ", ".join(f"{value:.9g} from {name}" for name, value in stated.items())
        raise ValueError(f"{what} contradicts inside the file: {listed} ({path})")
    return first


def _key(name: str) -> tuple[str, str]:
    """A name in small letters without blanks, and its unit: `Sampling rate [kHz]`, `force_N`."""
    match = re.fullmatch(r"(.*?)\s*[\[(]\s*(.+?)\s*[\])]\s*", name)
    base, unit = (match[1], match[2].lower()) if match else (name, "")
    key = re.sub(r"[\s_]+", "", base).lower()
    parts = re.fullmatch(r"(.+?)[\s_]+(k?hz|k?n|m?s)", base.strip().lower())
    if parts and not unit:
        known = re.sub(r"[\s_]+", "", parts[1])
        if known in (*_RATES, *_STEPS, *_FORCES):
            return known, parts[2]
    return key, unit


def _text(value: object) -> str:
    """A property as text; an array of one number is that number."""
    numbers = np.ravel(value) if isinstance(value, np.ndarray) else None
    return str(numbers[0] if numbers is not None and numbers.size == 1 else value).strip()


def _bare(text: str) -> bool:
    """Whether a text is a number and nothing behind it."""
    match = _AMOUNT.fullmatch(text)
    return match is not None and not match[2].strip()


def _round(rate: float) -> bool:
    """Whether a frequency is one that instruments are set to: whole, no prime factor above 7."""
    if not 0.5 < rate < 1e12:
        return False
    whole = round(rate)
    return abs(rate - whole) < 1e-9 * rate and pow(210, 40, whole) == 0


def _open(text: str) -> float:
    """What the digits of a number leave open, relative: half of the last one's step."""
    match = _AMOUNT.fullmatch(text)
    digits = re.sub(r"\D", "", match[1].lower().partition("e")[0]) if match else ""
    return 0.5 / max(int(digits), 1) if digits else 0.0


def _amount(text: str, unit: str, units: dict[str, float] | None) -> float:
    """A number in base units; a unit behind it counts more than one in the name. None: times."""
    match = _AMOUNT.fullmatch(text)
    if match is None:
        return float(text)  # nan and inf are numbers, and are refused as such
    unit = match[2].strip() or unit
    factor = seconds(unit) if units is None else units.get(unit.lower())
    if factor is None:
        raise ValueError(f"its unit {unit!r} is not known")
    return _number(match[1], factor == 1.0) * factor


def _number(text: str, whole: bool) -> float:
    """A number with a decimal comma, or commas between thousands where `whole` units are meant."""
    if "," in text and "." in text:
        thousands = min(",.", key=text.rfind)
        return float(text.replace(thousands, "").replace(",", "."))
    if re.fullmatch(r"[-+]?[1-9]\d{0,2}(,\d{3})+", text):
        if not whole:
            raise ValueError("a comma before three digits may be a decimal one or not")
        return float(text.replace(",", ""))
    return float(text.replace(",", "."))
