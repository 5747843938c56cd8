"""A mode as a problem of one degree of freedom, for causes that change matrices to act on."""

import numpy as np

from bladeroot.rom.ritz import Ritz


def one_mode() -> Ritz:
    """All stiffness in the body and all mass on it: a modulus moves it, contact does not."""
    one, none = np.ones((1, 1)), np.zeros((1, 1))
    display = np.zeros((2, 3, 1))
    display[:, 2] = 1.0
    return Ritz(
        beam=one, slots=none, geometric=none, springs=(none, none), beam_mass=one,
        contact=np.zeros((1, 3, 1)), display=display, display_x=np.array([-1.0, 1.0]),
        residual=np.zeros((1, 5)), own=1, rank=0, amplification=1.0,
    )  # fmt: skip
