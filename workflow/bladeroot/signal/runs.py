"""Runs of samples, and what is done with samples block by block."""

import numpy as np
from jaxtyping import Bool, Float, Int
from numpy import ndarray


def medians(rows: Float[ndarray, "*row k"]) -> Float[ndarray, "*row"] | np.float64:
    """np.median of each row, several times as fast (numpy's search for two places is slow).

    Of finite values only.
    """
    half = rows.shape[-1] // 2
    split = np.partition(rows, half, axis=-1)
    upper = split[..., half]
    return upper if rows.shape[-1] % 2 else 0.5 * (split[..., :half].max(axis=-1) + upper)


def block_scale(
    size: Float[ndarray, " k"], block: int = 256, stride: int = 1
) -> Float[ndarray, " k"]:
    """Median over blocks, the largest of each block and its neighbours, for every element.

    With a `stride` only each so many-th element is looked at.
    """
    count = max(1, size.size // block)
    edges = np.linspace(0, size.size, count + 1).astype(int)
    whole = size[: count * (size.size // count)].reshape(count, -1)
    middle = medians(whole[:, ::stride])
    wide = np.pad(middle, 1, mode="edge")
    middle = np.maximum(np.maximum(wide[:-2], wide[2:]), middle)
    return np.repeat(middle, np.diff(edges))


def in_frames(
    x: Float[ndarray, " sample"], weights: Float[ndarray, "width column"], step: int
) -> Float[ndarray, "frame column"]:
    """Weighted sums of frames that begin every `step` samples, whose width is some steps.

    Each step's samples are multiplied once with each part of the weights, without copies.
    """
    columns = weights.shape[1]
    parts = weights.reshape(-1, step, columns)
    each = x[: x.size // step * step].reshape(-1, step) @ np.hstack(parts)
    count = len(each) - len(parts) + 1
    return sum(each[k : k + count, columns * k : columns * (k + 1)] for k in range(len(parts)))


def runs(at: Bool[ndarray, " k"]) -> Int[ndarray, "run 2"]:
    """First and one past the last of every run of true values."""
    bounded = np.zeros(at.size + 2, bool)
    bounded[1:-1] = at
    return np.flatnonzero(bounded[1:] != bounded[:-1]).reshape(-1, 2)


def longest(at: Bool[ndarray, " k"]) -> slice:
    """The longest run of true values; empty where there is none."""
    found = runs(at)
    return slice(*map(int, found[np.argmax(np.diff(found))])) if len(found) else slice(0, 0)


def joined(spans: Int[ndarray, "run 2"], reach: int) -> Int[ndarray, "span 2"]:
    """Spans less than `reach` apart as one."""
    if len(spans) < 2:
        return spans
    far = spans[1:, 0] - spans[:-1, 1] >= reach
    first = spans[np.concatenate([[True], far]), 0]
    last = spans[np.concatenate([far, [True]]), 1]
    return np.stack([first, last], axis=1)


def missed(x: Float[ndarray, " k"], weights: Float[ndarray, " reach"]) -> Float[ndarray, " k"]:
    """What each value differs from the weighted sums of its neighbours on both sides by.

    Zero where there are too few neighbours.
    """
    miss = np.zeros(x.size)
    taps = np.concatenate([-weights[::-1], [1.0], -weights])
    miss[weights.size : x.size - weights.size] = np.convolve(x, taps, mode="valid")
    return miss
