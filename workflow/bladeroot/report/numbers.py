"""Numbers as text, the same way everywhere in a report."""

import math

NONE = "–"


def fixed(value: float, digits: int, unit: str = "") -> str:
    """A number with a fixed count of decimals, zero without a sign; a dash where there is none."""
    if not math.isfinite(value):
        return NONE
    return f"{value:z,.{digits}f}".replace(",", "\u202f") + (f" {unit}" if unit else "")


def significant(value: float, digits: int = 3, unit: str = "") -> str:
    """A number with a count of significant digits; a dash where there is none."""
    if not math.isfinite(value):
        return NONE
    if value == 0:
        return "0"
    decimals = max(0, digits - 1 - math.floor(math.log10(abs(value))))
    if decimals > 6:
        return f"{value:.{digits - 1}e}" + (f" {unit}" if unit else "")
    return fixed(value, decimals, unit)


def with_std(value: float, std: float, digits: int, unit: str = "") -> str:
    """Value ± standard deviation with the same decimals, more where the deviation needs them."""
    if not math.isfinite(value):
        return NONE
    if math.isfinite(std) and std > 0.0:  # two significant digits of it
        digits = max(digits, 1 - math.floor(math.log10(std)))
    spread = f" ± {fixed(std, digits)}" if math.isfinite(std) else ""
    return f"{fixed(value, digits)}{spread}" + (f" {unit}" if unit else "")


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
