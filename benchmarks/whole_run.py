"""The default run, a second one, and one after an added record, side by side in a fresh clone.

    python benchmarks/whole_run.py

Prints wall seconds and their ratio to the full run (about ten minutes; nothing is kept).
"""

import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
SHEET = Path("resources", "campaigns", "rig", "records.csv")


def seconds(folder: Path, *options: str) -> float:
    start = time.perf_counter()
    command = [sys.executable, "-m", "snakemake", "-j2", *options]
    subprocess.run(command, cwd=folder, check=True, capture_output=True)
    return time.perf_counter() - start


def main() -> None:
    with tempfile.TemporaryDirectory() as temporary:
        clone = Path(temporary) / "clone"
        subprocess.run(["git", "clone", "--quiet", str(ROOT), str(clone)], check=True)
        rows = [("thesis alone", seconds(clone, "--config", "campaigns=thesis"))]
        subprocess.run(["git", "clean", "-fdxq"], cwd=clone, check=True)
        full = seconds(clone)
        rows += [("full run", full), ("second run", seconds(clone))]
        lines = (clone / SHEET).read_text().splitlines()
        lines.append(lines[-1].replace("r056", "r057"))
        (clone / SHEET).write_text("\n".join(lines) + "\n")
        rows.append(("one record added", seconds(clone)))
    for name, wall in rows:
        print(f"{name:18s} {wall:7.1f} s  {wall / full:6.3f} of the full run")


if __name__ == "__main__":
    main()
