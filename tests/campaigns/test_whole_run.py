"""What a finished run leaves behind: artifacts, a report, timings, honest labels."""

import csv
import json
import re
import shutil
import subprocess
import zipfile

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
    pages = [folder / "small" / "report.html", *(folder / "small" / "report").glob("*.html")]
    assert len(pages) > 8
    assert all("Simulated records" in page.read_text() for page in pages)
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


def test_snakemakes_own_report_has_the_pages(house):
    house.run("--report", "archive.zip")
    with zipfile.ZipFile(house.folder / "archive.zip") as archive:
        names = [name.rpartition("/")[2] for name in archive.namelist()]
    assert {"index.html", "measurement.html", "plotly.min.js"} <= set(names)


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
        "ringdown", "curves", "stick", "integrity", "observations", "diagnosis", "verdict",
        "report",
    }  # fmt: skip
    told = visited.run(*asked)
    assert "steps (100%) done" in told.stdout + told.stderr
    assert "rejected: a of plate: " in told.stdout
    assert "at least 64 samples" in told.stdout
    page = (visited.folder / "results" / "plate" / "report.html").read_text()
    chapters = re.findall(r'<a href="report/(\w+)\.html">', page[: page.index("</nav>")])
    assert chapters == ["measurement", "quality", "stick", "diagnosis"]
    assert "compared with linear modes" in page
    assert "a: rejected: " in page
    folder = visited.folder / "results" / "plate" / "report"
    assert {f"{name}.html" for name in chapters} <= {path.name for path in folder.iterdir()}
    made = json.loads((folder / "provenance.json").read_text())
    assert set(made["sources"]) == {"campaign.yaml", "records.csv", "r003.nc", "a.csv"}
    visited.run(*asked, "--report", str(tmp_path / "archive.zip"))
    assert (tmp_path / "archive.zip").stat().st_size > 10_000


def test_a_specimen_of_which_nothing_is_invented(visited, tmp_path):
    """Two modes, two sensors, two places of the blow; no load, no gauge, no structure."""
    folder = tmp_path / "floors"
    folder.mkdir()
    (folder / "campaign.yaml").write_text(
        "title: Two floors\nmodes:\n  low: {expected_Hz: 20}\n  high: {expected_Hz: 55}\n"
    )
    rows = ["record,file,mode,channel,group,unit"]
    t = np.arange(0, 12, 1e-3)
    rng = np.random.default_rng(0)
    for k in range(4):
        loss = (0.01, 0.013)[k % 2]
        low, high = (np.exp(-np.pi * f * t * loss) * np.sin(2 * np.pi * f * t) for f in (20, 55))
        top, foot = 5e-2 * low + 2e-2 * high, 2e-2 * low - 3e-2 * high
        noise = 1e-5 * rng.standard_normal((2, t.size))
        table = np.column_stack([t, top + noise[0], foot + noise[1]])
        head = "time_s,top,foot"
        np.savetxt(folder / f"b{k}.csv", table, delimiter=",", header=head, comments="")
        rows.append(f"b{k},b{k}.csv,all,top;foot,blow {k % 2 + 1},m/s")
    (folder / "records.csv").write_text("\n".join(rows) + "\n")
    visited.run("--config", f"campaigns={folder}")
    results = visited.folder / "results" / "floors"
    assert (results / "decay" / "b3-high-foot.nc").is_file()
    stick = xr.load_dataset(results / "stick.nc")
    assert set(stick["group"].values) == {"blow 1", "blow 2"}
    said = json.loads((results / "diagnosis" / "verdict.json").read_text())
    assert said["structure"] is None
    assert "The loss factor of mode low depends on the group: in blow 2 it is " in said["reason"]
    pages = [results / "report.html", *(results / "report").glob("*.html")]
    assert "Groups of records" in (results / "report" / "measurement.html").read_text()
    for one in pages:
        page = re.sub(r"<style.*?</style>", "", one.read_text(), flags=re.DOTALL)
        assert not re.search(r"\b(axial|gauge|structures?|flanks?|forces?)\b|kN", page), one
