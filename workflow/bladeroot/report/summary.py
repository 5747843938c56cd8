"""The first and the last section: what came out in short, and what could not be decided."""

from collections.abc import Mapping

import numpy as np
import xarray as xr

from bladeroot.report.numbers import listed, percent, significant
from bladeroot.report.page import Section


def summary_section(stick: xr.Dataset, stiffness: xr.Dataset, theory: xr.Dataset) -> Section:
    """The campaign's results in a few sentences."""
    parts = [_measured(stick)]
    for structure in stiffness["structure"].values:
        parts.append(_found(stiffness.sel(structure=structure), structure))
    parts.append(
        "Contact theory gives a flank "
        f"{significant(float(theory['kn_theory'].mean()) / 1e9, 3)} GN/m normal and "
        f"{significant(float(theory['kt_theory'].mean()) / 1e9, 3)} GN/m tangential stiffness, "
        "nearly the same at every force; Table 5.2 of the thesis has "
        f"{_range(theory['kn_published_ratio'])} times the normal and "
        f"{_range(theory['kt_published_ratio'])} times the tangential one, growing with the force."
    )
    return Section("In short", parts)


def undecided_section(facts: Mapping, stick: xr.Dataset, stiffness: xr.Dataset) -> Section:
    """What the data and the model leave open, and what would settle it."""
    parts = [
        "Two frequencies fix two stiffnesses: the inversion has no freedom left to show an error "
        "of the model. A bias of the model's frequencies and a true change of kn and kt cannot be "
        "told apart here; a third mode, or frequencies of the free beam, would.",
    ]
    correlation = stiffness["correlation"].values
    if np.isfinite(correlation).any():
        parts.append(
            "kn and kt are almost one number: their correlation is "
            f"{significant(float(np.nanmedian(correlation)), 3)}. What the data fix is a "
            "combination of the two; each alone is known much less well."
        )
    misses = stiffness["status"].values == "no root"
    if misses.any():
        names = [str(n) for n in stiffness["structure"].values[misses.any(axis=1)]]
        parts.append(
            f"With {listed(names)} some measured pairs have no (kn, kt) at all. Whether geometry, "
            "slots or boundary are to blame cannot be said from these frequencies: the slots and "
            "the root block are not published."
        )
    if facts["entry"] == "stick frequencies":
        parts.append(
            "The stated errors of the stick frequencies are the thesis's own, from within the "
            "records. Neighbouring forces scatter by much more, so true errors are larger; without "
            "the records, or repeats of a clamping, by how much cannot be said."
        )
    elif stick.sizes["record"]:
        unreached = int((stick["plateau_reached"].values == 0).sum())
        if unreached:
            parts.append(
                f"Records that give no stick frequency: {unreached}. Smaller amplitudes (a longer "
                "decay above the noise) would give one."
            )
    parts.append(
        "Frequency and damping above the onset of slip are shown but not yet explained by a model."
    )
    return Section("What could not be decided", parts)


def _measured(stick: xr.Dataset) -> str:
    texts = []
    for mode in dict.fromkeys(stick["mode"].values):
        level = stick.isel(level=np.flatnonzero(stick["mode"].values == mode)).sortby("force")
        first, last = level.isel(level=0), level.isel(level=-1)
        texts.append(
            f"mode {mode} from {float(first['frequency']):.1f} Hz at "
            f"{float(first['force']) / 1e3:.1f} kN to {float(last['frequency']):.1f} Hz at "
            f"{float(last['force']) / 1e3:.1f} kN"
        )
    return f"The stick frequency rises with the axial force: {listed(texts)}."


def _found(line: xr.Dataset, structure: str) -> str:
    status = list(line["status"].values)
    roots, tried = status.count("root"), len(status) - status.count("no measurement")
    if not tried:
        return f"{structure}: no force of the simulation lies inside the measured range."
    text = f"{structure}: {roots or 'none'} of {tried} forces has a contact stiffness (kn, kt)"
    if roots:
        good = line.isel(force=np.flatnonzero(line["status"].values == "root"))
        text += (
            f"; kn {_range(good['kn'] / 1e9)} GN/m (relative std about "
            f"{percent(float(good['ln_kn_std'].median()), 0)}) and kt {_range(good['kt'] / 1e9)} "
            f"GN/m (about {percent(float(good['ln_kt_std'].median()), 0)})"
        )
    if roots < tried:
        bad = line.isel(force=np.flatnonzero(line["status"].values == "no root"))
        moves = [
            f"{mode} by {_signed_range(bad['needed_bias'].sel(mode=mode))} %"
            for mode in ("1B", "2B")
        ]
        place = "elsewhere" if roots else "for one to exist"
        text += f"; {place} the model's frequencies would have to move, {listed(moves)}"
    return text + "."


def _range(values: xr.DataArray) -> str:
    low, high = float(values.min()), float(values.max())
    if significant(low, 2) == significant(high, 2):
        return significant(low, 2)
    return f"{significant(low, 2)} to {significant(high, 2)}"


def _signed_range(values: xr.DataArray) -> str:
    low, high = 100 * float(values.min()), 100 * float(values.max())
    return f"{low:+.2f}" if f"{low:.2f}" == f"{high:.2f}" else f"{low:+.2f} to {high:+.2f}"
