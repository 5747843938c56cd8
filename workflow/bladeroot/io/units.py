"""Units of motion: what a unit text means, and the factor to SI.

The usual spellings are a table; everything else is read by pint, which is imported only then
(0.2 s, a tenth of the time of a record's whole job).
"""

import math
import re
from functools import cache

from bladeroot.signal.recording import SI

# quantity and factor to SI of the usual spellings
USUAL = {
    "m/s": ("velocity", 1.0),
    "mm/s": ("velocity", 1e-3),
    "um/s": ("velocity", 1e-6),
    "m": ("displacement", 1.0),
    "mm": ("displacement", 1e-3),
    "um": ("displacement", 1e-6),
    "m/s^2": ("acceleration", 1.0),
    "g": ("acceleration", 9.80665),
}
# What a digitiser says instead of motion; a sensitivity makes motion of it.
RAW = ("V", "mV", "FS", "count")
# What a file says where its numbers have no unit, or none is known.
NO_UNIT = ("", "1", "-", "none", "n/a", "na", "unknown", "dimensionless", "a.u.")
_TIME_UNITS = {
    1.0: ("s", "sec", "secs", "second", "seconds"),
    1e-3: ("ms", "msec", "millisecond", "milliseconds"),
    1e-6: ("us", "usec", "microsecond", "microseconds"),
    1e-9: ("ns", "nsec", "nanosecond", "nanoseconds"),
    60.0: ("min", "minute", "minutes"),
    3600.0: ("h", "hr", "hour", "hours"),
    86400.0: ("d", "day", "days"),
}
_SPELLINGS = str.maketrans({"µ": "u", "μ": "u", "²": "2", "¹": "1", "⁻": "-", "−": "-", "·": "*"})
# Names with small powers and nothing else: pint would work out 9**9**9 for ever.
_WRITTEN = re.compile(r"(?:[A-Za-z_](?:\^-?[1-4])?|[/*().\s])+")
# A blank multiplies in m s^-1 only: two units beside each other are two units.
_BLANK = re.compile(r"[\w)]\s+(?![A-Za-z_]+\^-[1-4])")
_NUMBER = re.compile(r"\s*([-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?)\s*(.*)")
# g is the acceleration. Prefixes stop at kilo: Mm/s is a slip of the shift key, no megametre.
_REGISTRY = """
nano- = 1e-9 = n-
micro- = 1e-6 = u-
milli- = 1e-3 = m-
centi- = 1e-2 = c-
kilo- = 1e3 = k-
meter = [length] = m = metre
second = [time] = s = sec
micron = 1e-6 * meter
inch = 0.0254 * meter = in
foot = 0.3048 * meter = ft = feet
mil = 0.001 * inch = _ = thou
ips = inch / second
gravity = 9.80665 * meter / second ** 2 = g = gn = g_n
galileo = 0.01 * meter / second ** 2 = Gal
volt = [voltage] = V
full_scale = [reading] = FS
count = [digit]
"""


def normal_unit(unit: str) -> str:
    """One spelling for a unit: um for the micro signs, m/s^2 for m/s2, m/s**2 and m s-2."""
    text = unit.strip().strip("[]").strip().translate(_SPELLINGS).replace("**", "^")
    text = re.sub(r"([A-Za-z])(-?[1-4])(?![\d.])", r"\1^\2", text)
    text = re.sub(r"\bm\s?s\^-([12])\b", lambda of: "m/s" if of[1] == "1" else "(m/s^2)", text)
    text = re.sub(r"\s+per\s+", "/", text)
    text = re.sub(r"\s*([/*^])\s*", r"\1", text)
    if text.lower() in ("volt", "volts"):
        return "V"
    bare = text.removeprefix("(").removesuffix(")")
    return "g" if bare == "g_n" else bare if bare in USUAL else text


@cache  # a sheet of ten thousand rows says the same in each
def motion(unit: str, sensitivity: str | None = None) -> tuple[str, float]:
    """Quantity and factor to SI of numbers in `unit`.

    Args:
        unit: a unit of velocity, displacement or acceleration; or, with a sensitivity, V, mV, FS
            (full scale of a WAV file) or count.
        sensitivity: the sensor's, either way round (`125 mm/s/V`, `100 mV/g`), or a plain factor.

    Raises:
        ValueError: not such a unit or sensitivity, in one line.
    """
    unit = normal_unit(unit)
    if sensitivity is None:
        if unit in USUAL:
            return USUAL[unit]
        if unit in RAW:
            raise ValueError(f"unit {unit} needs a sensitivity such as 125 mm/s/{unit}")
        found = _motion(_quantity(1.0, unit))
        if found is None:
            raise ValueError(f"expected a unit of motion such as {', '.join(USUAL)}, got {unit!r}")
        return found
    number, text = sensitivity_of(sensitivity)
    if not text:
        quantity, factor = motion(unit)
        return quantity, factor * number
    signal, sensor = _quantity(1.0, unit), _quantity(number, text)
    found = _motion(signal * sensor) or _motion(signal / sensor)
    if found is None and text.count("/") == 2:  # V/m/s is printed where V/(m/s) is meant
        found = _motion(signal / _quantity(number, "{}/({}/{})".format(*text.split("/"))))
    if found is None:
        raise ValueError(
            f"sensitivity {sensitivity!r} makes no motion of {unit!r}; expected one such as "
            + (f"125 mm/s/{unit}" if unit in RAW else "125 mm/s/V or 100 mV/g, with samples in V")
        )
    return found


def sensitivity_of(text: str) -> tuple[float, str]:
    """Number and unit of a sensitivity; no unit for a plain factor.

    Raises:
        ValueError: not such a text, in one line.
    """
    match = _NUMBER.fullmatch(text)
    number = float(match[1]) if match else 0.0
    if not match or number == 0.0 or not math.isfinite(number):
        raise ValueError(
            f"expected a sensitivity such as 125 mm/s/V, 100 mV/g or a factor, got {text!r}"
        )
    unit = normal_unit(match[2])
    if unit:
        _quantity(number, unit)
    return number, unit


def same(unit: str, other: str) -> bool:
    """Whether two texts mean the same unit."""
    if normal_unit(unit) == normal_unit(other):
        return True
    one, two = _quantity(1.0, normal_unit(unit)), _quantity(1.0, normal_unit(other))
    return one.dimensionality == two.dimensionality and math.isclose(one.magnitude, two.magnitude)


def one_unit(units: dict[str, str | None], path: str) -> str | None:
    """The unit that all places of a file agree on, by where it stands; None if there is none.

    Raises:
        ValueError: two differ.
    """
    stated = {where: unit for where, unit in units.items() if unit and unit.strip() not in NO_UNIT}
    first = next(iter(stated.values()), None)
    for unit in stated.values():
        if not _same(first, unit):
            listed = ", ".join(f"{text!r} {where}" for where, text in stated.items())
            raise ValueError(f"unit contradicts inside the file: {listed} ({path})")
    return first


def _same(unit: str, other: str) -> bool:
    try:
        return same(unit, other)
    except ValueError:
        return False


def quantity_of(name: str, unit: str | None) -> str | None:
    """Quantity of a channel as its unit, or else its name, tells it; None if neither does."""
    if unit:
        try:
            return motion(unit)[0]
        except ValueError:
            return None
    first = re.match(r"[a-z]*", name.strip().lower())[0]
    return first if first in SI else None


def seconds(unit: str) -> float | None:
    """Factor of a unit of time to seconds, None if it is no such unit."""
    text = unit.strip().strip("[]()").strip().translate(_SPELLINGS).lower()
    return next((factor for factor, names in _TIME_UNITS.items() if text in names), None)


@cache
def _registry():
    import pint

    registry = pint.UnitRegistry(None, on_redefinition="raise")
    registry.load_definitions(_REGISTRY.strip().splitlines())
    return registry


def _quantity(number: float, unit: str):
    """A pint quantity in base units; files in capitals (MM/S) are understood."""
    spellings = dict.fromkeys((unit, unit.lower())) if len(unit) <= 40 else ()
    for text in spellings:
        if not _WRITTEN.fullmatch(text) or _BLANK.search(text):
            break
        try:
            return _registry().Quantity(number, text).to_base_units()
        except Exception:  # pint's parser lets errors of many kinds through
            continue
    raise ValueError(f"expected a unit such as {', '.join(USUAL)} or V, got {unit[:40]!r}")


def _motion(amount) -> tuple[str, float] | None:
    powers = {name: float(power) for name, power in amount.dimensionality.items()}
    kinds = {
        "displacement": {"[length]": 1.0},
        "velocity": {"[length]": 1.0, "[time]": -1.0},
        "acceleration": {"[length]": 1.0, "[time]": -2.0},
    }
    for quantity, of in kinds.items():
        if powers == of and math.isfinite(amount.magnitude):
            return quantity, float(amount.magnitude)
    return None
