"""The part of the report on the joint inference with and without the causes of a model file."""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from bladeroot.report.numbers import NONE, fixed, interval, listed, percent
from bladeroot.report.page import Table


def extended_parts(joints: Sequence[xr.Dataset], extended: Sequence[xr.Dataset]) -> list:
    """kn and kt before and after, misses, and which causes could not be taken."""
    before = {one.attrs["structure"]: one for one in joints if one.attrs["law"]}
    pairs = [(before[one.attrs["structure"]], one) for one in extended if one.attrs["law"]]
    if not pairs:
        return []
    parts: list = [
        Table(
            "All forces at once, as before and with the causes of the model file: kn and kt at "
            "12 kN (68 % interval), how far the levels are from their predictions, and the bias "
            "that the model needs",
            ("structure", "law", "log evidence", "kn / GN/m", "kt / GN/m", "std ln kn", "std ln kt",
             "rms miss", "bias"),
            [row for old, new in pairs for row in (_row(old), _row(new))],
        )
    ]  # fmt: skip
    for _, one in pairs:
        missing = [name for name in one.attrs["extension_left_out"].split(";") if name]
        if missing:
            parts.append(
                f"With {one.attrs['structure']} the model file also names {listed(missing)}, which "
                "changes no stick frequency."
            )
    return parts


def _row(one: xr.Dataset) -> tuple[str, ...]:
    law = one.attrs["law"]
    quantile = one["reference_quantile"]
    at = int(np.argmin(np.abs(one["force"].values - one.attrs["reference_force_N"])))
    cells = []
    for name in ("kn", "kt"):
        middle, ends = interval(quantile.sel(stiffness=name), 0.16)
        cells.append(f"{middle} ({ends})")
    near = abs(one["force"].values[at] - one.attrs["reference_force_N"]) < 1.0
    std = [fixed(float(v), 2) if near else NONE for v in one["ln_std"].isel(force=at)]
    biases = [
        f"{100 * float(one['posterior_mean'].sel(parameter=n)):+z.2f} % in {str(n)[5:]}"
        for n in one["parameter"].values
        if str(n).startswith("bias_")
    ]
    rms = float(np.sqrt((one["level_misfit"] ** 2).mean()))
    evidence = float(one["log_evidence"].sel(law=law))
    return (one.attrs["structure"], law, fixed(evidence, 1), *cells, *std, percent(rms, 2),
            listed(biases))  # fmt: skip
