"""The first and the last section: what came out in short, and what could not be decided."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from bladeroot.loads import shown
from bladeroot.report.bad_records import rejected
from bladeroot.report.numbers import listed, percent, significant
from bladeroot.report.page import Section
from bladeroot.report.words import several_groups

_REFERENCE = 12e3  # N
_FEW = 10  # names that a sentence holds
ALONE = (
    "Nothing is simulated: each mode is judged against a linear one, whose frequency and loss "
    "factor are constant{}. What that leaves, and why, stands below; contact stiffness is not told."
)
FOREIGN = 0.05  # relative move of a mode that no error of a model of the specimen explains


def summary_section(
    stick: xr.Dataset,
    stiffness: xr.Dataset,
    theory: xr.Dataset,
    joints: Sequence[xr.Dataset],
    amplitudes: Sequence[xr.Dataset],
    of_the_thesis: bool,
) -> Section:
    """The campaign's results in a few sentences; joints, amplitudes: of its structures.

    of_the_thesis: whether its Table 5.2 belongs beside them.
    """
    parts = _measured(stick)
    if set(stick["mode"].values) != {"1B", "2B"}:
        missing = [mode for mode in ("1B", "2B") if mode not in stick["mode"].values]
        parts.append(
            f"There is no stick frequency of {listed(missing)}; without both modes there is no "
            "search for (kn, kt)."
        )
        return Section("In short", parts)
    for structure in stiffness["structure"].values:
        parts.append(_found(stiffness.sel(structure=structure), structure))
        curves = [one for one in amplitudes if one.attrs["structure"] == structure]
        alone = [one for one in joints if one.attrs["structure"] == structure]
        parts += _together(curves, alone)
    parts.append(
        "Contact theory gives a flank "
        f"{significant(float(theory['kn_theory'].mean()) / 1e9, 3)} GN/m normal and "
        f"{significant(float(theory['kt_theory'].mean()) / 1e9, 3)} GN/m tangential stiffness, "
        "nearly the same at every force."
    )
    if of_the_thesis and np.isfinite(theory["kn_published_ratio"]).any():
        parts.append(
            f"Table 5.2 of the thesis has {_range(theory['kn_published_ratio'])} times the normal "
            f"and {_range(theory['kt_published_ratio'])} times the tangential stiffness of theory, "
            "growing with the force."
        )
    return Section("In short", parts)


def alone_section(stick: xr.Dataset, said: Mapping) -> Section:
    """The results of a campaign without a structure, and what it is judged against."""
    if said["structure"]:
        what = [] if said["causes"] or said["shortfall"] else [f"{said['reason']}."]
    else:
        load = shown(stick.attrs)[2]
        line = f" (over the {load}, a line in the frequency's square)" if load else ""
        what = [ALONE.format(line)]
    return Section("In short", [*_measured(stick), *what])


def undecided_section(facts: Mapping, stick: xr.Dataset, stiffness: xr.Dataset) -> Section:
    """What the data and the model leave open, and what would settle it."""
    parts = []
    if np.isin(stiffness["status"].values, ["root", "no root"]).any():
        parts.append(
            "Two frequencies fix two stiffnesses: the inversion has no freedom left to show an "
            "error of the model. A bias of the model's frequencies and a true change of kn and kt "
            "cannot be told apart here; a third mode, or frequencies of the free beam, would."
        )
    correlation = stiffness["correlation"].values
    if np.isfinite(correlation).any():
        parts.append(
            "Force by force kn and kt are almost one number: their correlation is "
            f"{significant(float(np.nanmedian(correlation)), 3)}. What one force's frequencies "
            "fix is a combination of the two; only all forces and the curves together part them."
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
        of_the_thesis = facts["description"].get("published") == "thesis"
        parts.append(
            "The stated errors of the stick frequencies are "
            + (
                "the thesis's own, from within the records. Neighbouring forces scatter by much "
                "more, so true errors are larger"
                if of_the_thesis
                else "those of stick.csv and are taken as they are"
            )
            + "; without the records, or repeats of a clamping, they cannot be checked."
        )
    elif stick.sizes["record"]:
        unreached = int((stick["verdict"].values == "plateau not reached").sum())
        if unreached:
            parts.append(
                f"Records that do not reach their plateau: {unreached}. Smaller amplitudes (a "
                "longer decay above the noise) would show it."
            )
    return Section("What could not be decided", parts)


def _measured(stick: xr.Dataset) -> list[str]:
    """The stick frequencies, and which records have no part in them."""
    bad = [str(name) for name, _ in rejected(stick)]
    if not bad:
        return [_frequencies(stick)]
    more = [f"{len(bad) - _FEW} more"] if len(bad) > _FEW else []
    return [
        _frequencies(stick),
        f"Rejected: {len(bad)} of {stick.sizes['record']} records, {listed(bad[:_FEW] + more)}; "
        "why stands with what was measured.",
    ]


def _frequencies(stick: xr.Dataset) -> str:
    texts, (factor, unit, load) = [], shown(stick.attrs)
    lowest = float(stick["frequency"].min()) if stick.sizes["level"] else 0.0
    digits = 1 if lowest > 100.0 else 3
    for mode in dict.fromkeys(stick["mode"].values):
        level = stick.isel(level=np.flatnonzero(stick["mode"].values == mode)).sortby("force")
        ends = [level.isel(level=0), level.isel(level=-1)]
        if several_groups(stick):  # a range over loads would be one over groups, too
            ends = [level.isel(level=k) for k in range(level.sizes["level"])]
        said = [
            f"{float(end['frequency']):.{digits}f} Hz"
            + (f" at {factor * float(end['force']):.1f} {unit}" if load else "")
            + (f" in {end['group'].item()}" if several_groups(stick) else "")
            for end in ends
        ]
        texts.append(f"mode {mode} {' to '.join(dict.fromkeys(said))}")
    if not texts:
        bounds = "only bounds" if (stick["verdict"] == "plateau not reached").any() else "no bound"
        return f"No record reached its stick plateau: there is no stick frequency, {bounds}."
    bending = {"1B", "2B"} & set(stick["mode"].values.astype(str))
    what = " (1B and 2B: first and second bending mode)" if bending else ""
    return f"Stick frequencies{what}: {listed(texts)}."


def _found(line: xr.Dataset, structure: str) -> str:
    status = list(line["status"].values)
    roots = status.count("root") + status.count("fit")
    tried = len(status) - status.count("no measurement") - status.count("prior")
    if not tried:
        return f"{structure}: no force of the simulation lies inside the measured range of both."
    text = f"{structure}, force by force: at {roots} of {tried} a contact stiffness (kn, kt) exists"
    if roots:
        good = line.isel(force=np.flatnonzero(np.isin(status, ("root", "fit"))))
        text += (
            f"; kn {_range(good['kn'] / 1e9)} GN/m, known {_doubt(good['ln_kn_std'])}, and kt "
            f"{_range(good['kt'] / 1e9)} GN/m, known {_doubt(good['ln_kt_std'])}"
        )
    if roots < tried:
        bad = line.isel(force=np.flatnonzero(line["status"].values == "no root"))
        moves = [
            f"{mode} by {_signed_range(bad['needed_bias'].sel(mode=mode))} %"
            for mode in ("1B", "2B")
        ]
        place = "elsewhere" if roots else "for one to exist"
        text += f"; {place} the model's frequencies would have to move, {listed(moves)}"
        text += f" (assumed error of the model: {_bias(line)})"
        if float(np.abs(bad["needed_bias"]).min("force").max()) > FOREIGN:
            text += (
                ". So far off this structure is not the specimen, or a mode is taken for another: "
                "kn and kt from it mean nothing"
            )
    return text + "."


def _together(amplitudes: Sequence[xr.Dataset], joints: Sequence[xr.Dataset]) -> list[str]:
    """kn and kt from all forces at once, with the curves if they could be used."""
    curves = [one for one in amplitudes if one.attrs["law"] and one.attrs["converged"]]
    found = curves or [one for one in joints if one.attrs["law"]]
    if not found:
        return []
    here = found[0].isel(force=int(np.abs(found[0]["force"].values - _REFERENCE).argmin()))
    said = []
    for name in ("kn", "kt"):
        of_k = 1e-9 * here["k_quantile"].sel(stiffness=name)
        middle, low, high = (
            significant(float(of_k.sel(quantile=q, method="nearest")), 3)
            for q in (0.5, 0.025, 0.975)
        )
        said.append(f"{name} {middle} ({low} to {high}) GN/m")
    data = "frequencies and amplitude curves" if curves else "frequencies"
    return [
        f"From the {data} of all forces together, at {float(here['force']) / 1e3:.1f} kN: "
        f"{listed(said)} (median, 95 %; law {found[0].attrs['law']})."
    ]


def _doubt(ln_std: xr.DataArray) -> str:
    """One standard deviation of ln k in words: per cent while small, else a factor."""
    spread = float(ln_std.median())
    if spread < 0.5:
        return f"to about {percent(spread, 0)}"
    return f"only within a factor of about {significant(float(np.exp(spread)), 2)} either way"


def _bias(line: xr.Dataset) -> str:
    bias = line["fe_bias_std"].isel(force=0)
    return listed([f"{percent(float(bias.sel(mode=mode)))} in {mode}" for mode in ("1B", "2B")])


def _range(values: xr.DataArray) -> str:
    low, high = float(values.min()), float(values.max())
    if significant(low, 2) == significant(high, 2):
        return significant(low, 2)
    return f"{significant(low, 2)} to {significant(high, 2)}"


def _signed_range(values: xr.DataArray) -> str:
    low, high = 100 * float(values.min()), 100 * float(values.max())
    return f"{low:+z.2f}" if f"{low:z.2f}" == f"{high:z.2f}" else f"{low:+z.2f} to {high:+z.2f}"
