"""Matrices and tables of a model made elsewhere: what they claim, and what is valid and odd."""

import shutil

import h5py
import netCDF4
import numpy as np
import pytest
import scipy.io
import scipy.sparse as sp
import yaml
from answers import answer
from bladeroot.rom.external.description import read_description
from bladeroot.rom.external.export import export_matrices
from bladeroot.rom.external.matrix_file import read_matrix
from bladeroot.rom.external.mesh import external_mesh
from bladeroot.rom.external.reading import MOST_ROWS
from bladeroot.rom.external.reduction import reduce_matrices
from bladeroot.rom.joint import joint_of_reduced
from bladeroot.rom.parametric import frequencies, surface_of
from bladeroot.rom.parametric_build import parametric_model
from structure_coarse import coarse_loaded


def hdf5(change):
    def make(path):
        with h5py.File(path, "w", userblock_size=512) as file:
            file["K"] = np.eye(4)
            change(file, path)

    return make


def external(file, path):
    with h5py.File(path.with_name("other.mat"), "w") as other:
        other["K"] = np.eye(3)
    del file["K"]
    file["K"] = h5py.ExternalLink("other.mat", "K")


def loop(file, _):
    file["g"] = file["/"]


def netcdf(**attributes):
    def make(path):
        with netCDF4.Dataset(path, "w") as file:
            file.createDimension("n", 3)
            for part, values in (("row", [0, 1, 2]), ("column", [0, 1, 2]), ("value", [1.0] * 3)):
                one = file.createVariable(f"K_{part}", "i8" if part != "value" else "f8", "n")
                one[:] = values
            for name, value in attributes.items():
                file["K_value"].setncattr(name, value)

    return make


def text(content):
    return lambda path: path.write_text(content)


def market(sizes, entry="1 1 1.0", kind="coordinate real symmetric"):
    return text(f"%%MatrixMarket matrix {kind}\n{sizes}\n{entry}\n")


def harwell(counts="3 1 1 1", sizes="1 1 1", form="8I10"):
    forms = f"({form})".ljust(16) + "(8I10)".ljust(16) + "(4D20.12)".ljust(20)
    return text(f"title\n{counts}\nRSA {sizes} 0\n{forms}\n1\n1\n1.0\n")


BIG = "9" * 400
ROWS = f"{MOST_ROWS} rows"
# Name of the file, how it is made, and what is said of it.
MATRICES = {
    "an order of 10^9": ("k.mtx", market("1000000000 1000000000 1"), ROWS),
    "an order of 10^18": ("k.mtx", market(f"{10**18} {10**18} 1"), "k.mtx"),
    "an order of 400 digits": ("k.mtx", market(f"{BIG} {BIG} 1"), "k.mtx"),
    "10^12 entries": ("k.mtx", market("3 3 1000000000000"), "k.mtx"),
    "an entry outside": ("k.mtx", market("3 3 1", "9 9 1.0"), "k.mtx"),
    "an entry of 400 digits": ("k.mtx", market("1 1 1", f"1 1 {BIG}"), "k.mtx"),
    "a huge array": ("k.mtx", market("1000000 1000000", "1.0", "array real general"), "k.mtx"),
    "numbers near the largest, not symmetric": (
        "k.mtx",
        market("2 2 2", "1 2 1.7e308\n2 1 -1.7e308", "coordinate real general"),
        "symmetric",
    ),
    "no matrix": ("k.mtx", text("<script>"), "k.mtx"),
    "negative order": ("k.mtx", market("-3 -3 0", ""), "k.mtx"),
    "a node of 30 digits": ("k.sti", text("9" * 30 + " 1 1.0\n"), "k.sti"),
    "an order of 10^9 in triplets": ("k.sti", text("1000000000 1000000000 1.0\n"), ROWS),
    "a negative row": ("k.sti", text("-5 1 1.0\n"), "k.sti"),
    "10^9 columns": ("k.hb", harwell(sizes="1000000000 1000000000 1"), "k.hb"),
    "a format of 10^9 fields": ("k.hb", harwell(form="999999999I1"), "k.hb"),
    "a format without width": ("k.hb", harwell(form="8I0"), "format"),
    "10^12 lines": ("k.hb", harwell("3 1000000000000 1 1"), "k.hb"),
    "sizes of 5000 digits": ("k.hb", harwell("9" * 5000 + " 1 1 1"), "k.hb"),
    "a link to another file": ("k.mat#K", hdf5(external), "link to another"),
    "a loop of groups": ("k.mat#K", hdf5(loop), "two names"),
    "a scale that is a text": ("k.nc#K", netcdf(scale_factor="0.001"), "scale_factor"),
    "a size of 10^9": ("k.nc#K", netcdf(size=10**9), ROWS),
    "a size of nothing": ("k.nc#K", netcdf(size=0), "k.nc"),
    "braces in the name": ("{k}.mtx", text(""), "braces"),
    "a name of 300 signs": ("k" * 300 + ".mtx", lambda path: None, "none at"),
}


@pytest.mark.parametrize("case", MATRICES)
def test_matrix(case, tmp_path):
    reference, make, told = MATRICES[case]
    path = tmp_path / reference.partition("#")[0]
    make(path)
    assert len(answer(lambda: read_matrix(tmp_path, reference), path.name[:60], told)) == 1


def test_numbers_near_the_largest_stay_what_they_are(tmp_path):
    market("1 1 1", "1 1 1.7e308")(tmp_path / "k.mtx")
    assert read_matrix(tmp_path, "k.mtx").toarray() == 1.7e308


@pytest.fixture(scope="module")
def exported(tmp_path_factory):
    folder = tmp_path_factory.mktemp("exported")
    export_matrices(*coarse_loaded(), folder, "mtx", "mtx")
    return folder


@pytest.fixture
def lab(exported, tmp_path):
    shutil.copytree(exported, tmp_path / "lab")
    return tmp_path / "lab"


# A table, the part of its second row that is changed, and what is said.
TABLES = {
    "a node of 30 digits": ("beam_nodes.csv", 0, "9" * 30, "18 digits"),
    "a node of 5000 digits": ("beam_nodes.csv", 0, "9" * 5000, "18 digits"),
    "a node below zero": ("beam_nodes.csv", 0, "-1", "whole number"),
    "a node in another script": ("beam_nodes.csv", 0, "١", "whole number"),
    "a place of 400 digits": ("beam_nodes.csv", 1, "9" * 400, "finite"),
    "a place that is none": ("beam_nodes.csv", 1, "nan", "finite"),
    "a contact of 30 digits": ("contact.csv", 1, "9" * 30, "18 digits"),
    "an area of nothing": ("contact.csv", 3, "0", "positive"),
    "an area that is none": ("contact.csv", 3, "nan", "finite"),
    "no normal": ("contact.csv", 4, "1e-400", "normal"),
}


@pytest.mark.parametrize("case", TABLES)
def test_table(case, lab):
    name, column, cell, told = TABLES[case]
    path = next(lab.rglob(f"*{name}"))
    lines = path.read_text().splitlines()
    first = next(k for k, line in enumerate(lines) if not line.startswith("#")) + 1
    cells = lines[first].split(",")
    cells[column] = cell
    lines[first] = ",".join(cells)
    path.write_text("\n".join(lines) + "\n")
    assert answer(lambda: external_mesh(read_description(lab / "mtx.yaml")), name, told)


def test_a_model_without_prestress_is_valid(lab):
    """Its geometric stiffness is all zero: no frequency changes with force."""
    data = yaml.safe_load((lab / "mtx.yaml").read_text())
    file = lab / data["beam"]["geometric_stiffness"]
    rows = scipy.io.mmread(file).shape[0]
    scipy.io.mmwrite(file, sp.coo_array((rows, rows)), symmetry="symmetric")
    description = read_description(lab / "mtx.yaml")
    reduced = reduce_matrices(description, external_mesh(description))
    names = [name for name in reduced if reduced[name].dtype == float]
    assert all(np.isfinite(reduced[name].values).all() for name in names)
    joint = joint_of_reduced(reduced)
    model = parametric_model(joint, ["1B"], (1e9, 4e9), (1e3, 20e3))
    points = np.array([[np.log(2e9), np.log(2e9), force] for force in (1e3, 20e3)])
    values = frequencies(surface_of(model), points)
    np.testing.assert_allclose(values[0], values[1], rtol=1e-6)
