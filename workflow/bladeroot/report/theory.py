"""The section on contact theory: what chapter 6 predicts beside what was identified."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from bladeroot.report.numbers import fixed, listed, significant
from bladeroot.report.page import Picture, Section, Table

_HEADER = ("force / kN", "state", "theory kn / N/mm", "theory kt / N/mm", "thesis kn / theory",
           "thesis kt / theory")  # fmt: skip


TRACTIONS = (
    "Pressure and shear across the flank at {:g} kN axial force for several ratios of tangential "
    "to limiting force (figs 6.4, 6.5); grey: the flat part."
)
NORMAL = (
    "Tangential and normal stiffness of a flank against the normal force on it at T = 0 (figs 6.7, "
    "6.8)."
)
COMPARED = (
    "Stiffness of one flank against axial force: theory without tangential load (T = 0) and at the "
    "limit of friction (T = µN), Table 5.2 times 33 (6.16), and ours with one standard deviation "
    "(measurement and model bias)."
)


def theory_section(
    theory: xr.Dataset, stiffness: xr.Dataset, drawn: Mapping[str, Sequence[Picture]]
) -> Section:
    """Traction profiles, stiffness against force in both limits of friction, ratios.

    drawn: tractions, against_normal_force and compared.
    """
    rows = []
    for force in theory["force"].values:
        for state in theory["friction_state"].values:
            here = theory.sel(force=force, friction_state=state)
            rows.append(
                (
                    f"{force / 1e3:g}",
                    state.replace("mu", "µ"),
                    fixed(float(here["kn_theory"]) / 1e3, 0),
                    fixed(float(here["kt_theory"]) / 1e3, 0),
                    significant(float(here["kn_published_ratio"]), 3),
                    significant(float(here["kt_published_ratio"]), 3),
                )
            )
    parts = [
        "A flat punch with rounded edges on a half-space (6.3 to 6.15), smooth and elastic. Only "
        "the contact's half-width depends on the force, and only through a logarithm: theory "
        "predicts stiffness that hardly grows with the force, and a tangential one below the "
        "normal one.",
        *drawn["tractions"],
        *drawn["against_normal_force"],
        _sensitivity_table(theory),
        *drawn["compared"],
        Table(
            "Theory of a flank; where the thesis has the force, its stiffness over theory",
            _HEADER,
            rows,
        ),
        *_own_ratios(theory, stiffness),
        "Equation (6.5) is used with 2PR, which alone tends to Hertz's line contact; the printed "
        f"4PR would change kn by {_printed_effect(theory)}.",
    ]
    return Section("Contact theory", parts)


def _sensitivity_table(theory: xr.Dataset) -> Table:
    symbols = {"flat_half_width": "flat half-width a", "edge_radius": "edge radius R",
               "length": "length L", "youngs_modulus": "Young's modulus E",
               "poisson_ratio": "Poisson's ratio"}  # fmt: skip
    rows = [
        (
            symbols[str(name)],
            fixed(float(theory["kn_sensitivity"].sel(parameter=name)), 3),
            fixed(float(theory["kt_sensitivity"].sel(parameter=name)), 3),
        )
        for name in theory["parameter"].values
    ]
    header = ("one per cent more of", "changes kn by / %", "changes kt by / %")
    return Table(
        "Sensitivity of the theoretical stiffness at the lowest force, T = 0", header, rows
    )


def _own_ratios(theory: xr.Dataset, stiffness: xr.Dataset) -> list[str]:
    sentences = []
    for structure in stiffness["structure"].values:
        here = stiffness.sel(structure=structure)
        ratios = [
            float((here[name] / theory[f"{name}_theory"].sel(friction_state="T = 0")).median())
            for name in ("kn", "kt")
        ]
        if np.isfinite(ratios).all():
            texts = [
                f"{n} {significant(r, 2)} times" for n, r in zip(("kn", "kt"), ratios, strict=True)
            ]
            sentences.append(
                f"With {structure} the identified stiffness is {listed(texts)} the theoretical one "
                "at T = 0 (median over the forces that have a root)."
            )
    return sentences


def _printed_effect(theory: xr.Dataset) -> str:
    change = np.abs(theory["kn_printed"] / theory["kn"] - 1).max()
    return f"at most {100 * float(change):.1f} %"
