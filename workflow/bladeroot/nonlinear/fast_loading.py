"""First loading and Masing's rules for many curves: what inference asks for thousands of times.

The states are those of `quasi_static`, with the mode's own frequency in its inertia kept at that of
sticking; they are found contact by contact (`marching`), which is ten times as fast.
"""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.contact.laws.sliders import Sliders
from bladeroot.nonlinear.marching import load_up
from bladeroot.nonlinear.masing import first_harmonic
from bladeroot.nonlinear.monotone import interpolated
from bladeroot.nonlinear.system import System

# The ladder of amplitudes of the first loading.
_STATES_PER_DECADE = 24
_BEGINNING = 8.0  # ratio of the smallest amplitude asked for to the ladder's first
_TOLERANCE = 1e-6  # of the largest contact motion, to which a state settles
_SLOPE_STEP = 0.1  # of ln A to each side, for slopes: across several friction points' slips


def softening_curve(
    system: System, sliders: Sliders, amplitudes: Float[ndarray, " amplitude"]
) -> tuple[Float[ndarray, "2 amplitude"], Float[ndarray, "2 amplitude"]]:
    """`softening_curves` of one set of sliders."""
    value, slope = softening_curves(system, [sliders], amplitudes)
    return value[0], slope[0]


def softening_curves(
    system: System, many: Sequence[Sliders], amplitudes: Float[ndarray, " amplitude"]
) -> tuple[Float[ndarray, "curve 2 amplitude"], Float[ndarray, "curve 2 amplitude"]]:
    """Fall of the frequency f / f_stick - 1 and friction's loss factor, and both's slope by ln A.

    amplitudes: m, at the laser, rising. many: sliders of constant normal load, a curve each.
    ValueError for another law; RuntimeError if a state does not settle, or if the laser's motion
    does not rise with the mode's.
    """
    if any(one.varies for one in many):
        raise ValueError("first loading with Masing's rules needs constant normal load")
    low, high = amplitudes[0] / _BEGINNING, 1.3 * amplitudes[-1]
    count = 2 + int(_STATES_PER_DECADE * np.log10(high / low))
    master = np.geomspace(low, high, count) / abs(system.laser[0])
    loading = np.concatenate([states(system, one, master) for one in many], axis=1)
    slope = np.tile([system.values[0], system.laser[0]], len(many))
    cosine, sine = first_harmonic(master, loading, slope)
    load, laser = cosine[:, ::2], cosine[:, 1::2]
    rows = np.stack(
        [np.sqrt(load.T / master / system.values[0]) - 1.0, -(sine[:, ::2] / load).T], axis=2
    )
    seen, at = np.log(np.abs(laser)).T.copy(), np.log(amplitudes)
    if not np.all(np.diff(seen) > 0.0):
        raise RuntimeError(f"the motion at the laser does not rise with that of {system.mode}")
    asked = np.concatenate([at, at + _SLOPE_STEP, at - _SLOPE_STEP])
    made = [interpolated(*one, asked).T for one in zip(seen, rows, strict=True)]
    value, above, below = np.split(np.array(made), 3, axis=2)
    return value, (above - below) / (2.0 * _SLOPE_STEP)


def states(
    system: System, sliders: Sliders, master: Float[ndarray, " state"]
) -> Float[ndarray, "state 2"]:
    """Load on the master coordinate (N kg^-1/2) and motion of the laser (m) on first loading.

    master: rising coordinates, m kg^1/2. RuntimeError if a state does not settle.
    """
    shape, give, told = system.tangential
    kt, limit = sliders.tangential, sliders.friction * sliders.preload
    stuck = system.stiffness[:, 1].copy()
    g, settled = load_up(kt, limit, stuck, give, shape, master, _TOLERANCE)
    if settled < len(master):
        at = 1e6 * abs(system.laser[0] * master[settled])
        raise RuntimeError(
            f"the contacts of {system.mode} did not settle under first loading to {at:.3g} um "
            "at the laser"
        )
    return np.outer(master, [system.values[0], system.laser[0]]) + g @ told
