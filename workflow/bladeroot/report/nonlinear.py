"""The part of the report on the nonlinear joint: what curves add, and what slips first."""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from bladeroot.report.numbers import fixed, significant
from bladeroot.report.page import Picture, Section, Table

SLIP = (
    "Left: hysteresis loops of the mode, without the stuck mode's force. Right: the part of each "
    "node pair that slips on one flank."
)
_NARROWER = ("structure", "force / kN", "ln kn before", "ln kn", "ln kt before", "ln kt",
             "kn narrower by", "kt narrower by", "area smaller by", "correlation")  # fmt: skip
_FRICTION = ("structure", "parameter", "value", "factor", "prior", "its factor", "prior's origin")


def nonlinear_section(
    found: Sequence[xr.Dataset],
    shortfalls: Sequence[xr.Dataset],
    drawn: Sequence[Picture],
    of_the_thesis: bool,
) -> Section:
    """Inference with amplitude where there are records; the shortfall of uniform friction, for a
    campaign of the thesis beside the amplitude at which the thesis sees slip.
    """
    full = [one for one in found if one.attrs["law"]]
    parts: list = []
    if full:
        parts += [
            "Above a certain amplitude places of the flanks slip: the frequency falls and damping "
            "rises. The curves of each record, counted from its own stick frequency and loss "
            "factor, are explained together with all stick frequencies: how far they fall and rise "
            "says how much of the motion goes through the tangential springs. Friction and how "
            "pressure is spread over the flanks are unknown, too, and are integrated out. The "
            "simulated curves (first loading and Masing's rules) are trusted to "
            f"{100 * full[0].attrs['discrepancy']:g} % of the largest effect, besides what an "
            "uneven pressure does to all of them, whose high places are not known.",
            *[_said(one) for one in full],
            *[
                f"{one.attrs['structure']}: without the curves of {one.attrs['left_out']}."
                for one in full
                if one.attrs["left_out"]
            ],
            Table(
                "Standard deviations of ln kn and ln kt under the same law of the force, from the "
                "frequencies only and with the curves, and how much smaller they become; area: of "
                "the ellipse of both",
                _NARROWER,
                [_row(one, f) for one in full for f in range(one.sizes["force"])],
            ),
            Table(
                "Friction: most probable values at the stiffness found, factor of one standard "
                "deviation, and the prior's median and factor",
                _FRICTION,
                [_friction(one, k) for one in full for k in range(one.sizes["friction"])],
            ),
            "These numbers describe how slip spreads in this joint; they are no measured constants "
            "of its surfaces. High places of the pressure act like less friction, so one joint's "
            "curves do not part the two, and the factors, at fixed kn and kt, leave this out.",
            *drawn,
        ]
    parts += [
        f"{one.attrs['structure']}: no curves were used: {one.attrs['reason']}."
        for one in found
        if not one.attrs["law"]
    ]
    slips = [part for one in shortfalls for part in _shortfall(one, of_the_thesis)]
    return Section("Nonlinear joint", [*parts, *slips])


def _said(one: xr.Dataset) -> str:
    fall, rise = (
        float(np.sqrt((((one[name] - one[f"{name}_simulated"]) / one[f"{name}_std"]) ** 2).mean()))
        for name in ("fall", "rise")
    )
    relative = np.sqrt(
        np.mean((one["fall_simulated"] / one["fall"] - 1.0).values[_large(one)] ** 2)
    )
    shrunk = one["shrinkage"]
    text = (
        f"{one.attrs['structure']}, law {one.attrs['law']}: with the curves ln kn is known "
        f"{fixed(float(shrunk.sel(stiffness='kn').median()), 1)} and ln kt "
        f"{fixed(float(shrunk.sel(stiffness='kt').median()), 1)} times better (median of forces), "
        f"the area of their ellipse is {fixed(float(one['area_shrinkage'].median()), 1)} times "
        f"smaller. {one.sizes['point']} points of curves; where the frequency falls by more than a "
        f"fifth of the largest fall, simulation misses it by {significant(100 * relative, 2)} %; "
        f"in all, simulation misses the fall by {fixed(fall, 2)} of the standard deviations "
        f"allowed and the rise of damping by {fixed(rise, 2)}."
    )
    if not one.attrs["converged"]:
        text += " The fit did NOT converge: these numbers are not to be used."
    return text


def _large(one: xr.Dataset) -> np.ndarray:
    return one["fall"].values < 0.2 * one["fall"].values.min()


def _row(one: xr.Dataset, f: int) -> tuple[str, ...]:
    here = one.isel(force=f)
    cells = [one.attrs["structure"], f"{float(here['force']) / 1e3:g}"]
    for name in ("kn", "kt"):
        own = here.sel(stiffness=name)
        cells += [fixed(float(own["frequencies_ln_std"]), 3), fixed(float(own["ln_std"]), 3)]
    cells += [fixed(float(v), 2) for v in here["shrinkage"]]
    return (*cells, fixed(float(here["area_shrinkage"]), 2), fixed(float(here["correlation"]), 2))


def _friction(one: xr.Dataset, k: int) -> tuple[str, ...]:
    here = one.isel(friction=k)
    return (
        one.attrs["structure"],
        str(here["friction"].values),
        significant(float(here["friction_value"]), 2),
        fixed(float(np.exp(here["friction_ln_std"])), 2),
        significant(float(here["friction_prior"]), 2),
        fixed(float(np.exp(here["friction_prior_ln_std"])), 1),
        str(here["friction_origin"].values),
    )


def _shortfall(table: xr.Dataset, of_the_thesis: bool) -> list:
    """Where slip begins, by pressure, in words and as tables."""
    joint = (
        f"{table.attrs['mode']} at {table.attrs['force_N'] / 1e3:g} kN "
        f"({table.attrs['structure']}, kn {1e-9 * table.attrs['kn']:.2g} and kt "
        f"{1e-9 * table.attrs['kt']:.2g} GN/m, friction {table.attrs['friction']:g})"
    )
    if table.attrs["reason"]:
        return [f"What slips first in {joint} could not be simulated: {table.attrs['reason']}."]
    onset, partial = table["onset"], table["partial_onset"]
    words = (
        f"What slips first, in {joint}. With uniform pressure nothing slips below "
        f"{_um(table['first_slip'][0])}."
    )
    if of_the_thesis:
        seen = _um(table.attrs["seen_m"])
        words += f" The thesis sees the frequency fall from {seen} on{_nearest(table)}."
    never = f"a dash: not up to {_um(table['highest'])}"
    full = Table(
        "Full contact: amplitude at which the first place slips and at which the frequency has "
        "fallen by 200 ppm, by the exponent of pressure over the width (0 uniform, 0.5 elliptic); "
        + never,
        ("exponent", "first slip / µm", "fallen by 200 ppm / µm"),
        [
            (f"{e:g}", *(significant(1e6 * float(v.sel(exponent=e)), 2)
                         for v in (table["first_slip"], onset)))
            for e in table["exponent"].values
        ],
    )  # fmt: skip
    part = Table(
        "Partial contact: amplitude in µm at which the frequency has fallen by 200 ppm, by the "
        "part of the width that bears the load evenly and the load that stays spread over all; "
        + never,
        ("share in contact", *(f"{100 * v:g} % spread over all" for v in table["loose"].values)),
        [
            (f"{100 * s:g} %", *(significant(1e6 * float(v), 2) for v in partial.sel(share=s)))
            for s in table["share"].values
        ],
    )
    return [words, full, part]


def _um(metres: xr.DataArray | float) -> str:
    return significant(1e6 * float(metres), 2, "µm")


def _nearest(table: xr.Dataset) -> str:
    """Which of the contacts that were tried falls nearest to where the source saw it."""
    onsets = {f"with exponent {float(one['exponent']):g}": float(one) for one in table["onset"]} | {
        f"with {100 * float(one['share']):g} % of the width bearing all but "
        f"{100 * float(one['loose']):g} % of the load": float(one)
        for one in table["partial_onset"].stack(contact=("share", "loose"))
    }
    onsets = {name: value for name, value in onsets.items() if np.isfinite(value)}
    if not onsets:
        return f"; no contact that was tried lets it fall up to {_um(table['highest'])}"
    name = min(onsets, key=lambda name: abs(np.log(onsets[name] / table.attrs["seen_m"])))
    return f"; nearest comes contact {name}: {_um(onsets[name])}"
