"""Frequency and loss factor against amplitude at the laser, as FREEVIB sees them, of one mode.

In a free decay the action of a mode, omega q^2 / 2 with q the amplitude of unit modal mass, loses
zeta omega^2 q^2 in a unit of time. FREEVIB's loss factor (3.11) is -(2 omega A'/A + omega') /
omega^2 of the amplitude A at the laser. It equals 2 zeta if A keeps its ratio to q; where the shape
changes with amplitude it does not. Where the laser's phase against the mode changes with amplitude,
it adds to the frequency.
"""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float
from numpy import ndarray
from scipy.interpolate import PchipInterpolator

from bladeroot.contact.laws import closed_forms
from bladeroot.contact.laws.sliders import Sliders
from bladeroot.nonlinear.balance import Solution
from bladeroot.nonlinear.harmonic_balance import fall, growth, nonlinear_mode, sufficient
from bladeroot.nonlinear.masing import first_harmonic
from bladeroot.nonlinear.quasi_static import first_loading
from bladeroot.nonlinear.system import System

METHODS = ("harmonic-balance", "quasi-static", "fixed-shape")
# The ladder of amplitudes of quasi-static loading.
_STATES_PER_DECADE = 60
_BEGINNING = 10.0  # ratio of the smallest amplitude asked for to the ladder's first


@dataclass(frozen=True)
class Curve:
    """frequency (Hz), loss_factor: at the asked amplitudes, NaN where there is no solution.

    damping_ratio: of the mode, without what the changing shape adds at the laser. slip: share of
    each contact's tangential stiffness that slips. reason: why the curve ends early, or "". turns:
    amplitudes (m) where the branch turns back; between them a decay jumps.
    """

    frequency: Float[ndarray, " amplitude"]
    loss_factor: Float[ndarray, " amplitude"]
    damping_ratio: Float[ndarray, " amplitude"]
    slip: Float[ndarray, "amplitude contact"]
    reason: str
    turns: tuple[float, ...] = ()


def mode_curve(
    system: System,
    sliders: Sliders,
    amplitudes: Float[ndarray, " amplitude"],
    method: str = "quasi-static",
    harmonics: tuple[int, ...] = (0, 1, 2, 3),
    decaying: bool = True,
) -> Curve:
    """Curve of a mode at rising amplitudes (m) of the first harmonic at the laser.

    method: one of `METHODS`. decaying: for harmonic balance, whether the contacts move as in a free
    decay; the other methods take them in steady vibration. ValueError for an unknown method, for a
    law of varying normal load unless by harmonic balance, or for amplitudes that do not rise.
    """
    if not (amplitudes[0] > 0.0 and np.all(np.diff(amplitudes) > 0.0)):
        raise ValueError("amplitudes must be positive and rising")
    if method == "harmonic-balance":
        curve = _by_harmonic_balance(system, sliders, amplitudes, harmonics, decaying)
    elif method == "quasi-static":
        curve = _by_loading(system, sliders, amplitudes)
    elif method == "fixed-shape":
        curve = _by_fixed_shape(system, sliders, amplitudes)
    else:
        raise ValueError(f"the method must be one of {', '.join(METHODS)}, got {method!r}")
    return replace(curve, reason=_reason(curve, amplitudes))


def _reason(curve: Curve, amplitudes: Float[ndarray, " amplitude"]) -> str:
    """Why the curve ends early, and where, or ""."""
    known = np.flatnonzero(np.isfinite(curve.frequency))
    if len(known) == len(amplitudes):
        return ""
    last = amplitudes[known[-1]] if len(known) else 0.0
    why = curve.reason or "the first harmonic stays below the peaks of first loading"
    return f"{why}; the curve holds to {1e6 * last:.4g} um at the laser"


def first_slip(system: System, sliders: Sliders) -> float:
    """Amplitude at the laser (m) at which a slider first slips, or opens, in every cycle; or inf.

    A normal load that varies in phase with the motion helps at one end as much as it hurts at the
    other, and the friction point settles between them: so the preload decides, but for what the
    settling itself does to the mean load, which is not counted.
    """
    normal, along, slope = np.abs(system.shape[:, :, 0]).T[:, :, None]
    pull = sliders.tangential * np.hypot(along, slope)
    modal = _ratio(sliders.friction * sliders.preload, pull)
    if sliders.varies:
        modal = np.minimum(modal, _ratio(sliders.preload, sliders.normal * normal))
    return float(modal.min() * abs(system.laser[0]))


def _ratio(limit: ndarray, pull: ndarray) -> ndarray:
    return np.divide(limit, pull, out=np.full(pull.shape, np.inf), where=pull > 0.0)


def _at_laser(ratio: ndarray, laser: ndarray, frequency: ndarray) -> ndarray:
    """FREEVIB's loss factor from the mode's 2 zeta and d ln A, d ln omega by d ln q."""
    return ratio * (laser + 0.5 * frequency) / (1.0 + 0.5 * frequency)


def _slip_share(sliders: Sliders, slips: ndarray) -> Float[ndarray, " contact"]:
    return (sliders.tangential * (slips > 0.0)).sum(axis=1) / sliders.tangential.sum(axis=1)


def _by_harmonic_balance(system, sliders, amplitudes, harmonics, decaying) -> Curve:
    found = nonlinear_mode(system, sliders, amplitudes, harmonics, decaying=decaying)
    branch = sufficient(system, sliders, found, harmonics, decaying=decaying)
    rows = np.full((4 + len(system.count), len(amplitudes)), np.nan)
    first = 1 if sliders.varies and 0 in harmonics else 0
    for place, solution in enumerate(branch.solutions):
        rows[:4, place] = _laser_values(solution, first)
        rows[4:, place] = _slip_share(sliders, solution.slip)
    omega, ratio, laser, frequency = rows[:4]
    return Curve(
        omega / (2.0 * np.pi),
        _at_laser(ratio, laser, frequency),
        0.5 * ratio,
        rows[4:].T,
        branch.reason,
        branch.turns,
    )


def _laser_values(solution: Solution, first: int) -> tuple[float, float, float, float]:
    """omega at the laser, 2 zeta, and d ln A and d ln omega by d ln q."""
    ln_q, frequency = growth(solution, first)
    c, s = solution.laser[first : first + 2]
    rate_c, rate_s = solution.rate.laser[first : first + 2]
    turn = (s * rate_c - c * rate_s) / (c**2 + s**2)  # of the phase, by the master
    return (
        np.sqrt(solution.value) * (1.0 + turn * fall(solution, first)),
        solution.decay / solution.value,
        (c * rate_c + s * rate_s) / (c**2 + s**2) / ln_q,
        frequency,
    )


def _by_loading(system, sliders, amplitudes) -> Curve:
    low, high = amplitudes[0] / _BEGINNING, 1.1 * amplitudes[-1]
    count = 2 + int(_STATES_PER_DECADE * np.log10(high / low))
    ladder = np.geomspace(low, high, count)
    corner = first_slip(system, sliders)  # where the curves have their sharpest bend
    if low < corner < high:
        ladder = np.sort(
            np.append(ladder[np.abs(np.log(ladder / corner)) > 0.1 / _STATES_PER_DECADE], corner)
        )
    branch = first_loading(system, sliders, ladder)
    found = branch.solutions
    slip = np.full((len(amplitudes), len(system.count)), np.nan)
    if len(found) < 2:
        nothing = np.full(len(amplitudes), np.nan)
        return Curve(nothing, nothing, nothing, slip, branch.reason)
    master = np.array([one.amplitude for one in found])
    others = np.stack([one.modal[1:, 0] for one in found])
    load = master * [one.value for one in found]
    laser = np.array([one.laser[0] for one in found])
    slope = np.concatenate([[system.values[0], system.laser[0]], np.zeros(others.shape[1])])
    cosine, sine = first_harmonic(master, np.column_stack([load, laser, others]), slope)
    value = cosine[:, 0] / master
    ratio = (system.loss[0] * system.values[0] - sine[:, 0] / master) / value
    at_laser = np.hypot(cosine[:, 1], sine[:, 1])
    modal = np.sqrt(master**2 + (cosine[:, 2:] ** 2 + sine[:, 2:] ** 2).sum(axis=1))
    ln_q = np.log(modal)
    loss = _at_laser(
        ratio, np.gradient(np.log(at_laser), ln_q), np.gradient(0.5 * np.log(value), ln_q)
    )
    share = np.stack([_slip_share(sliders, one.slip) for one in found])
    rows = np.column_stack([np.sqrt(value) / (2.0 * np.pi), loss, 0.5 * ratio, share])
    rows = PchipInterpolator(np.log(at_laser), rows, extrapolate=False)(np.log(amplitudes))
    return Curve(rows[:, 0], rows[:, 1], rows[:, 2], rows[:, 3:], branch.reason)


def _by_fixed_shape(system, sliders, amplitudes) -> Curve:
    if sliders.varies:
        raise ValueError(
            "closed forms in the stuck shape need constant normal load; "
            "use harmonic balance for a law with varying normal load"
        )
    tangential = np.hypot(system.shape[:, 1, 0], system.shape[:, 2, 0])[:, None]
    slip = np.broadcast_to(tangential, sliders.tangential.shape)
    limit = sliders.friction * sliders.preload
    modal = amplitudes / abs(system.laser[0])
    stick = np.sqrt(system.values[0]) / (2.0 * np.pi)
    # a slider and its images are one of several times the stiffness and limit
    count = system.count[:, None]
    frequency, loss = closed_forms.fixed_shape(
        modal, stick, slip.ravel(), (count * sliders.tangential).ravel(), (count * limit).ravel()
    )
    loss = loss + system.loss[0] * (stick / frequency) ** 2
    slips = modal[:, None, None] * slip * sliders.tangential > limit
    share = np.stack([_slip_share(sliders, one) for one in slips])
    return Curve(frequency, loss, 0.5 * loss, share, "")
