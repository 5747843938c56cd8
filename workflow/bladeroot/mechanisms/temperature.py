"""Frequencies that follow the temperature measured with each record, as a modulus does."""

import numpy as np

from bladeroot.mechanisms.drift import HELD, law
from bladeroot.mechanisms.mechanism import Mechanism, Parameter, Records


def measured(records: Records, _: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """In proportion to the temperature."""
    return records.temperature, np.zeros((records.temperature.size, 1))


MECHANISM = Mechanism(
    id="temperature",
    kind="time",
    sentence="the frequencies follow the temperature of the records",
    parameters=(
        Parameter(
            "slope", "1/K", -1.2e-4, 3e-4, -3e-3, 3e-3,
            "of ln f: steel's modulus falls by 2.4e-4 a kelvin; a rig that expands adds as much",
        ),
        HELD,
    ),
    splitter="the {rig} warmed by some kelvin, and nothing else changed",
    stick=law(measured),
    over=("temperature",),
    moves_load=False,
)  # fmt: skip
