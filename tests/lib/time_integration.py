"""Free decays by time integration: Newmark's method or exact stepping, contacts by any law.

The linear part is that of stuck contacts in its modes, M q'' + C q' + K q = B^T g (3.15), with the
contacts' corrections g = k u - f(u, history) as its load; modes that are not kept answer at once,
through a residual flexibility. Implicit in the contact force, so the step is free of its stability.
"""

from dataclasses import dataclass
from typing import no_type_check

import numpy as np
from bladeroot.compiled import njit
from bladeroot.contact.laws.sliders import Sliders, at_rest, parts
from bladeroot.nonlinear.system import System
from jaxtyping import Float
from numpy import ndarray
from one_step import OneStep
from sweeps import SWEEPS, contact_force, correct, settle

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
    stuck = np.stack([sliders.normal.sum(axis=1), sliders.tangential.sum(axis=1)], axis=1)
    if len(stuck) != len(system.count) or not np.allclose(stuck, system.stiffness, rtol=1e-6):
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


@njit(cache=True)
@no_type_check
def any_moves(kn, kt, n0, mu, varies, u, w, g, force, tangent):
    """Whether a contact leaves its stuck state, or is not in it."""
    for c in range(u.shape[0]):
        if contact_force(kn[c], kt[c], n0[c], mu[c], varies, u[c], w[c], force, tangent):
            return True
        if varies and g[c, 0] != 0.0:
            return True
    return False


@njit(cache=True)
@no_type_check
def march(
    kn, kt, n0, mu, varies, stuck, count, shape, residual, step, loss, tolerance, steps, every,
    laser, watched, r, v, w, u, g, tension,
):  # fmt: skip
    """Step on; r, v, w, u, g and the sliders' tension are changed in place.

    count: images of each contact, which all push. shape (mode, motion). residual: row k is the
    motion of all, by the modes not kept, for correction k on all its images. Returns velocity at
    the samples, motion and force of the watched contact there, the work of damping and of friction
    (J), the most sweeps of a step and the number of steps made: fewer than asked if one did not
    settle.
    """
    modes = shape.shape[0]
    size = u.shape[1]
    samples = steps // every + 1
    velocity = np.zeros(samples)
    seen = np.zeros((2, samples, size))
    damped, rubbed, most = 0.0, 0.0, 0
    push = shape * np.repeat(count, size)
    give = residual + (push.T * step[:, 0, 3]) @ shape
    flat, flat_g = u.reshape(-1), g.reshape(-1)
    held = flat_g.copy()
    back = flat - shape.T @ r  # what the corrections move through the residual
    load0 = push @ flat_g
    load1, ahead = load0.copy(), np.empty(modes)
    z = np.empty(4)
    force, tangent = np.empty(size), np.empty((size, size))
    for n in range(steps + 1):
        if n % every == 0:
            at = n // every
            velocity[at] = laser @ v
            seen[0, at] = u[watched]
            seen[1, at] = stuck[watched] * u[watched] - g[watched]
        if n == steps:
            break
        flat[:] = back
        for m in range(modes):
            ahead[m] = (
                step[m, 0, 0] * r[m]
                + step[m, 0, 1] * v[m]
                + (step[m, 0, 2] + step[m, 0, 3]) * load0[m]
            )
            for k in range(flat.size):
                flat[k] += shape[m, k] * ahead[m]
        if any_moves(kn, kt, n0, mu, varies, u, w, g, force, tangent):
            sweeps = correct(kn, kt, n0, mu, varies, stuck, give, tolerance, w, u, g)
            if sweeps < 0 or sweeps == SWEEPS:
                return velocity, seen, damped, rubbed, most, n
            most = max(most, sweeps)
            back[:] = flat
            for m in range(modes):
                for k in range(flat.size):
                    load1[m] += push[m, k] * (flat_g[k] - held[k])
                ahead[m] += step[m, 0, 3] * (load1[m] - load0[m])
                for k in range(flat.size):
                    back[k] -= shape[m, k] * ahead[m]
            held[:] = flat_g
            rubbed += settle(kn, kt, n0, mu, varies, count, u, w, tension)
        else:
            settle(kn, kt, n0, mu, varies, count, u, w, tension)
        for m in range(modes):
            z[0], z[1], z[2], z[3] = r[m], v[m], load0[m], load1[m]
            fast = 0.0
            for a in range(4):
                fast += step[m, 1, a] * z[a]
                for b in range(4):
                    damped += z[a] * loss[m, a, b] * z[b]
            r[m], v[m], load0[m] = ahead[m], fast, load1[m]
    return velocity, seen, damped, rubbed, most, steps
