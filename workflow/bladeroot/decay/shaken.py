"""Noise that shakes the mode itself, as wind, traffic or a floor do, and how much of it there is.

A mode answers a white force with the pole of its own free decay. Relative to the decay z that noise
n is a random walk, d(n/z)/dt = force/z: its steps are independent and their variance grows as 1/A^2
(an Ornstein-Uhlenbeck process divided by its own decay). Over many blocks it is correlated, so that
the scatter of neighbouring blocks tells little of it, and the curve follows it to its end. How much
of the scatter is a walk is found by restricted likelihood (`signal.smooth.evidence`).
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.signal.phasors import WORST_STD, Phasors
from bladeroot.signal.smooth import Spline, coarse, evidence

# Effective degrees of freedom of the spline in the later half of the blocks: a mode's own laws take
# fewer, and more are a sign of noise that the curve follows.
MOST_BENDS = 16
BLOCKS_PER_BEND = 5  # of a short curve: one degree of freedom for this many of all its blocks
# Noise of the surroundings is there all along, what is left of other modes decays: largest ratio of
# the blocks' absolute scatter in the first third to that in the last third.
MOST_DECLINE = 2.0
# The random walk in the log-phasor, as which such noise is looked for.
WALK_SHARES = (0.01, 0.1, 0.4, 0.9)  # of the variance between neighbours; all are tried
WALK_GAIN = 3.0  # nats of log-likelihood that a walk must gain over none


def shaken(
    blocks: Phasors, fit: Spline
) -> tuple[Float[ndarray, " left"], Float[ndarray, " left"]] | None:
    """Standard errors of the blocks without such noise, and variances of its steps; None: no noise.

    fit: the blocks' spline. Both results are of the first blocks, as many as the walk leaves usable
    (its standard deviation below `WORST_STD`); the errors are those that are independent in the
    blocks.
    """
    time, y = blocks.time, blocks.rows
    value = fit.value(time)[0]
    off, level = y - value, np.minimum.accumulate(value[0])
    steps = np.diff(time, prepend=2.0 * time[0] - time[1])
    if smooth(blocks, fit, off) or not steady(off * np.exp(level) * np.sqrt(steps)):
        return None
    # the noise has acted since long before the decay: that is steps over half a time constant of A
    steps[0] = 0.5 * (time[-1] - time[0]) / max(level[0] - level[-1], 1.0)

    def likeliest(shares: tuple[float, ...], steps: ndarray) -> tuple[float, float, ndarray]:
        # in second differences of neighbours a walk has a sixth of its steps' variance
        steps = 6.0 * np.median(blocks.std[1:] ** 2 / steps[1:]) * steps
        tried = []
        for share in shares:
            own = time, y, np.sqrt(1.0 - share) * blocks.std
            made = coarse(*own, fit.scale, iterations=6, walk=share * steps)
            likelihood, factor = evidence(*own, share * steps, made)
            tried.append((likelihood, (1.0 - share) * factor, share * factor * steps))
        return max(tried, key=lambda one: one[0])

    growing = np.exp(2.0 * (level[0] - level)) * steps
    likelihood, white, walk = likeliest(WALK_SHARES, growing)
    if likelihood < likeliest((0.0,), growing)[0] + WALK_GAIN:
        return None
    # steps that do not grow as the mode decays are no force on it, but of a sensor's gain, say
    if likelihood < likeliest(WALK_SHARES, steps)[0]:
        return None
    left = slice(0, int(np.searchsorted(np.cumsum(walk), WORST_STD**2)))
    return np.sqrt(white) * blocks.std[left], walk[left]


def smooth(blocks: Phasors, fit: Spline, off: Float[ndarray, "part block"]) -> bool:
    """Whether a curve bends little to its end and its residuals are not correlated."""
    own, count = off / blocks.std, blocks.time.size
    later = slice(count // 2, None)
    bends = np.square(fit.std(blocks.time[later], 1)[0] / blocks.std[later]).sum()
    alike = (own[:, 1:] * own[:, :-1]).sum()
    return bool(bends < min(MOST_BENDS, count / BLOCKS_PER_BEND) and alike < np.sqrt(own.size))


def steady(off: Float[ndarray, "part block"]) -> bool:
    """Whether the blocks' noise, by second differences, is about as large at first as at last."""
    size = np.abs(np.diff(off, 2, axis=1))
    third = size.shape[1] // 3
    return bool(np.median(size[:, :third]) < MOST_DECLINE * np.median(size[:, -third:]))
