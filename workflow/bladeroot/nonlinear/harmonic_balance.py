"""Nonlinear modes by harmonic balance with the alternating frequency-time method."""

from collections.abc import Sequence
from functools import partial

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.contact.laws.sliders import Sliders
from bladeroot.nonlinear.aft import CYCLE_SAMPLES, contact_forces, cycle
from bladeroot.nonlinear.balance import Solution, first_step, solve
from bladeroot.nonlinear.continuation import Branch, follow
from bladeroot.nonlinear.response import harmonic
from bladeroot.nonlinear.system import System

# In a free decay the contacts' motion fades at the damping ratio that it causes: both are iterated.
_MOST_FADE_ROUNDS = 12
_FADE_TOLERANCE = 1e-4  # of the damping ratio between rounds; moves the loss factor by 0.03 % of it
# What the harmonics that are left out may change: relative, of the frequency and the loss factor.
TRUNCATION_LIMITS = (1e-4, 0.03)
# A smaller change of the loss factor is allowed in any case, as no record shows it: the smallest
# standard deviation of the source's Table 3.1. Where slip begins, friction's loss factor is nearly
# zero and a relative change of it is rounding.
MEASURABLE_LOSS = 1e-5


def nonlinear_mode(
    system: System,
    sliders: Sliders,
    amplitudes: Float[ndarray, " amplitude"],
    harmonics: Sequence[int] = (0, 1, 2, 3),
    times: int = CYCLE_SAMPLES,
    decaying: bool = True,
) -> Branch:
    """Motions at rising amplitudes (m) of the first harmonic at the laser.

    Under constant normal load even harmonics vanish and are left out. decaying: whether the
    contacts move as in the free decay that the mode is in, or as in steady vibration of constant
    amplitude. Each solution's slip is the part of the cycle in which a slider slips. Whether the
    harmonics suffice is asked of `sufficient`.
    """
    harmonics = _own(sliders, harmonics)
    balance = harmonic(harmonics)

    last = 0.0  # damping ratio of the last motion found, where the next one begins

    def at(amplitude: float, guess: ndarray, across=None) -> Solution | None:
        nonlocal last
        fade = last
        for _ in range(_MOST_FADE_ROUNDS):
            samples = cycle(harmonics, times, fade)
            evaluate = partial(contact_forces, sliders, samples=samples)
            found = solve(system, balance, evaluate, amplitude, guess, across)
            if found is None or not decaying:
                break
            ratio = 0.5 * found.decay / found.value
            if abs(ratio - fade) < _FADE_TOLERANCE:
                last = fade
                break
            fade, guess, amplitude = ratio, found.motion, found.amplitude
        else:
            return None
        return found

    def at_laser(solution: Solution) -> float:
        return float(np.hypot(*solution.laser[balance.first : balance.first + 2]))

    first = amplitudes[0] / abs(system.laser[0])
    stuck = np.zeros((len(system.count), 3, balance.size))
    stuck[:, :, balance.first] = first * system.shape[:, :, 0]
    return follow(at, amplitudes, at(first, stuck), at_laser)


def sufficient(
    system: System,
    sliders: Sliders,
    branch: Branch,
    harmonics: Sequence[int],
    decaying: bool = True,
) -> Branch:
    """The branch up to where further harmonics would change more than `TRUNCATION_LIMITS`.

    The branch is as `nonlinear_mode` finds it with the same arguments.
    """
    harmonics = _own(sliders, harmonics)
    more = [h for h in (harmonics[-1] + 1, harmonics[-1] + 2) if sliders.varies or h % 2]
    if 4 * more[-1] > CYCLE_SAMPLES:
        return branch
    for place, solution in enumerate(branch.solutions):
        frequency, loss = _left_out(system, sliders, solution, harmonics, more, decaying)
        most = max(TRUNCATION_LIMITS[1] * solution.decay / solution.value, MEASURABLE_LOSS)
        if not (abs(frequency) <= TRUNCATION_LIMITS[0] and abs(loss) <= most):
            reason = (
                f"harmonics to {harmonics[-1]} do not suffice: the next ones change the frequency "
                f"by {1e6 * frequency:.0f} ppm, the loss factor by {loss:.2g} of "
                f"{solution.decay / solution.value:.2g}"
            )
            return Branch(branch.solutions[:place], reason, branch.turns)
    return branch


def _own(sliders: Sliders, harmonics: Sequence[int]) -> list[int]:
    """The harmonics that a law makes: under constant normal load, only odd ones."""
    return [h for h in harmonics if sliders.varies or h % 2]


def _left_out(
    system: System,
    sliders: Sliders,
    solution: Solution,
    harmonics: Sequence[int],
    more: Sequence[int],
    decaying: bool,
) -> tuple[float, float]:
    """Relative change of frequency, and change of the loss factor, by more harmonics.

    In one step of Newton's method.
    """
    wide = [*harmonics, *more]
    balance = harmonic(wide)
    motion = np.zeros((*solution.motion.shape[:2], balance.size))
    motion[:, :, : solution.motion.shape[2]] = solution.motion
    fade = 0.5 * solution.decay / solution.value if decaying else 0.0
    evaluate = partial(contact_forces, sliders, samples=cycle(wide, CYCLE_SAMPLES, fade))
    value, decay = first_step(system, balance, evaluate, solution.amplitude, motion)
    ratio = solution.decay / solution.value
    return 0.5 * value / solution.value, (decay - ratio * value) / solution.value


def growth(solution: Solution, first: int) -> tuple[float, float]:
    """d ln q by the master amplitude (1 / (m kg^1/2)), and d ln omega by d ln q.

    q: amplitude of unit modal mass of all modes together; first: the coefficient of cos(theta).
    """
    own = slice(first, first + 2)
    modal, rate = solution.modal[:, own], solution.rate.modal[:, own]
    ln_q = float((modal * rate).sum() / (modal**2).sum())
    return ln_q, 0.5 * solution.rate.value / solution.value / ln_q


def fall(solution: Solution, first: int) -> float:
    """Change of the master amplitude in a free decay, m kg^1/2 per rad.

    The action omega q^2 / 2 loses zeta omega^2 q^2 in a unit of time.
    """
    ln_q, frequency = growth(solution, first)
    ratio = 0.5 * solution.decay / solution.value
    return -ratio / (1.0 + 0.5 * frequency) / ln_q
