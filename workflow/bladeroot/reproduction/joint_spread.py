"""What the spread of a calibrated geometry does to the joint: bonded frequencies, kn and kt."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.reproduction.calibration import Calibration, linearise
from bladeroot.reproduction.cases import Case
from bladeroot.reproduction.targets import Target

# N/m a flank: no gap opens or slips, yet modes far from it still converge.
BONDED = 1.0e12
MODES = ("1B", "2B")
_NEAR = 1e-3


@dataclass(frozen=True)
class JointSpread:
    """At one axial force: bonded frequencies and their derivatives; ln kn, ln kt by parameter.

    `ln_stiffness` is how ln kn and ln kt move per unit of a parameter if the frequencies are kept.
    """

    force: float
    bonded: Float[ndarray, "mode"]
    bonded_jacobian: Float[ndarray, "mode parameter"]
    ln_stiffness: Float[ndarray, "2 parameter"]


def joint_spread(
    asked: Calibration,
    point: Float[ndarray, " parameter"],
    force: float,
    stiffness: tuple[float, float],
) -> JointSpread:
    """The joint at a calibrated geometry, at `force` (N) and near kn, kt (N/m a flank)."""
    kn, kt = stiffness
    near = np.exp(_NEAR)
    contacts = [(BONDED, BONDED), (kn, kt), (kn * near, kt), (kn, kt * near)]
    targets = [
        Target("joint", mode, Case(True, force, *contact, slots=True), 0.0, 0.0, 1.0)
        for contact in contacts
        for mode in MODES
    ]
    linear = linearise(replace(asked, targets=targets), point)
    bonded, soft, normal, tangential = linear.values.reshape(4, -1)
    jacobian = linear.jacobian.reshape(4, len(MODES), -1)
    by_stiffness = np.stack([normal - soft, tangential - soft], axis=1) / _NEAR
    return JointSpread(force, bonded, jacobian[0], -np.linalg.solve(by_stiffness, jacobian[1]))
