"""How a problem's covariance turns with its parameters, by differences."""

from collections.abc import Iterator

import numpy as np
from bladeroot.inference.problem import Problem


def by_differences(
    made: Problem, at: np.ndarray, scales: np.ndarray, step: np.ndarray
) -> Iterator[np.ndarray]:
    """The covariance's derivative by each parameter in turn."""
    for k, length in enumerate(step):
        up, down = (made.predict(at + way * length * np.eye(at.size)[k]) for way in (1.0, -1.0))
        change = made.covariance(up, scales)[0] - made.covariance(down, scales)[0]
        yield change / (2.0 * length)
