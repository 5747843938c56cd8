"""Runs of samples, and what is done with samples block by block."""

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray
from scipy import fft


def medians(rows: Float[ndarray, "row k"]) -> Float[ndarray, " row"]:
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


def runs(at: ndarray) -> Int[ndarray, "run 2"]:
    """First and one past the last of every run of true values."""
    edge = np.flatnonzero(np.diff(at.astype(np.int8), prepend=0, append=0))
    return edge.reshape(-1, 2)


def joined(spans: Int[ndarray, "run 2"], reach: int) -> Int[ndarray, "span 2"]:
    """Spans less than `reach` apart as one."""
    if len(spans) < 2:
        return spans
    far = spans[1:, 0] - spans[:-1, 1] >= reach
    first = spans[np.concatenate([[True], far]), 0]
    last = spans[np.concatenate([far, [True]]), 1]
    return np.stack([first, last], axis=1)


def convolved(
    x: Float[ndarray, " k"], response: Float[ndarray, " tap"], size: int = 4096
) -> Float[ndarray, " k"]:
    """Centred convolution with an odd number of taps, by short Fourier transforms."""
    reach = response.size // 2
    step = size - 2 * reach
    count = -(-x.size // step)
    padded = np.zeros((count - 1) * step + size)
    padded[reach : reach + x.size] = x
    pieces = np.lib.stride_tricks.sliding_window_view(padded, size)[::step]
    spectra = fft.rfft(pieces, axis=1)
    spectra *= fft.rfft(response, size)
    return fft.irfft(spectra, size, axis=1)[:, 2 * reach :].ravel()[: x.size]
