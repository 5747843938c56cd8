"""Jenkins's element: spring and friction point in series, constant normal load (sec. 3.3)."""

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.contact.laws.sliders import Sliders


def jenkins(
    normal: Float[ndarray, " contact"],
    tangential: Float[ndarray, " contact"],
    preload: Float[ndarray, " contact"],
    friction: float,
) -> Sliders:
    """Contacts of normal and tangential stiffness (N/m) that slip at friction times preload (N).

    The normal spring is linear; slip is isotropic in the contact's plane.
    """
    limit = np.full((len(normal), 1), friction)
    return Sliders(normal[:, None], tangential[:, None], preload[:, None], limit, False)
