"""The level of white noise in a record's spectrum, and the digitiser's steps."""

import numpy as np
from jaxtyping import Float
from numpy import ndarray
from scipy import fft

from bladeroot.signal.runs import medians

# A digitiser that cuts towards zero has a zero twice as wide as its other steps: it counts where
# that is likelier by so many nats, beside steps that differ by no more than a factor. Counted is
# where a cycle reaches so many steps: what is not that high stays in the zero. Neighbours of a zero
# then sum to that mean square at least (steps): a frequency that is a part of the sampling's may
# meet the zero itself in every cycle, and its neighbours cancel.
SURELY, EVEN, CROSSING, APART = 10.0, 1.5, 8.0, 0.5


def white_noise(velocity: Float[ndarray, " sample"]) -> float:
    """Rms of the sensor's noise, taken as white, from the floor between the spectral lines.

    The median over frequency ignores lines, the lower quartile over tapered segments ignores
    impacts and the loud part of the record. Segments of 1024 samples, or eighths of a shorter
    record (64 at least, for a median); no more than 100 of them, spread evenly (the quartile
    then rests on 25), so that a long record costs no more than one of 51,000 samples.
    """
    segment = min(velocity.size, max(64, min(1024, velocity.size // 8)))
    count = min(100, max(1, 2 * velocity.size // segment - 1))
    start = np.linspace(0, velocity.size - segment, count).astype(int)
    taper = np.hanning(segment + 1)[:-1]  # periodic: a mean shows in the lowest two lines only
    pieces = velocity[start[:, None] + np.arange(segment)] * taper
    spectra = fft.rfft(pieces, axis=1)[:, segment // 50 + 2 : -2]
    power = spectra.real**2 + spectra.imag**2
    floor = medians(power) / (np.log(2.0) * (taper**2).sum())
    quartile = np.interp(0.25 * (count - 1), np.arange(count), np.sort(floor))
    return float(np.sqrt(quartile))


def quantum(samples: Float[ndarray, " sample"]) -> float:
    """The digitiser's step: the smallest difference of values (of some thousand samples)."""
    some = np.sort(samples[:: -(-samples.size // 8192)])
    steps = np.diff(some)
    steps = steps[steps > 1e-9 * (some[-1] - some[0])]
    return float(steps.min()) if steps.size else 0.0


def not_cut(samples: Float[ndarray, " sample"], cycle: int) -> Float[ndarray, " sample"]:
    """Samples with the half step put back that a conversion which cuts towards zero has taken.

    Cut samples are smaller by half a step on either side, so that an amplitude of some steps falls
    too fast. cycle: samples in a cycle.
    """
    step, cycle = quantum(samples), max(cycle, 8)
    whole = samples.size // cycle * cycle
    if step == 0.0 or not whole:
        return samples
    code = samples[:whole].reshape(-1, cycle) / step
    code = code[np.abs(code).max(axis=1) > CROSSING]
    zero = np.abs(code[:, 1:-1]) < 0.1
    around = (code[:, :-2] + code[:, 2:])[zero]
    counts = np.array([np.count_nonzero(np.abs(code - k) < 0.1) for k in (-2, -1, 0, 1, 2)])
    beside = counts[[0, 1, 3, 4]]
    usual = beside.mean()
    even = beside.min() * EVEN > usual and beside.max() < EVEN * usual
    cancel = np.sum(around**2) < APART * max(around.size, 1)
    if not even or cancel or counts[2] * np.log(2.0) - usual < SURELY:
        return samples
    return samples + 0.5 * step * np.sign(samples) * (np.abs(samples) > 0.5 * step)
