"""Nastran's OUTPUT4 as text (FORMATTED): real matrices, dense or sparse, also with large rows.

A small reader instead of pyNastran, whose 8 MB need numpy below 2.
"""

import re

import numpy as np
import scipy.sparse as sp

from bladeroot.rom.external.reading import both_triangles, check_order, choose

SUFFIXES = (".op4",)
_SYMMETRIC = 6  # form: only a triangle need be stored
_NUMBERS = re.compile(r"[\s\dEeDd+-]*\.[\s\dEeDd.+-]*")  # of a column; headers have no point
_STRING_PACKING = 65536  # a string's header packs its length and its first row


def read(path: str, variable: str | None = None) -> sp.coo_array:
    """The named matrix, or the only one."""
    with open(path, "rb") as file:
        if b"\0" in file.read(1024):
            raise ValueError(f"expected an OP4 file as text (FORMATTED), got a binary one ({path})")
    with open(path, encoding="latin-1") as file:
        lines = [line.rstrip("\r\n") for line in file if line.strip()]
    found, k = {}, 0
    while k < len(lines):
        name, matrix, k = _matrix(lines, k, path)
        found[name] = matrix
    return found[choose(list(found), variable, path)]


def _matrix(lines: list[str], k: int, path: str) -> tuple[str, sp.coo_array, int]:
    head = lines[k]
    columns, rows, form, kind = (int(head[8 * n : 8 * n + 8]) for n in range(4))
    name, large = head[32:40].strip(), rows < 0
    width = re.search(r"E(\d+)\.", head[40:])
    if kind not in (1, 2) or width is None:
        raise ValueError(f"expected a real matrix, got type {kind} of {name} ({path})")
    rows, digits = abs(rows), int(width[1])
    check_order(max(rows, columns), path)
    where, values = [], []
    k += 1
    while k < len(lines):
        column, row, _ = (int(lines[k][8 * n : 8 * n + 8]) for n in range(3))
        k += 1
        while k < len(lines) and (row == 0 or _NUMBERS.fullmatch(lines[k])):
            if not _NUMBERS.fullmatch(lines[k]):  # a string's header, or the next column's
                if len(lines[k].split()) > 2:
                    break
                told = [int(word) for word in lines[k].split()]
                at = told[1] if large else told[0] % _STRING_PACKING
                k += 1
            else:
                at = row
            while k < len(lines) and _NUMBERS.fullmatch(lines[k]):
                text = lines[k].replace("D", "E")
                for start in range(0, len(text.rstrip()), digits):
                    where.append((at - 1, column - 1))
                    values.append(float(text[start : start + digits]))
                    at += 1
                k += 1
            if row:
                break
        if column > columns:
            break
    index = np.array(where, dtype=np.int64).reshape(-1, 2)
    inside = index[:, 1] < columns  # the last record closes the matrix
    stored = sp.coo_array((np.array(values)[inside], index[inside].T), shape=(rows, columns))
    one_sided = form == _SYMMETRIC and not (sp.tril(stored, -1).nnz and sp.triu(stored, 1).nnz)
    return name, both_triangles(stored, path) if one_sided else stored, k
