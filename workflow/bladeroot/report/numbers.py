"""Numbers as text, the same way everywhere in a report."""

import math

NONE = "–"
_MOST_DECIMALS = 6  # more cannot be counted at a glance
_LEAST = 1e-300  # below it a power of ten is no number
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def fixed(value: float, digits: int, unit: str = "") -> str:
    """A number with a fixed count of decimals, zero without a sign; a dash where there is none."""
    if not math.isfinite(value):
        return NONE
    return f"{value:z,.{digits}f}".replace(",", "\u202f") + _of(unit)


def significant(value: float, digits: int = 3, unit: str = "") -> str:
    """A number with a count of significant digits; a dash where there is none."""
    if not math.isfinite(value):
        return NONE
    if value == 0:
        return "0"
    decimals = max(0, digits - 1 - _power(float(f"{value:.{digits - 1}e}")))
    if decimals > _MOST_DECIMALS:
        mantissa, power = f"{value:.{digits - 1}e}".split("e")
        return f"{mantissa}{_times(int(power))}" + _of(unit)
    return fixed(value, decimals, unit)


def span(low: float, high: float, digits: int) -> str:
    """Two numbers with a count of significant digits in one notation; once where they are alike."""
    ends = dict.fromkeys(significant(end, digits) for end in (low, high))
    if len(ends) == 2 and any("·" in end for end in ends) and _LEAST < low < high < 1e3 * low:
        power = _power(low)
        ends = [significant(end / 10.0**power, digits) for end in (low, high)]
        return f"({' to '.join(ends)}){_times(power)}"
    return " to ".join(ends)


def with_std(value: float, std: float, digits: int, unit: str = "") -> str:
    """Value ± standard deviation to two digits of the latter, six decimals at most; `digits`
    decimals where none is known.
    """
    if not math.isfinite(value):
        return NONE
    if math.isfinite(std) and std > 0.0:
        digits = 1 - _power(float(f"{std:.1e}"))
        power = _power(max(abs(value), std))
        if digits > _MOST_DECIMALS and math.log10(_LEAST) < power < -3:
            scale = 10.0**power
            return f"({with_std(value / scale, std / scale, digits)}){_times(power)}" + _of(unit)
        digits = min(digits, _MOST_DECIMALS)
        value, std = round(value, digits), max(round(std, digits), 10.0**-_MOST_DECIMALS)
    spread = f" ± {fixed(std, max(digits, 0))}" if math.isfinite(std) else ""
    return f"{fixed(value, max(digits, 0))}{spread}" + _of(unit)


def _power(value: float) -> int:
    return math.floor(math.log10(abs(value)))


def _times(power: int) -> str:
    return f"·10{str(power).translate(_RAISED)}"


def _of(unit: str) -> str:
    return f" {unit}" if unit else ""


def percent(ratio: float, digits: int = 1) -> str:
    """A ratio in per cent."""
    return fixed(100 * ratio, digits, "%")


def interval(quantiles, low: float, digits: int = 2) -> tuple[str, str]:
    """Median of quantiles of a stiffness (DataArray, N/m) in GN/m, and those of low and 1 - low."""
    asked = quantiles.sel(quantile=[low, 0.5, 1.0 - low], method="nearest").values
    ends = [significant(1e-9 * float(value), digits) for value in asked]
    return ends[1], f"{ends[0]} to {ends[2]}"


def listed(words: list[str], last: str = "and") -> str:
    """Words as an enumeration."""
    if len(words) < 2:
        return "".join(words)
    return f"{', '.join(words[:-1])} {last} {words[-1]}"
