"""Bad input: told in one line a fault before any job, or by name when it shows only later."""

import re

from house import SMALL, lab, matrices_lab


def refused(house, *options):
    """What a run says that must end before any job."""
    done = house.run(*options, check=False)
    assert done.returncode != 0
    assert "Traceback" not in done.stderr
    assert not (house.folder / "results").exists()
    return [line for line in done.stderr.splitlines() if line.startswith("bad input: ")]


def test_one_line_a_fault_of_each_campaign_and_no_job(bare, tmp_path):
    """A sheet, files of a structure, of a bench and of matrices, and folders that are not there."""
    head = "record,file,mode,force_N"
    sheet = lab(tmp_path / "sheet", [head, "r001,r001.nc,7B,12000"])
    (sheet / "r001.nc").touch()
    structure = lab(tmp_path / "structure", [head, "r001,r001.nc,1B,12000"])
    (structure / "r001.nc").touch()
    own = (SMALL / "tiny.yaml").read_text().replace("width_mm: 26", "width_mm: wide")
    (structure / "tiny.yaml").write_text(own)
    simulated = (SMALL / "records.csv").read_text().splitlines()
    bench = lab(tmp_path / "bench1", simulated, (SMALL / "campaign.yaml").read_text())
    moved = (SMALL / "bench.yaml").read_text().replace("seed: 7", "seed: -7")
    (bench / "bench.yaml").write_text(moved)
    matrices = matrices_lab(tmp_path / "matrices", "[own]")
    nodes = matrices / "own" / "Xn_nodes.csv"
    nodes.write_text(nodes.read_text().replace(",-0.013", ",-0.0131"))
    none = f"{tmp_path}/none"
    asked = ",".join(map(str, (none, "own/none", sheet, structure, bench, matrices)))
    told = refused(bare, "--config", f"campaigns={asked}")
    expected = (
        f"campaign folder not found: {none}",
        f"campaign folder not found: {bare.folder}/own/none",
        "mode must be one of 1B, 2B",
        "beam.width_mm",
        "seed",
        "expected contact nodes that coincide within 0.001 mm, got 0.1 mm",
    )
    assert len(told) == len(expected)
    assert all(part in line for part, line in zip(expected, told, strict=True))


def test_a_setting_that_is_not_allowed_is_one_line(bare):
    (told,) = refused(bare, "--config", "record={end: 2}")
    assert "record.end" in told


def test_a_model_is_refused_where_no_campaign_has_a_joint_inference(bare, tmp_path):
    columns = "frequency_Hz,frequency_std_Hz,loss_factor,loss_factor_std"
    folder = lab(tmp_path / "table", [f"mode,load,{columns}", "bend1,6000,160,0.1,0.002,0.0002"])
    (folder / "records.csv").rename(folder / "stick.csv")
    modes = "modes: {bend1: {expected_Hz: 160}}\nload: {name: bolt preload, unit: N}\n"
    (folder / "campaign.yaml").write_text(f"title: t\nstructure: [lap-joint]\n{modes}")
    campaign = f"campaigns={folder}"
    for asked in ("diagnosis", str(tmp_path / "own.yaml")):
        (told,) = refused(bare, "--config", campaign, f"model={asked}")
        assert "model: it redoes the joint inference" in told


def test_the_bias_of_a_mode_that_no_campaign_has_is_warned_of(bare, tmp_path):
    asked = ("--config", "search={fe_bias_percent: {flap: 0.3, 2B: 0.4, 3B: 0.5}}")
    told = bare.copied(tmp_path / "copy").run("--dry-run", *asked).stderr
    assert re.findall("warning: .*", told) == [
        "warning: search.fe_bias_percent: no campaign has a mode flap"
    ]


def test_mechanisms_that_are_not_there_or_no_python_end_the_run(bare, tmp_path):
    folder = tmp_path / "own"
    asked = ("--config", f"diagnosis={{mechanisms: {folder}}}")
    assert refused(bare, *asked) == [f"bad input: folder of mechanisms not found: {folder}"]
    folder.mkdir()
    (folder / "wire.py").write_text("one = 1\nx = (\n")
    fault = f"expected Python: '(' was never closed ({folder}/wire.py, row 2)"
    assert refused(bare, *asked) == [f"bad input: {fault}"]


def test_without_any_stick_frequency_there_is_still_a_report(house, tmp_path):
    """One mode, one force, every raw file spoilt: nothing to infer, and the report says so."""
    sheet = ["record,file,mode,force_N", "a,a.csv,1B,12000", "b,b.csv,1B,12000"]
    folder = lab(tmp_path / "poor", sheet)
    (folder / "a.csv").write_text("time_s,velocity_m/s\n0,1\n")
    (folder / "b.csv").touch()
    mesh = house.folder / "results" / "structures" / "tiny" / "mesh.nc"
    made = mesh.stat().st_mtime_ns
    house.run("--config", f"campaigns={folder}")
    assert mesh.stat().st_mtime_ns == made  # its structure was there
    page = (house.folder / "results" / "poor" / "report.html").read_text()
    assert "no usable record" in page
    assert "at least 64 samples" in page
    assert "got an empty file" in page
