"""Locks end with their process, however it ends; another machine's sign is respected."""

import subprocess
import sys

import pytest
from bladeroot import runs

HOLD = """
import sys
from bladeroot import runs
run = runs.Run(sys.argv[1])
print(run.begin(lambda line: print(line, flush=True)), flush=True)
if sys.argv[2] == "started":
    run.started()
sys.stdin.read()
"""
WORK = """
import sys
from bladeroot import runs
runs.work(sys.argv[1])
print("works", flush=True)
sys.stdin.read()
"""


@pytest.fixture
def started(tmp_path):
    """Begins a process in the folder; all end with the test."""
    begun = []

    def start(code, *more):
        process = subprocess.Popen(
            [sys.executable, "-c", code, tmp_path, *more],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
            env={"PYTHONPATH": runs.__file__.rpartition("/bladeroot/")[0]},
        )  # fmt: skip
        begun.append(process)
        return process

    yield start
    for process in begun:
        process.kill()
        process.communicate()


def test_a_run_that_was_killed_is_gone_at_once(started, tmp_path):
    first = started(HOLD, "started")
    assert first.stdout.readline() == "True\n"
    assert not runs.Run(tmp_path).alone()
    first.kill()
    first.wait()
    assert runs.Run(tmp_path).begin(pytest.fail)


def test_a_second_start_waits_until_the_first_has_its_lock(started, tmp_path):
    first = started(HOLD, "")
    first.stdout.readline()
    second = started(HOLD, "started")
    assert "another run is starting" in second.stdout.readline()
    first.kill()
    assert second.stdout.readline() == "True\n"


def test_two_runs_live_side_by_side_and_the_last_takes_the_sign_away(started, tmp_path):
    first = runs.Run(tmp_path)
    assert first.begin(pytest.fail)
    first.started()
    second = started(HOLD, "started")
    assert second.stdout.readline() == "False\n"
    first.end()
    assert not runs.Run(tmp_path).alone()
    second.kill()
    second.wait()
    last = runs.Run(tmp_path)
    last.begin(pytest.fail)
    last.end()
    assert not list(tmp_path.rglob("running-*"))


def test_a_job_that_outlives_its_run_is_waited_for(started, tmp_path):
    runs.Run(tmp_path)
    works = started(WORK)
    works.stdout.readline()
    told = []
    run = runs.Run(tmp_path)

    def end(line):
        told.append(line)
        works.kill()

    assert run.begin(end)
    assert "still works" in told[0]


def test_another_machines_sign_counts_as_alive(tmp_path):
    run = runs.Run(tmp_path)
    sign = tmp_path / "bladeroot_runs" / "running-another"
    sign.write_text("another")
    assert not run.alone()
    sign.write_text(runs.platform.node())  # this one, before it was restarted
    assert run.alone()


def test_what_is_left_goes_files_and_folders(tmp_path):
    results, snakemake = tmp_path / "results", tmp_path / ".snakemake"
    for path in (
        results / "a" / ".b.1.part",
        results / ".c.part" / "inner",
        snakemake / "locks" / "0.input.lock",
        snakemake / "backups" / "results" / "whole.nc",
    ):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch()
    (results / "whole.nc").touch()
    runs.remove_what_is_left(snakemake, results)
    left = [path.name for path in tmp_path.rglob("*") if path.is_file()]
    assert left == ["whole.nc"]
    assert not (results / ".c.part").exists()
