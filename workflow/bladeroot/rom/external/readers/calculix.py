"""CalculiX's matrices of *FREQUENCY, SOLVER=MATRIXSTORAGE: .sti (stiffness) and .mas (mass).

Lines of row, column (from 1) and value, one triangle with the diagonal; the .dof file beside them
says which node and direction each row is.
"""

import numpy as np
import scipy.sparse as sp

from bladeroot.rom.external.reading import both_triangles, refuse_variable

SUFFIXES = (".sti", ".mas")


def read(path: str, variable: str | None = None) -> sp.coo_array:
    """The file's one matrix, spread to both triangles."""
    refuse_variable(variable, path)
    rows, columns, values = np.loadtxt(path, ndmin=2).reshape(-1, 3).T
    index = rows.astype(np.int64) - 1, columns.astype(np.int64) - 1
    size = int(max(part.max(initial=-1) for part in index)) + 1
    return both_triangles(sp.coo_array((values, index), shape=(size, size)), path)
