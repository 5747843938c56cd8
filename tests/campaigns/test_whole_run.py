"""What a finished run leaves behind: artifacts, a report, timings, honest labels."""

import csv
import json
import re
import subprocess
import zipfile

import numpy as np
import pytest
import xarray as xr
from answers import Tags
from bladeroot import artifacts


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
            assert artifact.attrs["schema"] == artifacts.SCHEMA, path
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
    pages = [folder / "small" / "report.html", *(folder / "small" / "report").glob("*.html")]
    assert len(pages) > 8
    assert all("Simulated records" in page.read_text() for page in pages)
    assert "Simulated records" not in (folder / "floors" / "report.html").read_text()
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


def test_snakemakes_own_report_has_the_pages_and_executes_nothing(house, floors):
    """In its page and in ours no text of a campaign is a tag, a script or a template."""
    secret = house.folder / "secret.txt"
    secret.write_text("that nobody includes")
    house.run("--report", "archive.zip", "--config", f"campaigns=small,{floors}")
    secret.unlink()
    with zipfile.ZipFile(house.folder / "archive.zip") as archive:
        names = {name.rpartition("/")[2] for name in archive.namelist()}
        assert {"index.html", "measurement.html", "plotly.min.js", "report.html"} <= names
        pages = {
            name: archive.read(name).decode() for name in archive.namelist() if ".html" in name
        }
    assert sum("alert(1)" in page for page in pages.values()) > 3
    for name, page in pages.items():
        assert "that nobody includes" not in page, name
        assert str(7 * 71917191) not in page, name
        tags = Tags(page)
        assert ("img", "src", "onerror") not in tags.seen, name
        assert not any(one.startswith(("javascript:", "alert")) for one in tags.values), name
        for script in tags.scripts:
            if "alert(1)" in script:  # nothing but data
                json.loads(re.fullmatch(r"\s*(?:var \w+ = )?(.*?);?\s*", script, re.DOTALL)[1])


@pytest.fixture(scope="module")
def plan(house, floors) -> str:
    """A dry run of all that the floors need."""
    options = ("--dry-run", "--printshellcmds", "--forceall")
    return house.run(*options, "--config", f"campaigns={floors}").stdout


def test_a_stage_runs_alone_without_snakemake(house, plan, tmp_path):
    """As Snakemake prints it for a person who debugs it."""
    made = "results/floors/stick.nc"
    command = re.search(r"^Shell command: (.*stick\.py.*)$", plan, re.MULTILINE).group(1)
    command = command.replace(made, str(tmp_path / "stick.nc"))
    command = command.replace("results/logs", str(tmp_path))
    (tmp_path / "stick").mkdir(parents=True)
    subprocess.run(command, shell=True, check=True, env=house.environment, cwd=house.folder)
    xr.testing.assert_equal(xr.load_dataset(tmp_path / "stick.nc"), load(house, "floors/stick.nc"))


def test_a_specimen_of_which_nothing_is_invented(house, plan):
    """No load, no gauge, no structure: a report, and who is rejected."""
    assert "rejected: bad of floors: " in house.said
    results = house.folder / "results" / "floors"
    assert (results / "decay" / "b1-high-foot.nc").is_file()
    stick = xr.load_dataset(results / "stick.nc")
    assert set(stick["group"].values) == {"blow 1", "blow 2"}
    said = json.loads((results / "diagnosis" / "verdict.json").read_text())
    assert said["structure"] is None
    assert "The loss factor of mode low depends on the group: in blow 2 it is " in said["reason"]
    front = (results / "report.html").read_text()
    chapters = re.findall(r'<a href="report/(\w+)\.html">', front[: front.index("</nav>")])
    assert chapters == ["measurement", "quality", "stick", "diagnosis"]
    assert "compared with linear modes" in front
    assert "bad: rejected: " in front
    for one in (front, *((results / "report" / f"{c}.html").read_text() for c in chapters)):
        page = re.sub(r"<style.*?</style>", "", one, flags=re.DOTALL)
        assert not re.search(r"\b(axial|gauge|structures?|flanks?|forces?)\b|kN", page)
    made = json.loads((results / "report" / "provenance.json").read_text())
    assert {"campaign.yaml", "records.csv"} < set(made["sources"])
    assert set(house.jobs(plan)) == {
        "ringdown", "curves", "stick", "integrity", "observations", "diagnosis", "verdict",
        "report",
    }  # fmt: skip
