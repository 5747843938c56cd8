"""Bad input: told in one line a fault before any job, or by name when it shows only later."""

import shutil

import numpy as np
import pytest
import xarray as xr
from house import SMALL, copy_house

SHEET = "resources/campaigns/small/records.csv"
TINY = "resources/structures/tiny.yaml"


def test_a_campaign_that_is_not_there_is_called_as_asked(tmp_path):
    house = copy_house(tmp_path / "house")
    for asked, told in ((f"{tmp_path}/none", f"{tmp_path}/none"), ("own/none", "own/none")):
        done = house.run("--config", f"campaigns={asked}", check=False)
        assert f"bad input: campaign folder not found: {house.folder / told}\n" in done.stderr


def test_mechanisms_that_are_not_there_or_no_python_end_the_run(tmp_path):
    house = copy_house(tmp_path / "house")
    folder = tmp_path / "own"
    asked = ("--config", f"diagnosis={{mechanisms: {folder}}}")
    done = house.run(*asked, check=False)
    assert f"bad input: folder of mechanisms not found: {folder}\n" in done.stderr
    folder.mkdir()
    (folder / "wire.py").write_text("one = 1\nx = (\n")
    done = house.run(*asked, check=False)
    assert done.returncode != 0
    assert f"bad input: expected Python: '(' was never closed ({folder}/wire.py, row 2)\n" in (
        done.stderr
    )
    assert not (house.folder / "results").exists()


@pytest.mark.parametrize(
    ("path", "old", "new", "told"),
    [
        (SHEET, "r002,r002.nc", "r001,r001.nc", "record 'r001' stands in row 2 already"),
        (SHEET, "1B,60", "1B,900", "pressure_bar 900 lies outside the gauge's range"),
        (SHEET, "1B,60", "1B,nan", "pressure_bar must be a finite number, got 'nan'"),
        (SHEET, "1B,60", "7B,60", "mode must be one of 1B, 2B"),
        ("config/config.yaml", "end: noise", "end: 2", "record.end"),
        ("config/config.yaml", "[0, 1, 2, 3]", "[3, 1]", "nonlinear.harmonics must ascend"),
        ("config/config.yaml", "[small]", "[smal]", "campaign folder not found"),
        (TINY, "width_mm: 26", "width_mm: wide", "beam.width_mm"),
        (TINY, "name: tiny", "name: huge", "name must be 'tiny'"),
        ("resources/campaigns/small/bench.yaml", "seed: 7", "seed: -7", "seed"),
    ],
)
def test_one_line_and_no_job(tmp_path, path, old, new, told):
    house = copy_house(tmp_path / "house")
    house.edit(path, old, new)
    done = house.run(check=False)
    assert done.returncode != 0
    lines = [line for line in done.stderr.splitlines() if line.startswith("bad input: ")]
    assert len(lines) == 1
    assert told in lines[0]
    assert "Traceback" not in done.stderr
    assert not (house.folder / "results").exists()


def test_without_any_stick_frequency_there_is_still_a_report(visited, tmp_path):
    """One mode, one force, every raw file spoilt: nothing to infer, and the report says so."""
    folder = tmp_path / "poor"
    folder.mkdir()
    description = (SMALL / "campaign.yaml").read_text().replace("bench: bench.yaml\n", "")
    (folder / "campaign.yaml").write_text(description)
    (folder / "a.csv").write_text("time_s,velocity_m/s\n0,1\n")
    (folder / "b.csv").touch()
    (folder / "records.csv").write_text(
        "record,file,mode,force_N\na,a.csv,1B,12000\nb,b.csv,1B,12000\n"
    )
    mesh = visited.folder / "results" / "structures" / "tiny" / "mesh.nc"
    made = mesh.stat().st_mtime_ns
    visited.run("--config", f"campaigns={folder}")
    assert mesh.stat().st_mtime_ns == made  # its structure was there
    page = (visited.folder / "results" / "poor" / "report.html").read_text()
    assert "no usable record" in page
    assert "at least 64 samples" in page
    assert "got an empty file" in page
    assert "no pair of frequencies to invert" in page


@pytest.mark.slow
def test_a_bad_record_is_named_and_the_rest_goes_on(visited, tmp_path):
    """Real raw files, two of them spoilt: a campaign folder outside the house."""
    folder = tmp_path / "lab"
    folder.mkdir()
    # A structure of its own, beside the records; the house's stays as it is.
    structure = (SMALL / "tiny.yaml").read_text().replace("name: tiny", "name: own")
    (folder / "own.yaml").write_text(structure)
    description = (SMALL / "campaign.yaml").read_text().replace("bench: bench.yaml\n", "")
    description = description.replace("[tiny]", "[own]").replace("SIMULATED, ", "")
    (folder / "campaign.yaml").write_text(description)
    sheet = (SMALL / "records.csv").read_text()
    for raw in (visited.folder / "results" / "bench" / "small").glob("*.nc"):
        shutil.copy(raw, folder)
    whole = (folder / "r001.nc").read_bytes()
    (folder / "r007.nc").write_bytes(whole[:5000])
    middle = len(whole) // 2
    (folder / "r009.nc").write_bytes(whole[:middle] + b"\xaa" * 4096 + whole[middle + 4096 :])
    spoilt = xr.load_dataset(folder / "r001.nc").drop_encoding()
    spoilt["velocity"][5000:5005] = np.nan
    spoilt.to_netcdf(folder / "r008.nc")
    for record in ("r007", "r008", "r009"):
        sheet += f"{record},{record}.nc,1B,60,h1,up,1000,1.4\n"
    (folder / "records.csv").write_text(sheet)

    visited.run("--config", f"campaigns={folder}")
    stick = xr.load_dataset(visited.folder / "results" / "lab" / "stick.nc")
    verdicts = dict(zip(stick["record"].values, stick["verdict"].values, strict=True))
    bad = {record for record, verdict in verdicts.items() if verdict.startswith("rejected")}
    assert bad == {"r007", "r008", "r009"}
    assert "r008.nc" in verdicts["r008"]
    assert "finite" in verdicts["r008"]
    results = visited.folder / "results" / "lab"
    assert "Simulated records" not in (results / "report.html").read_text()
    page = (results / "report" / "measurement.html").read_text()
    assert "Rejected, and left out of all that follows" in page
    assert "r008.nc" in page
