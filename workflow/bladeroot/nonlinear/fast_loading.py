"""First loading and Masing's rules for many curves: what inference asks for thousands of times.

The states are those of `quasi_static`, with the mode's own frequency in its inertia kept at that of
sticking; they are found by the sweeps of the time integration, which is ten times as fast.
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray
from scipy.interpolate import PchipInterpolator

from bladeroot.contact.laws.sliders import Sliders, at_rest, parts
from bladeroot.nonlinear.marching import load_up
from bladeroot.nonlinear.masing import first_harmonic
from bladeroot.nonlinear.system import System

_A_DECADE, _BELOW = 24, 8.0
_TOLERANCE = 1e-6
# To each side, of ln A, for slopes: across the slips of several friction points, not one's.
_APART = 0.1


def softening_curve(
    system: System, sliders: Sliders, amplitudes: Float[ndarray, " amplitude"]
) -> tuple[Float[ndarray, "2 amplitude"], Float[ndarray, "2 amplitude"]]:
    """Fall of the frequency f / f_stick - 1 and friction's loss factor, and both's slope by ln A.

    amplitudes: m, at the laser, rising. sliders: of constant normal load. ValueError for another
    law; RuntimeError if a state does not settle, or if the laser's motion does not rise with the
    mode's.
    """
    if sliders.varies:
        raise ValueError("first loading with Masing's rules needs constant normal load")
    low, high = amplitudes[0] / _BELOW, 1.3 * amplitudes[-1]
    count = 2 + int(_A_DECADE * np.log10(high / low))
    master = np.geomspace(low, high, count) / abs(system.laser[0])
    load, laser = states(system, sliders, master)
    slope = np.array([system.values[0], system.laser[0]])
    cosine, sine = first_harmonic(master, np.column_stack([load, laser]), slope)
    value = cosine[:, 0] / master
    rows = np.stack([np.sqrt(value / system.values[0]) - 1.0, -sine[:, 0] / cosine[:, 0]])
    seen = np.log(np.abs(cosine[:, 1]))
    if not np.all(np.diff(seen) > 0.0):
        raise RuntimeError(f"the motion at the laser does not rise with that of {system.mode}")
    fit = PchipInterpolator(seen, rows, axis=1)
    at = np.log(amplitudes)
    return fit(at), (fit(at + _APART) - fit(at - _APART)) / (2.0 * _APART)


def states(system: System, sliders: Sliders, master: ndarray) -> tuple[ndarray, ndarray]:
    """Load on the master coordinate (N kg^-1/2) and motion of the laser (m) on first loading.

    master: rising coordinates, m kg^1/2. RuntimeError if a state does not settle.
    """
    k = system.stiffness[:, [1, 1]].copy()
    shape = system.shape[:, 1:].reshape(k.size, -1)
    pushed = shape * np.repeat(system.count, 2)[:, None]
    others = 1.0 / (system.values[1:] - system.values[0])
    give = system.flexibility[:, 1:][..., 1:].reshape(k.size, k.size)
    give = (give + (shape[:, 1:] * others) @ pushed[:, 1:].T).T.copy()
    at_laser = system.laser_flexibility[:, 1:].ravel()
    at_laser = at_laser + pushed[:, 1:] @ (others * system.laser[1:])
    law = (*(np.ascontiguousarray(one, float) for one in parts(sliders)[:4]), False)
    g, settled = load_up(
        *law, k, system.count, give, shape[:, 0].copy(), master, _TOLERANCE, at_rest(sliders)
    )
    if settled < len(master):
        at = 1e6 * abs(system.laser[0] * master[settled])
        raise RuntimeError(
            f"the contacts of {system.mode} did not settle under first loading to {at:.3g} um "
            "at the laser"
        )
    return system.values[0] * master - g @ pushed[:, 0], system.laser[0] * master + g @ at_laser
