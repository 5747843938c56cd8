"""The main job and what follows it on a clean clone, beside the seconds that are asked for.

    python benchmarks/whole_run.py [--commit COMMIT] [--cores N] [--keep FOLDER] [--json FILE]
    python benchmarks/whole_run.py --page whole_run.json       # these numbers into README.md

In turn: the campaign `thesis` alone and the default run, each in a clean clone without compiled
code from before, then a second run, one after a changed setting of the diagnosis, one after an
added record, and what one more record costs in the batch of all. Ten minutes of CPU. The targets
are wall seconds at -j2 on two idle cores; on a busy machine the CPU seconds count, over the cores.
"""

import argparse
import json
import os
import resource
import shlex
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from foreign_lab.score import with_table

ROOT = Path(__file__).resolve().parents[1]
PAGE = Path(__file__).with_name("README.md")
SHEET = Path("resources", "campaigns", "rig", "records.csv")
SNAKEMAKE = (sys.executable, "-m", "snakemake")
TARGETS = {
    "thesis alone": 60.0,
    "default run": 180.0,
    "nothing to do": 3.0,
    "diagnosis set": 20.0,
    "record added": 12.0,
    "one record more": 0.15,
}


def seconds(folder: Path, *command: str) -> tuple[float, float]:
    """Wall and CPU seconds of a command in a clone, its processes included."""
    # one thread of the libraries a process, as the workflow sets it
    environment = {**os.environ, "XDG_CACHE_HOME": str(folder / "cache"), "OMP_NUM_THREADS": "1"}
    # of another checkout, and of shells that have every process read its sources anew
    for variable in ("PYTHONPATH", "NUMBA_CACHE_DIR", "PYTHONDONTWRITEBYTECODE"):
        environment.pop(variable, None)
    start, before = time.perf_counter(), resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, env=environment)
    wall, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode:
        raise SystemExit(f"{' '.join(command)[:200]}\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    return wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def cloned(folder: Path, commit: str) -> Path:
    """A clean clone, unless one is left from a run before."""
    if not folder.is_dir():
        subprocess.run(["git", "clone", "--quiet", str(ROOT), str(folder)], check=True)
        subprocess.run(["git", "checkout", "--quiet", commit], cwd=folder, check=True)
    return folder


def add_record(clone: Path) -> None:
    """The last row once more, under a name of its own."""
    lines = (clone / SHEET).read_text().splitlines()
    lines.append(lines[-1].replace("r056", "r057"))
    (clone / SHEET).write_text("\n".join(lines) + "\n")


def one_record_more(clone: Path) -> tuple[float, float]:
    """Wall and CPU seconds of a record in the process that analyses all, its start not counted."""
    lists = sorted((clone / "results" / "rig" / "batches").glob("*.txt"))
    largest = max(lists, key=lambda path: len(path.read_text().split())).relative_to(clone)
    plan = [*SNAKEMAKE, "-n", "-p", "--force", str(largest)]
    said = subprocess.run(plan, cwd=clone, capture_output=True, text=True, check=True).stdout
    line = next(one for one in said.splitlines() if "ringdown.py" in one)
    words = shlex.split(line.split(" > results/logs")[0].partition(": ")[2])
    raw, facts = words.index("--raw") + 1, words.index("--facts") + 1
    known = json.loads(words[facts])
    place = clone / "once_more"
    words[words.index("--folder") + 1] = str(place)
    words[words.index("--batch") + 1] = str(place / "batch.txt")
    for stage in ("records", "decay", "plateau"):
        (place / stage).mkdir(parents=True, exist_ok=True)
    taken = []
    for some in (1, 1, len(known)):  # the first may have to compile
        less = [*words[: raw + some], "--facts", json.dumps(known[:some]), *words[facts + 1 :]]
        taken.append(seconds(clone, *less))
    return tuple((b - a) / (len(known) - 1) for a, b in zip(*taken[1:], strict=True))


def measured(folder: Path, commit: str, cores: int):
    """What was run, with its wall and CPU seconds, one after the other."""
    run = [*SNAKEMAKE, f"-j{cores}"]
    alone = cloned(folder / "thesis", commit)
    yield "thesis alone", seconds(alone, *run, "--config", "campaigns=thesis")
    clone = cloned(folder / "whole", commit)
    yield "default run", seconds(clone, *run)
    yield "nothing to do", seconds(clone, *run)
    own = folder / "mechanisms"
    own.mkdir(exist_ok=True)
    yield "diagnosis set", seconds(clone, *run, "--config", f"diagnosis={{mechanisms: {own}}}")
    yield "one record more", one_record_more(clone)
    seconds(clone, *run)  # back to the setting as shipped
    add_record(clone)
    yield "record added", seconds(clone, *run)


def paged(made: dict) -> str:
    """README.md with a table of the numbers."""
    lines = ["| run | wall s | CPU s | asked, wall s | |", "|---|---|---|---|---|"]
    for name, one in made.items():
        verdict = "ok" if one["wall_s"] <= one["target_s"] else "FAILS"
        lines.append(
            f"| {name} | {one['wall_s']:.3g} | {one['cpu_s']:.3g} | {one['target_s']:g} "
            f"| {verdict} |"
        )
    return with_table(PAGE.read_text(), "whole_run", "\n".join(lines) + "\n")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--commit", default="HEAD")
    parser.add_argument("--cores", type=int, default=2)
    parser.add_argument("--keep", type=Path, help="folder of the clones; what is in it is used")
    parser.add_argument("--json", type=Path, help="where the numbers go, too")
    parser.add_argument("--page", type=Path, help="numbers that go into README.md")
    asked = parser.parse_args()
    if asked.page:
        PAGE.write_text(paged(json.loads(asked.page.read_text())))
        return
    table = {}
    with tempfile.TemporaryDirectory() as temporary:
        for name, (wall, used) in measured(
            asked.keep or Path(temporary), asked.commit, asked.cores
        ):
            table[name] = {"wall_s": wall, "cpu_s": used, "target_s": TARGETS[name]}
            verdict = "ok" if wall <= TARGETS[name] else "FAILS"
            print(
                f"{name:16s} {wall:7.2f} s wall, {used:7.2f} s CPU; asked {TARGETS[name]:g} s: "
                f"{verdict}; load {os.getloadavg()[0]:.1f}",
                flush=True,
            )
    if asked.json:
        asked.json.write_text(json.dumps(table, indent=2) + "\n")


if __name__ == "__main__":
    main()
