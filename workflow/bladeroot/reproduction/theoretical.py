"""Quantities of chapter 6 and of Appendices C and E: contact theory."""

from dataclasses import replace

import numpy as np

from bladeroot.contact import compliance
from bladeroot.contact.punch import Punch, punch_from
from bladeroot.reproduction.entry import Computed, Evidence


def normal_force(evidence: Evidence) -> Computed:
    """Normal force on a flank over the axial force at T = 0 (section 4.3)."""
    theory = evidence.stages["theory"]
    ratio = theory["normal_force_theory"].sel(friction_state="T = 0") / theory["force"]
    return {"": ratio.values[:1]}


def pressure_resultant(evidence: Evidence) -> Computed:
    """Per cent: largest difference between the pressure's integral and P, over the load ratios."""
    return {"": 100.0 * np.array([_resultant(evidence, "pressure", lambda ratio, mu: 1.0)])}


def shear_resultant(evidence: Evidence) -> Computed:
    """Per cent of mu P: largest difference between the shear's integral and Q."""
    return {"": 100.0 * np.array([_resultant(evidence, "shear", lambda ratio, mu: mu * ratio)])}


def _resultant(evidence: Evidence, name: str, expected) -> float:
    theory = evidence.stages["theory"]
    line = theory["profile_normal_force"] / theory.attrs["length"]
    scale = expected(1.0, theory.attrs["friction"]) * line
    whole = theory[name].integrate("position")
    wanted = expected(theory["load_ratio"], theory.attrs["friction"]) * line
    return float(np.abs((whole - wanted) / scale).max())


def stick_over_flat(evidence: Evidence) -> Computed:
    """Smallest half-width of the sticking part over the flat's, up to full sliding."""
    theory = evidence.stages["theory"]
    return {"": np.array([float(theory["profile_stick_half_width"].min())
                          / theory.attrs["flat_half_width"]])}  # fmt: skip


def least_step(evidence: Evidence, name: str) -> Computed:
    """Per cent: smallest step of the stiffness along the curve over the normal force."""
    line = evidence.stages["theory"][name]
    return {"": np.array([100.0 * float((line.diff("normal_force") / line.mean()).min())])}


def published_over_theory(evidence: Evidence, name: str) -> Computed:
    """Mean over the forces of Table 5.2 times 33 over theory at T = 0."""
    ratio = evidence.stages["theory"][f"{name}_published_ratio"].sel(friction_state="T = 0")
    return {"": np.array([float(ratio.mean())])}


def least_published_over_theory(evidence: Evidence, name: str) -> Computed:
    """Smallest ratio of Table 5.2 times 33 over theory, both states of friction."""
    return {"": np.array([float(evidence.stages["theory"][f"{name}_published_ratio"].min())])}


def growth_against_published(evidence: Evidence, name: str) -> Computed:
    """Relative growth of the theory's stiffness over the forces, over Table 5.2's."""
    theory = evidence.stages["theory"].sel(friction_state="T = 0").sortby("force")
    grown = [
        line.values[-1] / line.values[0] - 1.0
        for line in (theory[f"{name}_theory"], theory[f"{name}_published"].dropna("force"))
    ]
    return {"": np.array([grown[0] / grown[1]])}


def _punch(evidence: Evidence, flat_half_width: float) -> Punch:
    return replace(punch_from(evidence.parameters), flat_half_width=flat_half_width)


def dissipated_at_full_sliding(evidence: Evidence) -> Computed:
    """Energy of a cycle of a cylinder in units of (2/pi)^2 (mu P)^2 / E* a metre (App. C)."""
    punch = _punch(evidence, 0.0)
    force = np.array([1e4])
    energy = compliance.dissipated_energy(force, punch.friction * force, punch) / punch.length
    limit = punch.friction * force / punch.length
    return {"": energy / ((2.0 / np.pi) ** 2 * limit**2 / punch.contact_modulus)}


def approach_of_a_flat(evidence: Evidence) -> Computed:
    """Normal approach at 10 kN, flat of 0.8 mm half-width over a cylinder (App. E)."""
    force = np.array([1e4])
    approach = [compliance.normal_approach(force, _punch(evidence, a)) for a in (0.8e-3, 0.0)]
    return {"": approach[0] / approach[1]}
