"""Harwell-Boeing and Rutherford-Boeing text, as ANSYS's HBMAT writes it (ASCII form)."""

import re
from collections.abc import Mapping

import numpy as np
import scipy.sparse as sp

from bladeroot.rom.external.reading import both_triangles, refuse_variable

SUFFIXES = (".hb", ".rb", ".rsa", ".rua", ".matrix", ".txt")
_FORMAT = re.compile(r"\(?\s*(?:\d+P,?)?\s*(\d*)\s*([IEDFG])\s*(\d+)", re.IGNORECASE)


def read(path: str, variable: str | None = None) -> sp.coo_array:
    """The file's one matrix: real, assembled, symmetric (one triangle stored) or not.

    A right-hand side at the end is left alone.
    """
    refuse_variable(variable, path)
    with open(path, encoding="latin-1") as file:
        lines = file.read().splitlines()
    _, of_lines, sizes, formats = (lines + [""] * 4)[:4]  # the first is the title
    counts = _whole_numbers(of_lines, "line 2, the numbers of lines", 4, path)
    kind, *rest = sizes.split() or [""]
    if not re.fullmatch(r"[Rr][SsUu][Aa]", kind):
        raise ValueError(
            f"expected a real assembled matrix (RSA or RUA) in line 3, got {kind!r} ({path})"
        )
    rows, columns, entries = _whole_numbers(" ".join(rest), "line 3, the sizes", 3, path)[:3]
    forms = [formats[:16], formats[16:32], formats[32:52]]
    with_right_side = len(counts) > 4 and counts[4] > 0  # which has a line of its own
    ends = np.cumsum([5 if with_right_side else 4, *counts[1:4]]).tolist()
    first, second, third = (
        (dict(enumerate(lines[a:b], a + 1)), form)
        for a, b, form in zip(ends[:-1], ends[1:], forms, strict=True)
    )
    starts = _numbers(*first, columns + 1, int, path) - 1
    index = _numbers(*second, entries, int, path) - 1
    values = _numbers(*third, entries, float, path)
    if starts[0] != 0 or starts[-1] != entries or (np.diff(starts) < 0).any():
        raise ValueError(
            f"expected column pointers from 1 to {entries + 1}, got {starts[0] + 1} to "
            f"{starts[-1] + 1} ({path})"
        )
    column = np.repeat(np.arange(columns), np.diff(starts))
    stored = sp.coo_array((values, (index, column)), shape=(rows, columns))
    return both_triangles(stored, path) if kind[1] in "Ss" else stored


def _whole_numbers(line: str, what: str, least: int, path: str) -> list[int]:
    try:
        numbers = [int(word) for word in line.split()]
    except ValueError:
        numbers = []
    if len(numbers) < least:
        raise ValueError(f"expected {least} whole numbers in {what}, got {line.strip()!r} ({path})")
    return numbers


def _numbers(
    lines: Mapping[int, str], form: str, expected: int, kind: type, path: str
) -> np.ndarray:
    """`expected` numbers from lines, by their number, of a Fortran format such as (4D20.12)."""
    match = _FORMAT.match(form)
    if match is None or int(match[3]) == 0:
        raise ValueError(f"expected a Fortran format such as (4D20.12), got {form!r} ({path})")
    width, a_line = int(match[3]), int(match[1] or 1)
    numbers = []
    for at, line in lines.items():
        # a format may claim any number
        for k in range(min(a_line, len(line) // width + 1)):
            field = line[k * width : (k + 1) * width].strip()
            plain = field.replace("D", "E").replace("d", "e") if kind is float else field
            try:
                numbers += [kind(plain)] if plain else []
            except ValueError:
                raise ValueError(
                    f"expected a number in each {width} characters of line {at}, as the header's "
                    f"format {form.strip()} says, got {field!r} ({path})"
                ) from None
    if len(numbers) != expected:
        raise ValueError(f"expected {expected} numbers in {form}, got {len(numbers)} ({path})")
    return np.array(numbers)
