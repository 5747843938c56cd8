"""The main job of two commits side by side: wall and CPU seconds, and their ratios.

    python benchmarks/whole_run.py [--base COMMIT] [--rounds N] [--json FILE]

Each commit runs in clones of its own, in turn: the campaign `thesis` alone and the default run, in
a clean clone whose compiled code is not kept from before, then a second run, one after a changed
setting of the diagnosis and one after an added record. Ten minutes a round for the first commit and
half of that for the second; on an idle machine the wall seconds say what the targets ask.
"""

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
SHEET = Path("resources", "campaigns", "rig", "records.csv")
BASE = "6d7e5d5"  # before a batch of records was one job
TARGETS = {  # wall seconds at -j2 on two idle cores
    "thesis alone": 60.0,
    "default run": 180.0,
    "nothing to do": 3.0,
    "diagnosis set": 20.0,
    "record added": 12.0,
}


def seconds(folder: Path, *options: str) -> tuple[float, float]:
    """Wall and CPU seconds of a run in a clone, its jobs included."""
    environment = {**os.environ, "XDG_CACHE_HOME": str(folder / "cache")}
    for variable in ("PYTHONPATH", "NUMBA_CACHE_DIR"):  # of another checkout
        environment.pop(variable, None)
    command = [sys.executable, "-m", "snakemake", "-j2", *options]
    start, before = time.perf_counter(), resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, cwd=folder, check=True, capture_output=True, env=environment)
    wall, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return wall, used


def cloned(folder: Path, commit: str) -> Path:
    subprocess.run(["git", "clone", "--quiet", str(ROOT), str(folder)], check=True)
    subprocess.run(["git", "checkout", "--quiet", commit], cwd=folder, check=True)
    return folder


def add_record(clone: Path) -> None:
    """The last row once more, under a name of its own."""
    lines = (clone / SHEET).read_text().splitlines()
    lines.append(lines[-1].replace("r056", "r057"))
    (clone / SHEET).write_text("\n".join(lines) + "\n")


def measured(folder: Path, commits: dict[str, str]) -> dict[str, dict[str, tuple[float, float]]]:
    """Wall and CPU seconds by what was run and by commit, one commit after the other in each."""
    clones = {name: cloned(folder / name, commit) for name, commit in commits.items()}
    alone = {name: cloned(folder / f"{name}-thesis", commit) for name, commit in commits.items()}
    own = folder / "mechanisms"
    own.mkdir()
    setting = ("--config", f"diagnosis={{mechanisms: {own}}}")
    rows = {
        "thesis alone": {n: seconds(c, "--config", "campaigns=thesis") for n, c in alone.items()},
        "default run": {name: seconds(clone) for name, clone in clones.items()},
        "nothing to do": {name: seconds(clone) for name, clone in clones.items()},
        "diagnosis set": {name: seconds(clone, *setting) for name, clone in clones.items()},
    }
    for clone in clones.values():
        seconds(clone)  # back to the setting as shipped
        add_record(clone)
    rows["record added"] = {name: seconds(clone) for name, clone in clones.items()}
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--base", default=BASE, help="commit to compare with")
    parser.add_argument("--rounds", type=int, default=1)
    parser.add_argument("--json", type=Path, help="where the numbers go, too")
    asked = parser.parse_args()
    rounds = []
    for _ in range(asked.rounds):
        with tempfile.TemporaryDirectory() as temporary:
            rounds.append(measured(Path(temporary), {"before": asked.base, "now": "HEAD"}))
    table = {}
    for name, target in TARGETS.items():
        best = {
            commit: [min(one[name][commit][part] for one in rounds) for part in (0, 1)]
            for commit in ("before", "now")
        }
        wall, used = (best["now"][part] / best["before"][part] for part in (0, 1))
        table[name] = {**best, "wall_ratio": wall, "cpu_ratio": used, "target_s": target}
        verdict = "ok" if best["now"][0] <= target else "FAILS"
        print(
            f"{name:14s} {best['before'][0]:7.1f} -> {best['now'][0]:6.1f} s wall ({wall:.2f}), "
            f"{best['before'][1]:7.1f} -> {best['now'][1]:6.1f} s CPU ({used:.2f}); "
            f"asked {target:g} s: {verdict}"
        )
    if asked.json:
        asked.json.write_text(json.dumps(table, indent=2) + "\n")


if __name__ == "__main__":
    main()
