"""The flanks at some amplitudes: hysteresis loops of the mode, and where slip is."""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.contact.laws.sliders import Sliders
from bladeroot.nonlinear.curves import mode_curve
from bladeroot.nonlinear.fast_loading import states
from bladeroot.nonlinear.system import System
from bladeroot.rom.joint import Joint
from bladeroot.variables import dataset

_LOADING_STATES = 80  # of the first loading, from which a loop is made


def pictures(
    joint: Joint, system: System, sliders: Sliders, amplitudes: Sequence[float]
) -> xr.Dataset:
    """Hysteresis loops of a mode and slip of every pair at amplitudes (m) at the laser.

    The loop's motion is that at the laser (m); its force is the stuck mode's restoring force less
    the actual one, referred to the laser (N), so that a stuck cycle is a flat line.
    """
    laser = abs(system.laser[0])
    motion, force = [], []
    for amplitude in amplitudes:
        master = np.linspace(0.0, amplitude / laser, _LOADING_STATES + 1)[1:]
        load = states(system, sliders, master)[:, 0]
        q, f = loop(master, load)
        motion.append(q * laser)
        force.append((system.values[0] * q - f) / laser)
    rising = np.unique(np.asarray(amplitudes, float))
    slip = mode_curve(system, sliders, rising).slip[:, system.image]
    order = np.searchsorted(rising, amplitudes)
    flank = joint.flank
    along = np.einsum(
        "pla,pa->pl",
        joint.assembly["frame"].values[:, 1:],
        joint.assembly["pair_position"].values,
    )
    made = {
        "loop_motion": np.array(motion),
        "loop_force": np.array(force),
        "slip": slip[order],
        "pair_flank": flank,
        "pair_along": along,
        "picture_amplitude": np.asarray(amplitudes, float),
        "direction": ["along Y", "along slope"],
    }
    return dataset("nonlinear/pictures", made).assign_attrs(picture_mode=system.mode)


def loop(
    motion: Float[ndarray, " point"], loading: Float[ndarray, " point"], points: int = 200
) -> tuple[Float[ndarray, " sample"], Float[ndarray, " sample"]]:
    """The closed loop (motion, force) of a cycle, from its first loading by Masing's rule."""
    rise = np.linspace(0.0, 2.0 * motion[-1], points)
    doubled = 2.0 * np.interp(0.5 * rise, np.append(0.0, motion), np.append(0.0, loading))
    down, force = motion[-1] - rise, loading[-1] - doubled
    return np.concatenate([down, -down]), np.concatenate([force, -force])
