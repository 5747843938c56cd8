"""Pressure over the flank's width, as the share of the normal load on one side of a place.

A profile maps places s, from 0 at one edge of the contact to 1 at the other, to that share.
"""

from collections.abc import Callable

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.contact.punch import Punch, contact_half_width, pressure

Profile = Callable[[Float[ndarray, "..."]], Float[ndarray, "..."]]


def power_profile(exponent: float) -> Profile:
    """Pressure in proportion to (s (1 - s))^exponent: 0 is uniform, 0.5 elliptic (Hertz).

    The larger the exponent, the less pressure is left at the edges. ValueError unless above -1.
    """
    from scipy.special import betainc

    if not exponent > -1.0:
        raise ValueError(f"the exponent of a pressure profile must be above -1, got {exponent}")
    return lambda place: betainc(exponent + 1.0, exponent + 1.0, place)


def punch_profile(punch: Punch, normal_force: float, points: int = 2001) -> Profile:
    """The flat punch with rounded edges under a normal force (N) on its whole length (eq. 6.4)."""
    line_load = normal_force / punch.length
    b = float(contact_half_width(line_load, punch))
    # Dense at the rims, where pressure starts like a root; in the angle it starts like a square.
    angle = np.linspace(0.0, np.pi, points)
    density = pressure(-b * np.cos(angle), line_load, punch) * np.sin(angle)
    share = np.append(0.0, np.cumsum(0.5 * (density[1:] + density[:-1])))
    share /= share[-1]

    def profile(place):
        return np.interp(np.arccos(1.0 - 2.0 * np.asarray(place)), angle, share)

    return profile
