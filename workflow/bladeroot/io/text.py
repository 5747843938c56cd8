"""Text as labs write it: encoding, what splits fields, decimal commas, signs between thousands."""

import codecs
import math
import re

_BOMS = {
    codecs.BOM_UTF8: "utf-8-sig",
    codecs.BOM_UTF16_LE: "utf-16",
    codecs.BOM_UTF16_BE: "utf-16",
}
# Commas or points between thousands for certain, and those that may be such.
_THOUSANDS = re.compile(
    r"[-+]?\d{1,3}((,\d{3})+\.\d*|(\.\d{3})+,\d*|(,\d{3}){2,}|(\.\d{3}){2,})(e[-+]?\d+)?",
    re.IGNORECASE,
)
_UNSURE = re.compile(r"[-+]?[1-9]\d{0,2}[,.]\d{3}")
# Marks in the place of a number: of a sensor over its range, and of a sample that is lost.
_OVER = re.compile(
    r"[-+]?(ov[rl]?|ovld|ovfl|over([ -]?(load(ed)?|range|flow))?|ol|inf(inity)?|1\.#inf)", re.I
)
_LOST = re.compile(r"-*|[-+]?(nan|1\.#(qnan|snan|ind))|#?n/?a|#(num|value|div/0)!|null|none", re.I)


def encoding_of(start: bytes, path: str) -> str:
    """Encoding of a text by its first bytes: UTF-8 or UTF-16 with or without mark, else cp1252.

    Raises:
        ValueError: not text.
    """
    for mark, name in _BOMS.items():
        if start.startswith(mark):
            return name
    if b"\0" in start:
        # ASCII as UTF-16 has every second byte zero
        for name, zeros in (("utf-16-le", start[1::2]), ("utf-16-be", start[0::2])):
            if zeros.count(0) > 0.9 * len(zeros) and start.count(0) < 0.6 * len(start):
                return name
        raise ValueError(f"expected text, got zero bytes as in a binary file ({path})")
    try:
        codecs.getincrementaldecoder("utf-8")().decode(start)
    except UnicodeDecodeError:
        return "cp1252"
    return "utf-8"


def decode(content: bytes, path: str) -> str:
    """A whole text in whatever encoding; one line on what cannot be text."""
    encoding = encoding_of(content, path)
    try:
        text = content.decode(encoding)
    except UnicodeDecodeError as error:
        raise ValueError(
            f"not {encoding} text: {error.reason} at byte {error.start} ({path})"
        ) from error
    odd = next((sign for sign in text if sign < " " and sign not in "\t\r\n\f\v"), None)
    if odd is not None:
        raise ValueError(f"not a text: it holds the control character {odd!r} ({path})")
    return text


def separator_of(line: str) -> str | None:
    """What splits a line's fields: semicolon, tab or comma, in this order; None for spaces."""
    return next((sign for sign in ";\t," if sign in line), None)


def numeric(field: str) -> bool:
    """Whether a field is a number, with a decimal point or comma."""
    return bool(
        re.fullmatch(r"[-+]?(\d+[.,]?\d*|[.,]\d+)([eE][-+]?\d+)?|[-+]?(nan|inf)", field, re.I)
    )


def no_number(field: str) -> float | None:
    """What a mark in the place of a number means: infinity for a sensor over its range, NaN for a
    sample that is lost; None where it is no such mark.
    """
    if _OVER.fullmatch(field):
        return math.inf
    return math.nan if _LOST.fullmatch(field) else None


def unsure(field: str) -> bool:
    """Whether a number's only comma or point may stand between thousands."""
    return _UNSURE.fullmatch(field) is not None


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
    if all(unsure(field) for _, field in commas):
        raise ValueError(
            f"expected numbers without commas between thousands, got {field!r}, whose comma may "
            f"be that or a decimal one ({path}, row {first + row + 1})"
        )
