"""Numbers in text as labs write them: decimal commas, and signs between thousands."""

import re

# Commas or points between thousands for certain, and commas that may be such.
_THOUSANDS = re.compile(
    r"[-+]?\d{1,3}((,\d{3})+\.\d*|(\.\d{3})+,\d*|(,\d{3}){2,}|(\.\d{3}){2,})(e[-+]?\d+)?",
    re.IGNORECASE,
)
_UNSURE = re.compile(r"[-+]?[1-9]\d{0,2},\d{3}")


def numeric(field: str) -> bool:
    """Whether a field is a number, with a decimal point or comma."""
    return bool(
        re.fullmatch(r"[-+]?(\d+[.,]?\d*|[.,]\d+)([eE][-+]?\d+)?|[-+]?(nan|inf)", field, re.I)
    )


def check_thousands(rows: list[list[str]], path: str) -> None:
    """Refuse signs between thousands, in a row of nothing but numbers."""
    for k, fields in enumerate(rows):
        grouped = [field for field in fields if _THOUSANDS.fullmatch(field)]
        if grouped and all(numeric(field) or field in grouped for field in fields):
            raise ValueError(
                f"expected numbers without signs between their thousands, got {grouped[0]!r} "
                f"({path}, row {k + 1})"
            )


def check_commas(rows: list[list[str]], first: int, path: str) -> None:
    """Refuse commas that no number shows to be decimal ones, and points beside commas.

    first: lines above the rows.
    """
    commas = [(k, field) for k, row in enumerate(rows) for field in row if "," in field]
    points = [(k, field) for k, row in enumerate(rows) for field in row if "." in field]
    row, field = commas[0]
    if points:
        raise ValueError(
            f"expected one decimal sign, got {field!r} and {points[0][1]!r} ({path}, rows "
            f"{first + row + 1} and {first + points[0][0] + 1})"
        )
    if all(_UNSURE.fullmatch(field) for _, field in commas):
        raise ValueError(
            f"expected numbers without commas between thousands, got {field!r}, whose comma may "
            f"be that or a decimal one ({path}, row {first + row + 1})"
        )
