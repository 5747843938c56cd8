"""Held or zeroed samples: a value that repeats for longer than the motion can stand still."""

import numpy as np

from bladeroot.quality.examined import Examined, Finding
from bladeroot.signal.runs import runs

FIRST = True
MIXED = True
STATISTIC = "longest run of equal samples over the longest that the digitiser's step explains"
THRESHOLD = 0.85


def find(seen: Examined) -> Finding | None:
    """Runs of equal samples away from the record's extremes."""
    x, rate = seen.velocity, seen.sampling_Hz
    held = runs(x[1:] == x[:-1])
    held[:, 1] += 1
    held = held[held[:, 1] - held[:, 0] >= 3]
    value = x[held[:, 0]]
    held = held[(value < x.max()) & (value > x.min())]
    if not len(held):
        return Finding(0.0, THRESHOLD, "mask", "")
    frames = seen.frames
    # the amplitude before the run (a long one pulls its own frames down), or else after it
    before = (held[:, 0] - frames.row.size) / frames.hop
    index = np.where(before >= 0, before, (held[:, 1] + frames.hop) / frames.hop)
    amplitude = frames.amplitude[np.clip(index.astype(int), 0, frames.log.size - 1)]
    # two modes may make a saddle point, v = A (w t)^3 / 6, which stays within half a step each way
    still = 2.0 * np.cbrt(3.0 * seen.quantum / amplitude) / (2.0 * np.pi * seen.own_Hz)
    longest = 2.0 * still * rate + 3.0
    length = held[:, 1] - held[:, 0]
    # a motion of a few steps of the digitiser may rest on one value for any time
    ratio = np.where(amplitude > 12.0 * seen.quantum, length / longest, 0.0)
    bad = held[ratio > THRESHOLD]
    if not len(bad):
        return Finding(float(ratio.max()), THRESHOLD, "mask", "")
    lost = int((bad[:, 1] - bad[:, 0]).sum())
    zero = " of zeros" if np.all(x[bad[:, 0]] == 0.0) else ""
    text = (
        f"{len(bad)} runs{zero} of equal samples, the first at {seen.seconds(bad[0, 0]):.6g} s, "
        f"{lost} samples in all; masked"
    )
    spans = tuple((max(int(a) - 1, 0), min(int(b) + 1, x.size)) for a, b in bad)
    return Finding(float(ratio.max()), THRESHOLD, "mask", text, spans)
