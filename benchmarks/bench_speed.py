"""CPU and wall seconds of the virtual bench for a simulated second, all node pairs in contact.

python benchmarks/bench_speed.py [reduced.nc]
"""

import sys
import time
from pathlib import Path

import xarray as xr
import yaml
from bladeroot.bench.bench import move
from bladeroot.bench.clamping import clamp
from bladeroot.bench.joint import parts

ROOT = Path(__file__).resolve().parents[1]
LIMIT = 5.0  # wall seconds
SLIPS = 1e-6  # part of the work put in that friction takes


def main(reduced):
    bench = yaml.safe_load((ROOT / "resources" / "bench" / "rig.yaml").read_text())
    with xr.open_dataset(reduced) as opened:
        whole = parts(opened.load())
    print(f"{whole.share.size} node pairs, {bench['specimen']['modes']} modes")
    for mode, drive in (("1B", 0.01), ("1B", 3.6), ("2B", 5.5)):
        row = {"record": "r1", "mode": mode, "hold": "h1", "pressure_bar": 20}
        clamping = clamp(bench, whole, row)
        move(bench, clamping, drive)  # compiled
        began, clock = time.process_time(), time.perf_counter()
        motion, _ = move(bench, clamping, drive)
        spent, wall = time.process_time() - began, time.perf_counter() - clock
        seconds = motion.velocity.size / bench["recording"]["sampling_Hz"]
        slips = "slipping" if motion.work_friction > SLIPS * motion.work_in else "stuck"
        verdict = "ok" if wall < LIMIT * seconds else "FAILS"
        print(
            f"{mode} {slips:9} {spent / seconds:6.2f} s CPU, {wall / seconds:.2f} s wall a second, "
            f"at most {LIMIT}: {verdict}"
        )


if __name__ == "__main__":
    shipped = ROOT / "results" / "structures" / "dovetail-HB" / "reduced.nc"
    main(sys.argv[1] if len(sys.argv) > 1 else shipped)
