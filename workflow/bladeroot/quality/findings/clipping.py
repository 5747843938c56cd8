"""Flat tops: the record stops at the largest value that the converter or the sensor can give."""

from dataclasses import replace

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.quality.examined import FRAME_CYCLES, LEAST_FRAME_SAMPLES, Examined, Finding, joined
from bladeroot.signal.envelope import tapered
from bladeroot.signal.lines import white_noise
from bladeroot.signal.recording import SI
from bladeroot.signal.runs import runs

MIXED = True
STATISTIC = "samples piled up at an extreme, over those that an unclipped cosine has there"
THRESHOLD = 3.0
# Which samples form a flat top, and what is masked with it.
TOP_STEPS = 1.001  # a sample this many steps of the digitiser below the extreme is on its top
TOP_NOISES = 3.0  # or this many times the noise's rms below it
MASK_NOISES = 5.0  # what is masked goes this many times the noise's rms further down
TOP_GAP_CYCLES = 0.1  # runs of samples closer than this part of a cycle are one top
# Where one extreme is clipped, the other one is masked too from this ratio on (see STATISTIC).
OTHER_EXTREME_RATIO = 1.5
# A smooth top is a parabola: it has this many times as many samples from the extreme down to a
# depth as from there to twice that depth. Only what is flatter is clipped.
PARABOLA_RATIO = 1.0 + np.sqrt(2.0)

# The loudest line is the mode's where its frequency differs by less than this (relative).
MODE_LINE = 0.3


def find(seen: Examined) -> Finding:
    """Flat tops: samples within a step, or some times the noise, of an extreme.

    The tops of an unclipped decay reach that near in the first cycles only, as the envelope tells.
    All before the last flat top is masked, flanks included: its harmonics belong to no mode. The
    sensor's own samples are looked at: differentiation or integration makes flat tops round.
    """
    seen = _own(seen)
    ratios = {sign: _piled(seen, sign) for sign in (1.0, -1.0)}
    statistic = max(ratios.values())
    if statistic > THRESHOLD:
        flatter = max(_flatter(seen, sign) for sign, one in ratios.items() if one > THRESHOLD)
        statistic = min(statistic, THRESHOLD * flatter)
    if statistic <= THRESHOLD:
        return Finding(statistic, THRESHOLD, "mask", "")
    x = seen.velocity
    # noise breaks a flat top into several runs
    near = max(2, int(TOP_GAP_CYCLES * seen.sampling_Hz / seen.own_Hz))
    flat = np.zeros(x.size, bool)
    for sign, ratio in ratios.items():
        if ratio > OTHER_EXTREME_RATIO:
            flat |= sign * x >= (sign * x).max() - _band(seen)
    tops = joined(runs(flat), near)
    last = int(tops[-1, 1])
    text = (
        f"clipped: {len(tops)} flat tops at {np.abs(x).max():.4g} {seen.unit}, the last "
        f"{seen.seconds(last):.4g} s into the decay; only what follows is used"
    )
    return Finding(statistic, THRESHOLD, "mask", text, ((0, min(last + 2, x.size)),))


def _own(seen: Examined) -> Examined:
    """The same decay in the sensor's own samples."""
    own, part = seen.recording, slice(seen.first, seen.first + seen.velocity.size)
    if own is None or own.quantity == "velocity":
        return seen
    made = {"noise": white_noise(own.samples), "unit": SI[own.quantity]}
    return replace(seen, velocity=own.samples[part], **made)


def _reaches(seen: Examined) -> tuple[float, float]:
    return TOP_STEPS * seen.quantum, TOP_NOISES * seen.floor


def _band(seen: Examined) -> float:
    """Height below the extreme that holds a flat top with its noise."""
    return max(_reaches(seen)) + MASK_NOISES * seen.floor


def _flatter(seen: Examined, sign: float) -> float:
    """How much flatter than a parabola the tops at one extreme are, up to the last one's cycle."""
    x, cycle, ratios = sign * seen.velocity, _loudest(seen)[0], []
    depth = x.max() - x
    for band in (max(_reaches(seen)), _band(seen)):  # without and with noise after the clipping
        until = depth[: np.flatnonzero(depth <= band)[-1] + cycle]
        flat = np.count_nonzero(until <= band)
        ratios.append(flat / (1.0 + np.count_nonzero(until <= 2.0 * band) - flat))
    return max(ratios) / PARABOLA_RATIO


def _piled(seen: Examined, sign: float) -> float:
    """Samples at one extreme over those expected of the loudest line, whose envelope is known."""
    x = sign * seen.velocity
    top = float(x.max())
    if top <= 0.0:
        return 0.0
    cycle, amplitude = _loudest(seen)
    envelope = amplitude * (top / amplitude.max())
    ratio = 0.0
    for reach in _reaches(seen):
        share = np.arccos(np.clip((top - reach) / envelope, -1.0, 1.0)) / np.pi
        ratio = max(ratio, np.count_nonzero(x >= top - reach) / (1.0 + cycle * share.sum()))
    return float(ratio)


def _loudest(seen: Examined) -> tuple[int, Float[ndarray, " frame"]]:
    """Samples in a cycle of the loudest line, the mode's or another's; its amplitude, by cycles."""
    frequency, level = seen.early
    line = float(frequency[np.argmax(level)])
    if abs(line / seen.own_Hz - 1.0) < MODE_LINE:
        return seen.frames.hop, seen.frames.amplitude
    cycle = min(max(round(seen.sampling_Hz / line), 1), seen.velocity.size)
    width = (
        min(max(FRAME_CYCLES, -(-LEAST_FRAME_SAMPLES // cycle)), seen.velocity.size // cycle)
        * cycle
    )
    return cycle, np.exp(tapered(seen.velocity, seen.sampling_Hz, line, cycle, width).log.real)
