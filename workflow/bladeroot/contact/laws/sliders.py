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
