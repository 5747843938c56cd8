"""A checksum at the end of a file, by which a reader knows that it is whole and unaltered.

It stands behind the content: NetCDF-4 (HDF5) files end where their header says, and readers ignore
what follows.
"""

import hashlib
from pathlib import Path

_MARK = b"\nbladeroot sha256 "
# Bytes at the end of a sealed file: the mark, the digest in hexadecimal and a line end.
LENGTH = len(_MARK) + 64 + 1
_BLOCK_BYTES = 1 << 20  # that are read at a time


def seal(path: str | Path) -> None:
    """Write the checksum of a file's content behind it."""
    with open(path, "r+b") as file:
        size = file.seek(0, 2)
        digest = _digest(file, size)
        file.seek(size)
        file.write(_MARK + digest.encode() + b"\n")


def fault(path: str | Path) -> str:
    """What is wrong with a sealed file: "", or `is empty`, `is cut off ...`, `was altered ...`.

    Raises OSError if it cannot be read.
    """
    with open(path, "rb") as file:
        size = file.seek(0, 2) - LENGTH
        if size + LENGTH == 0:
            return "is empty"
        file.seek(max(size, 0))
        end = file.read(LENGTH)
        if size < 0 or not end.startswith(_MARK):
            return "is cut off, or was not written by this version: it has no checksum at its end"
        if _digest(file, size).encode() != end[len(_MARK) : -1]:
            return "was altered after it was written: its checksum does not match"
    return ""


def is_sealed(path: str | Path) -> bool:
    """Whether a file ends with a checksum, right or wrong."""
    with open(path, "rb") as file:
        size = file.seek(0, 2)
        file.seek(max(size - LENGTH, 0))
        return file.read(len(_MARK)) == _MARK


def _digest(file, size: int) -> str:
    """Of the first `size` bytes of an open file."""
    digest, left = hashlib.sha256(), size
    file.seek(0)
    while left and (block := file.read(min(left, _BLOCK_BYTES))):
        digest.update(block)
        left -= len(block)
    return digest.hexdigest()
