"""Friction of flanks whose pressure falls towards all their edges and is uneven in between.

A family with continuous parameters, for inference: the edges' pressure over the middle's, how fast
it falls to them, and how unevenly it is spread at random, as by waviness and roughness. Uniform
pressure is its limit; the punch of section 6.2 lies near an exponent of one half without pressure
at the edges.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np
from jaxtyping import Float
from numpy import ndarray
from scipy.special import ndtri

from bladeroot.contact.laws.sliders import Sliders
from bladeroot.nonlinear.flanks import even_preload
from bladeroot.nonlinear.system import System
from bladeroot.rom.joint import Joint

CONTACT_PARTS = 6  # equal parts of a contact, each with a pressure of its own
_GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)  # its multiples modulo one fill the unit interval evenly


@dataclass(frozen=True)
class Uneven:
    """friction: coefficient. edge: pressure at the edges over that in the middle. Between them its
    root of order `exponent` goes with 1 - d^2, where d is 1 at the edges and 0 in the middle.
    spread: standard deviation of ln pressure about that, from place to place.
    """

    friction: float = 0.42
    edge: float = 0.2
    exponent: float = 0.5
    spread: float = 0.3


def relative_pressure(joint: Joint, law: Uneven) -> Float[ndarray, " pair"]:
    """Pressure at each pair over its flank's mean, without the spread."""
    least = law.edge ** (1.0 / law.exponent)
    inwards = np.maximum(1.0 - joint.edge_distance**2, 0.0)
    raw = (least + (1.0 - least) * inwards) ** law.exponent
    flank, share = joint.flank, joint.area
    return raw * (np.bincount(flank, share) / np.bincount(flank, share * raw))[flank]


def uneven_sliders(joint: Joint, system: System, force: float, law: Uneven) -> Sliders:
    """Sliders of a system's contacts under an axial force (N), of constant normal load.

    The unevenness takes evenly spaced quantiles of its distribution, in a fixed order of places.
    """
    load = (even_preload(joint, force) * relative_pressure(joint, law))[system.pair]
    uneven = np.exp(law.spread * _dealt(load.size))
    uneven /= (system.count * load) @ uneven.mean(axis=1) / (system.count @ load)
    one = np.full(uneven.shape, 1.0 / CONTACT_PARTS)
    normal, tangential = system.stiffness.T[..., None] * one
    friction = np.full(uneven.shape, law.friction)
    return Sliders(normal, tangential, load[:, None] * one * uneven, friction, False)


@cache
def _dealt(contacts: int) -> Float[ndarray, "contact part"]:
    """Evenly spaced quantiles of a standard normal distribution, one for each part."""
    places = (_GOLDEN * np.arange(1, contacts * CONTACT_PARTS + 1)) % 1.0
    return ndtri(places).reshape(contacts, CONTACT_PARTS)
