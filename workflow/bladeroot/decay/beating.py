"""The beat of two close modes in an envelope, and the stronger mode's own course under it."""

from dataclasses import replace

import numpy as np
from jaxtyping import Complex, Float
from numpy import ndarray

from bladeroot.signal.envelope import Envelope

# Frames (half cycles) in which a beat is looked for, beats that must fit into them, and the
# furthest line in turns a frame: two modes 18 % apart.
WINDOWS, FEWEST, FURTHEST = (48, 96, 192, 384, 768), 3.0, 0.09
# A line on one side of zero, over the one on the other side, over the median line, and at least.
ONE_SIDED, CLEAR, LEAST = 2.5, 20.0, 0.01
DEGREE = 3


def beat(seen: Envelope, noise: float, begin: int) -> float | None:
    """Frames in a beat of a decay from frame `begin` on, None where no beat is found.

    A second mode of relative amplitude r < 1 adds ln(1 + r exp(i d t)) to the log-phasor: lines
    on one side of zero only, which no knock, bend or law of amplitude makes.
    """
    weak = np.flatnonzero(seen.level[begin:] < np.log(max(8.0 * noise, 1e-300)))
    stop = begin + int(weak[0]) if weak.size else seen.log.size
    best = (CLEAR, None)
    for count in WINDOWS:
        if begin + count <= stop:
            best = max(best, _line(seen.log[begin : begin + count]), key=lambda one: one[0])
    return best[1]


def _line(log: Complex[ndarray, " frame"]) -> tuple[float, float | None]:
    """How clear the strongest one-sided line beside a smooth course is, and its period."""
    x = np.linspace(-1.0, 1.0, log.size)
    trend = np.polynomial.chebyshev.chebvander(x, DEGREE)
    taper = np.hanning(log.size)
    rest = (log - trend @ np.linalg.lstsq(trend, log, rcond=None)[0]) * taper
    line = np.fft.fft(rest, 4 * log.size) / taper.sum()
    turns = np.abs(np.fft.fftfreq(line.size))
    inside = (turns * log.size >= FEWEST) & (turns <= FURTHEST)
    if not inside.any():
        return 0.0, None
    k = int(np.argmax(np.where(inside, np.abs(line), 0.0)))
    level, other = float(np.abs(line[k])), float(np.abs(line[-k]))
    if level < max(LEAST, ONE_SIDED * other):
        return 0.0, None
    usual = float(np.median(np.abs(line[(turns * log.size >= FEWEST) & (turns <= 0.25)])))
    return level / max(usual, 1e-300), 1.0 / float(turns[k])


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
