"""Matrix Market (.mtx): coordinate or array, general or symmetric."""

import scipy.sparse as sp
from scipy.io import mmread

from bladeroot.rom.external.reading import refuse_variable

SUFFIXES = (".mtx", ".mm")


def read(path: str, variable: str | None = None) -> sp.coo_array:
    """The file's one matrix; a symmetric file is spread to both triangles."""
    refuse_variable(variable, path)
    return sp.coo_array(mmread(path))
