"""Stick frequencies that lie far from what their neighbours in force say: typing errors."""

import numpy as np
from jaxtyping import Float
from numpy import ndarray

# A frequency stands alone where its distance from what its neighbours allow exceeds both: a wrong
# digit, no law of the force.
_USUAL_DISTANCES = 20.0  # times the others' median distance from their neighbours' line
_LEAST_DISTANCE = 0.02  # of ln f
_FEWEST_OTHERS = 5  # points besides the outlier, which tell a law of the force and its scatter


def outliers(
    force: Float[ndarray, " row"], frequency: Float[ndarray, " row"]
) -> list[tuple[int, float]]:
    """Rows (all of one mode, each at a force of its own) whose frequency stands alone, with what
    the neighbours say instead; the worst first.
    """
    kept = np.argsort(force)
    x, y = np.log(force), np.log(frequency)
    found = []
    while kept.size > _FEWEST_OTHERS:
        # The line of a point's neighbours is spoilt by an outlier, too: the outlier is that
        # without which the others agree best.
        rests = [np.delete(kept, k) for k in range(kept.size)]
        worst = int(np.argmin([np.abs(_distances(x[rest], y[rest])).max() for rest in rests]))
        row, rest = kept[worst], rests[worst]
        expected = _neighbours(x[rest], y[rest], x[row], y[row])
        distance = abs(y[row] - expected)
        usual = np.median(np.abs(_distances(x[rest], y[rest])))
        if not (distance > _LEAST_DISTANCE and distance > _USUAL_DISTANCES * usual):
            break
        found.append((int(row), float(np.exp(expected))))
        kept = rest
    return found


def _distances(x: Float[ndarray, " point"], y: Float[ndarray, " point"]) -> ndarray:
    """Distance of each inner point from the line of its two neighbours."""
    share = (x[1:-1] - x[:-2]) / (x[2:] - x[:-2])
    return y[1:-1] - (1.0 - share) * y[:-2] - share * y[2:]


def _neighbours(
    x: Float[ndarray, " point"], y: Float[ndarray, " point"], at: float, seen: float
) -> float:
    """What the two points next to a place say of it, the nearest to what is seen.

    A law may bend: between two points anything between their values, outside from the last one's
    value to twice as far as the line of the two goes.
    """
    right = int(np.clip(np.searchsorted(x, at), 1, x.size - 1))
    near, far = y[right - 1], y[right]
    if not x[0] < at < x[-1]:
        near = y[0] if at < x[0] else y[-1]
        slope = (y[right] - y[right - 1]) / (x[right] - x[right - 1])
        far = near + 2.0 * slope * (at - (x[0] if at < x[0] else x[-1]))
    return float(np.clip(seen, min(near, far), max(near, far)))
