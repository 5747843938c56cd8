"""The campaigns of the benchmark of scale are sound, and their records are what they say."""

import shlex
import subprocess
import sys
from pathlib import Path

import scale
from bladeroot.decay.from_file import from_file
from bladeroot.io.campaign import load_campaign


def test_a_campaign_is_sound_and_a_record_of_it_is_analysed(tmp_path):
    campaign = load_campaign(scale.make_campaign(tmp_path / "some", 9))
    assert len(campaign.records) == 9
    assert not campaign.warnings
    assert {row["hold"] for row in campaign.records} == {"h0", "h1"}
    row = campaign.records[0]
    mode = campaign.description["modes"][row["mode"]]
    known = {**row, **mode, "other_modes_Hz": [520.0], "simulated": False}
    _, curves, plateau = from_file(
        campaign.folder / row["file"],
        known,
        {"end": "noise"},
        {"damping": "hysteretic"},
    )
    # the plateau lies below a tenth of the start, at 1 + 0.01 ln(4 / 12) times 180 Hz
    assert abs(float(plateau["stick_frequency"]) / (180.0 * 0.98901) - 1.0) < 2e-3
    assert float(curves["frequency"].min()) < 0.998 * float(plateau["stick_frequency"])


def test_no_argument_of_a_stage_is_longer_than_linux_takes(tmp_path):
    """As of ten thousand records, by names that are as much longer."""
    folder = tmp_path / "many"
    (folder / "raw").mkdir(parents=True)
    (folder / "campaign.yaml").write_text(scale.DESCRIPTION.format(count=1500))
    (folder / "raw" / "r.wav").write_bytes(b"")
    rows = [f"{'r' * 95}{k},raw/r.wav,1B,4000,h{k // 8},{60 * k},velocity" for k in range(1500)]
    text = "\n".join(["record,file,mode,force_N,hold,time_s,quantity", *rows])
    (folder / "records.csv").write_text(text + "\n")
    snakefile = Path(scale.ROOT, "Snakefile")
    plan = [sys.executable, "-m", "snakemake", "--snakefile", str(snakefile), "-n", "-p"]
    plan += [f"--directory={tmp_path}", "--config", f"campaigns={folder}"]
    done = subprocess.run(plan, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-2000:]
    commands = [line for line in done.stdout.splitlines() if "/workflow/scripts/" in line]
    assert sum("/observations.py" in line for line in commands) == 1
    longest = max(len(word.encode()) for line in commands for word in shlex.split(line))
    assert 20_000 < longest < 131_072
