"""Artifacts are whole or absent, and say what made them."""

import json
import os
import shutil

import netCDF4
import numpy as np
import pytest
import xarray as xr
from bladeroot import __version__, artifacts, checksum
from bladeroot.files import save_text
from bladeroot.io.hdf5 import length_notes
from bladeroot.provenance import environment

SAMPLE = xr.Dataset({"x": ("n", np.arange(5.0), {"units": "m"})}, attrs={"mode": "1B"})


def test_what_is_saved_is_loaded_with_its_provenance(tmp_path):
    path = tmp_path / "deep" / "sample.nc"
    origin = SAMPLE.assign_attrs(campaign="rig", simulated=1, other="left behind")
    artifacts.save(SAMPLE, path, origin=origin, settings='{"a":1}')
    loaded = artifacts.load(path)
    xr.testing.assert_equal(loaded, SAMPLE)
    assert loaded.attrs == {
        "mode": "1B", "bladeroot_version": __version__, "campaign": "rig", "simulated": 1,
        "settings": '{"a":1}', "environment": environment(), "schema": artifacts.SCHEMA,
    }  # fmt: skip
    assert loaded["x"].attrs["units"] == "m"


def test_variables_are_left_out_by_name_or_by_pattern(tmp_path):
    made = SAMPLE.assign(x_std=SAMPLE["x"], y=SAMPLE["x"], z=SAMPLE["x"])
    artifacts.save(made, tmp_path / "sample.nc")
    less = artifacts.load(tmp_path / "sample.nc", without=("x_*", "z"))
    assert set(less.variables) == {"x", "y"}


def test_what_is_written_is_what_xarray_would_write(tmp_path):
    made = xr.Dataset(
        {
            "flag": ("n", [True, False]), "text": ("n", ["a", "ü"]), "word": ((), "one"),
            "none": ("m", np.zeros(0)), "single": ("n", np.float32([1.0, np.nan])),
        },
        coords={"n": [1.5, 2.0], "label": ("n", ["p", "q"]), "k": 3},
        attrs={"numbers": [1.0, 2.0], "names": ["a", "b"], "empty": []},
    )  # fmt: skip
    packed = {"dtype": "int16", "scale_factor": 0.5, "add_offset": 7.0, "_FillValue": -9}
    made["packed"] = xr.Variable("n", [7.5, 9.0], encoding=packed)
    artifacts.save(made, tmp_path / "ours.nc")
    ours = artifacts.load(tmp_path / "ours.nc")
    made.assign_attrs(ours.attrs).to_netcdf(tmp_path / "theirs.nc")
    with xr.open_dataset(tmp_path / "theirs.nc") as theirs:
        xr.testing.assert_identical(ours, theirs.load())
        for name, one in theirs.variables.items():
            assert ours[name].dtype == one.dtype


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


def damaged(path, fault):
    """The file's bytes with a fault."""
    content = bytearray(path.read_bytes())
    if fault == "missing":
        path.unlink()
        return
    if fault == "a bit":
        content[len(content) // 2] ^= 1
    elif fault == "the checksum":
        content[-3] ^= 1
    elif fault == "the mark":
        content[-checksum.LENGTH] ^= 1
    elif fault == "more":
        content += b"more"
    elif fault == "twice":
        content += content
    elif fault == "zeros":
        content[1000:2000] = bytes(1000)
    else:
        del content[{"empty": 0, "half": len(content) // 2, "end": -1, "seal": -90}[fault] :]
    path.write_bytes(content)


FAULTS = ["missing", "a bit", "the checksum", "the mark", "more", "zeros", "empty", "half", "end",
          "seal"]  # fmt: skip


@pytest.mark.parametrize("fault", FAULTS)
def test_a_damaged_artifact_is_one_line_with_what_to_do(tmp_path, monkeypatch, fault):
    monkeypatch.chdir(tmp_path)
    artifacts.save(SAMPLE, "results/rig/a b.nc")
    damaged(tmp_path / "results/rig/a b.nc", fault)
    with pytest.raises(ValueError, match=r"^results/rig/a b\.nc") as caught:
        artifacts.load("results/rig/a b.nc")
    text = str(caught.value)
    assert "\n" not in text
    assert "`snakemake -j2 --force 'results/rig/a b.nc'`" in text


def test_another_artifact_under_its_name_and_a_rewritten_one(tmp_path):
    """A copy is whole; what another program wrote into it is not."""
    artifacts.save(SAMPLE, tmp_path / "a.nc")
    shutil.copy(tmp_path / "a.nc", tmp_path / "b.nc")
    xr.testing.assert_identical(
        artifacts.load(tmp_path / "b.nc"), artifacts.load(tmp_path / "a.nc")
    )
    with xr.open_dataset(tmp_path / "b.nc") as opened:
        changed = opened.load() + 1.0
    changed.to_netcdf(tmp_path / "b.nc")
    with pytest.raises(ValueError, match="has no checksum at its end"):
        artifacts.load(tmp_path / "b.nc")


def test_a_sealed_raw_record_is_not_called_longer_than_it_is(tmp_path):
    path = tmp_path / "a.nc"
    artifacts.save(SAMPLE, path)
    assert length_notes(str(path)) == ()
    path.write_bytes(path.read_bytes()[: -checksum.LENGTH] + bytes(7))
    assert "7 bytes more" in length_notes(str(path))[0]


VERDICT = {"schema": "x", "probability": 0.1 + 0.2, "causes": [{"a": None}], "names": ["ü"]}


def test_a_verdict_is_loaded_as_it_was_saved(tmp_path):
    path = tmp_path / "verdict.json"
    artifacts.save_json(VERDICT, path)
    assert artifacts.load_json(path) == VERDICT
    assert set(json.loads(path.read_text())) == {*VERDICT, "checksum"}
    artifacts.save_json(json.loads(path.read_text()), path)  # its checksum is not part of it
    assert artifacts.load_json(path) == VERDICT


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("0.3000", "0.4000"), ('"x"', '"y"'), ('"names"', '"other"'), ("null", "0"), ('"a"', '"b"'),
        ('"checksum": "', '"checksum": "0'), ('"checksum"', '"sum"'), ("}", ""), ("{", "["),
        ("", None),
    ],
)  # fmt: skip
def test_an_altered_verdict_is_one_line(tmp_path, old, new):
    path = tmp_path / "verdict.json"
    artifacts.save_json(VERDICT, path)
    text = path.read_text()
    assert old in text
    path.write_text("" if new is None else text.replace(old, new))
    with pytest.raises(ValueError, match=r"verdict\.json.* makes it again$"):
        artifacts.load_json(path)


def test_what_the_system_refuses_is_one_line(tmp_path, monkeypatch):
    (tmp_path / "file").touch()
    with pytest.raises(ValueError, match=r"file/a\.nc cannot be written: "):
        artifacts.save(SAMPLE, tmp_path / "file" / "a.nc")
    with pytest.raises(ValueError, match="cannot be written: file name too long"):
        save_text("text", tmp_path / ("a" * 300))
    artifacts.save(SAMPLE, tmp_path / ("a" * 255))
    save_text("before", tmp_path / "full")

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(ValueError, match="full cannot be written: no space left on device"):
        save_text("after", tmp_path / "full")
    assert (tmp_path / "full").read_text() == "before"
    assert not list(tmp_path.glob(".*.part"))
    monkeypatch.undo()
    monkeypatch.setattr(
        netCDF4, "Dataset", lambda *_, **__: (_ for _ in ()).throw(RuntimeError("HDF error"))
    )
    with pytest.raises(ValueError, match="hdf error; is the disk full"):
        artifacts.save(SAMPLE, tmp_path / "b.nc")
