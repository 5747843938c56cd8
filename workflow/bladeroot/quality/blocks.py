"""Blocks, spans and neighbours of samples, and frames without their trend, for the checks."""

import numpy as np
from jaxtyping import Complex, Float, Int
from numpy import ndarray

from bladeroot.quality.examined import Frames
from bladeroot.signal.lines import hann
from bladeroot.signal.runs import medians

FEWEST_WHOLE_FRAMES = 38  # frames without blind samples from which a trend is taken off
LEAST_FRAME_STD = 3e-4  # of ln A + i phase: no frame is believed to be more certain, in weights


def block_scale(
    size: Float[ndarray, " k"], block: int = 256, stride: int = 1
) -> Float[ndarray, " k"]:
    """The largest median of an element's block of about `block` elements and of its neighbours.

    The medians are those of every `stride`-th element.
    """
    count = max(1, size.size // block)
    edges = np.linspace(0, size.size, count + 1).astype(int)
    whole = size[: count * (size.size // count)].reshape(count, -1)
    middle = medians(whole[:, ::stride])
    wide = np.pad(middle, 1, mode="edge")
    middle = np.maximum(np.maximum(wide[:-2], wide[2:]), middle)
    return np.repeat(middle, np.diff(edges))


def joined(spans: Int[ndarray, "run 2"], reach: int) -> Int[ndarray, "span 2"]:
    """Spans less than `reach` apart as one."""
    if len(spans) < 2:
        return spans
    far = spans[1:, 0] - spans[:-1, 1] >= reach
    first = spans[np.concatenate([[True], far]), 0]
    last = spans[np.concatenate([far, [True]]), 1]
    return np.stack([first, last], axis=1)


def frame_weights(frames: Frames, used: slice) -> Float[ndarray, " frame"]:
    """One over the standard error of some frames; zero where they are not whole."""
    return frames.whole[used] / np.maximum(frames.std[used], LEAST_FRAME_STD)


def without_trend(frames: Frames, used: slice, degree: int) -> Complex[ndarray, " frame"] | None:
    """Tapered `log` of some frames less a polynomial; None where too few are whole."""
    log, whole = frames.log[used], frames.whole[used]
    if np.count_nonzero(whole) < FEWEST_WHOLE_FRAMES:
        return None
    trend = np.polynomial.chebyshev.chebvander(np.linspace(-1.0, 1.0, log.size), degree)
    weight = frame_weights(frames, used)
    weighted = trend * weight[:, None]
    fit = np.linalg.solve(weighted.T @ weighted, weighted.T @ (log * weight))
    return (log - trend @ fit) * hann(log.size) * whole
