"""Runs of values, and medians of rows."""

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


def runs(at: Bool[ndarray, " k"]) -> Int[ndarray, "run 2"]:
    """First and one past the last of every run of true values."""
    bounded = np.zeros(at.size + 2, bool)
    bounded[1:-1] = at
    return np.flatnonzero(bounded[1:] != bounded[:-1]).reshape(-1, 2)
