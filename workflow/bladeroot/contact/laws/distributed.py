"""Coulomb friction under a pressure that varies over the flank's width: edges slip first.

Each contact stands for a part of the flank's width, cut into strips. A strip has its part of the
stiffness by width and of the normal load by pressure.
"""

from dataclasses import replace

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.contact.laws.profiles import Profile
from bladeroot.contact.laws.sliders import Sliders


def distributed(
    law: Sliders, place: Float[ndarray, "contact 2"], profile: Profile, strips: int = 8
) -> Sliders:
    """Split contacts of one slider each, made for uniform pressure, into strips under a profile.

    place: where each contact begins and ends, in parts of the flank's width. strips: of each
    contact, denser towards the flank's edges.
    """
    if law.tangential.shape[1] != 1:
        raise ValueError(f"expected one slider a contact, got {law.tangential.shape[1]}")
    angle = np.arccos(1.0 - 2.0 * place)
    edges = 0.5 * (1.0 - np.cos(np.linspace(angle[:, 0], angle[:, 1], strips + 1, axis=1)))
    whole = place[:, 1:] - place[:, :1]
    width = np.diff(edges, axis=1) / whole
    force = np.maximum(np.diff(profile(edges), axis=1), 0.0) / whole
    return replace(
        law,
        normal=law.normal * width,
        tangential=law.tangential * width,
        preload=law.preload * force,
        friction=np.repeat(law.friction, strips, axis=1),
    )
