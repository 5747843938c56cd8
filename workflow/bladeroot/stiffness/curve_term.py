"""What amplitude curves say of the stiffness at each level, as rows of a linear model.

Near a point the softening curves are linear in (ln kn, ln kt, ln F) of their levels. What else they
depend on, the friction, is integrated out before: it only makes their covariance wider.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from numpy import ndarray


@dataclass(frozen=True)
class CurveTerm:
    """rest = slope (z - center) + errors of unit variance, as few rows as say it all.

    center: (ln kn, ln kt, ln F) of each level, F the true axial force in N; slope by the same
    coordinates, flattened. constant: what these rows leave out of the log-likelihood. points:
    numbers behind it.
    """

    center: Float[ndarray, "level 3"]
    rest: Float[ndarray, " row"]
    slope: Float[ndarray, "row coordinate"]
    constant: float
    points: int


def curve_term(
    center: Float[ndarray, "level 3"],
    rest: Float[ndarray, " point"],
    slope: Float[ndarray, "point coordinate"],
    covariance: Float[ndarray, "point point"],
) -> CurveTerm:
    """The term of measured minus simulated curves, `rest`, whose simulation has `slope`."""
    factor = np.linalg.cholesky(covariance)
    whitened = np.linalg.solve(factor, np.column_stack([rest, slope]))
    rest, slope = whitened[:, 0], whitened[:, 1:]
    across, rows = np.linalg.qr(slope)
    kept = across.T @ rest
    spare = len(rest) - len(kept)
    volume = np.log(np.diag(factor)).sum() + 0.5 * spare * np.log(2.0 * np.pi)
    constant = float(-0.5 * (rest @ rest - kept @ kept) - volume)
    return CurveTerm(center, kept, rows, constant, len(rest))
