"""Kill runs of the small campaign at random and at aimed moments: one command continues each.

    python tests/hostile/kills.py FOLDER [--random 200] [--aimed 20] [--seed 1]

FOLDER gets the small house, if it is not there, and keeps it. A trial deletes some of its results,
starts a run, kills it with all that it started (or alone, so that its jobs outlive it), gives the
command once more (or twice at once) and compares every result byte by byte with those of the run
that nobody disturbed.
"""

import argparse
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "campaigns"))
from house import House, copy_house

LIMIT_S = 900.0
# What a trial deletes, and what it asks for besides the report: stages that take a second or two.
SMALL, TINY = "results/small", "results/structures/tiny"
WORK = [
    [f"{SMALL}/stick.nc", f"{SMALL}/report.html"],
    [f"{SMALL}/theory.nc", f"{SMALL}/report.html"],
    [f"{SMALL}/score.nc", f"{SMALL}/report.html"],
    [f"{SMALL}/curves.nc", f"{SMALL}/report.html"],
    [f"{TINY}/modes.svg", f"{TINY}/shapes.nc", f"{SMALL}/report.html"],
    [f"{TINY}/matrices-mtx", f"{SMALL}/report.html"],
    [f"{SMALL}/export", f"{SMALL}/diagnosis/verdict.json", f"{SMALL}/report.html"],
]
# Moments that are waited for: a pattern of a file that is there for a moment, of which work.
AIMED = {
    "Snakemake's lock": (".snakemake/locks/*.lock", 0),
    "a job that began": (".snakemake/incomplete/*", 1),
    "a half-written artifact": ("results/small/.*.part", 2),
    "a half-written chapter": ("results/small/report/.*.part", 3),
    "a statement": ("results/provenance/**/.*.part", 4),
    "a half-written folder of matrices": ("results/structures/tiny/.*.part", 5),
    "a half-written export": ("results/small/.*.part", 6),
    "the sign of a run": (".snakemake/bladeroot_runs/running-*", 0),
}


def contents(house):
    """Bytes of all results but what a run says of itself."""
    beside = ("logs", "benchmarks", "provenance", "timings.csv")
    found = {}
    for path in sorted((house.folder / "results").rglob("*")):
        name = path.relative_to(house.folder / "results")
        if path.is_file() and name.parts[0] not in beside and not path.name.startswith(".snake"):
            found[str(name)] = path.read_bytes()
    return found


def started(house, work):
    targets = [one for one in work if one.endswith(("matrices-mtx", "export"))]
    return subprocess.Popen(
        house.command(f"{SMALL}/report.html", *work, *targets),
        cwd=house.folder, env=house.environment, start_new_session=True,
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )  # fmt: skip


def kill(process, alone):
    """kill -9 of a run with its jobs, or of it alone."""
    if process.poll() is not None:
        return False
    if alone:
        process.kill()
    else:
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    return True


def wait_for(house, pattern, process):
    end = time.monotonic() + LIMIT_S
    while process.poll() is None and time.monotonic() < end:
        if any(house.folder.glob(pattern)):
            return
        time.sleep(0.001)


def trial(reference, whole, place, work, moment, alone, twice):
    """What went wrong in one trial: "" for nothing; and whether the run was killed in its midst."""
    shutil.rmtree(place, ignore_errors=True)
    shutil.copytree(reference.folder, place, symlinks=True)
    house = House(place)
    for path in work:
        one = place / path
        shutil.rmtree(one) if one.is_dir() else one.unlink()
    process = started(house, work)
    if isinstance(moment, float):
        time.sleep(moment)
    else:
        wait_for(house, moment, process)
    killed = kill(process, alone)
    begun = [started(house, work) for _ in range(1 + twice)]
    done = [one.wait(LIMIT_S) for one in begun]
    if all(done):
        again = house.run(*work, check=False)
        return f"the next command ends with {done}: {again.stderr[-300:]}", killed
    if contents(house) != whole:
        now = contents(house)
        return f"others: {[n for n in {*now, *whole} if now.get(n) != whole.get(n)]}", killed
    if list((place / "results").rglob(".*.part")):
        return "a part is left", killed
    told = house.run("--dry-run", f"{SMALL}/report.html", *work)
    return "" if "Nothing to be done" in told.stdout + told.stderr else "not settled", killed


def main():
    """Run the trials that were asked for; the exit status is the number that failed."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--random", type=int, default=200)
    parser.add_argument("--aimed", type=int, default=20)
    parser.add_argument("--longest", type=float, default=20.0, help="s until a random kill")
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    house = asked.folder / "whole"
    reference = House(house) if (house / "Snakefile").is_file() else copy_house(house)
    everything = sorted({path for work in WORK for path in work})
    reference.run(f"{SMALL}/report.html", *everything)
    whole, draw = contents(reference), random.Random(asked.seed)
    aimed = [list(AIMED.items())[k % len(AIMED)] for k in range(asked.aimed)]
    trials = [(name, WORK[work], pattern) for name, (pattern, work) in aimed]
    for k in range(asked.random):
        # one in four in the first half second
        moment = draw.uniform(0.02, 0.5) if k % 4 == 0 else draw.uniform(0.0, asked.longest)
        trials.append(("at random", draw.choice(WORK), moment))
    counts = Counter()
    for k, (name, work, moment) in enumerate(trials):
        wrong, killed = trial(
            reference, whole, asked.folder / "trial", work, moment,
            alone=k % 3 == 2, twice=k % 5 == 4,
        )  # fmt: skip
        counts["failed" if wrong else "killed" if killed else "ended before"] += 1
        print(f"{k + 1:4d} {name}, {moment}: {wrong or 'identical'}", flush=True)
    print(dict(counts))
    sys.exit(min(counts["failed"], 100))


if __name__ == "__main__":
    main()
