"""Quasi-static modal analysis: first loading in the mode's inertia pattern, then Masing's rules.

The joint is loaded by omega^2 M times its own displacement, so that the pattern follows the shape
as contacts slip; cycles are not marched. Valid for constant normal load and small damping.
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.contact.laws.sliders import Sliders, at_rest, load
from bladeroot.nonlinear.balance import Solution, solve
from bladeroot.nonlinear.continuation import Branch, follow
from bladeroot.nonlinear.response import QUASI_STATIC
from bladeroot.nonlinear.system import System


def first_loading(
    system: System,
    sliders: Sliders,
    amplitudes: Float[ndarray, " amplitude"],
) -> Branch:
    """Static states at rising amplitudes (m) at the laser, met within a thousandth.

    Each solution's value is the load over displacement, 1/s^2; its slip says which sliders slip.
    ValueError for a law of varying normal load: Masing's rules do not hold for it.
    """
    if sliders.varies:
        raise ValueError(
            "quasi-static loading with Masing's rules needs constant normal load; "
            "use harmonic balance for a law with varying normal load"
        )
    rest = at_rest(sliders)

    def evaluate(motion: ndarray) -> tuple[ndarray, ndarray, ndarray]:
        force, tangent, _, slips = load(sliders, np.ascontiguousarray(motion[:, :, 0]), rest)
        return force[:, :, None], tangent[:, :, None, :, None], slips.astype(float)

    def at(amplitude: float, guess: ndarray, across=None) -> Solution | None:
        return solve(system, QUASI_STATIC, evaluate, amplitude, guess, across)

    first = amplitudes[0] / abs(system.laser[0])
    start = at(first, first * system.shape[:, :, :1])
    return follow(at, amplitudes, start, lambda solution: abs(float(solution.laser[0])), 1e-3)
