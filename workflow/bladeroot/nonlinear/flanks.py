"""The flanks' contact law: preload of every pair from the static state, and its part of the width.

A flank carries F / (2 |n_x|) of the axial force (section 6.5, T = 0). Along the beam's width it is
shared among the lines of pairs evenly, or as the elastic bodies share it; across the flank a
pressure profile decides.
"""

from dataclasses import dataclass

import numpy as np
import scipy.linalg
from jaxtyping import Float
from numpy import ndarray

from bladeroot.contact.laws.coulomb import coulomb
from bladeroot.contact.laws.distributed import distributed
from bladeroot.contact.laws.iwan import iwan
from bladeroot.contact.laws.jenkins import jenkins
from bladeroot.contact.laws.linear import linear
from bladeroot.contact.laws.profiles import power_profile, punch_profile
from bladeroot.contact.laws.sliders import Sliders
from bladeroot.contact.punch import Punch
from bladeroot.nonlinear.system import System
from bladeroot.rom.joint import Joint, described, stable_factor, stiffness_at

LAWS = ("linear", "jenkins", "coulomb", "iwan")
PRELOADS = ("even", "elastic")
# Tangential over normal stiffness of flanks without friction; at zero the beam could drift off.
_FRICTIONLESS = 1e-5


@dataclass(frozen=True)
class FlankContact:
    """What is assumed of all flanks.

    law: one of `LAWS`. friction: coefficient. pressure: over the flank's width, the exponent of
    `power_profile` or "punch" (eq. 6.4, for which `punch` is needed). preload: "even" or "elastic"
    among the pairs. strips: of each pair across the width, where pressure is not uniform. An iwan
    contact has its own population of sliders instead.
    """

    law: str = "jenkins"
    friction: float = 0.42
    pressure: float | str = 0.0
    preload: str = "even"
    strips: int = 8
    punch: Punch | None = None

    def __post_init__(self) -> None:
        """Refuse unknown laws, preloads and pressures."""
        if self.law not in LAWS:
            raise ValueError(f"the contact law must be one of {', '.join(LAWS)}, got {self.law!r}")
        if self.preload not in PRELOADS:
            raise ValueError(
                f"the preload must be one of {', '.join(PRELOADS)}, got {self.preload!r}"
            )
        if isinstance(self.pressure, str) and (self.pressure != "punch" or self.punch is None):
            raise ValueError(
                f"pressure must be an exponent, or 'punch' with its punch, got {self.pressure!r}"
            )


def flank_sliders(
    joint: Joint, system: System, point: Float[ndarray, "3"], contact: FlankContact
) -> Sliders:
    """Sliders of a system's contacts at (ln kn, ln kt, F)."""
    kn, kt = system.stiffness.T
    if contact.law == "linear":
        return linear(kn, kt)
    even = contact.preload == "even"
    preload = even_preload(joint, point[2]) if even else elastic_preload(joint, point)
    load = np.bincount(system.image, preload) / system.count
    law = {"jenkins": jenkins, "coulomb": coulomb, "iwan": iwan}[contact.law]
    sliders = law(kn, kt, load, contact.friction)
    if contact.law == "iwan" or contact.pressure == 0.0:
        return sliders
    if contact.pressure == "punch":
        profile = punch_profile(contact.punch, preload.sum() / len(np.unique(joint.flank)))
    else:
        profile = power_profile(contact.pressure)
    return distributed(sliders, width_places(joint)[system.pair], profile, contact.strips)


def even_preload(joint: Joint, force: float) -> Float[ndarray, " pair"]:
    """Normal load of each pair (N) under the axial force (N), in proportion to its area."""
    return joint.weight * force / (2.0 * np.abs(joint.normal[:, 0]))


def elastic_preload(joint: Joint, point: Float[ndarray, "3"]) -> Float[ndarray, " pair"]:
    """Normal load of each pair (N) as the elastic bodies share it, without friction.

    The slots are pulled apart until they carry the axial force; the contact has the normal
    stiffness of the point (ln kn, ln kt, F). A pair that would be torn open carries nothing.
    """
    kn = np.exp(point[0])
    smooth = np.array([point[0], point[0] + np.log(_FRICTIONLESS), point[2]])
    normal = joint.normal[:, 0]
    end = np.sign(joint.assembly["pair_position"].values[:, 0])
    approach = -np.sqrt(joint.weight) * end * normal  # of slots moved out by one metre
    factor = (stable_factor(stiffness_at(joint, smooth), described(smooth)), True)
    gap = approach - joint.gap @ scipy.linalg.cho_solve(factor, kn * joint.gap.T @ approach)
    load = np.maximum(np.sqrt(joint.weight) * gap, 0.0)
    return load * point[2] / (0.5 * (load * np.abs(normal)).sum())


def width_places(joint: Joint) -> Float[ndarray, "pair 2"]:
    """Where each pair's part of the flank's width begins and ends, 0 to 1 along the slope."""
    assembly = joint.assembly
    weight = assembly["weight"].values
    y = np.round(assembly["pair_position"].values[:, 1], 7)
    along = np.einsum("pa,pa->p", assembly["frame"].values[:, 2], assembly["pair_position"].values)
    line = np.unique(np.stack([assembly["flank"].values, y], axis=1), axis=0, return_inverse=True)[
        1
    ].ravel()
    order = np.lexsort((along, line))
    total = np.bincount(line, weight)[line]
    passed = np.cumsum(weight[order])
    start = np.empty(len(weight))
    start[order] = passed - weight[order]
    start -= np.array([start[line == one].min() for one in range(line.max() + 1)])[line]
    edges = np.stack([start, start + weight], axis=1) / total[:, None]
    return np.clip(edges, 0.0, 1.0)
