"""What amplitude curves say of the stiffness at each level, as a normal distribution.

Near a point the softening curves are linear in (ln kn, ln kt, ln F) of their levels. What else they
depend on, the friction, is integrated out before: it only makes the distribution wider.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from numpy import ndarray


@dataclass(frozen=True)
class CurveTerm:
    """The log-likelihood constant + gradient d - d information d / 2, with d = z - center.

    center: (ln kn, ln kt, ln F) of each level, with F the true axial force in N; gradient and
    information in the same order, flattened. points: numbers behind it.
    """

    center: Float[ndarray, "level 3"]
    gradient: Float[ndarray, " coordinate"]
    information: Float[ndarray, "coordinate coordinate"]
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
    volume = np.log(np.diag(factor)).sum() + 0.5 * len(rest) * np.log(2.0 * np.pi)
    constant = float(-0.5 * rest @ rest - volume)
    return CurveTerm(center, slope.T @ rest, slope.T @ slope, constant, len(rest))


def log_likelihood(term: CurveTerm, z: Float[ndarray, "draw level 3"]) -> Float[ndarray, " draw"]:
    """Of the curves at many points z."""
    away = (z - term.center).reshape(len(z), -1)
    bent = np.einsum("di,ij,dj->d", away, term.information, away, optimize=True)
    return term.constant + away @ term.gradient - 0.5 * bent
