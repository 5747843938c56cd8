"""Reading one matrix file, by its suffix, and what must hold for a mass or a stiffness."""

import importlib
import pkgutil
import warnings
from functools import cache
from pathlib import Path

import numpy as np
import scipy.sparse as sp

from bladeroot.rom.external import readers
from bladeroot.rom.external.reading import check_order, check_path

# Largest difference of a matrix from its transpose, over its largest entry.
ASYMMETRY = 1.0e-9


@cache
def formats() -> dict[str, str]:
    """Module of every known suffix; a new file in `readers` is found by itself."""
    known = {}
    for module in pkgutil.iter_modules(readers.__path__):
        name = f"{readers.__name__}.{module.name}"
        known.update(dict.fromkeys(importlib.import_module(name).SUFFIXES, name))
    return known


def split(reference: str) -> tuple[str, str | None]:
    """File and variable of `model.mat#K`; the variable is None in `K.mtx`."""
    file, _, variable = reference.partition("#")
    return file, variable or None


def check_file(path: Path) -> None:
    """Raise ValueError, one line, if there is no such file or no reader for its suffix."""
    if path.suffix.lower() not in formats():
        raise ValueError(
            f"expected a matrix file ending in {', '.join(sorted(formats()))}, got {path}"
        )
    check_path(path, "a matrix file")


def read_matrix(folder: Path, reference: str) -> sp.csr_array:
    """A real, finite, square and symmetric matrix as written in the file, in the file's units.

    `reference` is a path from `folder`, with the name of the matrix behind # where the file holds
    several. Raises ValueError, one line that names the file and what was expected.
    """
    name, variable = split(reference)
    path = folder / name
    check_file(path)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found = importlib.import_module(formats()[path.suffix.lower()]).read(
                str(path), variable
            )
    except ImportError:
        raise
    except Exception as error:
        text = " ".join(str(error).split())[:400]
        if isinstance(error, ValueError) and str(path) in text:
            raise ValueError(text) from error
        raise ValueError(
            f"expected a sound {path.suffix} file, got {type(error).__name__}: {text} ({path})"
        ) from error
    return _checked(found, f"{folder / reference}")


def _checked(found: sp.coo_array, where: str) -> sp.csr_array:
    rows, columns = found.shape
    if rows != columns or rows == 0:
        raise ValueError(f"expected a square matrix, got {rows} x {columns} ({where})")
    check_order(rows, where)
    if np.iscomplexobj(found.data):
        raise ValueError(f"expected a real matrix, got a complex one ({where})")
    bad = np.flatnonzero(~np.isfinite(found.data))
    if len(bad):
        row, column = (part[bad[0]] + 1 for part in found.coords)
        raise ValueError(
            f"expected finite numbers, got {found.data[bad[0]]} in row {row}, column {column} "
            f"({where})"
        )
    matrix = sp.csr_array(found, dtype=float)
    matrix.sum_duplicates()
    matrix.eliminate_zeros()
    off = sp.coo_array(matrix - matrix.T)
    if off.nnz and not np.abs(off.data).max() <= ASYMMETRY * np.abs(matrix.data).max():
        row, column = (part[np.argmax(np.abs(off.data))] for part in off.coords)
        raise ValueError(
            f"expected a symmetric matrix, got {matrix[row, column]:.6g} in row {row + 1}, column "
            f"{column + 1} and {matrix[column, row]:.6g} across the diagonal ({where})"
        )
    return sp.csr_array(matrix / 2 + matrix.T / 2)
