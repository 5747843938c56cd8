"""`bladeroot check results/...` says in a line what is not current, and why."""

import os
import shutil
import subprocess
import sys

import pytest

SMALL = "results/small/"
CALL = "import sys; from bladeroot.command.main import main; sys.argv[0] = 'bladeroot'; main()"


def altered(folder):
    """Another byte; the file keeps its times."""
    place = folder / SMALL / "stick.nc"
    kept, content = place.stat(), bytearray(place.read_bytes())
    content[len(content) // 2] ^= 1
    place.write_bytes(content)
    os.utime(place, ns=(kept.st_atime_ns, kept.st_mtime_ns))


def moved_input(folder):
    place = folder / "resources" / "campaigns" / "small" / "bench.yaml"
    place.rename(place.with_name("b.yaml"))


def other_versions(folder):
    place = folder / "workflow" / "bladeroot" / "provenance.py"
    place.write_text(place.read_text().replace("NUMERICAL = (", 'NUMERICAL = ("pandas", '))


# change, what is asked for, what is said of it
CASES = {
    "nothing": (lambda folder: None, "results/small", "current"),
    "altered": (altered, SMALL + "stick.nc", "stick.nc: it was altered or replaced"),
    "what it stands on is altered": (altered, SMALL + "theory.nc", "stick.nc has changed since"),
    "an input is missing": (moved_input, SMALL + "report.html", "file not found: "),
    "a file of one's own": (
        lambda folder: (folder / SMALL / "mine.nc").touch(), SMALL + "mine.nc", "nothing states"),
    "not there": (lambda folder: None, SMALL + "none.nc", "none.nc is not there"),
    "other versions": (other_versions, SMALL + "stick.nc", "and here is python"),
}  # fmt: skip


@pytest.mark.parametrize("case", CASES)
def test_what_is_said(case, house, tmp_path):
    """In a checkout that was copied to another place."""
    change, asked, told = CASES[case]
    copy = tmp_path / "a copy"
    shutil.copytree(house.folder, copy, symlinks=True)
    change(copy)
    done = subprocess.run(
        [sys.executable, "-c", CALL, "check", asked],
        cwd=copy,
        env=house.environment | {"PYTHONPATH": str(copy / "workflow")},
        capture_output=True,
        text=True,
    )
    lines = (done.stdout + done.stderr).splitlines()
    assert any(told in line for line in lines), lines
    assert not any("Traceback" in line for line in lines)
    assert len(lines) <= 3, lines
    assert (done.returncode == 0) == (case == "nothing")
