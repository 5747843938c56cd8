"""What a fit says of data that it has not seen, and what further covariance its misses ask for."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray

from bladeroot.inference.gaussian import Fit


def asked_for(fitted: Fit, unit: Float[ndarray, "datum datum"]) -> float:
    """How much a fit's misses ask for a further covariance: its score over the standard deviation.

    Of the marginal likelihood by the covariance's size, at none (Rao's test of a component).
    """
    pulled = fitted.precision @ fitted.residual
    seen = fitted.precision @ unit
    variance = 2.0 * float(np.sum(seen * seen.T))
    if not variance > 0.0:  # what the parameters take up whole no miss asks for
        return 0.0
    return float((pulled @ unit @ pulled - np.trace(seen)) / np.sqrt(variance))


def asked_along(fitted: Fit, slope: Float[ndarray, "datum parameter"]) -> float:
    """How much a fit's misses ask for further parameters of such slopes (Rao's score test): twice
    the nats that they would gain.
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
    """Leave out each part in turn (parts are numbers from 0), scales kept, model made straight.

    With Q the precision, the error of part B is Q_BB^-1 (Q r)_B, its covariance Q_BB^-1.
    allowance: parameters that the prediction goes without (left at their prior's mean): what they
    took up in the rest of the data is an error then. The log score has them.
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
