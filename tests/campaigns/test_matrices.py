"""A campaign with matrices of another program: the dovetail's own, exported and brought back."""

import shutil

import numpy as np
import pytest
import xarray as xr
from bladeroot.fem.mesh import build_mesh
from bladeroot.fem.prestress import prestress
from bladeroot.rom.external.export import export_matrices
from bladeroot.rom.file import load_structure
from house import ROOT, SMALL, copy_house


def lab(folder, structures):
    """A campaign of published stick frequencies with the small structure's matrices."""
    folder.mkdir()
    structure = load_structure(SMALL / "tiny.yaml")
    mesh = build_mesh(structure)
    export_matrices(structure, mesh, prestress(structure, mesh), folder, "own", "hb")
    description = (SMALL / "campaign.yaml").read_text().replace("bench: bench.yaml\n", "")
    (folder / "campaign.yaml").write_text(description.replace("[tiny]", structures))
    stick = ROOT / "resources" / "campaigns" / "thesis" / "stick.csv"
    shutil.copy(stick, folder)
    return folder


def test_pairs_that_do_not_coincide_are_told_before_any_job(tmp_path):
    house = copy_house(tmp_path / "house")
    folder = lab(tmp_path / "lab", "[own]")
    nodes = folder / "own" / "Xn_nodes.csv"
    nodes.write_text(nodes.read_text().replace(",-0.013", ",-0.0131"))
    done = house.run("--config", f"campaigns={folder}", check=False)
    lines = [line for line in done.stderr.splitlines() if line.startswith("bad input: ")]
    assert len(lines) == 1
    assert "expected contact nodes that coincide within 0.001 mm, got 0.1 mm" in lines[0]
    assert not (house.folder / "results").exists()


@pytest.mark.slow
def test_matrices_give_what_the_geometry_gives(tmp_path):
    house = copy_house(tmp_path / "house")
    folder = lab(tmp_path / "lab", "[own, tiny]")
    house.run("--config", f"campaigns={folder}")
    structures = house.folder / "results" / "structures"
    one, other = (
        xr.load_dataset(structures / name / "map" / "12000.nc") for name in ("own", "tiny")
    )
    np.testing.assert_allclose(one["map_frequency"], other["map_frequency"], rtol=1e-6)
    assert xr.load_dataset(structures / "own" / "checks.nc")["within"].all()
    page = (house.folder / "results" / "lab" / "report" / "structure.html").read_text()
    assert "rigid motion of the free beam" in page
    assert house.planned("--config", f"campaigns={folder}") == {}
    house_file = folder / "own" / "beam_mass.hb"
    house_file.write_text(house_file.read_text().replace("own beam mass", "another title", 1))
    planned = house.planned("--config", f"campaigns={folder}")
    assert planned["matrices_reduced"] == planned["matrices_checks"] == 1
    assert "matrices_mesh" not in planned
    assert "reduced" not in planned
