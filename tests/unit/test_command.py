"""The command: what a person types, and what they get."""

import re

import numpy as np
import pytest
import scipy.io
import yaml
from bladeroot import artifacts
from bladeroot.command.main import COMMANDS, main
from bladeroot.command.new import description
from bladeroot.command.results import refuse_another
from bladeroot.command.run import followed, settings_among
from bladeroot.io.campaign import load_campaign
from bladeroot.io.read import channels, read
from bladeroot.rom.external.assembly import export_assembly
from bladeroot.shipped_files import structure_file
from bladeroot.signal.spectral_peaks import common, peaks, spectrum
from click.testing import CliRunner
from lap_coarse import lap_assembly, lap_data
from report_bench import cause, found, verdict

RATE, MODES = 4096.0, (61.0, 173.0, 402.0)


def ringing(seed):
    t = np.arange(int(2.0 * RATE)) / RATE
    parts = [
        a * np.exp(-3.0 * t) * np.cos(2 * np.pi * f * t + seed)
        for f, a in zip(MODES, (1.0, 0.4, 0.1), strict=True)
    ]
    noise = 1e-5 * np.random.default_rng(seed).standard_normal(t.size)
    return t, 0.01 * sum(parts) + noise


@pytest.fixture
def folder(tmp_path):
    """Two files of two sensors whose unit nobody wrote down."""
    for k in (1, 2):
        t, v = ringing(k)
        table = np.column_stack([t, v, 0.5 * v])
        np.savetxt(
            tmp_path / f"blow {k}.csv", table, delimiter=",", header="time_s,top,base", comments=""
        )
    return tmp_path


def called(*arguments):
    return CliRunner().invoke(main, list(map(str, arguments)))


def test_modes_that_most_records_show_are_suggested():
    lines = [peaks(*spectrum(ringing(k)[1], RATE)) for k in (1, 2, 3)]
    np.testing.assert_allclose(common(lines), MODES, rtol=0.005)
    assert common([lines[0], [], []]) == []


def test_noise_suggests_no_mode():
    noise = np.random.default_rng(0).standard_normal(20_000)
    assert peaks(*spectrum(noise, RATE)) == []


def test_a_new_campaign_says_what_files_say_and_marks_what_they_do_not(folder):
    (folder / "results.csv").write_text("a,b\n" + "".join(f"{k % 7},{k % 5}\n" for k in range(99)))
    done = called("new", folder)
    assert "left out: no times in it" in done.stderr
    assert done.exit_code == 0
    assert "FILL_IN" in done.output
    modes = yaml.safe_load((folder / "campaign.yaml").read_text())["modes"]
    np.testing.assert_allclose([m["expected_Hz"] for m in modes.values()], MODES, rtol=0.005)
    header, *rows = (folder / "records.csv").read_text().splitlines()
    assert header == "record,file,mode,channel,unit,group,note"
    assert rows == [f"blow_{k},blow {k}.csv,all,top;base,FILL_IN,," for k in (1, 2)]


def test_several_blows_in_a_file_are_a_row_each_and_the_hammer_is_no_motion(tmp_path):
    blows = np.concatenate([ringing(k)[1] for k in (1, 2, 3)])
    time, force = np.arange(blows.size) / RATE, np.random.default_rng(0).standard_normal(blows.size)
    table = np.column_stack([time, force, blows])
    header = "time_s,hammer (N),tip (m/s)"
    np.savetxt(tmp_path / "three.csv", table, delimiter=",", header=header, comments="")
    assert "several decays in a file are a row each" in called("new", tmp_path).output
    header, *rows = (tmp_path / "records.csv").read_text().splitlines()
    assert header == "record,file,mode,channel,from_s,to_s,group,note"
    cells = [row.split(",") for row in rows]
    assert [row[0] for row in cells] == ["three", "three_2", "three_3"]
    assert {row[3] for row in cells} == {"tip (m/s)"}
    edges = [float(row[4]) for row in cells[1:]]
    assert edges == [float(row[5]) for row in cells[:-1]]
    np.testing.assert_allclose(edges, [2.0, 4.0], atol=0.1)
    load_campaign(tmp_path)
    looked = called("look", tmp_path / "three.csv").output
    assert "looking at channel 3: tip (m/s)" in looked
    assert "3 decays, from " in looked


def test_a_line_of_the_mains_is_shown_and_is_no_mode():
    made = yaml.safe_load(description("a", [50.02, 61.0, 99.98]))
    assert [one["expected_Hz"] for one in made["modes"].values()] == [61.0]
    assert description("a", [50.02]).count("FILL_IN") == 1


def test_harmonics_of_a_line_are_shown_and_are_no_modes():
    text = description("t", [80.47, 160.94, 241.2, 297.7])
    modes = yaml.safe_load(text)["modes"]
    assert [m["expected_Hz"] for m in modes.values()] == [80.47, 297.7]
    assert "# 160.9 Hz is 2 times 80.47 Hz" in text


def test_a_unit_that_is_none_is_to_be_filled_in_and_of_a_list_the_motions_is_taken(tmp_path):
    t, v = ringing(1)
    for name, unit in (("one", "s, m/s^2"), ("two", "furlong")):
        scipy.io.savemat(tmp_path / f"{name}.mat", {"d": {"acc": v, "time": t, "units": unit}})
    assert called("new", tmp_path).exit_code == 0
    header, *rows = (tmp_path / "records.csv").read_text().splitlines()
    found = [dict(zip(header.split(","), row.split(","), strict=True)) for row in rows]
    assert "FILL_IN" in found[1]["unit"]
    assert read(tmp_path / "one.mat").quantity == "acceleration"


def test_nothing_is_written_over_a_campaign(folder):
    (folder / "records.csv").write_text("mine")
    done = called("new", folder)
    assert done.exit_code == 1
    assert "records.csv is there already" in done.stderr
    assert (folder / "records.csv").read_text() == "mine"
    assert not (folder / "campaign.yaml").exists()


def test_a_folder_without_raw_files_is_told(tmp_path):
    (tmp_path / "notes.docx").write_text("x")
    done = called("new", tmp_path)
    assert done.exit_code == 1
    assert "readable raw files" in done.stderr
    assert "Traceback" not in done.stderr


def test_look_shows_channels_lines_and_the_curve(folder):
    file, picture = folder / "blow 1.csv", folder / "seen.png"
    assert [entry.name for entry in channels(file)] == ["top", "base"]
    done = called("look", file, "--channel", "top", "--unit", "m/s", "--picture", picture)
    assert done.exit_code == 0, done.output
    assert "channel 1: top" in done.output or "channel 2: top" in done.output
    told = re.search(r"line at +([\d.]+) Hz, +0.0 dB", done.output)
    assert float(told[1]) == pytest.approx(MODES[0], rel=1e-3)
    assert "ring-down of the mode near 61" in done.output
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_look_says_what_it_takes_for_what_nobody_states(folder):
    done = called("look", folder / "blow 1.csv")
    assert done.exit_code == 0, done.output
    assert "looking at channel 2: top" in done.output
    assert "taken for m/s" in done.output
    assert "ring-down of the mode near 61" in done.output


def test_signals_of_a_digitiser_need_a_sensitivity_and_no_more(tmp_path):
    samples = (2e4 * ringing(1)[1] / 0.02).astype(np.int16)
    scipy.io.wavfile.write(tmp_path / "a.wav", int(RATE), samples)
    assert "taken for 1 m/s/FS" in called("look", tmp_path / "a.wav").output
    (tmp_path / "a.wav.look.png").unlink()
    assert called("new", tmp_path).exit_code == 0
    sheet = tmp_path / "records.csv"
    assert sheet.read_text().splitlines() == [
        "record,file,mode,sensitivity,group,note", "a,a.wav,all,FILL_IN,,"
    ]  # fmt: skip
    sheet.write_text(sheet.read_text().replace("FILL_IN", "2 g/FS"))
    assert called("check", tmp_path).exit_code == 0


def test_times_without_a_name_are_no_channel_and_need_their_unit(tmp_path):
    t, v = ringing(1)
    np.savetxt(tmp_path / "a.txt", np.column_stack([1e3 * t, v]), fmt="%.9g")
    done = called("look", tmp_path / "a.txt")
    assert done.exit_code == 1
    assert "channel 2: column 2" in done.output
    assert "channel 1" not in done.output
    assert f"{1e3 / (1e3 / RATE):.9g} in ms" in done.stderr
    assert len(done.stderr.strip().splitlines()) == 1
    done = called("look", tmp_path / "a.txt", "--sampling", RATE)
    assert "ring-down of the mode near 61" in done.output
    assert "column 1" not in done.output


def test_check_tells_every_fault_on_a_line(folder):
    called("new", folder)
    done = called("check", folder)
    assert done.exit_code == 1
    assert all(line.startswith("bladeroot: ") for line in done.stderr.strip().splitlines())


@pytest.mark.parametrize(
    ("row", "told"),
    [
        ("blow 1.csv,a,top,m/s,,,,", ""),
        ("blow 1.csv,a,tip,m/s,,,,", "r1: expected channel 'tip', got none of"),
        ("blow 1.csv,a,top,100 mV,,,,", "100 mV"),
        ("blow 1.csv,a,top,m/s,50,,,", "between from_s and to_s, got 0 of the file's"),
        ("blow 1.csv,slow,top,m/s,,,,", "too short"),
        ("blow 1.csv,a,top,m/s,,,50,", "r1: start_s must lie within the record's"),
        ("blow 1.csv,a,top,m/s,,,,40-4e4", "r1: band_Hz must end below half the sampling"),
    ],
)
def test_check_reads_the_raw_files(folder, row, told):
    (folder / "campaign.yaml").write_text(
        "title: a\nload: {name: torque, unit: Nm}\n"
        "modes: {a: {expected_Hz: 60}, slow: {expected_Hz: 0.06}}\n"
    )
    (folder / "records.csv").write_text(
        "load,record,file,mode,channel,unit,from_s,to_s,start_s,band_Hz\n"
        f"1,r1,{row}\n1,r2,blow 2.csv,a,top,m/s,,,,\n"
    )
    done = called("check", folder)
    assert done.exit_code == bool(told)
    assert told in done.stderr


@pytest.mark.parametrize(
    ("mode", "loads", "told"),
    [
        ("bend1", "[1, 20]", "load_range of .*own.yaml is 1 to 20; records have 0, 30"),
        ("bend7", "[0, 30]", "own.yaml knows bend1, bend2, bend3, not bend7"),
        ("bend1", "[0, 30]", ""),
    ],
)
def test_check_reads_the_structure_that_a_campaign_names(folder, mode, loads, told):
    own = structure_file("lap-joint").read_text().replace("name: lap-joint", "name: own")
    (folder / "own.yaml").write_text(f"{own}\nload_range: {loads}\n")
    (folder / "campaign.yaml").write_text(
        f"title: a\nsimulation: own\nload: {{name: speed, unit: rpm}}\n"
        f"modes: {{{mode}: {{expected_Hz: 60}}}}\n"
    )
    rows = [f"r{k},blow {k}.csv,{mode},top,m/s,{30 * (k - 1)}" for k in (1, 2)]
    (folder / "records.csv").write_text("\n".join(["record,file,mode,channel,unit,load", *rows]))
    done = called("check", folder)
    assert done.exit_code == bool(told)
    assert len(done.stderr.splitlines()) == bool(told)
    assert re.search(told, done.stderr)


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("", "", ()),
        ("units: m-N-kg", "units: mm-N-t", ("first weighs", "second weighs")),
        ("second_mass.mtx", "second_mass.mtx#M", ("leave #M out",)),
    ],
)
def test_check_reads_the_matrices(folder, old, new, told):
    """Faults of all bodies and of the raw files at once."""
    export_assembly(lap_assembly(), lap_data() | {"description": "its own"}, folder, "lap")
    text = (folder / "lap.yaml").read_text()
    (folder / "lap.yaml").write_text(text.replace(old, new))
    (folder / "campaign.yaml").write_text(
        "title: a\nsimulation: lap\nmodes: {bend1: {expected_Hz: 60}}\n"
    )
    (folder / "records.csv").write_text(
        "record,file,mode,channel,unit\nr1,blow 1.csv,bend1,tip,m/s\n"
    )
    done = called("check", folder)
    assert done.exit_code == 1
    lines = done.stderr.splitlines()
    assert all(part in line for part, line in zip((*told, "r1: "), lines, strict=True))


def test_explain_says_what_the_report_says(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    place = tmp_path / "results" / "c" / "diagnosis"
    place.mkdir(parents=True)
    reason = (
        "the simulation does-not explain the stick-frequency of mode 1B; to decide: another force. "
        "none is like it"
    )
    said = verdict(causes=[cause()], structure=None, reason=reason, campaign="c")
    artifacts.save(found().assign_attrs(simulated=0), place / "linear.nc")
    for name in ("linear", "verdict"):
        artifacts.save_json(said, place / f"{name}.json")
    done = called("explain", "c")
    assert done.exit_code == 0, done.output
    lines = done.output.splitlines()
    assert lines[0] == "c, compared with S: cause named"
    assert lines[1].startswith("The simulation does not explain the stick frequency of mode 1B")
    assert lines[-1] == "Besides: None is like it"  # what is told already is not told again
    assert any(line.startswith("Measure next: another force") for line in lines)
    assert called("explain", "other").exit_code == 1
    artifacts.save_json({**said, "reason": "of another run"}, place / "linear.json")
    done = called("explain", "c")
    assert done.exit_code == 1
    assert len(done.stderr.strip().splitlines()) == 1
    assert "Traceback" not in done.output


def test_results_of_another_folder_of_that_name_are_not_written_over(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for place in ("made", "other/made"):
        (tmp_path / place).mkdir(parents=True)
        (tmp_path / place / "campaign.yaml").write_text("title: made\n")
    known = tmp_path / "results" / "made" / "report" / "provenance.json"
    artifacts.save_json({"command": "bladeroot run made"}, known)
    refuse_another(tmp_path / "made" / ".." / "made")
    with pytest.raises(ValueError, match="results/made are the results of made"):
        refuse_another(tmp_path / "other" / "made")
    (tmp_path / "made" / "campaign.yaml").unlink()  # it has moved there
    refuse_another(tmp_path / "other" / "made")
    (tmp_path / "made" / "campaign.yaml").write_text("title: made\n")
    known.write_text("{")  # damaged: the run makes it again
    refuse_another(tmp_path / "other" / "made")


def test_run_shows_the_stage_and_keeps_what_stands_behind_the_last_step():
    shown = []
    lines = ["job         count", "----------  -----", "ringdown.c.b     2", "curves           1",
             "report           4", "total            7", "Job 3: free decays",
             "Finished jobid: 3 (Rule: ringdown.c.b)", "1 of 7 steps (14%) done",
             "Job 4: mean curves of c", "7 of 7 steps (100%) done",
             "report of c: results/c/report.html"]  # fmt: skip
    seconds = iter([0.0, 120.0, 270.0])  # at the start, and as each step ends
    told = followed(lines, shown.append, lambda: next(seconds))
    assert told == ["report of c: results/c/report.html"]
    first, second, _ = map(str.strip, shown)
    assert first == "free decays"
    # a batch of records is as long as ten others: 15 of 25 parts are left, at 12 s each
    assert second == "1 of 7, about 3 min left  mean curves of c"


def test_where_the_system_refuses_a_run_says_what_and_not_where_in_whose_code():
    """As of Snakemake's cache of sources, which it writes before it reads the workflow."""
    lines = ["Traceback (most recent call last):", "", '  File "/a/sourcecache.py", line 7, in f',
             "    file.close()", "", "OSError: [Errno 28] No space left on device", ""]  # fmt: skip
    (told,) = followed(["1 of 9 steps (11%) done", *lines], lambda text: None)
    assert "No space left on device" in told
    assert "sourcecache" not in told
    kept = ["bad input: [Errno 28] stands in a name"]
    assert followed(kept, lambda text: None) == kept


@pytest.mark.parametrize("name", COMMANDS)
def test_every_subcommand_has_a_help_of_its_own(name):
    done = called(name, "--help")
    assert done.exit_code == 0
    assert done.output.startswith("Usage:")


def test_cells_of_a_matlab_file_are_records_of_their_own(tmp_path):
    t = np.arange(4096) / 2048.0
    cells = np.empty((2, 2), dtype=object)
    for k in range(2):
        cells[k] = [t, np.exp(-3.0 * t) * np.cos(2.0 * np.pi * 60.0 * t + k)]
    scipy.io.savemat(tmp_path / "blows.mat", {"x": cells})
    done = called("new", tmp_path)
    assert done.exit_code == 0, done.output
    rows = (tmp_path / "records.csv").read_text().splitlines()[1:]
    assert [row.split(",all,")[0] for row in rows] == ["blows,blows.mat", "blows_2,blows.mat"]
    assert all(";" not in row for row in rows)


def test_settings_of_a_run_stand_beside_its_campaign():
    options = [
        "-n",
        "--config",
        "a=1",
        "b={c: 2}",
        "--forcerun",
        "stick",
        "-C",
        "d=3",
        "--config=e=4",
    ]
    settings, others = settings_among(options)
    assert settings == ["a=1", "b={c: 2}", "d=3", "e=4"]
    assert others == ["-n", "--forcerun", "stick"]
    assert settings_among(["results/a.nc", "-n"]) == ([], ["results/a.nc", "-n"])
