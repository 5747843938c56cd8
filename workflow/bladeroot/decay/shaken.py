"""Noise that shakes the mode itself, as wind, traffic or a floor do, and how much of it there is.

A mode answers a white force with the pole of its own free decay. Relative to the decay z that noise
n is a random walk, d(n/z)/dt = force/z: its steps are independent and their variance grows as 1/A^2
(a process of Ornstein and Uhlenbeck, over its own decline). It is alike in many blocks, so that
neighbours tell little of it. How much of what they scatter by is a walk, has a restricted
likelihood (`signal.smooth.evidence`).
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.signal.phasors import WORST, Phasors
from bladeroot.signal.smooth import Spline, coarse, evidence

# Shares of the neighbours' scatter that are tried for the walk: some first, and others where one of
# them is better than none.
FIRST, OTHERS = (0.003, 0.3), (0.001, 0.01, 0.03, 0.1, 0.6, 0.95)
# Gain in ln of the likelihood from which on there is such noise, and least number of blocks.
GAIN, FEWEST = 3.0, 16
# Of the neighbours' scatter squared: where less is found, it is no scatter but what other lines may
# have left, which is not told from a walk.
SCATTER = 0.5
# Noise of the surroundings is there all along. What is left of other modes falls: its amplitude in
# the first third of the blocks is so many times that in the last.
STEADY = 2.0


def shaken(
    blocks: Phasors, fit: Spline, near: Float[ndarray, " block"]
) -> tuple[Phasors, Float[ndarray, " left"]] | None:
    """The blocks that such noise leaves, and the variances of its steps; None: there is none.

    fit: of the blocks; near: what neighbouring blocks scatter by. The errors of the blocks are what
    is independent in them.
    """
    y = np.stack([blocks.log.real, blocks.log.imag])
    value = fit.value(blocks.time)[0]
    level = np.minimum.accumulate(value[0])
    steps = np.diff(blocks.time, prepend=2.0 * blocks.time[0] - blocks.time[1])
    if y.shape[1] < FEWEST or not steady((y - value) * np.exp(level) * np.sqrt(steps)):
        return None
    growth = np.exp(2.0 * (level[0] - level))
    # what has gone on since long before: the steps of half the time in which A falls by e
    steps[0] = 0.5 * (blocks.time[-1] - blocks.time[0]) / max(level[0] - level[-1], 1.0)

    def tried(share: float, steps: ndarray) -> tuple[float, float, float]:
        # the second differences of a walk's means over its steps have a sixth of a step's variance
        walk = share * 6.0 * np.median(near[1:] ** 2 / steps[1:]) * steps
        own = blocks.time, y, np.sqrt(1.0 - share) * near
        made = coarse(*own, fit.scale, iterations=3, walk=walk if share else None)
        likelihood, factor = evidence(*own, walk, made)
        return likelihood, share, factor

    none = tried(0.0, steps)[0]
    found = max(tried(share, growth * steps) for share in FIRST)
    if found[0] < none:
        return None
    found = max(found, *(tried(share, growth * steps) for share in OTHERS))
    # what sways in proportion to the mode, as a sensor's gain, is no noise
    swaying = max(tried(share, steps)[0] for share in FIRST + OTHERS)
    if found[0] < max(none + GAIN, swaying):
        return None
    _, share, factor = found
    if factor < SCATTER:
        return None
    steps = growth * steps
    steps *= 6.0 * np.median(near[1:] ** 2 / steps[1:])
    walk = share * factor * steps
    beside = np.maximum(blocks.std**2 - near**2, 0.0)
    std = np.sqrt((1.0 - share) * factor * near**2 + beside)
    left = slice(0, int(np.searchsorted(np.cumsum(walk), WORST**2)))
    return Phasors(blocks.time[left], blocks.log[left], std[left]), walk[left]


def steady(off: Float[ndarray, "part block"]) -> bool:
    """Whether noise in blocks is hardly larger at first than at last, by second differences."""
    size = np.abs(np.diff(off, 2, axis=1))
    third = size.shape[1] // 3
    return bool(np.median(size[:, :third]) < STEADY * np.median(size[:, -third:]))
