"""How often faults put into the virtual bench's records are found; what clean ones raise.

python benchmarks/rig_faults.py results/bench/rig [seed]

The records and the instants of release and return are those of resources/bench/rig.yaml.
"""

import csv
import sys
from pathlib import Path

import numpy as np
import xarray as xr
import yaml
from bladeroot.decay.cut import cut
from bladeroot.quality.integrity import bridged, judge
from scipy.signal import hilbert

ROOT = Path(__file__).resolve().parents[1] / "resources"
NAMES = {
    "clean": "", "clipping 10 %": "clipping", "re-contact 10 %, at once": "shaker-recontact",
    "re-contact 10 %, over 1.5 cycles": "shaker-recontact",
    "re-contact 10 %, other mode struck": "shaker-recontact",
    "hum 2e-4 m/s": "mains-hum", "close mode 5 %": "mode-beating",
}  # fmt: skip


def faulty(rng, fault, velocity, rate, release, back, own, other):
    """The record with one fault in the decay between two samples."""
    t = np.arange(velocity.size) / rate
    free = slice(release, back)
    phasor = np.zeros(velocity.size, complex)
    phasor[free] = hilbert(velocity[free])
    if fault.startswith("clipping"):
        top = 0.9 * np.abs(velocity[release:]).max()
        return np.clip(velocity, -top, top)
    if fault.startswith("hum"):
        mains = rng.choice([50, 60, 150])
        return velocity + 2e-4 * np.cos(2 * np.pi * (mains * t + rng.random()))
    if fault.startswith("close"):
        away = 1.0 + rng.choice([-1, 1]) * np.exp(rng.uniform(np.log(0.02), np.log(0.15)))
        window = np.hanning(int(12 * rate / own))
        size = np.convolve(np.abs(phasor), 0.05 * window / window.sum(), "same")
        return velocity + size * np.cos(2 * np.pi * (away * own * t + rng.random()))
    if fault.startswith("re-contact"):
        at = release + int(rng.uniform(0.05, 0.35) * (back - release))
        after = np.maximum(t - t[at], 0.0)
        on = np.minimum(after * own / 1.5, 1.0) if "over" in fault else after > 0.0
        step = on * (0.1 * np.exp(2j * np.pi * rng.random()) * phasor).real
        if "struck" in fault:
            ring = np.exp(-np.pi * 0.003 * other * after) * np.sin(2 * np.pi * other * after)
            step += 0.05 * np.abs(phasor[at]) * ring
        return velocity + step
    return velocity


def main(folder, seed=0):
    bench = yaml.safe_load((ROOT / "bench" / "rig.yaml").read_text())["recording"]
    modes = yaml.safe_load((ROOT / "campaigns" / "rig" / "campaign.yaml").read_text())["modes"]
    with open(ROOT / "campaigns" / "rig" / "records.csv", encoding="utf-8") as sheet:
        rows = list(csv.DictReader(sheet))
    before = bench["quiet_s"] + bench["push_s"]
    drive, fall = bench["drive_time_constants"], bench["decay_time_constants"]
    for fault, name in NAMES.items():
        own_name = anything = 0
        for k, row in enumerate(rows):
            rng = np.random.default_rng([seed, k])
            whole = xr.open_dataset(Path(folder) / row["file"])["velocity"].values
            rate = bench["sampling_Hz"]
            constant = (whole.size / rate - before - bench["back_s"]) / (drive + fall)
            release = int((before + drive * constant) * rate)
            back = int((before + (drive + fall) * constant) * rate)
            own = modes[row["mode"]]["expected_Hz"]
            others = [m["expected_Hz"] for n, m in modes.items() if n != row["mode"]]
            velocity = faulty(rng, fault, whole, rate, release, back, own, others[0])
            found = cut(bridged(velocity, rate, own), rate, own)
            ids = judge(found, velocity, own, tuple(others))["finding_id"].values.tolist()
            own_name += name in ids
            anything += bool(len(ids))
        count = len(rows)
        print(f"{fault:36} by name {own_name:3} any {anything:3} of {count}", flush=True)


if __name__ == "__main__":
    main(sys.argv[1], *map(int, sys.argv[2:]))
