"""How often the free decay is cut right, beside the thesis's rule, on raw records drawn afresh.

python benchmarks/cutting.py [records a kind and noise level] [seed]

At last it counts how many clean decays of any law are ended as if they were disturbed.
"""

import sys
from pathlib import Path

import numpy as np
from bladeroot.decay.cut import cut
from scipy.signal import hilbert

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "lib"))
from integrity import decay, measured
from records_bench import KINDS, RETURNS, draw

NOISE_DB = (60, 40, 20)
COLUMNS = ("found", "not before", "soon", "start right", "end free", "end full", "named")


def by_the_source(velocity, sampling_Hz):
    """Sec. 3.1.1 as read off figs 3.1, 3.2: from the largest envelope to its thousandth."""
    envelope = np.abs(hilbert(velocity - velocity.mean()))
    first = int(np.argmax(envelope))
    below = np.flatnonzero(envelope[first:] < 1e-3 * envelope[first])
    stop = first + below[0] if below.size else velocity.size
    return first / sampling_Hz, stop / sampling_Hz, ""


def by_us(velocity, sampling_Hz, expected_Hz):
    attrs = cut(velocity, sampling_Hz, expected_Hz).attrs
    if attrs["verdict"] != "usable":
        return None
    return attrs["start_s"], attrs["end_s"], attrs["excitation"]


def judged(found, truth):
    """One truth value a column.

    Not before: at most a twentieth of a cycle of what is not free. Soon: within five cycles or a
    tenth of the time constant. End free: not after a disturbance that stands out of the noise.
    End full: three quarters of what is free and stands out of the noise.
    """
    if found is None:
        return [False] * len(COLUMNS)
    start, end, excitation = found
    slack = 0.05 / truth.frequency_Hz
    inside = [span for span in truth.free if span[0] - slack <= start < span[1]]
    first, last = inside[-1] if inside else min(truth.free, key=lambda s: abs(start - s[0]))
    late = (start - first) * truth.frequency_Hz
    before = late >= -0.05
    soon = late <= max(5.0, 0.1 / (np.pi * truth.eta))
    disturbed = last < truth.visible or "several" in truth.kind
    free = end <= last or not disturbed
    full = end - start >= 0.75 * ((last if disturbed else min(truth.visible, last)) - first)
    return [True, before, soon, before and soon, free, full, excitation == truth.excitation]


def false_ends(records, seed):
    """Decays with humps of damping up to sevenfold and softening to 3 %, by other modes' place."""
    count = {"above": [0, 0], "below": [0, 0]}
    for k in range(records):
        rng = np.random.default_rng([seed, k])
        fixed = {
            "more": rng.uniform(0, 6), "eta": np.exp(rng.uniform(np.log(5e-4), np.log(0.01))),
            "noise_db": rng.choice([40.0, 60.0, 80.0]), "bits": rng.choice([16, 24]),
            "nepers": rng.uniform(4, 9), "a_cycle": np.exp(rng.uniform(np.log(8), np.log(100))),
            "longest": 100_000,
        }  # fmt: skip
        if rng.random() < 0.5:
            fixed["hump"] = rng.uniform(0.35, 1.2)
        velocity, rate, made = decay(rng, **fixed)
        velocity = measured(rng, velocity, made)
        reason = cut(velocity, rate, made["f"] * rng.uniform(0.97, 1.03)).attrs["end_reason"]
        kind = count["below" if any(f < made["f"] for f in made["others"]) else "above"]
        kind[0] += reason == "disturbed"
        kind[1] += 1
    for place, (ended, of) in count.items():
        print(f"clean decays, other modes {place} (if any): {ended} of {of} end as disturbed")


def main(records=30, seed=0):
    print(f"{records} records a line; per cent; ours | the thesis's rule")
    print(f"{'kind':20} {'tip back':8} {'dB':>3}  " + "  ".join(f"{c:>12}" for c in COLUMNS))
    for kind in KINDS:
        for back in RETURNS if kind.startswith("shaker") else RETURNS[:1]:
            for noise_db in NOISE_DB:
                ours, theirs = [], []
                for k in range(records):
                    velocity, truth = draw(seed + k, kind, noise_db, back, count=60_000)
                    found = by_us(velocity, truth.sampling_Hz, 1.02 * truth.frequency_Hz)
                    ours.append(judged(found, truth))
                    theirs.append(judged(by_the_source(velocity, truth.sampling_Hz), truth))
                cells = zip(100 * np.mean(ours, axis=0), 100 * np.mean(theirs, axis=0), strict=True)
                line = "  ".join(f"{a:4.0f} | {b:4.0f} " for a, b in cells)
                print(f"{kind:20} {back:8} {noise_db:3}  {line}", flush=True)
    false_ends(50 * records, seed)


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
