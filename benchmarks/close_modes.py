"""Two modes close together: curves that are right, wrong with a finding, wrong in silence.

    python benchmarks/close_modes.py            # 150 records, about two minutes
    python benchmarks/close_modes.py --count 20 --seed 7 --each

A decay of 100 to 1000 Hz, 25 to 60 samples a cycle, loss factor 0.001 to 0.005 and up to 1 %
softening above 0.3 of its start, with a second mode of 5 to 50 % of its size and 0.5 to 2 times its
loss factor; noise 40 to 60 dB down. In one half of the records the second mode lies at 0.85 to 1.18
times the frequency, in the other so near that the two beat 0.2 to 3 times while ln A falls by one:
strings, bells, discs. Each record goes through the workflow's analysis. A point from 0.02 of the
start on is wrong if its frequency is off by more than WRONG_PPM and three stated errors, or its
loss factor by more than WRONG_LOSS and three; a curve, if more than one point in twenty is.
"""

import argparse
import secrets
from collections import Counter

import numpy as np
from bladeroot.decay.record import analyse
from bladeroot.io.recording import recording

WRONG_PPM = 500.0
WRONG_LOSS = 0.1
FEW_BEATS = (0.2, 3.0)  # while ln A falls by one


def draw(rng: np.random.Generator) -> dict:
    """A record, and the truth of its mode."""
    slow, ratio = rng.random() < 0.5, rng.uniform(0.85, 1.18)
    size = np.exp(rng.uniform(np.log(0.05), np.log(0.5)))
    own_Hz = 10.0 ** rng.uniform(2.0, 3.0)
    rate = own_Hz * rng.uniform(25.0, 60.0)
    loss = 10.0 ** rng.uniform(-3.0, -2.3)
    if slow:
        ratio = 1.0 + np.sign(ratio - 1.0) * np.pi * loss * np.exp(rng.uniform(*np.log(FEW_BEATS)))
    count = int(min(np.log(200.0) / (np.pi * loss), 2500.0) * rate / own_Hz)
    time = np.arange(count) / rate
    amplitude = np.exp(-np.pi * own_Hz * loss * time)
    softening = rng.uniform(0.0, 0.01)
    frequency = own_Hz * (1.0 - softening * np.maximum(amplitude - 0.3, 0.0) / 0.7)
    phase = 2.0 * np.pi * np.cumsum(frequency) / rate + rng.uniform(0.0, 6.28)
    other_loss = loss * np.exp(rng.uniform(-0.7, 0.7))
    other = size * np.exp(-np.pi * own_Hz * ratio * other_loss * time)
    velocity = amplitude * np.cos(phase)
    velocity += other * np.cos(2.0 * np.pi * ratio * own_Hz * time + rng.uniform(0.0, 6.28))
    velocity += 10.0 ** rng.uniform(-3.0, -2.0) / np.sqrt(2.0) * rng.standard_normal(count)
    return {
        "velocity": 0.1 * velocity, "rate": rate, "expected": own_Hz * rng.uniform(0.97, 1.03),
        "time": time, "frequency": frequency, "amplitude": amplitude,
        "ratio": ratio, "own_Hz": own_Hz, "size": size, "loss": loss, "other_loss": other_loss,
    }  # fmt: skip


def outcome(made: dict) -> tuple[str, float, float]:
    """What comes of a record, the curve's rms error (ppm), and the part of it that is right."""
    record = recording(made["velocity"], "m/s", "drawn", sampling_Hz=made["rate"])
    known = {"expected_Hz": made["expected"], "other_modes_Hz": (), "simulated": True}
    judged, curve, _ = analyse(record, known, {"end": "noise"}, {})
    found = set(judged["finding_id"].values.tolist())
    if not curve.sizes["point"]:
        return "rejected", np.nan, np.nan
    at = curve["time"].values + judged.attrs["start_s"]
    wanted = np.interp(at, made["time"], made["amplitude"]) > 0.02
    if not wanted.any():
        return "rejected", np.nan, np.nan
    truth = np.interp(at, made["time"], made["frequency"])[wanted]
    loss = made["loss"] * made["own_Hz"] / truth
    ok = np.ones(truth.size, dtype=bool)
    for name, true, least in (
        ("frequency", truth, 1e-6 * WRONG_PPM * truth), ("loss_factor", loss, WRONG_LOSS * loss),
    ):  # fmt: skip
        miss = np.abs(curve[name].values[wanted] - true)
        ok &= miss <= np.maximum(least, 3.0 * curve[f"{name}_std"].values[wanted])
    off = curve["frequency"].values[wanted] / truth - 1.0
    right = "right" if np.mean(ok) >= 0.95 else "wrong"
    told = "with a finding" if found else "no finding"
    return f"{right}, {told}", 1e6 * float(np.sqrt(np.mean(off**2))), float(np.mean(ok))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seed", type=int, help="repeat a run; drawn afresh if not given")
    parser.add_argument("--count", type=int, default=150)
    parser.add_argument("--each", action="store_true", help="a line for each record")
    options = parser.parse_args()
    seed = secrets.randbits(32) if options.seed is None else options.seed
    found = []
    for k in range(options.count):
        made = draw(np.random.default_rng([seed, k]))
        found.append((*outcome(made), abs(made["ratio"] - 1.0) / np.pi / made["loss"]))
        if options.each:
            about = " ".join(f"{made[n]:.4g}" for n in ("ratio", "size", "loss", "other_loss"))
            print(f"{k:4d} {about}  {found[-1][0]} {found[-1][1]:.1f} ppm {found[-1][2]:.2f}")
    print(f"seed {seed}, {options.count} records")
    for name, few, many in (("all", 0.0, np.inf), ("up to 3 beats a neper", 0.0, 3.0),
                            ("more", 3.0, np.inf)):  # fmt: skip
        part = [one for one in found if few <= one[3] < many]
        errors = [one[1] for one in part if np.isfinite(one[1])]
        median = np.median(errors) if errors else np.nan
        within = np.mean([one[2] for one in part if np.isfinite(one[2])] or [np.nan])
        print(
            f"{name} ({len(part)}): median {median:.1f} ppm, {100 * within:.1f} % of points right"
        )
        for what, number in sorted(Counter(one[0] for one in part).items()):
            print(f"  {what:24s} {number}")


if __name__ == "__main__":
    main()
