"""Nastran's punched matrices (.pch, DMIG cards): EXTSEOUT, or EXTOUT of OptiStruct."""

import scipy.sparse as sp

from bladeroot.rom.external.labelled import matrix_of, punch_entries

SUFFIXES = (".pch",)


def read(path: str, variable: str | None = None) -> sp.coo_array:
    """The named matrix, or the only one."""
    return matrix_of(punch_entries(path, variable), path)
