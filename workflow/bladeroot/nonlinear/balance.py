"""Newton's method for the motion at one amplitude: contact forces and structure in balance.

Only contacts that slip or open fail to carry their linear share, so only these enter the linear
system; the others follow.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.linalg
from jaxtyping import Float
from numpy import ndarray

from bladeroot.nonlinear.response import (
    Balance,
    Response,
    laser_motion,
    respond,
    respond_change,
    response_matrix,
)
from bladeroot.nonlinear.system import System

TOLERANCE = 1e-9  # of the largest contact motion: a smaller residual ends Newton's method
_MOST_ITERATIONS = 12
_MOST_HALVINGS = 6  # of a step that does not reduce the residual enough

# Contact motion -> force, its derivative (contact, 3, coefficient, 3, coefficient), slip share.
Evaluate = Callable[[ndarray], tuple[ndarray, ndarray, ndarray]]


@dataclass(frozen=True)
class Rate:
    """Derivatives by the master amplitude along the branch."""

    motion: Float[ndarray, "contact 3 coefficient"]
    modal: Float[ndarray, "mode coefficient"]
    value: float
    laser: Float[ndarray, " coefficient"]


@dataclass(frozen=True)
class Solution:
    """A balanced motion at one master amplitude.

    amplitude: of the master coordinate, m kg^1/2. motion: of the contacts, m. missing: linear
    contact force less the law's, N. modal: coordinates of the modes, m kg^1/2. value: omega^2,
    decay: 2 zeta omega^2, 1/s^2. slip: what the law says of each slider. laser: coefficients of the
    motion there, m.
    """

    amplitude: float
    motion: Float[ndarray, "contact 3 coefficient"]
    missing: Float[ndarray, "contact 3 coefficient"]
    modal: Float[ndarray, "mode coefficient"]
    value: float
    decay: float
    slip: Float[ndarray, "contact slider"]
    laser: Float[ndarray, " coefficient"]
    rate: Rate
    iterations: int


def solve(
    system: System,
    balance: Balance,
    evaluate: Evaluate,
    amplitude: float,
    guess: Float[ndarray, "contact 3 coefficient"],
    across: tuple[ndarray, float] | None = None,
) -> Solution | None:
    """The motion at a master amplitude (m kg^1/2) from a guess (m); None if Newton fails.

    across: a direction of motion and amplitude. With it the amplitude is found too, in the plane
    through the guess across that direction (pseudo-arclength).
    """
    stiffness = system.stiffness[:, [0, 1, 1]]
    motion, begun = guess, amplitude

    def state(motion: ndarray, amplitude: float) -> tuple:
        force, tangent, slip = evaluate(motion)
        missing = stiffness[:, :, None] * motion - force
        response = respond(system, balance, amplitude, missing)
        rest = motion - response.motion
        return missing, tangent, slip, response, rest, np.abs(rest).max()

    missing, tangent, slip, response, rest, error = state(motion, amplitude)
    for iteration in range(_MOST_ITERATIONS):
        if not (np.isfinite(error) and response.value > 0.0):
            return None
        lost = _lost(tangent, stiffness)
        line = linearised(system, balance, amplitude, response, lost)
        done = error <= TOLERANCE * np.abs(motion).max()
        if done or across is not None:
            along = respond_change(system, balance, amplitude, response, 0.0 * missing, 1.0)
            rise = line(along.motion)  # of the motion by the amplitude
        if done:
            change = np.einsum("cahbg,cbg->cah", lost, rise)
            along = respond_change(system, balance, amplitude, response, change, 1.0)
            modal, value, decay = response.modal, response.value, response.decay
            laser = laser_motion(system, modal, missing)
            rate = Rate(rise, along.modal, along.value, laser_motion(system, along.modal, change))
            return Solution(
                amplitude, motion, missing, modal, value, decay, slip, laser, rate, iteration
            )
        step, longer = line(-rest), 0.0
        if across is not None:
            off = (across[0] * (motion + step - guess)).sum() + across[1] * (amplitude - begun)
            longer = float(-off / ((across[0] * rise).sum() + across[1]))
            step = step + longer * rise
        part = 1.0
        for _ in range(_MOST_HALVINGS):
            trial = state(motion + part * step, amplitude + part * longer)
            if trial[5] < (1.0 - 0.1 * part) * error:
                break
            part *= 0.5
        motion, amplitude = motion + part * step, amplitude + part * longer
        missing, tangent, slip, response, rest, error = trial
    return None


def first_step(
    system: System,
    balance: Balance,
    evaluate: Evaluate,
    amplitude: float,
    motion: Float[ndarray, "contact 3 coefficient"],
) -> tuple[float, float]:
    """Change of value and decay (1/s^2) by one step of Newton's method from a motion (m)."""
    stiffness = system.stiffness[:, [0, 1, 1]]
    force, tangent, _ = evaluate(motion)
    response = respond(system, balance, amplitude, stiffness[:, :, None] * motion - force)
    lost = _lost(tangent, stiffness)
    line = linearised(system, balance, amplitude, response, lost)
    change = np.einsum("cahbg,cbg->cah", lost, line(response.motion - motion))
    moved = respond_change(system, balance, amplitude, response, change)
    return moved.value, moved.decay


def _lost(tangent: ndarray, stiffness: ndarray) -> ndarray:
    """Derivative of the missing force by the motion, N/m."""
    axis, place = np.arange(3)[:, None], np.arange(tangent.shape[2])
    lost = -tangent
    lost[:, axis, place, axis, place] += stiffness[:, :, None]
    lost[np.abs(lost) < 1e-12 * stiffness.max()] = 0.0
    return lost


def linearised(
    system: System,
    balance: Balance,
    amplitude: float,
    response: Response,
    lost: Float[ndarray, "contact 3 coefficient 3 coefficient"],
) -> Callable[[ndarray], ndarray]:
    """Solver of (1 - dresponse/dmissing lost) step = right, both shaped like the motion."""
    contacts, size = len(system.count), balance.size
    used = lost.any(axis=(2, 3, 4)) | lost.any(axis=(1, 2, 4))
    if not used.any():
        return lambda right: right
    own, axes = np.flatnonzero(used.any(axis=1)), np.flatnonzero(used.any(axis=0))
    active = (3 * own[:, None] + axes).ravel()
    matrix = response_matrix(system, balance, amplitude, response, active)
    # contact by contact: the matrix's columns of a contact times its block
    each = axes.size * size
    blocks = lost[np.ix_(own, axes, range(size), axes, range(size))].reshape(-1, each, each)
    columns = matrix.reshape(-1, own.size, each).swapaxes(0, 1)
    dense = np.eye(len(matrix)) - (columns @ blocks).swapaxes(0, 1).reshape(matrix.shape)
    factor = scipy.linalg.lu_factor(dense, overwrite_a=True, check_finite=False)

    def line(right: ndarray) -> ndarray:
        rest = right.reshape(-1, size)[active].ravel()
        step = np.zeros((3 * contacts, size))
        step[active] = scipy.linalg.lu_solve(factor, rest, check_finite=False).reshape(-1, size)
        change = np.einsum("cahbg,cbg->cah", lost, step.reshape(contacts, 3, size))
        return right + respond_change(system, balance, amplitude, response, change).motion

    return line
