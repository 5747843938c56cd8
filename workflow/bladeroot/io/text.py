"""Text files as labs write them: their encoding, and what splits their fields."""

import codecs

_BOMS = {
    codecs.BOM_UTF8: "utf-8-sig",
    codecs.BOM_UTF16_LE: "utf-16",
    codecs.BOM_UTF16_BE: "utf-16",
}


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
