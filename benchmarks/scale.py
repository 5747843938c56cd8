"""Time, memory and files of campaigns of hundreds to tens of thousands of records.

    python benchmarks/scale.py                            # 112 and 1,000 records: some ten minutes
    python benchmarks/scale.py 112 --small                # a minute
    python benchmarks/scale.py 10000 --dry --json FILE    # the plan of the jobs alone

Each campaign has short records (16-bit WAV, 20 to 60 kB) of two modes at eight loads: decays whose
frequency and loss factor depend on the amplitude, with noise. There is no structure, so that the
time is that of records. Wall time is honest on an idle machine only; CPU time is that of all
processes, Snakemake and compiled caches included.
"""

import argparse
import csv
import json
import os
import subprocess
import sys
import tempfile
import time
import wave
from collections.abc import Iterator
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
SAMPLING_HZ = 8192
FULL_SCALE = 0.05  # m/s
MODES = {"1B": 180.0, "2B": 520.0}
LOADS_KN = (4, 6, 8, 10, 12, 16, 20, 24)
REPEATS = 4  # records of a clamping
DESCRIPTION = """title: {count} records, simulated for the benchmark of scale
modes:
  1B: {{expected_Hz: 180, laser_x_mm: 0}}
  2B: {{expected_Hz: 520, laser_x_mm: 0}}
force:
  gauge: pressure
  piston_area_cm2: 17.9
  full_scale_bar: 700
  accuracy_percent: 1
  accuracy_of: reading
"""


def decay(rng: np.random.Generator, frequency_Hz: float, loss_factor: float) -> np.ndarray:
    """Velocity in m/s: quiet, then a decay that softens and damps above a tenth of its start.

    The amplitude a (relative) falls by a' = -pi f eta a (1 + 2 s), s = max(0, 1 - 0.1 / a), and the
    frequency is f (1 - 0.005 s): integrated by steps of a sample, which is exact enough for cost.
    """
    quiet = int(0.05 * SAMPLING_HZ)
    # to 0.2 % of the start
    count = int(SAMPLING_HZ * 6.2 / (np.pi * frequency_Hz * loss_factor))
    slow = np.pi * frequency_Hz * loss_factor / SAMPLING_HZ
    level = np.geomspace(1.0, 0.002, 400)
    slip = np.maximum(0.0, 1.0 - 0.1 / level)
    steps = -np.diff(np.log(level)) / (slow * (1.0 + slip[:-1] + slip[1:]))
    at = np.concatenate([[0.0], np.cumsum(steps)])
    amplitude = np.exp(np.interp(np.arange(count), at, np.log(level)))
    slip = np.maximum(0.0, 1.0 - 0.1 / amplitude)
    phase = 2 * np.pi * np.cumsum(frequency_Hz * (1.0 - 0.005 * slip)) / SAMPLING_HZ
    whole = np.concatenate([np.zeros(quiet), 0.8 * FULL_SCALE * amplitude * np.sin(phase)])
    return whole + 1e-4 * FULL_SCALE * rng.standard_normal(whole.size)


def save_wav(path: Path, velocity: np.ndarray) -> None:
    with wave.open(str(path), "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(SAMPLING_HZ)
        file.writeframes((velocity / FULL_SCALE * 32767).round().astype("<i2").tobytes())


def records(count: int, seed: int = 0) -> Iterator[tuple[dict, np.ndarray]]:
    """Rows of the sheet with their velocities."""
    rng = np.random.default_rng(seed)
    for number in range(count):
        hold, repeat = divmod(number, REPEATS * len(MODES))
        mode = list(MODES)[repeat % len(MODES)]
        load = LOADS_KN[hold % len(LOADS_KN)]
        stiffness = 1.0 + 0.01 * np.log(load / 12.0) + 0.0005 * rng.standard_normal()
        velocity = decay(rng, MODES[mode] * stiffness, 0.004 * (1.0 + 0.1 * rng.standard_normal()))
        row = {
            "record": f"r{number:06d}",
            "file": f"raw/r{number:06d}.wav",
            "mode": mode,
            "force_N": 1000 * load,
            "hold": f"h{hold}",
            "time_s": 60 * number,
            "quantity": "velocity",
            "unit": "FS",
            "sensitivity": f"{1 / FULL_SCALE:g} FS/(m/s)",
        }
        yield row, velocity


def make_campaign(folder: Path, count: int) -> Path:
    """The campaign's folder with its files."""
    (folder / "raw").mkdir(parents=True)
    (folder / "campaign.yaml").write_text(DESCRIPTION.format(count=count))
    with (folder / "records.csv").open("w", newline="") as sheet:
        table = None
        for row, velocity in records(count):
            save_wav(folder / row["file"], velocity)
            table = table or csv.DictWriter(sheet, list(row))
            if sheet.tell() == 0:
                table.writeheader()
            table.writerow(row)
    return folder


def measured(campaign: Path, home: Path, *options: str) -> dict[str, float]:
    """One run of the workflow in the folder `home`: wall and CPU seconds, largest process in MB."""
    command = [sys.executable, "-m", "snakemake", "--snakefile", str(ROOT / "Snakefile")]
    command += ["--workflow-profile", str(ROOT / "profiles" / "default")]
    command += [*options, "--config", f"campaigns={campaign}"]
    with (home / "log.txt").open("a") as log:
        start = time.perf_counter()
        process = subprocess.Popen(
            command, cwd=home, stdout=log, stderr=log, env={**os.environ, "OMP_NUM_THREADS": "1"}
        )
        # what it and all that it waited for have used
        _, status, used = os.wait4(process.pid, 0)
        wall = time.perf_counter() - start
    if status:
        sys.exit(f"the run failed: {home / 'log.txt'}:\n{(home / 'log.txt').read_text()[-2000:]}")
    return {
        "wall_s": round(wall, 1),
        "cpu_s": round(used.ru_utime + used.ru_stime, 1),
        "memory_MB": round(used.ru_maxrss / 1024),
    }


def rules(home: Path) -> dict[str, dict[str, float]]:
    """What results/timings.csv says of each rule."""
    with (home / "results" / "timings.csv").open(newline="") as sheet:
        return {
            row.pop("rule"): {key: float(value) for key, value in row.items()}
            for row in csv.DictReader(sheet)
        }


def files_in(folder: Path) -> dict[str, float]:
    """Number and megabytes of the files below a folder."""
    sizes = [path.stat().st_size for path in folder.rglob("*") if path.is_file()]
    return {"files": len(sizes), "MB": round(sum(sizes) / 1e6, 1)}


def scale(count: int, home: Path, jobs: list[int], dry: bool) -> dict:
    """All measurements of one size."""
    campaign = make_campaign(home / f"scale{count}", count)
    found = {"records": count, "raw": files_in(campaign)}
    (home / "planned").mkdir()
    found["plan"] = measured(campaign, home / "planned", "--dry-run", "--quiet")
    for cores in [] if dry else jobs:
        run = home / f"j{cores}"
        run.mkdir()
        found[f"j{cores}"] = measured(campaign, run, f"-j{cores}", "--quiet")
        found[f"j{cores}"]["rules"] = rules(run)
        found["results"] = files_in(run / "results")
        found["metadata"] = files_in(run / ".snakemake")
        found["again"] = measured(campaign, run, "--dry-run", "--quiet")
    return found


def line(found: dict) -> str:
    cells = [f"{found['records']:8d}", f"{found['plan']['wall_s']:8.1f}"]
    for name in ("j1", "j2"):
        run = found.get(name)
        cells.append(f"{run['wall_s']:8.1f}" if run else f"{'':8s}")
        cells.append(f"{1000 * run['cpu_s'] / found['records']:8.0f}" if run else f"{'':8s}")
        cells.append(f"{run['memory_MB']:8d}" if run else f"{'':8s}")
    if "again" in found:
        cells += [f"{found['again']['wall_s']:8.1f}", f"{found['results']['files']:8d}"]
    return " ".join(cells)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("counts", nargs="*", type=int, default=[112, 1000], help="records")
    parser.add_argument("--jobs", nargs="*", type=int, default=[1, 2], help="cores, a run each")
    parser.add_argument("--dry", action="store_true", help="plan the jobs and run none")
    parser.add_argument("--small", action="store_true", help="at -j2 only")
    parser.add_argument("--folder", help="keep campaigns and results there")
    parser.add_argument("--json", help="file for the numbers")
    options = parser.parse_args()
    heads = ["records", "plan s", *(f"-j{n} {u}" for n in (1, 2) for u in ("s", "ms/rec", "MB"))]
    print(" ".join(f"{head:>8s}" for head in [*heads, "again s", "files"]))
    table = []
    for count in options.counts:
        with tempfile.TemporaryDirectory() as passing:
            home = Path(options.folder or passing) / f"{count}"
            home.mkdir(parents=True)
            jobs = [2] if options.small else options.jobs
            table.append(scale(count, home, jobs, options.dry))
        print(line(table[-1]), flush=True)
    if options.json:
        Path(options.json).write_text(json.dumps(table, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
