"""MATLAB .mat of version 5 (scipy) and 7.3 (h5py): full and sparse matrices."""

import numpy as np
import scipy.sparse as sp

from bladeroot.hdf5_links import check_links
from bladeroot.rom.external.reading import choose

SUFFIXES = (".mat",)


def read(path: str, variable: str | None = None) -> sp.coo_array:
    """One variable of the file, which may be left out where there is only one matrix."""
    with open(path, "rb") as file:
        head = file.read(520)
    new = head.startswith(b"\x89HDF") or head[512:516] == b"\x89HDF"
    return _version_73(path, variable) if new else _version_5(path, variable)


def _version_5(path: str, variable: str | None) -> sp.coo_array:
    from scipy.io import loadmat, whosmat

    matrices = [name for name, shape, kind in whosmat(path) if _is_matrix(shape, kind)]
    name = choose(matrices, variable, path)
    return sp.coo_array(loadmat(path, variable_names=[name])[name])


def _is_matrix(shape: tuple[int, ...], kind: str) -> bool:
    return len(shape) == 2 and max(shape) > 1 and kind in ("double", "single", "sparse")


def _is_full(item: object) -> bool:
    return getattr(item, "ndim", 0) == 2 and item.size > 1 and item.dtype.kind == "f"


def _version_73(path: str, variable: str | None) -> sp.coo_array:
    import h5py

    check_links(path)
    with h5py.File(path) as file:
        sparse = {n for n, item in file.items() if "MATLAB_sparse" in item.attrs}
        full = {n for n, item in file.items() if _is_full(item)}
        name = choose(sorted(sparse | full), variable, path)
        item = file[name]
        if name in full:
            # the axes of a 7.3 file stand in the other order
            return sp.coo_array(np.asarray(item[()]).T)
        starts = np.asarray(item["jc"][()]).astype(np.int64)
        rows = int(item.attrs["MATLAB_sparse"])
        if "data" not in item:  # MATLAB leaves out what is empty
            return sp.coo_array((rows, len(starts) - 1))
        values, index = item["data"][()], item["ir"][()].astype(np.int64)
        return sp.coo_array(sp.csc_array((values, index, starts), shape=(rows, len(starts) - 1)))
