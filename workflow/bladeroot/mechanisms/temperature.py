"""Frequencies that follow the temperature measured with each record, as a modulus does."""

import numpy as np

from bladeroot.mechanisms.mechanism import Mechanism, Parameter, Records, StickEffect


def stick(records: Records, values: np.ndarray) -> StickEffect:
    """All ln f alike, in proportion to the temperature."""
    return StickEffect(
        {"ln_f": values[0] * records.temperature}, {"ln_f": records.temperature[:, None]}
    )


MECHANISM = Mechanism(
    id="temperature",
    kind="time",
    sentence="the frequencies follow the temperature of the records",
    parameters=(
        Parameter(
            "slope", "1/K", -1.2e-4, 3e-4, -3e-3, 3e-3,
            "of ln f: steel's modulus falls by 2.4e-4 a kelvin; a rig that expands adds as much",
        ),
    ),
    splitter="the {rig} warmed by some kelvin, and nothing else changed",
    stick=stick,
    over=("temperature",),
)  # fmt: skip
