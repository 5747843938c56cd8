"""Segalman's four-parameter Iwan element: a population of sliders, so that slip begins at once.

The density of sliders over the stretch phi at which they slip is R phi^chi up to phi_max, with a
peak S at phi_max (J. Appl. Mech. 72, 2005, 752). Here in its four observable parameters.
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.contact.laws.sliders import Sliders

_RESOLVED_DECADES = 5.0  # of stretch below phi_max that are resolved; the rest is one slider


def iwan(
    normal: Float[ndarray, " contact"],
    tangential: Float[ndarray, " contact"],
    preload: Float[ndarray, " contact"],
    friction: float,
    chi: float = -0.5,
    beta: float = 0.0,
    sliders: int = 40,
) -> Sliders:
    """Contacts with tangential stiffness (N/m) at rest that slip as a whole at friction * preload.

    chi: -1 < chi, the exponent of small slip: a cycle's loss grows with amplitude to chi + 3. beta:
    not negative, stiffness that leaves at the last slip over all that left before. Each slider
    takes exactly the stiffness and the force of its share of the population. ValueError for
    parameters out of range.
    """
    if not chi > -1.0 or not beta >= 0.0 or sliders < 2:
        raise ValueError(
            f"chi must be above -1, beta not negative and sliders at least 2, "
            f"got {chi}, {beta}, {sliders}"
        )
    # In units of phi_max; R phi_max^(chi + 1) / (chi + 1) is the stiffness of all but the peak.
    edge = np.append(0.0, np.geomspace(10.0**-_RESOLVED_DECADES, 1.0, sliders - 1))
    stiffness = np.append(np.diff(edge ** (chi + 1.0)), beta) / (1.0 + beta)
    force = np.append(np.diff(edge ** (chi + 2.0)) * (chi + 1.0) / (chi + 2.0), beta)
    share = force / force.sum()
    if beta == 0.0:
        stiffness, share = stiffness[:-1], share[:-1]
    count = len(share)
    return Sliders(
        np.repeat(normal[:, None] / count, count, axis=1),
        tangential[:, None] * stiffness,
        preload[:, None] * share,
        np.full((len(normal), count), friction),
        False,
    )
