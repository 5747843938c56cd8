"""Kill runs of the small campaign at random and at aimed moments, time after time, then continue.

    python tests/hostile/kills.py FOLDER [--random 200] [--aimed 20] [--seed 1] [--json FILE]

FOLDER gets the small house, if it is not there, and keeps it. A chain deletes some results, starts
the run, kills it (with all that it started, or alone, so that its jobs outlive it; or two that were
started at once), gives the same command again and kills that, and so on; a run that ends before it
is killed begins with the results deleted again. After each kill every file that is there must have
the bytes that it has in a run that nobody disturbed; the chain's last command, undisturbed, must
end well with all of them, leave no part and nothing to do. A chain that fails is repeated a kill at
a time. Runs are forks of this process: Snakemake is loaded once.
"""

import argparse
import atexit
import json
import os
import random
import shutil
import signal
import sys
import time
from collections import Counter
from datetime import UTC, datetime
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "lib"))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "campaigns"))
from forked import snakemake_main
from house import House, copy_house

LIMIT_S = 900.0
KILLS = 10  # of a chain
# What a chain deletes and asks for: stages that take a second or two.
SMALL, TINY = "results/small", "results/structures/tiny"
WORK = {
    "a record of a batch": f"{SMALL}/decay/r001.nc",
    "stick": f"{SMALL}/stick.nc",
    "theory": f"{SMALL}/theory.nc",
    "score": f"{SMALL}/score.nc",
    "curves": f"{SMALL}/curves.nc",
    "shapes": f"{TINY}/modes.svg",
    "map": f"{TINY}/map/12000.nc",
    "verdict": f"{SMALL}/diagnosis/verdict.json",
    "matrices": f"{TINY}/matrices-mtx",
    "export": f"{SMALL}/export",
    "report": f"{SMALL}/report.html",
}
LIGHT = [name for name in WORK if name != "report"]
# Moments that are waited for: a file that is there for a moment, while which work is done.
AIMED = {
    "records that a batch keeps, set aside": (".snakemake/backups/**/*.nc", "a record of a batch"),
    "half-written record": ("results/small/*/.*.part", "a record of a batch"),
    "Snakemake's lock": (".snakemake/locks/*.lock", "score"),
    "the sign of a run": (".snakemake/bladeroot_runs/running-*", "score"),
    "a job that began": (".snakemake/incomplete/*", "theory"),
    "half-written artifact": ("results/small/.*.part", "stick"),
    "half-written curves": ("results/small/.*.part", "curves"),
    "half-written statement": ("results/provenance/*/.*.part", "score"),
    "half-written drawing": ("results/structures/tiny/.*.part", "shapes"),
    "half-written folder of matrices": ("results/structures/tiny/.*.part", "matrices"),
    "half-written export": ("results/small/.*.part", "export"),
    "half-written report": ("results/small/.*.part", "report"),
}


def contents(house):
    """Bytes of all results but what a run says of itself."""
    beside = ("logs", "benchmarks", "provenance", "timings.csv")
    found = {}
    for path in sorted((house.folder / "results").rglob("*")):
        name = path.relative_to(house.folder / "results")
        hidden = any(part.startswith(".") for part in name.parts)
        if name.parts[0] not in beside and not hidden and path.is_file():
            found[str(name)] = path.read_bytes()
    return found


def start(house, *asked):
    """A run in a session of its own; its process id."""
    main = snakemake_main()
    child = os.fork()
    if child:
        return child
    status = 1
    try:
        os.setsid()
        os.chdir(house.folder)
        os.environ.update(house.environment)
        said = os.open("said.txt", os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        os.dup2(said, 1)
        os.dup2(said, 2)
        for name in [name for name in sys.modules if name.split(".")[0] == "bladeroot"]:
            del sys.modules[name]  # the house has its own
        tests = str(Path(__file__).parents[2])
        sys.path[:] = [one for one in sys.path if not one.startswith(tests)]
        main(["-j2", *asked])
    except SystemExit as end:
        status = int(end.code or 0)
    finally:
        atexit._run_exitfuncs()
        os._exit(status)


def ended(process, wait=False):
    """Status of a run, None while it goes on."""
    found, status = os.waitpid(process, 0 if wait else os.WNOHANG)
    return os.waitstatus_to_exitcode(status) if found else None


def kill(process, alone):
    """kill -9 of a run with its jobs, or of it alone; whether it was still going on."""
    if ended(process) is not None:
        return False
    (os.kill if alone else os.killpg)(process, signal.SIGKILL)
    return ended(process, wait=True) == -signal.SIGKILL


def seen(house, pattern):
    found = set()
    for path in house.folder.glob(pattern):
        try:
            found.add((path, path.lstat().st_ctime_ns))
        except OSError:  # gone again
            continue
    return found


def wait_for(house, moment, process, before):
    """Until some seconds have passed, or a file is there that was not `before`."""
    end = time.monotonic() + (moment if isinstance(moment, float) else LIMIT_S)
    while time.monotonic() < end:
        if not isinstance(moment, float) and seen(house, moment) - before:
            return
        # not reaped here: `kill` does
        if os.waitid(os.P_PID, process, os.WEXITED | os.WNOHANG | os.WNOWAIT):
            return
        time.sleep(0.002)


def delete(house, work):
    for name in work:
        place = house.folder / WORK[name]
        shutil.rmtree(place) if place.is_dir() else place.unlink(missing_ok=True)


def chain(reference, whole, place, work, kills, counts):
    """What went wrong in one chain, "" for nothing; counts takes classes of kills that happened."""
    shutil.rmtree(place, ignore_errors=True)
    shutil.copytree(reference.folder, place, symlinks=True)
    house, asked = House(place), [WORK[name] for name in work]
    delete(house, work)
    for name, moment, own, alone, twice in kills:
        if own:
            delete(house, [own])
        before = set() if isinstance(moment, float) else seen(house, moment)
        begun = [start(house, *asked) for _ in range(1 + twice)]
        wait_for(house, moment, begun[0], before)
        killed = [kill(one, alone) for one in begun]
        counts[name, "killed" if any(killed) else "ended before"] += 1
        if not any(killed):
            delete(house, work)
        now = contents(house)
        if spoilt := [one for one in now if now[one] != whole.get(one)]:
            return f"after {name}, {moment}: {spoilt}"
    status = ended(start(house, *asked), wait=True)
    now = contents(house)
    if status:
        return f"the last command: {status}, {(place / 'said.txt').read_text()[-2000:]}"
    if now != whole:
        return f"others: {[one for one in {*now, *whole} if now.get(one) != whole.get(one)]}"
    if left := list((place / "results").rglob(".*.part")):
        return f"left: {left}"
    ended(start(house, "--dry-run", *WORK.values()), wait=True)
    told = (place / "said.txt").read_text()
    return "" if "Nothing to be done" in told else f"not settled: {told[-2000:]}"


def plan(asked):
    """Chains: the work of each, and its kills."""
    draw = random.Random(asked.seed)
    kills = []
    for k in range(asked.random):
        early = k % 3 == 0
        moment = draw.uniform(0.02, 1.0) if early else draw.uniform(0.5, asked.longest)
        name, alone, twice = "at random, in the first second" if early else "at random", False, 0
        if k % 4 == 2:
            name, alone = "at random, its jobs outlive it", True
        elif k % 4 == 3:
            name, twice = "at random, two started at once", 1
        kills.append((name, moment, None, alone, twice))
    chains = []
    for k in range(0, len(kills), KILLS):
        work = draw.sample(LIGHT, 4) if k % (4 * KILLS) else ["report", *draw.sample(LIGHT, 3)]
        chains.append((work, kills[k : k + KILLS]))
    aims = [list(AIMED.items())[k % len(AIMED)] for k in range(asked.aimed)]
    for k in range(0, len(aims), KILLS):
        some = aims[k : k + KILLS]
        own = [(name, pattern, work, False, 0) for name, (pattern, work) in some]
        chains.append((list(dict.fromkeys(one[2] for one in own)), own))
    return chains


def main():
    """Run the chains that were asked for; the exit status is the number that failed."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--random", type=int, default=200)
    parser.add_argument("--aimed", type=int, default=20)
    parser.add_argument("--longest", type=float, default=6.0, help="s until a random kill")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--json", type=Path, help="file for the table of outcomes")
    asked = parser.parse_args()
    place = asked.folder / "whole"
    reference = House(place) if (place / "Snakefile").is_file() else copy_house(place)
    reference.run(f"{SMALL}/report.html", *WORK.values())
    whole, counts, failed = contents(reference), Counter(), []
    for k, (work, kills) in enumerate(plan(asked)):
        wrong = chain(reference, whole, asked.folder / "chain", work, kills, counts)
        print(f"{k + 1:3d} {' '.join(work)}: {wrong or 'identical'}", flush=True)
        if wrong:
            failed.append(wrong)
            for one in kills:
                wrong = chain(reference, whole, asked.folder / "chain", work, [one], Counter())
                print(f"      {one}: {wrong or 'identical'}", flush=True)
    table = [
        {"class": name, **{what: counts[name, what] for what in ("killed", "ended before")}}
        for name in dict.fromkeys(name for name, _ in counts)
    ]
    result = {
        "date": datetime.now(UTC).date().isoformat(),
        "seed": asked.seed,
        "chains": k + 1,
        "chains not identical": len(failed),
        "kills": table,
    }
    text = json.dumps(result, indent=1) + "\n"
    print(text)
    if asked.json:
        asked.json.write_text(text, encoding="utf-8")
    sys.exit(min(len(failed), 100))


if __name__ == "__main__":
    main()
