"""A stuck joint whose losses depend on the axial force."""

import numpy as np

from bladeroot.mechanisms.mechanism import REFERENCE_FORCE, Mechanism, Parameter, Records


def power(records: Records, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Loss factors as a power of the force, of the other modes times a ratio."""
    return _of_modes(records, values, np.log(records.force / REFERENCE_FORCE))


def contact_part(records: Records, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """As far as the linear term goes, a part of the loss is as one over the force, the rest fixed.

    `exponent` is the slope at 12 kN in this form too.
    """
    return _of_modes(records, values, 1.0 - REFERENCE_FORCE / records.force)


def _of_modes(records: Records, values: np.ndarray, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    exponent, ratio = values
    other = records.mode > 0
    factor = np.where(other, ratio, 1.0)
    return exponent * factor * x, np.stack([factor * x, np.where(other, exponent * x, 0.0)], axis=1)


MECHANISM = Mechanism(
    id="force-dependent-damping",
    kind="force-law",
    sentence="the {stuck_joint}'s losses depend on the {load}, the frequencies as simulated",
    parameters=(
        Parameter(
            "exponent", "1", 0.0, 0.3, -1.5, 1.5,
            "of the loss factors over the force: a rubbing joint loses less the tighter it is",
        ),
        Parameter("ratio", "1", 1.0, 0.5, -3.0, 3.0, "another mode over the first", ratio=True),
    ),
    splitter="loss factors at twice the {force}; another lubricant",
    damping=power,
    form="power",
).also("contact's part", damping=contact_part)  # fmt: skip
