"""Free decays by time integration: Newmark's method or exact stepping, contacts by any law.

The linear part is that of stuck contacts in its modes, M q'' + C q' + K q = B^T g (3.15), with the
contacts' corrections g = k u - f(u, history) as its load; modes that are not kept answer at once,
through a residual flexibility. Implicit in the contact force, so the step is free of its stability.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.contact.laws.sliders import Sliders, at_rest, parts, stuck_stiffness
from bladeroot.nonlinear.marching import SWEEPS, correct, march, settle
from bladeroot.nonlinear.one_step import OneStep
from bladeroot.nonlinear.system import System

ENERGY_TOLERANCE = 2e-3  # of the energy at the start
_TOLERANCE = 1e-9  # of a step's contact motion, of the largest at the start


@dataclass(frozen=True)
class Decay:
    """A free decay: `velocity` (m/s) at the sensor and tangential motion (m) and
    force (N) of one contact.

    energy (J): stored at start and end; damped, rubbed (J): lost to damping and friction. sweeps:
    the most that one step needed.
    """

    velocity: Float[ndarray, " sample"]
    motion: Float[ndarray, "sample 2"]
    force: Float[ndarray, "sample 2"]
    energy: tuple[float, float]
    damped: float
    rubbed: float
    sweeps: int

    @property
    def energy_error(self) -> float:
        """Energy that is not accounted for, over the energy at the start."""
        lost = self.energy[0] - self.energy[1] - self.damped - self.rubbed
        return abs(lost) / self.energy[0]


def free_decay(
    system: System,
    sliders: Sliders,
    step: OneStep,
    start: Float[ndarray, " mode"],
    steps: int,
    every: int = 1,
    watched: int = 0,
    tolerance: float = ENERGY_TOLERANCE,
) -> Decay:
    """Release a system at rest and step on.

    sliders: the law of the system's contacts, as stiff as they while they stick. step: of its
    modes, from `one_step.newmark` or `one_step.exact`. start: modal displacement, kg^1/2 m, reached
    from the static state in one stroke: what slips on the way has slipped. every: steps a sample.
    watched: the contact whose motion is kept.

    Raises ValueError if the law is not one for the system or start is zero; RuntimeError if a step
    does not converge or the energy balance is not kept to `tolerance`.
    """
    if not np.any(start):
        raise ValueError("expected a start that is not zero")
    if sliders.normal.shape[0] != len(system.count) or not np.allclose(
        stuck_stiffness(sliders), system.stiffness, rtol=1e-6
    ):
        raise ValueError("the law's stiffness while stuck must be that of the system's contacts")
    used = slice(0 if sliders.varies else 1, None)  # a linear normal spring stays in the modes
    k = np.repeat(system.stiffness, (1, 2), axis=1)[:, used].copy()
    law = (*(np.ascontiguousarray(one, float) for one in parts(sliders)[:4]), bool(sliders.varies))
    count = system.count
    shape = system.shape[:, used].reshape(k.size, -1).T.copy()
    residual = system.flexibility[:, used][..., used].reshape(k.size, k.size).T.copy()
    r, v, w = np.array(start, float), np.zeros(system.values.size), at_rest(sliders)
    u = (r @ shape).reshape(k.shape)
    g, tension = np.zeros_like(u), np.zeros((*law[1].shape, 2))
    settled = _TOLERANCE * np.abs(u).max()
    # While the modes are held at the start the contacts answer through the residual alone.
    if not 0 < correct(*law, k, residual, settled, w, u, g) < SWEEPS:
        raise RuntimeError("the contacts did not settle at the start of the decay")
    settle(*law, count, u, w, tension)

    def stored() -> float:
        back = (g.ravel() @ residual).reshape(g.shape)
        contacts = ((g * back - k * u**2).sum(axis=1) + _strain(sliders, u, w)) @ count
        return 0.5 * float(v @ v + step.omega**2 @ r**2 + contacts)

    first = stored()
    velocity, seen, damped, rubbed, most, made = march(
        *law, k, count, shape, residual, step.matrix, step.loss, settled, steps, every,
        system.laser, watched, r, v, w, u, g, tension,
    )  # fmt: skip
    if made < steps:
        raise RuntimeError(
            f"the contacts' friction did not settle in step {made} of {steps}, "
            f"at {1e3 * made * step.dt:.4g} ms"
        )
    decay = Decay(velocity, *seen[:, :, -2:], (first, stored()), damped, rubbed, most)
    if not decay.energy_error <= tolerance:
        raise RuntimeError(
            f"energy balance: {decay.energy_error:.1e} of the energy at the start is not accounted "
            f"for, at most {tolerance:.1e} may be; a smaller step than {step.dt:.2e} s is needed"
        )
    return decay


def _strain(sliders: Sliders, u: ndarray, w: ndarray) -> Float[ndarray, " contact"]:
    """Twice the energy of each contact's springs, J; of the tangential ones if u has no other."""
    energy = sliders.tangential * ((u[:, None, -2:] - w) ** 2).sum(axis=2)
    if sliders.varies:  # an open contact pulls with the preload that it has lost
        stretched = sliders.normal * u[:, :1]
        gap = np.minimum(stretched + sliders.preload, 0.0)
        energy = energy + (stretched**2 - gap**2) / np.maximum(sliders.normal, 1e-300)
    return energy.sum(axis=1)
