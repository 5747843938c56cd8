"""What a finished run leaves behind: artifacts, a report, timings, honest labels."""

import csv
import re
import shutil
import subprocess

import numpy as np
import xarray as xr
from house import SMALL


def load(house, name):
    return xr.load_dataset(house.folder / "results" / name)


def test_every_stage_left_its_artifact(house):
    folder = house.folder / "results" / "small"
    for name in ("stick.nc", "fe_forces.nc", "stiffness.nc", "theory.nc", "report.html"):
        assert (folder / name).is_file()
    assert len(list((folder / "records").glob("*.nc"))) == 6
    assert len(list((folder / "decay").glob("*.nc"))) == 6


def test_every_artifact_says_what_made_it_and_what_its_numbers_are(house):
    for path in (house.folder / "results").rglob("*.nc"):
        with xr.open_dataset(path) as artifact:
            assert artifact.attrs["bladeroot_version"], path
            assert "settings" in artifact.attrs, path
            for name, variable in artifact.data_vars.items():
                assert "units" in variable.attrs, f"{path}: {name}"
                assert "long_name" in variable.attrs, f"{path}: {name}"


def test_stick_frequencies_hit_the_bench(house):
    score = load(house, "small/score.nc")
    assert score.attrs["reached"] >= 5
    assert score.attrs["within_3"] >= score.attrs["reached"] - 1


def test_a_search_ends_in_a_root_or_says_by_how_much_the_model_must_move(house):
    stiffness = load(house, "small/stiffness.nc")
    for status, kn, needed in zip(
        stiffness["status"].values.ravel(),
        stiffness["kn"].values.ravel(),
        stiffness["needed_bias"].transpose(..., "mode").values.reshape(-1, 2),
        strict=True,
    ):
        assert status in ("root", "no root")
        assert np.isfinite(kn) == (status == "root")
        assert np.any(needed != 0) == (status == "no root")


def test_simulated_records_are_labelled_everywhere(house):
    folder = house.folder / "results"
    assert "Simulated records" in (folder / "small" / "report.html").read_text()
    for raw in (folder / "bench" / "small").glob("*.nc"):
        with xr.open_dataset(raw) as record:
            assert "SIMULATED" in record.attrs["title"]
    for path in (folder / "small").rglob("*.nc"):
        with xr.open_dataset(path) as artifact:
            assert artifact.attrs["simulated"] == 1, path
            assert artifact.attrs["campaign"] == "small", path


def test_time_of_every_rule_is_gathered(house):
    with (house.folder / "results" / "timings.csv").open() as sheet:
        rows = {row["rule"]: row for row in csv.DictReader(sheet)}
    assert int(rows["ringdown"]["jobs"]) >= 1
    assert float(rows["ringdown"]["total_s"]) > 0
    assert all(float(row["total_s"]) >= 0 for row in rows.values())  # a copy takes no time


def test_snakemakes_own_report_has_captions_and_categories(house):
    house.run("--report", "archive.zip")
    assert (house.folder / "archive.zip").stat().st_size > 10_000


def test_a_stage_runs_alone_without_snakemake(house, tmp_path):
    """As Snakemake prints it for a person who debugs it."""
    record = "results/small/decay/r001.nc"
    asked = house.run("--dry-run", "--printshellcmds", "--force", record).stdout
    command = re.search(r"^Shell command: (.*ringdown\.py.*)$", asked, re.MULTILINE).group(1)
    command = command.replace("results/small", str(tmp_path)).replace("results/logs", str(tmp_path))
    (tmp_path / "ringdown" / "small").mkdir(parents=True)
    subprocess.run(command, shell=True, check=True, env=house.environment, cwd=house.folder)
    for stage in ("records", "decay", "plateau"):
        made = load(house, f"small/{stage}/r001.nc")
        xr.testing.assert_equal(xr.load_dataset(tmp_path / stage / "r001.nc"), made)


def test_the_measurement_alone_needs_no_structure(visited, tmp_path):
    """For a specimen that is no dovetail (config/README.md): a report, and who is rejected."""
    folder = tmp_path / "plate"
    folder.mkdir()
    description = (SMALL / "campaign.yaml").read_text()
    for line in ("bench: bench.yaml\n", "structure: [tiny]\n"):
        assert line in description
        description = description.replace(line, "")
    (folder / "campaign.yaml").write_text(description)
    shutil.copy(visited.folder / "results" / "bench" / "small" / "r003.nc", folder)
    (folder / "a.csv").write_text("time_s,velocity_m/s\n0,1\n")
    (folder / "records.csv").write_text(
        "record,file,mode,force_N\nr003,r003.nc,1B,21480\na,a.csv,1B,21480\n"
    )
    asked = ("--config", f"campaigns={folder}")
    assert set(visited.planned(*asked)) == {
        "ringdown", "curves", "stick", "integrity", "figures_records", "figures_stick",
        "report",
    }  # fmt: skip
    told = visited.run(*asked)
    assert "steps (100%) done" in told.stdout + told.stderr
    assert "rejected: a of plate: " in told.stdout
    assert "at least 64 samples" in told.stdout
    page = (visited.folder / "results" / "plate" / "report.html").read_text()
    assert "1. In short" in page
    assert "4. Stick frequencies" in page
    assert "5. " not in page[page.index("<nav>") : page.index("</nav>")]
    assert "campaign.yaml names no structure" in page
    assert "Rejected: 1 of 2 records, a;" in page
    visited.run(*asked, "--report", str(tmp_path / "archive.zip"))
    assert (tmp_path / "archive.zip").stat().st_size > 10_000
