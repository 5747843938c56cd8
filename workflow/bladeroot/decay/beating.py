"""The beat of two close modes in an envelope, and the stronger mode's own course under it."""

from dataclasses import replace

import numpy as np
from jaxtyping import Complex, Float
from numpy import ndarray

from bladeroot.signal.envelope import Envelope
from bladeroot.signal.lines import one_sided

# Frames (half cycles) in which a beat is looked for, and the furthest line in turns a frame: two
# modes 18 % apart.
WINDOWS, FURTHEST = (48, 96, 192, 384, 768), 0.09
# The line over the median one, and what it swings the logarithm by at least.
CLEAR, LEAST = 20.0, 0.01


def beat(seen: Envelope, noise: float, begin: int) -> float | None:
    """Frames in a beat of a decay from frame `begin` on, None where no beat is found."""
    weak = np.flatnonzero(seen.level[begin:] < np.log(max(8.0 * noise, 1e-300)))
    stop = begin + int(weak[0]) if weak.size else seen.log.size
    best, period = CLEAR, None
    for count in WINDOWS:
        if begin + count <= stop:
            clear, turns = one_sided(seen.log[begin : begin + count], LEAST, FURTHEST, 0.25)
            if clear > best:
                best, period = clear, 1.0 / abs(turns)
    return period


def without_beat(seen: Envelope, begin: int, period: float) -> Envelope:
    """The envelope from frame `begin` on with the log-phasor's mean over a beat about each frame.

    The mean of ln(1 + r exp(i d t)) over a beat is zero: what is left is the stronger mode.
    """
    log = seen.log.copy()
    log[begin:] = _mean(seen.log[begin:], period)
    return replace(seen, log=log)


def _mean(log: Complex[ndarray, " frame"], period: float) -> Complex[ndarray, " frame"]:
    """Mean over a period about each frame; near the ends it goes on as a straight line."""
    half = 0.5 * period
    edge = np.arange(log.size + 1) - 0.5
    total = np.concatenate([[0.0], np.cumsum(log)])
    centre = np.arange(log.size, dtype=float)
    inner = centre[(centre - half >= -0.5) & (centre + half <= log.size - 0.5)]
    if inner.size < 2:
        return log

    def upto(at: Float[ndarray, " frame"]) -> Complex[ndarray, " frame"]:
        return np.interp(at, edge, total.real) + 1j * np.interp(at, edge, total.imag)

    mean = (upto(inner + half) - upto(inner - half)) / period
    first, last = int(inner[0]), int(inner[-1])
    whole = np.empty_like(log)
    whole[first : last + 1] = mean
    run = min(max(int(half), 2), mean.size)
    for part, at, ends in (
        (mean[:run], first + np.arange(run), np.arange(first)),
        (mean[-run:], last + 1 - run + np.arange(run), np.arange(last + 1, log.size)),
    ):
        slope = (part[-1] - part[0]) / (at[-1] - at[0])
        whole[ends] = part.mean() + slope * (ends - at.mean())
    return whole
