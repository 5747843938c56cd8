"""Stages that are forks of a process with the libraries loaded: as if each were started alone."""

import csv
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import psutil
import pytest
import tiny_workflow

ROOT = Path(__file__).resolve().parents[2]
AWKWARD = 'it\'s $HOME, "two"  spaces; * > all'
SNAKEFILE = f"""
import os, sys
from pathlib import Path
PYTHON, SCRIPTS = sys.executable, Path("scripts").resolve()
rule second:
    input: "first.json"
    output: "second.json"
    log: "second.log"
    params: text=Path("text").read_text()
    benchmark: "second.tsv"
    threads: 2
    shell: "{{PYTHON:q}} {{SCRIPTS:q}}/stage.py {{output}} {{params.text:q}} > {{log}} 2>&1"
rule first:
    output: "first.json"
    log: "first.log"
    threads: 1
    shell: "{{PYTHON:q}} {{SCRIPTS:q}}/stage.py {{output}} > {{log}} 2>&1"
rule of_shell:
    output: "of_shell.json"
    log: "of_shell.log"
    shell: "{{PYTHON:q}} {{SCRIPTS:q}}/stage.py {{output}} $((1 + 1)) > {{log}} 2>&1"
include: "{ROOT}/workflow/rules/warm.smk"
"""
STAGE = """
import json, os, sys
from pathlib import Path
import xarray
parent = Path(f"/proc/{os.getppid()}/cmdline").read_text()
known = {"warm": "_warm.py" in parent, "arguments": sys.argv[1:], "folder": os.getcwd(),
         "threads": os.environ["OMP_NUM_THREADS"], "name": __name__}
from own import NUMBER, hook
print("said")
print("complained", file=sys.stderr)
hook(sys.argv[1])
with open(sys.argv[1], "w") as file:
    json.dump({**known, "number": NUMBER}, file)
"""
OWN = "NUMBER = 1\ndef hook(output):\n    import os, signal, sys, time\n    {}\n"


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "scripts").mkdir()
    shutil.copy(ROOT / "workflow" / "scripts" / "_warm.py", tmp_path / "scripts")
    (tmp_path / "scripts" / "stage.py").write_text(STAGE)
    (tmp_path / "Snakefile").write_text(SNAKEFILE)
    (tmp_path / "text").write_text(AWKWARD)
    return tmp_path


def run(folder, hook="pass", *options):
    """Status of a run whose stages call the hook, and what it said."""
    (folder / "scripts" / "own.py").write_text(OWN.format(hook))
    return tiny_workflow.run(folder, *options)


def told(folder, name):
    return json.loads((folder / f"{name}.json").read_text())


def processes(folder):
    """Those of the warm process, its stages included."""
    return [one for one in psutil.process_iter() if str(folder / "scripts") in _words(one)]


def _words(process):
    try:
        return " ".join(process.cmdline())
    except psutil.Error:
        return ""


def until(wanted, seconds=30.0):
    last = time.monotonic() + seconds
    while not wanted() and time.monotonic() < last:
        time.sleep(0.02)
    return wanted()


def test_a_stage_is_as_if_it_was_started_by_itself(folder):
    # the first edits the module, as a person may between two jobs
    edit = "output == 'first.json' and open(__file__, 'a').write('NUMBER = 2')"
    status, said = run(folder, edit)
    assert status == 0, said
    first, second = told(folder, "first"), told(folder, "second")
    assert first == {
        "warm": True,
        "arguments": ["first.json"],
        "folder": str(folder),
        "threads": "1",
        "name": "__main__",
        "number": 1,
    }
    assert second["arguments"] == ["second.json", AWKWARD]
    assert second["threads"] == "2"
    assert second["number"] == 2
    for name in ("first", "second"):
        assert sorted((folder / f"{name}.log").read_text().split()) == ["complained", "said"]
    with open(folder / "second.tsv", newline="") as sheet:
        (row,) = csv.DictReader(sheet, delimiter="\t")
    assert float(row["max_rss"]) > 25.0  # of the stage, not of what waits for it
    assert not processes(folder)


@pytest.mark.parametrize(
    ("hook", "last"),
    [
        ("sys.exit('a bad record')", "a bad record"),
        ("raise RuntimeError('a fault')", "RuntimeError: a fault"),
        ("os.kill(os.getpid(), signal.SIGKILL)", ""),
    ],
)
def test_a_stage_that_fails_ends_the_run(hook, last, folder):
    status, _ = run(folder, hook)
    assert status == 1
    assert (folder / "first.log").read_text().rstrip().endswith(last)
    assert not (folder / "second.log").exists()
    assert not processes(folder)


def test_without_the_warm_process_stages_start_by_themselves(folder):
    kill = "parent = os.getppid(); output == 'first.json' and os.kill({}, signal.SIGKILL)"
    of_keeper = "int(open(f'/proc/{parent}/stat').read().split()[3])"
    status, said = run(folder, kill.format(of_keeper))
    assert status == 0, said
    assert told(folder, "first")["warm"]
    assert not told(folder, "second")["warm"]


def test_a_command_that_needs_a_shell_has_one(folder):
    status, said = run(folder, "pass", "of_shell.json")
    assert status == 0, said
    assert told(folder, "of_shell")["arguments"] == ["of_shell.json", "2"]
    assert not told(folder, "of_shell")["warm"]


@pytest.mark.parametrize("how", ["Ctrl-C", "kill -9", "kill -9 of all"])
def test_nothing_is_left_running(how, folder):
    hook = "time.sleep(2 if 'alone' in os.listdir() else 60)"
    (folder / "scripts" / "own.py").write_text(OWN.format(hook))
    if how == "kill -9":
        (folder / "alone").touch()
    command = [sys.executable, "-m", "snakemake", "-j2", "--quiet", "all"]
    with open(folder / "said.txt", "w") as said:
        process = subprocess.Popen(
            command,
            cwd=folder,
            stderr=said,
            start_new_session=True,
            # tests that a script started in the background ignore it
            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
        )
    log = folder / "first.log"
    assert until(lambda: log.exists() and len(processes(folder)) == 3)
    if how == "Ctrl-C":
        os.killpg(process.pid, signal.SIGINT)
    elif how == "kill -9":
        process.kill()
    else:
        os.killpg(process.pid, signal.SIGKILL)
    process.wait(30)
    if how == "kill -9":  # a stage goes on to its end, as it does by itself
        assert processes(folder)
    assert until(lambda: not processes(folder), 10.0)
    assert (folder / "first.json").exists() == (how == "kill -9")
