"""How often peak fitting is said to differ from FREEVIB where nothing is wrong.

    python benchmarks/second_opinion.py [records] [blocks or thesis] [seed]

Records drawn afresh: 120 to 700 Hz at 5 to 26 kHz, 30 to 80 dB, softening 0 to 2 %, loss factor
0.001 to 0.01 rising up to fourfold, with and without a second mode. Prints the differences in
their stated standard errors, how many lie beyond the threshold, and all that is reported, also of
single stretches, with the 95 % interval of its rate.
"""

import sys
from pathlib import Path

import numpy as np
from bladeroot.quality.agreement import THRESHOLD, compare
from bladeroot.quality.peak_fit import peak_fit
from bladeroot.reproduction.thesis_filters import thesis_freevib
from scipy.stats import binomtest

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "lib"))
from decay_bench import ring_down, separated_curves


def main() -> None:
    records = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    estimator = thesis_freevib if "thesis" in sys.argv else separated_curves
    rng = np.random.default_rng(int(sys.argv[3]) if len(sys.argv) > 3 else 430000)
    scores, reported = [], []
    for _ in range(records):
        sampling_Hz = rng.choice([5120.0, 12800.0, 25600.0])
        frequency_Hz = min(rng.uniform(120.0, 700.0), sampling_Hz / 8.0)
        loss = 10.0 ** rng.uniform(-3.0, -2.0)
        duration_s = max(2.5 / loss, 60.0) / frequency_Hz
        velocity, noise, _, _ = ring_down(
            int(rng.integers(2**31)),
            noise_db=rng.uniform(30.0, 80.0),
            softening=rng.choice([0.0, 0.002, 0.005, 0.02]),
            eta=(loss, loss * rng.uniform(0.7, 4.0)),
            onset=rng.uniform(0.05, 0.6),
            frequency_Hz=frequency_Hz,
            sampling_Hz=sampling_Hz,
            count=int(min(102400, duration_s * sampling_Hz)),
            second=rng.choice([0.0, 0.3]),
        )
        curves = estimator(velocity, sampling_Hz, frequency_Hz * rng.uniform(0.95, 1.05), noise)
        found = compare(curves, peak_fit(velocity, sampling_Hz, frequency_Hz, noise))
        reported += [str(found["pff_finding"].values)] if found["pff_agrees"] == 0 else []
        scores.append(
            [abs(float(found[f"pff_{n}_difference_z"])) for n in ("frequency", "loss_factor")]
        )
    for name, z in zip(("frequency", "loss factor"), np.array(scores).T, strict=True):
        rms, worst, loud = np.sqrt(np.mean(z**2)), z.max(), int((z > THRESHOLD).sum())
        print(
            f"{name:12s} rms {rms:.2f}, 99 % {np.quantile(z, 0.99):.2f}, largest {worst:.2f},"
            f" beyond {THRESHOLD}: {loud} of {z.size}"
        )
    low, high = binomtest(len(reported), records).proportion_ci(method="exact")
    rate = f"{100.0 * low:.2g} to {100.0 * high:.2g} %"
    print(f"reported: {len(reported)} of {records} ({rate})", *reported, sep="\n")


if __name__ == "__main__":
    main()
