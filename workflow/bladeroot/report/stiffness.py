"""The section on kn and kt: what was found with each structure, and how certain it is."""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from bladeroot.report.numbers import NONE, fixed, listed, percent, significant
from bladeroot.report.page import Picture, Section, Table

DETERMINED = ("root", "fit")  # status where the frequencies alone give kn and kt
_HEADER = (
    "structure", "force / kN", "kn nodal / N/mm", "kt nodal / N/mm", "std ln kn", "std ln kt",
    "measured part", "correlation", "draws with a root",
)  # fmt: skip
_MISS_HEADER = (
    "structure", "force / kN", "model must move, 1B", "model must move, 2B", "in its stds",
    "draws with a root",
    "bonded 1B / Hz", "bonded 2B / Hz", "measured 1B / Hz", "measured 2B / Hz",
)  # fmt: skip


MAPS = (
    "Lines of constant frequency over (kn, kt). Thick: the measured stick frequency of each mode, "
    "the band one standard deviation with the model's bias. Where the two thick lines cross, the "
    "pair of frequencies has a root; else none exists."
)


def stiffness_section(
    stiffness: xr.Dataset, drawn: Sequence[Picture], score: xr.Dataset | None
) -> Section:
    """Roots and missing roots, the maps, the laws over force, the bench's truth."""
    roots, misses = [], []
    for structure in stiffness["structure"].values:
        for force in stiffness["force"].values:
            found = stiffness.sel(structure=structure, force=force)
            status = found["status"].item()
            if status in DETERMINED:
                roots.append(_root_row(found, structure, force))
            elif status == "no root":
                misses.append(_miss_row(found, structure, force))
    if not roots and not misses and not (stiffness["status"] == "prior").any():
        return Section(
            "Contact stiffness",
            [
                "No force of the simulation has measured frequencies of both modes: force by "
                "force there is no search for kn and kt."
            ],
        )
    parts: list = [
        "At each axial force the two measured frequencies are inverted for the normal and the "
        "tangential stiffness of a flank (5.8). Two numbers from two numbers leave no residual: "
        "the fit cannot show an error of the model. Its doubt is carried by the covariance of "
        "(ln kn, ln kt), from the measured frequencies and from a bias of the model's "
        f"frequencies (std {_bias(stiffness)}). Nodal values are the flank's total over 33 nodes, "
        "as Table 5.2 prints them; our springs are shared by area.",
        *drawn,
    ]
    if roots:
        parts.append(Table(
                "Roots. Standard deviations are of the logarithm: 0.2 is about 20 %, 2.7 a factor "
                "of 15 either way; measured part: from the measurement. Draws with a root: "
                "share of draws of all errors for which any (kn, kt) exists.",
                (*_HEADER, *(f"thesis {k}" for k in _published(stiffness))), roots))  # fmt: skip
    if misses:
        parts.append(
            Table(
                "No root: the smallest relative change of the model's frequencies (weighted by "
                "their standard deviations) that would give one, the share of draws of all errors "
                "that have one, and the frequencies of bonded contact, which no stiffness exceeds.",
                _MISS_HEADER,
                misses,
            )
        )
    parts += _further_modes(stiffness) + _one_mode(stiffness)
    if score is not None and roots:
        parts += _truth(stiffness, score)
    return Section("Contact stiffness", parts)


def _further_modes(stiffness: xr.Dataset) -> list[str]:
    """Chi-square of more modes than unknowns, and how far each mode is off."""
    lines = []
    for structure in stiffness["structure"].values:
        for force in stiffness["force"].values:
            found = stiffness.sel(structure=structure, force=force)
            if found["status"].item() != "fit":
                continue
            misses = [
                f"{float(found['misfit'].sel(mode=mode)):+z.1f} in {mode}"
                for mode in found["mode"].values
                if np.isfinite(found["misfit"].sel(mode=mode))
            ]
            chance = float(found["probability"])
            said = "the model fits" if found["fits"].item() == 1 else "the model does not fit"
            lines.append(
                f"{structure} at {force / 1e3:g} kN, weighted least squares: chi-square "
                f"{significant(float(found['chi_square']), 2)} with {int(found['freedom'])} degree "
                f"of freedom (probability of more {significant(chance, 2)}): {said}; misfits "
                f"{listed(misses)} standard deviations of measurement and model."
            )
    return lines


def _one_mode(stiffness: xr.Dataset) -> list[str]:
    """Where one frequency leaves the rest to the prior."""
    alone = stiffness["status"] == "prior"
    forces = stiffness["force"].values[alone.any("structure").values]
    if not forces.size:
        return []
    return [
        f"At {listed([f'{force / 1e3:g} kN' for force in forces])} one mode was measured: it fixes "
        "a line of (kn, kt), and along it only the prior says more (ln kn and ln kt alike, the box "
        "of the model within two standard deviations). Nothing more is known of these forces."
    ]


def _truth(stiffness: xr.Dataset, score: xr.Dataset) -> list:
    """What was found beside what the bench put in, where a force was measured."""
    rows = []
    for structure in stiffness["structure"].values:
        for force in stiffness["force"].values:
            found = stiffness.sel(structure=structure, force=force)
            same = np.isclose(score["force"].values, force, rtol=1e-6)
            if found["status"].item() not in DETERMINED or not same.any():
                continue
            cells = [structure, f"{force / 1e3:g}"]
            for name in ("kn", "kt"):
                true = float(np.exp(np.log(score[f"true_{name}"].values[same]).mean()))
                cells += [
                    fixed(float(found[name]) / 1e6, 0),
                    fixed(true / 1e6, 0),
                    f"{100 * (float(found[name]) / true - 1):+z.1f} %",
                ]
            rows.append(tuple(cells))
    header = ["structure", "force / kN"]
    for name in ("kn", "kt"):
        header += [f"{name} found / N/µm", f"{name} of the bench", "difference"]
    return [
        "The bench moves the same finite-element structure that the search uses, so this shows the "
        "method without an error of the model; the stated doubt allows for one.",
        Table("Found and true stiffness of a flank (simulated campaign)", header, rows),
    ]


def _bias(stiffness: xr.Dataset) -> str:
    bias = stiffness["fe_bias_std"].isel(structure=0, force=0)
    return listed([f"{percent(float(bias.sel(mode=m)))} in {m}" for m in bias["mode"].values])


def _root_row(found: xr.Dataset, structure: str, force: float) -> tuple[str, ...]:
    measured = found["ln_covariance"].sel(source="measurement").values
    spread = np.sqrt(np.diag(measured))
    return (
        structure,
        f"{force / 1e3:g}",
        fixed(float(found["kn_nodal"]) / 1e3, 0),
        fixed(float(found["kt_nodal"]) / 1e3, 0),
        significant(float(found["ln_kn_std"]), 2),
        significant(float(found["ln_kt_std"]), 2),
        f"{significant(spread[0], 2)}, {significant(spread[1], 2)}",
        fixed(float(found["correlation"]), 3),
        percent(float(found["root_share"]), 0),
        *(_printed(found, name) for name in _published(found)),
    )


def _published(stiffness: xr.Dataset) -> list[str]:
    return [name for name in ("kn", "kt") if f"published_{name}_nodal" in stiffness]


def _printed(found: xr.Dataset, name: str) -> str:
    value = float(found[f"published_{name}_nodal"]) / 1e3
    spread = float(found[f"published_{name}_nodal_std"]) / 1e3
    return f"{fixed(value, 0)} ± {fixed(spread, 0)}" if np.isfinite(value) else NONE


def _miss_row(found: xr.Dataset, structure: str, force: float) -> tuple[str, ...]:
    needed = found["needed_bias"]
    spread = np.hypot(found["fe_bias_std"], found["target_std"] / found["target_frequency"])
    return (
        structure,
        f"{force / 1e3:g}",
        *(f"{100 * float(needed.sel(mode=m)):+z.2f} %" for m in ("1B", "2B")),
        significant(float(np.sqrt(((needed / spread) ** 2).sum())), 2),
        percent(float(found["root_share"]), 0),
        *(fixed(float(found["bonded_frequency"].sel(mode=m)), 1) for m in ("1B", "2B")),
        *(fixed(float(found["target_frequency"].sel(mode=m)), 2) for m in ("1B", "2B")),
    )
