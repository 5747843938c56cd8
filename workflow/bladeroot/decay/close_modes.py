"""Modes so close that frames of few cycles cannot tell them apart: one taken off another."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Bool, Float
from numpy import ndarray

from bladeroot.decay.rough import roughly
from bladeroot.signal.phasors import Phasors
from bladeroot.signal.smooth import Spline

# Beats at either end of a decay in which a close mode is not told from this one, and the part of
# the mode's amplitude that the other may have: what is louder is not told off well enough.
SPOILT_BEATS, LOUDEST = 1.5, 0.7
# Lines further from the mode than this part of its frequency are told apart for good.
CLOSE = 0.3
# Beats while ln A falls by one at which the errors of telling two modes apart are as large as those
# by noise; as in simulation (benchmarks/close_modes.py), for residuals do not show them.
BEATS = 11.0


def near_waves(
    velocity: Float[ndarray, " sample"],
    sampling_Hz: float,
    line_Hz: float,
    near: Sequence[float],
    noise: float,
    usable: Bool[ndarray, " sample"] | None = None,
    rounds: int = 6,
) -> list[Float[ndarray, " sample"]]:
    """The waves of lines that frames of few cycles cannot tell from the mode or from a mean.

    Each is followed in what the rest leave over and taken off, some times round. Lines whose beat
    with the mode is as slow as its own curves bend cannot be told apart in this way.
    """
    waves = [np.zeros_like(velocity) for _ in near]
    rest = velocity
    for _ in range(rounds):
        left = roughly(rest, sampling_Hz, line_Hz, noise, usable)[-1]
        for k, other_Hz in enumerate(near):
            alone = left + waves[k]
            try:
                left = roughly(alone, sampling_Hz, other_Hz, noise, usable)[-1]
            except ValueError:  # a line that cannot be followed is no mode
                left = alone
            waves[k] = alone - left
        rest = velocity - sum(waves)
    return waves


def quieter_s(
    taken: Float[ndarray, " sample"], sampling_Hz: float, fit: Spline, beat_s: float
) -> tuple[float, float]:
    """The longest time (s, from and to) in which the close modes taken off are less loud."""
    length = int(np.clip(beat_s * sampling_Hz, 1, taken.size))
    count = taken.size // length
    pieces = taken[: count * length].reshape(count, length)
    size = np.sqrt(2.0 * np.einsum("ij,ij->i", pieces, pieces) / length)
    middle = (np.arange(count) + 0.5) * length / sampling_Hz
    last_s = fit.origin + fit.scale * fit.knots[-1]
    mode = np.exp(fit.value(np.minimum(middle, last_s))[0, 0])
    louder = middle[size > LOUDEST * mode]
    ends = np.concatenate([[0.0], louder, [taken.size / sampling_Hz]])
    longest = int(np.argmax(np.diff(ends)))
    return float(ends[longest]), float(ends[longest + 1])


def widened(blocks: Phasors, fit: Spline, beat_s: float) -> tuple[Phasors, Spline]:
    """The same with larger standard errors, the more the fewer beats there are in the decay."""
    rate = float(np.median(np.abs(fit.value(blocks.time)[1, 0])))  # of ln A
    wider = float(np.hypot(1.0, BEATS * beat_s * rate))
    blocks = Phasors(blocks.time, blocks.log, wider * blocks.std)
    return blocks, replace(fit, covariance=wider**2 * fit.covariance)


def within(blocks: Phasors, first_s: float, last_s: float) -> Phasors:
    """The blocks between two times, where close modes are told apart."""
    part = (blocks.time >= first_s) & (blocks.time <= last_s)
    if part.sum() < 8:
        raise ValueError(
            f"expected a stretch in which this mode and another close by are told apart, got "
            f"{first_s:.3g} to {last_s:.3g} s"
        )
    return Phasors(blocks.time[part], blocks.log[part], blocks.std[part])
