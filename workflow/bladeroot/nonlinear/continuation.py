"""From small to large amplitude along one branch, in steps as small as the motion asks for.

Slip makes a corner where it begins, and the shape may turn fast: both ask for smaller steps. Where
the branch itself turns back in amplitude, as when a harmonic meets another mode, it is followed by
arclength until it rises again. Where that fails, too, it ends with a reason: it is never left for
another branch unnoticed.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.nonlinear.balance import Solution

# Steps along the branch.
SMALLEST_STEP = 0.01  # of ln amplitude; where a shorter one would be needed, arclength is tried
_MOST_STEPS = 100  # towards one target
_ARC_STEPS = (1e-5, 2e-3, 0.1)  # smallest, first, largest arclength, of relative changes
_MOST_ARC_STEPS = 300  # around one turn
# Two successive solutions are of the same branch if both hold.
_LEAST_CORRELATION = 0.9  # of their contact motions
_LARGEST_JUMP = 0.1  # of ln omega^2

# Master amplitude, guess, and a direction to be met across (or None) -> motion.
Solve = Callable[..., Solution | None]


@dataclass(frozen=True)
class Branch:
    """Solutions at rising amplitudes.

    reason: why it ends before the last one asked, or "". turns: amplitudes where it turned back;
    between the turns it has several solutions, of which the first and the last part are kept.
    """

    solutions: tuple[Solution, ...]
    reason: str
    turns: tuple[float, ...] = ()


def follow(
    solve: Solve,
    targets: Float[ndarray, " amplitude"],
    start: Solution | None,
    measure: Callable[[Solution], float],
    close: float = 1e-4,
) -> Branch:
    """Solve at rising amplitudes `targets` of what `measure` gives.

    solve: motion at a master amplitude (m kg^1/2) from a guess. start: the motion while all sticks,
    from which every other motion is continued. close: how well a target must be met, relative.
    """
    if start is None:
        return Branch((), "Newton's method did not converge at the smallest amplitude")
    found: list[Solution] = []
    turns: list[float] = []
    last = start
    for target in targets:
        tries = 0
        while abs(measure(last) / target - 1.0) > close:
            tries += 1
            new = None
            if tries < _MOST_STEPS:
                new = _rise(solve, last, last.amplitude * target / measure(last))
                if new is None:
                    new, passed = _around(solve, last, float(target), measure)
                    turns += passed
            if new is None:
                return Branch(tuple(found), "no further solution could be followed", tuple(turns))
            last = new
        found.append(last)
    return Branch(tuple(found), "", tuple(turns))


def _rise(solve: Solve, last: Solution, amplitude: float) -> Solution | None:
    """The motion at an amplitude, or as far towards it as Newton's method gets; None if nowhere."""
    while True:
        step = amplitude - last.amplitude
        new = solve(amplitude, last.motion + step * last.rate.motion)
        if new is not None and _same_branch(last, new):
            return new
        if abs(np.log(amplitude / last.amplitude)) < SMALLEST_STEP:
            return None
        amplitude = float(np.sqrt(last.amplitude * amplitude))


def _around(
    solve: Solve, last: Solution, target: float, measure: Callable[[Solution], float]
) -> tuple[Solution | None, list[float]]:
    """The solution where the branch, by arclength, rises through the target; where it turned."""
    smallest, step, largest = _ARC_STEPS
    heading, turns = 1.0, []
    way = _direction(last, last)
    for _ in range(_MOST_ARC_STEPS):
        size = np.linalg.norm(last.motion)
        guess = last.motion + step * size * way[0]
        amplitude = last.amplitude * (1.0 + step * way[1])
        new = None
        if amplitude > 0.0:
            new = solve(amplitude, guess, (way[0] / size, way[1] / last.amplitude))
        if new is None or not _same_branch(last, new):
            step *= 0.5
            if step < smallest:
                return None, turns
            continue
        ahead = _direction(new, last)
        if (ahead[0] * way[0]).sum() + ahead[1] * way[1] < 0.0:
            ahead = (-ahead[0], -ahead[1])
        if ahead[1] * heading < 0.0:
            heading = -heading
            turns.append(measure(new))
        last, way = new, ahead
        step = min(largest, step * (1.5 if new.iterations < 6 else 0.8))
        if heading > 0.0 and measure(last) >= target:
            return last, turns
    return None, turns


def _direction(here: Solution, scale: Solution) -> tuple[ndarray, float]:
    """Unit tangent of the branch in relative motion and relative amplitude."""
    motion = here.rate.motion * here.amplitude / np.linalg.norm(scale.motion)
    length = np.sqrt((motion**2).sum() + 1.0)
    return motion / length, 1.0 / float(length)


def _same_branch(last: Solution, new: Solution) -> bool:
    a, b = last.motion, new.motion
    alike = abs((a * b).sum()) / np.sqrt((a**2).sum() * (b**2).sum())
    return bool(alike > _LEAST_CORRELATION and abs(np.log(new.value / last.value)) < _LARGEST_JUMP)
