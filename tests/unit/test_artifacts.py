"""Artifacts are whole or absent, and say what made them."""

import numpy as np
import pytest
import xarray as xr
from bladeroot import __version__, artifacts

SAMPLE = xr.Dataset({"x": ("n", np.arange(5.0), {"units": "m"})}, attrs={"mode": "1B"})


def test_what_is_saved_is_loaded_with_its_provenance(tmp_path):
    path = tmp_path / "deep" / "sample.nc"
    origin = SAMPLE.assign_attrs(campaign="rig", simulated=1, other="left behind")
    artifacts.save(SAMPLE, path, origin=origin, settings='{"a":1}')
    loaded = artifacts.load(path)
    xr.testing.assert_equal(loaded, SAMPLE)
    assert loaded.attrs == {
        "mode": "1B", "bladeroot_version": __version__, "campaign": "rig", "simulated": 1,
        "settings": '{"a":1}',
    }  # fmt: skip
    assert loaded["x"].attrs["units"] == "m"


def test_the_same_data_make_the_same_bytes(tmp_path):
    for name in ("a.nc", "b.nc"):
        artifacts.save(SAMPLE, tmp_path / name)
    assert (tmp_path / "a.nc").read_bytes() == (tmp_path / "b.nc").read_bytes()


def test_a_failed_write_leaves_the_old_artifact_and_no_rest(tmp_path):
    path = tmp_path / "sample.nc"
    artifacts.save(SAMPLE, path)
    before = path.read_bytes()
    unwritable = SAMPLE.assign_attrs(bad={"a": 1})
    with pytest.raises(TypeError):
        artifacts.save(unwritable, path)
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]
