"""The blocks of a decay, joined into groups, and what a rate integrates to over them."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from numpy import ndarray


@dataclass(frozen=True)
class Stretch:
    """Groups of blocks in time order; `y` holds log-amplitude and phase, `log` ln A for the laws.

    `width` is the variance of the times in a group, whose mean is not the value at its middle.
    """

    time: Float[ndarray, " group"]
    y: Float[ndarray, "2 group"]
    std: Float[ndarray, " group"]
    log: Float[ndarray, " group"]
    width: Float[ndarray, " group"]

    def below(self, log: float) -> "Stretch":
        """The groups up to an amplitude, given as ln A."""
        keep = self.log <= log + 1e-9
        return Stretch(
            self.time[keep], self.y[:, keep], self.std[keep], self.log[keep], self.width[keep]
        )


def grouped(
    time: Float[ndarray, " block"],
    y: Float[ndarray, "2 block"],
    std: Float[ndarray, " block"],
    amplitude: Float[ndarray, " block"],
    most: int = 200,
) -> Stretch:
    """Neighbouring blocks joined so that every group falls by about the same in ln A."""
    fallen = np.maximum.accumulate(np.log(amplitude[0] / amplitude))
    step = max(fallen[-1] / most, 1e-9)
    start = np.flatnonzero(np.diff(np.floor(fallen / step), prepend=-1.0) > 0)
    weight = std**-2.0
    total = np.add.reduceat(weight, start)

    def mean(values: Float[ndarray, "*part block"]) -> Float[ndarray, "*part group"]:
        return np.add.reduceat(values * weight, start, axis=-1) / total

    centre = mean(time)
    width = np.maximum(mean(time**2) - centre**2, 0.0)
    return Stretch(centre, mean(y), total**-0.5, mean(np.log(amplitude)), width)


def integral(stretch: Stretch, rate: Float[ndarray, "group law"]) -> Float[ndarray, "group law"]:
    """Integral of rates over time as the groups see it, zero at the record's end."""
    steps = 0.5 * (rate[1:] + rate[:-1]) * np.diff(stretch.time)[:, None]
    total = np.zeros_like(rate)
    total[:-1] = -np.cumsum(steps[::-1], axis=0)[::-1]
    slope = (rate[2:] - rate[:-2]) / (stretch.time[2:] - stretch.time[:-2])[:, None]
    total[1:-1] += 0.5 * stretch.width[1:-1, None] * slope
    return total


def line_of(stretch: Stretch) -> tuple[Float[ndarray, "group 2"], Float[ndarray, " 2"]]:
    """Orthonormal basis of constants and straight lines in the whitened groups.

    Also the row by which a whitened series projected on that basis gives its slope in time.
    """
    scale = 1.0 / stretch.std
    from_middle = stretch.time - np.average(stretch.time, weights=scale**2)
    q = np.stack([scale, from_middle * scale], axis=1)
    length = np.sqrt((q**2).sum(axis=0))
    return q / length, np.array([0.0, 1.0 / length[1]])


def first_departure(stretch: Stretch, detection: float) -> float | None:
    """Smallest ln A up to which the record shows that it leaves a constant rate, or None.

    From the smallest amplitude upwards, windows of growing amplitude are tested for a straight
    hinge anywhere in them, against a chi-square gain of `detection` in either channel.
    """
    low, high = stretch.log.min(), stretch.log.max()
    onsets = np.linspace(low, high, max(8, int(8 * (high - low)) + 1))
    hinges = integral(stretch, np.maximum(0.0, np.exp(stretch.log[:, None] - onsets) - 1.0))
    for index in range(3, onsets.size):
        keep = stretch.log <= onsets[index] + 1e-9
        if keep.sum() < 10 or onsets[index] < low + 0.4:
            continue
        window = stretch.below(onsets[index])
        q, _ = line_of(window)
        columns = hinges[keep][:, :index] / window.std[:, None]
        columns -= q @ (q.T @ columns)
        y = (window.y - window.y.mean(axis=1, keepdims=True)) / window.std
        y -= (y @ q) @ q.T
        size = (columns**2).sum(axis=0)
        size = np.where(size > 1e-12 * size.max(), size, np.inf)
        if ((y @ columns) ** 2 / size).max() > detection:
            return float(onsets[index])
    return None
