"""How a fit predicts data that it has not seen, and whether its residuals ask for more freedom."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray

from bladeroot.inference.gaussian import Fit


def asked_for(fitted: Fit, unit: Float[ndarray, "datum datum"]) -> float:
    """How much a fit's residuals ask for a further covariance: Rao's score test of a component.

    The slope of the marginal likelihood by the covariance's size, at size zero, over the slope's
    standard deviation. unit: the covariance of size one.
    """
    pulled = fitted.precision @ fitted.residual
    seen = fitted.precision @ unit
    variance = 2.0 * float(np.sum(seen * seen.T))
    if not variance > 0.0:  # the parameters take all of it up: no residual can ask for it
        return 0.0
    return float((pulled @ unit @ pulled - np.trace(seen)) / np.sqrt(variance))


def asked_along(fitted: Fit, slope: Float[ndarray, "datum parameter"]) -> float:
    """How much a fit's residuals ask for further parameters of such slopes (Rao's score test).

    Twice the nats of likelihood that these parameters would gain.
    """
    seen = fitted.precision @ slope
    pull = seen.T @ fitted.residual
    return float(pull @ np.linalg.lstsq(slope.T @ seen, pull, rcond=1e-10)[0])


@dataclass(frozen=True)
class HeldOut:
    """Predictions of parts of the data by the rest: error, log score."""

    error: Float[ndarray, " datum"]
    log_score: Float[ndarray, " part"]


def hold_out(fitted: Fit, part: Int[ndarray, " datum"], allowance: slice = slice(0)) -> HeldOut:
    """Leave out each part of the data in turn, with the scales and the linear model of the fit.

    With Q the precision and r the residual, the error of part B is Q_BB^-1 (Q r)_B, its covariance
    Q_BB^-1. part: number of each datum's part, from 0. allowance: parameters that are left at their
    prior's mean for the error, which then includes what they took up in the rest of the data; the
    log score is with these parameters.
    """
    pulled = fitted.precision @ fitted.residual
    error, scores = np.zeros(part.size), np.zeros(int(part.max()) + 1)
    spared = fitted.state.slope[:, allowance]
    learned = (fitted.problem.prior.std[allowance] ** 2)[:, None] * spared.T
    for number in range(scores.size):
        rows = np.flatnonzero(part == number)
        block = np.linalg.inv(fitted.precision[np.ix_(rows, rows)])
        error[rows] = block @ pulled[rows]
        scores[number] = -0.5 * (
            pulled[rows] @ error[rows]
            + np.linalg.slogdet(block)[1]
            + rows.size * np.log(2.0 * np.pi)
        )
        without = pulled - fitted.precision[:, rows] @ error[rows]  # of the fit to the rest
        error[rows] += spared[rows] @ (learned @ without)
    return HeldOut(error, scores)
