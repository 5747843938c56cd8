"""A mode as a problem of one degree of freedom, for causes that change matrices to act on."""

from dataclasses import replace

import numpy as np
from numpy import ndarray

from bladeroot.diagnosis.structures import solved_change
from bladeroot.mechanisms.mechanism import Mechanism, Records
from bladeroot.rom.ritz import Ritz


class OneMode:
    """A simulation of records whose modes are of one degree of freedom each."""

    records: Records

    def structures(
        self, theta: ndarray, one: Mechanism, values: ndarray, changed: ndarray
    ) -> tuple[ndarray, ndarray, ndarray]:
        """Changed matrices, which do the same to all modes."""
        alike = replace(self.records, mode=np.zeros_like(self.records.mode))
        return solved_change(alike, [one_mode()], one, values, np.zeros((alike.mode.size, 3)))


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
