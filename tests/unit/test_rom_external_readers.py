"""Each format gives back the matrix that was written, and tells what is wrong with a file."""

import netCDF4
import numpy as np
import pytest
import scipy.io
import scipy.sparse as sp
from bladeroot.rom.external.equations import equations_of
from bladeroot.rom.external.export import _write_harwell_boeing
from bladeroot.rom.external.matrix_file import formats, read_matrix
from bladeroot.rom.external.tables import Table


@pytest.fixture(scope="module")
def matrix():
    rng = np.random.default_rng(3)
    root = sp.random_array((40, 40), density=0.1, rng=rng)
    return sp.csr_array(root + root.T + sp.diags_array(rng.uniform(1.0, 2.0, 40)))


def same(found, expected, rtol=0.0):
    np.testing.assert_allclose(found.toarray(), expected.toarray(), rtol=rtol)


@pytest.mark.parametrize("symmetry", ["symmetric", "general"])
def test_matrix_market(tmp_path, matrix, symmetry):
    scipy.io.mmwrite(tmp_path / "K.mtx", sp.coo_array(matrix), precision=17, symmetry=symmetry)
    same(read_matrix(tmp_path, "K.mtx"), matrix)


@pytest.mark.parametrize("full", [True, False])
def test_matlab_5(tmp_path, matrix, full):
    content = {"K": matrix.toarray() if full else sp.csc_matrix(matrix), "x": np.ones((3, 1))}
    scipy.io.savemat(tmp_path / "model.mat", {**content, "note": "text", "n": 40.0})
    same(read_matrix(tmp_path, "model.mat#K"), matrix)


@pytest.mark.parametrize("full", [True, False])
def test_matlab_73(tmp_path, matrix, full):
    h5py = pytest.importorskip("h5py")
    stored = sp.csc_array(matrix)
    with h5py.File(tmp_path / "model.mat", "w", userblock_size=512) as file:
        if full:
            file["K"] = matrix.toarray().T
        else:
            group = file.create_group("K")
            group.attrs["MATLAB_sparse"] = np.uint64(40)
            group["data"], group["ir"], group["jc"] = stored.data, stored.indices, stored.indptr
    same(read_matrix(tmp_path, "model.mat"), matrix)


@pytest.mark.parametrize("first", [0, 1])
def test_netcdf(tmp_path, matrix, first):
    triplets = sp.coo_array(matrix)
    with netCDF4.Dataset(tmp_path / "model.nc", "w") as file:
        file.createDimension("entry", triplets.nnz)
        file.createDimension("row", 40)
        for name, values in zip(("K_row", "K_column"), triplets.coords, strict=True):
            item = file.createVariable(name, "i4", ("entry",))
            item[:] = values + first
            if first:
                item.start_index = first
        file.createVariable("K_value", "f8", ("entry",))[:] = triplets.data
        file.createVariable("M", "f8", ("row", "row"))[:] = matrix.toarray()
    same(read_matrix(tmp_path, "model.nc#K"), matrix)
    same(read_matrix(tmp_path, "model.nc#M"), matrix)
    with pytest.raises(ValueError, match=r"expected file#name.*K, M .*model\.nc"):
        read_matrix(tmp_path, "model.nc")
    with pytest.raises(ValueError, match=r"expected a matrix C, the file holds K, M .*model\.nc"):
        read_matrix(tmp_path, "model.nc#C")


@pytest.mark.parametrize("suffix", [".hb", ".matrix", ".txt"])
def test_harwell_boeing(tmp_path, matrix, suffix):
    _write_harwell_boeing(tmp_path / f"K{suffix}", matrix, "a title")
    same(read_matrix(tmp_path, f"K{suffix}"), matrix)


def test_unsymmetric_storage_as_scipy_writes_it(tmp_path, matrix):
    scipy.io.hb_write(tmp_path / "K.rua", sp.csc_matrix(matrix))
    same(read_matrix(tmp_path, "K.rua"), matrix, rtol=1e-12)


def test_fields_that_do_not_fit_the_header_are_told_with_their_line(tmp_path):
    """scipy states a width of 25 and writes 24, which shows where a third number is negative."""
    scipy.io.hb_write(tmp_path / "K.rua", sp.csc_matrix([[1e-7, -1e-6], [-1e-6, 1e-7]]))
    told = r"25 characters of line 7, .*format \(3E25.16\) says, got '-9.9+5E-07 -' .*K.rua"
    with pytest.raises(ValueError, match=told):
        read_matrix(tmp_path, "K.rua")


HBMAT = """\
stiffness of a chain                                                    STIFF
            13             4             5             5             3
RSA                        3             3             5             0
(1I14)          (1I14)          (1D25.15)           (1D25.15)
F                          1             0
             1
             3
             5
             6
             1
             2
             2
             3
             3
   0.200000000000000D+04
  -0.100000000000000D+04
   0.200000000000000D+04
  -0.100000000000000D+04
   0.100000000000000D+04
   0.000000000000000D+00
   0.000000000000000D+00
   0.250000000000000D+01
"""
CHAIN = sp.csr_array(np.array([[2e3, -1e3, 0], [-1e3, 2e3, -1e3], [0, -1e3, 1e3]]))


def test_as_hbmat_writes_it_with_a_load_at_the_end(tmp_path):
    (tmp_path / "file.matrix").write_text(HBMAT)
    same(read_matrix(tmp_path, "file.matrix"), CHAIN)


def test_rutherford_boeing_with_fields_that_touch(tmp_path):
    (tmp_path / "K.rb").write_text(
        f"{'chain':<72}{'K':<8}\n"
        f"{3:14d}{1:14d}{1:14d}{1:14d}\n"
        f"rsa{'':11}{3:14d}{3:14d}{5:14d}{0:14d}\n"
        f"{'(4I3)':<16}{'(5I3)':<16}{'(1P5E11.4)':<20}\n"
        "  1  3  5  6\n"
        "  1  2  2  3  3\n"
        " 2.0000E+03-1.0000E+03 2.0000E+03-1.0000E+03 1.0000E+03\n"
    )
    same(read_matrix(tmp_path, "K.rb"), CHAIN)


def test_calculix(tmp_path):
    (tmp_path / "job.sti").write_text("1 1 2e3\n1 2 -1e3\n2 2 2e3\n2 3 -1e3\n3 3 1e3\n")
    same(read_matrix(tmp_path, "job.sti"), CHAIN)


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("RSA", "PUA", "expected a real assembled matrix"),
        ("RSA", "CSA", "expected a real assembled matrix"),
        ("(1I14)", "(oops)", "expected a Fortran format"),
        (
            "0.200000000000000D+04\n  -0.1",
            "0.2000000x0000000D+04\n  -0.1",
            "in each 25 characters of line 15",
        ),
        ("   0.100000000000000D+04\n   0.0", "   NaN\n   0.0", "expected finite numbers, got nan"),
        ("             6\n", "             7\n", "expected column pointers from 1 to 6"),
    ],
)
def test_a_faulty_harwell_boeing_file_is_one_line(tmp_path, old, new, told):
    assert old in HBMAT
    (tmp_path / "file.matrix").write_text(HBMAT.replace(old, new, 1))
    with pytest.raises(ValueError, match=r"file\.matrix") as caught:
        read_matrix(tmp_path, "file.matrix")
    assert told in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_file_that_is_cut_off_is_one_line(tmp_path):
    (tmp_path / "file.matrix").write_text(HBMAT[: HBMAT.index("   0.100000000000000D+04")])
    with pytest.raises(ValueError, match=r"expected 5 numbers in .* got 4 .*file\.matrix"):
        read_matrix(tmp_path, "file.matrix")


@pytest.mark.parametrize("suffix", sorted(formats()))
def test_rubbish_is_one_line_in_every_format(tmp_path, suffix):
    (tmp_path / f"K{suffix}").write_bytes(b"\x00\xffrubbish\n1 2 x\n")
    with pytest.raises(ValueError, match=rf"K\{suffix}") as caught:
        read_matrix(tmp_path, f"K{suffix}")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("values", "told"),
    [
        (np.ones((2, 3)), "expected a square matrix, got 2 x 3"),
        (np.array([[1.0, 2.0], [2.1, 1.0]]), "expected a symmetric matrix, got"),
        (np.array([[1.0, np.inf], [np.inf, 1.0]]), "expected finite numbers, got inf in row 1"),
        (np.eye(2) * 1j, "expected a real matrix"),
    ],
)
def test_what_no_mass_or_stiffness_can_be(tmp_path, values, told):
    scipy.io.mmwrite(tmp_path / "K.mtx", sp.coo_array(values), symmetry="general")
    with pytest.raises(ValueError, match=r"K\.mtx") as caught:
        read_matrix(tmp_path, "K.mtx")
    assert told in str(caught.value)


def test_a_name_where_there_is_only_one_matrix(tmp_path, matrix):
    scipy.io.mmwrite(tmp_path / "K.mtx", sp.coo_array(matrix))
    with pytest.raises(ValueError, match=r"leave #K out .*K\.mtx"):
        read_matrix(tmp_path, "K.mtx#K")


def test_missing_and_unknown_files(tmp_path):
    with pytest.raises(ValueError, match=r"expected a matrix file, got none at .*K\.mtx"):
        read_matrix(tmp_path, "K.mtx")
    with pytest.raises(ValueError, match=r"expected a matrix file ending in .*\.mtx.*K\.full"):
        read_matrix(tmp_path, "K.full")


def _punched(name, matrix):
    """DMIG cards as Nastran punches them: a triangle by columns, three directions a node."""
    lines = [f"DMIG    {name:<8}{0:8d}{6:8d}{2:8d}{0:8d}"]
    for column in range(matrix.shape[0]):
        lines.append(f"DMIG*   {name:<16}{column // 3 + 1:16d}{column % 3 + 1:16d}")
        for row in range(column, matrix.shape[0]):
            if matrix[row, column]:
                value = f"{matrix[row, column]:.9E}".replace("E", "D")
                lines.append(f"*       {row // 3 + 1:16d}{row % 3 + 1:16d}{value:>16}")
    return lines


def test_punch(tmp_path, matrix):
    dense = matrix.toarray()[:39, :39]
    lines = _punched("KAAX", dense) + _punched("MAAX", 2.0 * dense)
    (tmp_path / "model.pch").write_text("\n".join(lines) + "\n")
    for name, factor in (("KAAX", 1.0), ("MAAX", 2.0)):
        found = read_matrix(tmp_path, f"model.pch#{name}").toarray()
        np.testing.assert_allclose(found, factor * dense, atol=1e-8 * abs(dense).max())


@pytest.mark.parametrize("square", [True, False])
def test_abaqus(tmp_path, matrix, square):
    small = sp.coo_array(matrix[:39, :39] if square else sp.tril(matrix[:39, :39]))
    rows = [f"{i // 3 + 5},{i % 3 + 1}, {j // 3 + 5},{j % 3 + 1}, {v!r}"
            for i, j, v in zip(*small.coords, small.data.tolist(), strict=True)]  # fmt: skip
    (tmp_path / "job_STIF2.mtx").write_text("\n".join(rows) + "\n")
    same(read_matrix(tmp_path, "job_STIF2.mtx"), sp.csr_array(matrix[:39, :39]))
    equations = equations_of(
        Table(tmp_path / "nodes.csv", [], {"node": [str(k) for k in range(1, 30)]}),
        tmp_path / "job_STIF2.mtx",
    )
    np.testing.assert_array_equal(equations.node, np.repeat(np.arange(4, 17), 3))
    np.testing.assert_array_equal(equations.axis, np.tile(np.arange(3), 13))


def _op4(name, matrix, kind):
    """OUTPUT4 as text: dense, sparse, or sparse with large rows."""
    count = matrix.shape[0]
    lines = [f"{count:8d}{-count if kind == 'large' else count:8d}{2:8d}{2:8d}{name:<8}1P,3E23.16"]

    def numbers(values):
        fields = [f"{value:23.16E}" for value in values]
        return ["".join(fields[k : k + 3]) for k in range(0, len(fields), 3)]

    for column in range(count):
        used = np.flatnonzero(matrix[:, column])
        if kind == "dense":
            values = matrix[used[0] : used[-1] + 1, column]
            lines += [f"{column + 1:8d}{used[0] + 1:8d}{2 * len(values):8d}", *numbers(values)]
            continue
        lines.append(f"{column + 1:8d}{0:8d}{100:8d}")
        for part in np.split(used, np.flatnonzero(np.diff(used) > 1) + 1):
            words, row = 2 * len(part), int(part[0]) + 1
            packed = (
                f"{words + 1:8d}{row:8d}" if kind == "large" else f"{row + 65536 * (words + 1):12d}"
            )
            lines += [packed, *numbers(matrix[part, column])]
    return [*lines, f"{count + 1:8d}{1:8d}{1:8d}", f"{1.0:23.16E}"]


@pytest.mark.parametrize("kind", ["dense", "sparse", "large"])
def test_op4(tmp_path, matrix, kind):
    dense = matrix.toarray()
    lines = _op4("KAA", dense, kind) + _op4("MAA", 3.0 * dense, kind)
    (tmp_path / "model.op4").write_text("\n".join(lines) + "\n")
    same(read_matrix(tmp_path, "model.op4#KAA"), matrix)
    same(read_matrix(tmp_path, "model.op4#MAA"), 3.0 * matrix)
    (tmp_path / "binary.op4").write_bytes(b"\x18\0\0\0" + bytes(40))
    with pytest.raises(ValueError, match="as text"):
        read_matrix(tmp_path, "binary.op4")
