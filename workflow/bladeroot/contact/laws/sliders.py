"""Sliders in parallel: the one mechanism that every contact law here is made of.

A slider is a normal and an isotropic tangential spring in series with a friction point. Its
force is what the contact adds to the static state, in which all springs are at rest under their
preload. The normal load varies with the motion, down to lift-off, or is kept constant.
"""

from dataclasses import dataclass
from typing import no_type_check

import numpy as np
from jaxtyping import Bool, Float
from numpy import ndarray

from bladeroot.compiled import njit


@dataclass(frozen=True)
class Sliders:
    """Sliders of contacts, all in parallel.

    normal, tangential: stiffness, N/m. preload: static normal load, N. friction: coefficient; a
    slider never slips where it is infinite. varies: whether friction follows the momentary normal
    load and the contact can lift off; else the normal spring is linear.
    """

    normal: Float[ndarray, "contact slider"]
    tangential: Float[ndarray, "contact slider"]
    preload: Float[ndarray, "contact slider"]
    friction: Float[ndarray, "contact slider"]
    varies: bool

    def __post_init__(self) -> None:
        """Refuse what is no slider; one layout in memory, for which kernels are compiled once."""
        for name in ("normal", "tangential", "preload", "friction"):
            values = np.ascontiguousarray(getattr(self, name))
            object.__setattr__(self, name, values)
            if not np.all(values >= 0.0):
                raise ValueError(f"{name} of sliders must not be negative, got {np.min(values)}")
        if np.isinf(self.friction).any() and not np.all(self.preload[np.isinf(self.friction)] > 0):
            raise ValueError("preload must be positive where friction is infinite")


def stuck_stiffness(sliders: Sliders) -> Float[ndarray, "contact 2"]:
    """Normal and tangential stiffness of each contact while it sticks, N/m."""
    return np.stack([sliders.normal.sum(axis=1), sliders.tangential.sum(axis=1)], axis=1)


def at_rest(sliders: Sliders) -> Float[ndarray, "contact slider 2"]:
    """The friction points' places in the static state, m."""
    return np.zeros((*sliders.tangential.shape, 2))


def parts(sliders: Sliders) -> tuple[ndarray, ndarray, ndarray, ndarray, bool]:
    """The fields in order, for kernels."""
    return (sliders.normal, sliders.tangential, sliders.preload, sliders.friction, sliders.varies)


def load(
    sliders: Sliders,
    motion: Float[ndarray, "contact 3"],
    state: Float[ndarray, "contact slider 2"],
) -> tuple[
    Float[ndarray, "contact 3"],
    Float[ndarray, "contact 3 3"],
    Float[ndarray, "contact slider 2"],
    Bool[ndarray, "contact slider"],
]:
    """One step to `motion` (normal, two tangential; m) from a state: monotonic loading.

    Returns force (N), its exact derivative by the motion (N/m), the new state (m) and which
    sliders slip.
    """
    return _load(*parts(sliders), motion, state)


def history(
    sliders: Sliders,
    motion: Float[ndarray, "time contact 3"],
    state: Float[ndarray, "contact slider 2"],
    seeds: Float[ndarray, "time contact 3 column"] | None = None,
) -> tuple[
    Float[ndarray, "time contact 3"],
    Float[ndarray, "contact slider 2"],
    Float[ndarray, "time contact 3 column"],
]:
    """Force (N) along a history of motion (m), the last state, and the force's derivative.

    seeds: derivative of the motion by any parameters, of which the start does not depend; the
    derivative of the force by the same ones is exact. Without seeds it has no columns.
    """
    if seeds is None:
        seeds = np.zeros((*motion.shape, 0))
    return _history(*parts(sliders), motion, state, seeds)


@njit(cache=True)
@no_type_check
def slide(kn, kt, n0, mu, varies, un, u1, u2, w1, w2):
    """One slider moved to (un, u1, u2) with its friction point at (w1, w2).

    Returns the normal force, its slope, the tangential force's limit, that limit's slope by un,
    the spring's stretch before slip (size, direction) and whether it slips.
    """
    normal, slope = kn * un, kn
    limit, steeper = mu * n0, 0.0
    if varies:
        if normal + n0 > 0.0:
            limit, steeper = mu * (normal + n0), mu * kn
        else:
            normal, slope, limit = -n0, 0.0, 0.0
    e1, e2 = u1 - w1, u2 - w2
    size = np.sqrt(e1 * e1 + e2 * e2)
    slips = kt * size > limit
    if slips:
        e1, e2 = e1 / size, e2 / size
    return normal, slope, limit, steeper, size, e1, e2, slips


@njit(cache=True)
@no_type_check
def _load(kn, kt, n0, mu, varies, motion, state):
    contacts, sliders = kn.shape
    force = np.zeros((contacts, 3))
    tangent = np.zeros((contacts, 3, 3))
    after = state.copy()
    slipping = np.zeros((contacts, sliders), dtype=np.bool_)
    for c in range(contacts):
        un, u1, u2 = motion[c]
        for s in range(sliders):
            k = kt[c, s]
            normal, slope, limit, steeper, size, e1, e2, slips = slide(
                kn[c, s], k, n0[c, s], mu[c, s], varies, un, u1, u2, state[c, s, 0], state[c, s, 1]
            )
            force[c, 0] += normal
            tangent[c, 0, 0] += slope
            slipping[c, s] = slips
            if slips:
                force[c, 1] += limit * e1
                force[c, 2] += limit * e2
                tangent[c, 1, 0] += steeper * e1
                tangent[c, 2, 0] += steeper * e2
                turn = limit / size  # a slip that turns keeps its size
                tangent[c, 1, 1] += turn * e2 * e2
                tangent[c, 1, 2] -= turn * e1 * e2
                tangent[c, 2, 1] -= turn * e1 * e2
                tangent[c, 2, 2] += turn * e1 * e1
                after[c, s, 0] = u1 - limit * e1 / k
                after[c, s, 1] = u2 - limit * e2 / k
            else:
                force[c, 1] += k * e1
                force[c, 2] += k * e2
                tangent[c, 1, 1] += k
                tangent[c, 2, 2] += k
    return force, tangent, after, slipping


@njit(cache=True)
@no_type_check
def _history(kn, kt, n0, mu, varies, motion, state, seeds):
    times, contacts = motion.shape[:2]
    columns = seeds.shape[3]
    force = np.zeros((times, contacts, 3))
    derivative = np.zeros((times, contacts, 3, columns))
    last = state.copy()
    moved = np.zeros((2, columns))  # the friction point's derivative
    for c in range(contacts):
        for s in range(kn.shape[1]):
            k = kt[c, s]
            w1, w2 = state[c, s]
            moved[:] = 0.0
            for t in range(times):
                un, u1, u2 = motion[t, c]
                normal, slope, limit, steeper, size, e1, e2, slips = slide(
                    kn[c, s], k, n0[c, s], mu[c, s], varies, un, u1, u2, w1, w2
                )
                force[t, c, 0] += normal
                if slips:
                    force[t, c, 1] += limit * e1
                    force[t, c, 2] += limit * e2
                    w1, w2 = u1 - limit * e1 / k, u2 - limit * e2 / k
                else:
                    force[t, c, 1] += k * e1
                    force[t, c, 2] += k * e2
                for p in range(columns):
                    dn, d1, d2 = seeds[t, c, 0, p], seeds[t, c, 1, p], seeds[t, c, 2, p]
                    derivative[t, c, 0, p] += slope * dn
                    f1, f2 = k * (d1 - moved[0, p]), k * (d2 - moved[1, p])
                    if slips:
                        across = limit * (e1 * f2 - e2 * f1) / (k * size)
                        f1, f2 = (
                            steeper * dn * e1 - across * e2,
                            steeper * dn * e2 + across * e1,
                        )
                        moved[0, p], moved[1, p] = d1 - f1 / k, d2 - f2 / k
                    derivative[t, c, 1, p] += f1
                    derivative[t, c, 2, p] += f2
            last[c, s] = w1, w2
    return force, last, derivative
