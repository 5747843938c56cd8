"""A workflow of two files a campaign with the real rules of what is current; a run takes a moment.

raw.txt -> results/<campaign>/a.nc -> results/<campaign>/b.nc: its letters large and a setting, then
twice. Runs are forks of this process, so that Snakemake is loaded once.
"""

import atexit
import faulthandler
import os
import signal
import sys
from pathlib import Path

from forked import snakemake_main

ROOT = Path(__file__).resolve().parents[2]
LIMIT_S = 60  # of a run
SNAKEFILE = f"""
import sys
from pathlib import Path
CAMPAIGNS = dict.fromkeys(("one", "two"))
rule all:
    input: expand("results/{{campaign}}/b.nc", campaign=CAMPAIGNS)
rule large:
    input: "{{campaign}}.txt"
    output: "results/{{campaign}}/a.nc"
    log: "results/logs/large/{{campaign}}.log"
    params: setting=Path("setting").read_text()
    shell: "if [ -f hook ]; then sh hook; fi; (tr a-z A-Z < {{input}}; cat setting) > {{output}}"
rule twice:
    input: "results/{{campaign}}/a.nc"
    output: "results/{{campaign}}/b.nc"
    log: "results/logs/twice/{{campaign}}.log"
    shell: "cat {{input}} {{input}} > {{output}}"
include: "{ROOT}/workflow/rules/current.smk"
onstart:
    if RUN:
        RUN.started()
onsuccess:
    STATED.state_rest()
onerror:
    STATED.state_rest()
"""


def make(folder):
    """A folder in which nothing has run."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "Snakefile").write_text(SNAKEFILE)
    (folder / "setting").write_text("set\n")
    for name in ("one", "two"):
        (folder / f"{name}.txt").write_text(f"raw of {name}\n")
    return folder


def run(folder, *options, before=None):
    """Snakemake in the folder: exit status and what it said. before: called in its process."""
    # a pipe: a file would be cut off where a case lets files be short
    main = snakemake_main()
    ours, theirs = os.pipe()
    child = os.fork()
    if child == 0:
        status = 1
        try:
            os.setsid()
            signal.alarm(LIMIT_S)
            os.chdir(folder)
            sys.stdout = sys.stderr = os.fdopen(theirs, "w", 1, errors="backslashreplace")
            os.dup2(theirs, 1)
            os.dup2(theirs, 2)
            # where each thread of a run that never ends stands, before the alarm ends it
            faulthandler.dump_traceback_later(LIMIT_S - 2)
            if before:
                before()
            profile = ["--workflow-profile", str(ROOT / "profiles" / "default")]
            main(["-j2", *profile, *options])
        except SystemExit as end:
            status = end.code if isinstance(end.code, int) else 1
        finally:
            atexit._run_exitfuncs()
            os._exit(status)
    os.close(theirs)
    with os.fdopen(ours, errors="replace") as told:
        said = told.read()
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), said


def right(folder):
    """Whether all results are those of the raw files as they are; what is in between may lack."""
    for name in ("one", "two"):
        large = (folder / f"{name}.txt").read_text().upper() + (folder / "setting").read_text()
        for file, content in (("a.nc", large), ("b.nc", 2 * large)):
            place = folder / "results" / name / file
            if (file == "b.nc" or place.exists()) and place.read_text() != content:
                return False
    return True
