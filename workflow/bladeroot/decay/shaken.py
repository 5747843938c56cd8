"""Noise that shakes the mode itself, as wind, traffic or a floor do, and how much of it there is.

A mode answers a white force with the pole of its own free decay. Relative to the decay z that noise
n is a random walk, d(n/z)/dt = force/z: its steps are independent and their variance grows as 1/A^2
(a process of Ornstein and Uhlenbeck, over its own decline). It is alike in many blocks, so that
neighbours tell little of it, and a curve bends with it to its end. How much of what neighbours
scatter by is a walk, has a restricted likelihood (`signal.smooth.evidence`).
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.signal.phasors import WORST, Phasors
from bladeroot.signal.smooth import Spline, coarse, evidence

# Laws of a mode bend the later half of a curve's blocks by so many degrees of freedom at most, or
# by one for so many blocks.
BENDS, APART = 16, 5
# Noise of the surroundings is there all along. What is left of other modes falls: its amplitude in
# the first third of the blocks is so many times that in the last.
STEADY = 2.0
# Shares of the neighbours' scatter that are tried for the walk, and the gain in ln of the
# likelihood from which on there is one.
SHARES, GAIN = (0.01, 0.1, 0.4, 0.9), 3.0


def shaken(
    blocks: Phasors, fit: Spline
) -> tuple[Float[ndarray, " left"], Float[ndarray, " left"]] | None:
    """Errors of the blocks that such noise leaves, and variances of its steps; None: there is none.

    fit: the blocks' spline. Its errors are what neighbouring blocks scatter by; those that are
    returned are what is independent in the blocks, the first ones.
    """
    time, y = blocks.time, np.stack([blocks.log.real, blocks.log.imag])
    value = fit.value(time)[0]
    off, level = y - value, np.minimum.accumulate(value[0])
    steps = np.diff(time, prepend=2.0 * time[0] - time[1])
    if smooth(blocks, fit, off) or not steady(off * np.exp(level) * np.sqrt(steps)):
        return None
    # what has gone on since long before: the steps of half the time in which A falls by e
    steps[0] = 0.5 * (time[-1] - time[0]) / max(level[0] - level[-1], 1.0)

    def likeliest(shares: tuple[float, ...], steps: ndarray) -> tuple[float, float, ndarray]:
        # the second differences of a walk's means over its steps have a sixth of a step's variance
        steps = 6.0 * np.median(blocks.std[1:] ** 2 / steps[1:]) * steps
        tried = []
        for share in shares:
            own = time, y, np.sqrt(1.0 - share) * blocks.std
            made = coarse(*own, fit.scale, iterations=6, walk=share * steps)
            likelihood, factor = evidence(*own, share * steps, made)
            tried.append((likelihood, (1.0 - share) * factor, share * factor * steps))
        return max(tried, key=lambda one: one[0])

    growing = np.exp(2.0 * (level[0] - level)) * steps
    likelihood, white, walk = likeliest(SHARES, growing)
    if likelihood < likeliest((0.0,), growing)[0] + GAIN:
        return None
    # what sways in proportion to the mode, as a sensor's gain, is no noise
    if likelihood < likeliest(SHARES, steps)[0]:
        return None
    left = slice(0, int(np.searchsorted(np.cumsum(walk), WORST**2)))
    return np.sqrt(white) * blocks.std[left], walk[left]


def smooth(blocks: Phasors, fit: Spline, off: Float[ndarray, "part block"]) -> bool:
    """Whether a curve bends little to its end, and neighbours are not alike in what it misses."""
    own, count = off / blocks.std, blocks.time.size
    later = slice(count // 2, None)
    bends = np.square(fit.std(blocks.time[later], 1)[0] / blocks.std[later]).sum()
    alike = (own[:, 1:] * own[:, :-1]).sum()
    return bool(bends < min(BENDS, count / APART) and alike < np.sqrt(own.size))


def steady(off: Float[ndarray, "part block"]) -> bool:
    """Whether noise in blocks is hardly larger at first than at last, by second differences."""
    size = np.abs(np.diff(off, 2, axis=1))
    third = size.shape[1] // 3
    return bool(np.median(size[:, :third]) < STEADY * np.median(size[:, -third:]))
