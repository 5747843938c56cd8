"""Matrix Market (.mtx): coordinate or array, general or symmetric; and Abaqus's .mtx files."""

import scipy.sparse as sp
from scipy.io import mmread

from bladeroot.rom.external.labelled import abaqus_entries, is_abaqus, matrix_of
from bladeroot.rom.external.reading import refuse_variable

SUFFIXES = (".mtx", ".mm")


def read(path: str, variable: str | None = None) -> sp.coo_array:
    """The file's one matrix; a symmetric file is spread to both triangles."""
    refuse_variable(variable, path)
    if is_abaqus(path):
        return matrix_of(abaqus_entries(path), path)
    return sp.coo_array(mmread(path))
