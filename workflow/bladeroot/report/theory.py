"""The section on contact theory: what chapter 6 predicts beside what was identified."""

from collections.abc import Mapping, Sequence

import xarray as xr

from bladeroot.report.numbers import fixed, significant
from bladeroot.report.page import Picture, Section, Table

_HEADER = ("force / kN", "state", "theory kn / N/mm", "theory kt / N/mm")
_PUBLISHED = ("thesis kn / theory", "thesis kt / theory")


TRACTIONS = (
    "Pressure and shear across the flank at {:g} kN axial force for several ratios of tangential "
    "to limiting force (figs 6.4, 6.5); grey: the flat part."
)
COMPARED = (
    "Stiffness of one flank against axial force: theory without tangential load (T = 0) and at the "
    "limit of friction (T = µN), {}and ours with one standard deviation (measurement and model "
    "bias)."
)


def theory_section(theory: xr.Dataset, drawn: Mapping[str, Sequence[Picture]]) -> Section:
    """Traction profiles, stiffness against force in both limits of friction, ratios.

    drawn: tractions and compared.
    """
    rows = []
    ratios = [name for name in ("kn_published_ratio", "kt_published_ratio") if name in theory]
    for force in theory["force"].values:
        for state in theory["friction_state"].values:
            here = theory.sel(force=force, friction_state=state)
            rows.append(
                (
                    f"{force / 1e3:g}",
                    state.replace("mu", "µ"),
                    fixed(float(here["kn_theory"]) / 1e3, 0),
                    fixed(float(here["kt_theory"]) / 1e3, 0),
                    *(significant(float(here[name]), 3) for name in ratios),
                )
            )
    parts = [
        "A flat punch with rounded edges on a half-space (6.3 to 6.15), smooth and elastic. Only "
        "the contact's half-width depends on the force, and only through a logarithm: theory "
        "predicts stiffness that hardly grows with the force, and a tangential one below the "
        "normal one.",
        *drawn["tractions"],
        *drawn["compared"],
        Table(
            "Theory of a flank"
            + "; where the thesis has the force, its stiffness over theory" * bool(ratios),
            (*_HEADER, *_PUBLISHED[: len(ratios)]),
            rows,
        ),
    ]
    return Section("Contact theory", parts)
