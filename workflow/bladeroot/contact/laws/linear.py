"""Linear contact: springs that never slip nor lift off (eq. 5.3)."""

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.contact.laws.sliders import Sliders


def linear(normal: Float[ndarray, " contact"], tangential: Float[ndarray, " contact"]) -> Sliders:
    """Contacts of normal and tangential stiffness (N/m)."""
    one = np.ones((len(normal), 1))
    return Sliders(normal[:, None], tangential[:, None], one, np.inf * one, False)
