"""The part of the report on the joint posterior: all forces at once, and what would help."""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from bladeroot.report.numbers import fixed, interval, listed, percent, significant
from bladeroot.report.page import Picture, Table

_HEADER = (
    "structure", "force / kN", "kn / GN/m", "kn, 95 %", "kt / GN/m", "kt, 95 %", "std ln kn",
    "std ln kt", "Laplace's", "correlation", "stiff combination", "its std", "sloppy one",
    "its std",
)  # fmt: skip


def joint_parts(found: Sequence[xr.Dataset], drawn: Sequence[Picture]) -> list:
    """Posterior of kn(F), kt(F), laws, misfit, what it rests on, what would help."""
    full = [one for one in found if one.attrs["law"]]
    if not full:
        return [
            "All forces at once: kn and kt need stick frequencies of two modes; there are none."
        ]
    first = full[0]
    least = first.attrs["least_force_N"]
    return [
        "All forces at once. Every measured stick frequency"
        + (f" from {least / 1e3:g} kN up" if least else "")
        + " is explained together: kn and kt follow a law over the force, the model has one bias "
        "in each mode, the gauge one offset and gain for all its readings, and kn and kt scatter "
        "from clamping to clamping. All of them are unknown, with priors that the artifact lists. "
        "Each frequency is compared at its own force, so nothing is interpolated.",
        *[_said(one) for one in full],
        *drawn,
        Table(
            "Joint posterior: median and 95 % interval; standard deviations of ln kn and ln kt by "
            "draws and by curvature (Laplace); the combinations of ln kn and ln kt that the data "
            "fix best (stiff) and least (sloppy)",
            _HEADER,
            [
                _row(one, f)
                for one in full
                for f in sorted({0, one.force.size // 2, one.force.size - 1})
            ],
        ),
        _laws(full),
        _variations(full),
    ]


def _said(one: xr.Dataset) -> str:
    """The outcome with one structure in words."""
    quantile = one["reference_quantile"]
    texts = []
    for name in ("kn", "kt"):
        middle, ends = interval(quantile.sel(stiffness=name), 0.16)
        texts.append(f"{name} {middle} ({ends}) GN/m")
    biases = []
    for name in one["parameter"].values:
        if str(name).startswith("bias_"):
            here = one.sel(parameter=name)
            biases.append(
                f"{100 * float(here['posterior_mean']):+z.2f} ± "
                f"{100 * float(here['posterior_std']):.2f} % in {str(name)[5:]}"
            )
    z = one["level_misfit"] / one["level_misfit_std"]
    worst = int(np.abs(z.values).argmax())
    rms = float(np.sqrt((one["level_misfit"] ** 2).mean()))
    text = (
        f"{one.attrs['structure']}, law {one.attrs['law']}: at 12 kN {listed(texts)}, 68 % "
        f"intervals, with a bias of the model of {listed(biases)}. The {one.sizes['level']} levels "
        f"miss their predictions by {percent(rms, 2)} "
        f"rms; the worst, {one['level_mode'].values[worst]} at "
        f"{float(one['level_force'][worst]) / 1e3:.1f} kN, by "
        f"{significant(abs(float(z[worst])), 2)} of its standard deviations. The draws "
        f"count as {one.attrs['independent_draws']:.0f} independent ones."
    )
    biased = [
        abs(float(one.sel(parameter=n)["posterior_mean"] / one.sel(parameter=n)["prior_std"]))
        for n in one["parameter"].values
        if str(n).startswith("bias_")
    ]
    if max(biased) > 2.0:
        text += (
            f" The model's bias comes out at {significant(max(biased), 2)} of its own standard "
            "deviations: this structure agrees with the measurement only if it is more wrong than "
            "was assumed."
        )
    return text


def _row(one: xr.Dataset, f: int) -> tuple[str, ...]:
    here = one.isel(force=f)
    cells = [one.attrs["structure"], f"{float(here['force']) / 1e3:g}"]
    for name in ("kn", "kt"):
        cells += interval(here["k_quantile"].sel(stiffness=name), 0.025)
    cells += [fixed(float(v), 2) for v in here["ln_std"]]
    cells.append(", ".join(fixed(float(v), 2) for v in here["ln_laplace_std"]))
    cells.append(fixed(float(here["correlation"]), 2))
    for name in ("stiff", "sloppy"):
        weights = here["combination_weight"].sel(combination=name).values
        cells.append(f"{weights[0]:.2f} ln kn {weights[1]:+z.2f} ln kt")
        cells.append(fixed(float(here["combination_std"].sel(combination=name)), 2))
    return tuple(cells)


def _laws(full: Sequence[xr.Dataset]) -> Table:
    rows = [
        (
            one.attrs["structure"],
            str(law),
            fixed(float(here["log_evidence"] - one["log_evidence"].max()), 1),
            *(fixed(1e-9 * float(k), 2) for k in here["law_k"]),
            *(fixed(float(s), 2) for s in here["law_ln_std"]),
            percent(float(here["law_scatter"]), 0),
        )
        for one in full
        for law in one["law"].values
        for here in [one.sel(law=law)]
    ]
    return Table(
        "Laws of stiffness over force: log evidence less that of the best (a difference of 3 is 20 "
        "to 1; of the laws within it the freest is taken), most probable kn and kt at 12 kN, and "
        "how much ln k scatters about the law, by clamping or because the law is wrong",
        ("structure", "law", "log evidence", "kn / GN/m", "kt / GN/m", "std ln kn", "std ln kt",
         "scatter"),
        rows,
    )  # fmt: skip


def _variations(full: Sequence[xr.Dataset]) -> Table:
    rows = [
        (
            one.attrs["structure"],
            str(variation),
            *(fixed(1e-9 * float(k), 2) for k in here["variation_k"]),
            *(fixed(float(s), 2) for s in here["variation_ln_std"]),
        )
        for one in full
        for variation in one["variation"].values
        for here in [one.sel(variation=variation)]
    ]
    return Table(
        "What the answer rests on: most probable kn and kt at 12 kN and their standard deviations "
        "(Laplace) when an assumption is changed",
        ("structure", "assumption", "kn / GN/m", "kt / GN/m", "std ln kn", "std ln kt"),
        rows,
    )
