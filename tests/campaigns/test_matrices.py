"""A campaign with matrices of another program: the dovetail's own, exported and brought back."""

import numpy as np
import xarray as xr
from house import matrices_lab


def test_matrices_give_what_the_geometry_gives(untouched, tmp_path):
    house = untouched
    folder = matrices_lab(tmp_path / "lab", "[own, tiny]")
    # as arguments of an option would take what follows, the files go first
    wanted = [f"results/structures/own/{name}" for name in ("map/12000.nc", "checks.nc")]
    house.run(*wanted, "--config", f"campaigns={folder}")
    structures = house.folder / "results" / "structures"
    one, other = (
        xr.load_dataset(structures / name / "map" / "12000.nc") for name in ("own", "tiny")
    )
    np.testing.assert_allclose(one["map_frequency"], other["map_frequency"], rtol=1e-6)
    assert xr.load_dataset(structures / "own" / "checks.nc")["within"].all()
    assert house.planned(*wanted, "--config", f"campaigns={folder}") == {}
    house_file = folder / "own" / "beam_mass.hb"
    house_file.write_text(house_file.read_text().replace("own beam mass", "another title", 1))
    planned = house.planned("--config", f"campaigns={folder}")
    assert planned["matrices_reduced"] == planned["matrices_checks"] == 1
    assert "matrices_mesh" not in planned
    assert "reduced" not in planned
