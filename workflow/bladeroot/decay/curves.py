"""Frequency and damping over amplitude at each force: the curves of all its records as one."""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.decay.settling import unsettled

CURVES = {"frequency": ("Hz", "natural frequency"), "loss_factor": ("1", "hysteretic loss factor")}
KINDS = {
    "": "mean over records of",
    "_std": "standard error of the mean",
    "_change_std": "standard error, without that of the records' levels, of the mean",
    "_scatter": "standard deviation between records of",
}


def mean_curves(
    decays: Sequence[xr.Dataset], plateaus: Sequence[xr.Dataset], points_a_decade: int = 40
) -> xr.Dataset:
    """The mean curve of each mode and force, on one ladder of amplitudes.

    decays: as from `bladeroot.decay.freevib.freevib`, with mode, force_N and simulated in the
    attributes. plateaus: of the same records; what is rejected there is left out. At each
    amplitude the mean over the records that reach it is weighted by within- and between-record
    variance (DerSimonian-Laird), with each record's level against the others taken off before and
    the mean of the levels put back; nothing is extrapolated. First cycles that decay unlike all
    records which pass them later (`settling`) are left out.

    Returns:
        dims level (mode, force) and amplitude (m): frequency (Hz) and loss_factor with their
        standard errors, with and without that of the levels (`_std`, `_change_std`), and the
        scatter between records, levels included (NaN for one record alone); `records`,
        how many reach the amplitude, and `unsettled`, how many more do but are left out there.
    """
    decays = [
        decay
        for decay, plateau in zip(decays, plateaus, strict=True)
        if decay.sizes["point"] > 1 and not str(plateau["verdict"].values).startswith("rejected")
    ]
    level_of = [(str(d.attrs["mode"]), float(d.attrs["force_N"])) for d in decays]
    levels = sorted(set(level_of))
    ladder = ladder_of(decays, points_a_decade)
    values = {name: np.full((len(levels), ladder.size), np.nan) for name in _names()}
    count, left_out = (np.zeros((len(levels), ladder.size), dtype=int) for _ in range(2))
    for k, level in enumerate(levels):
        here = [decay for decay, own in zip(decays, level_of, strict=True) if own == level]
        start = np.array([float(decay["amplitude"].max()) for decay in here])
        read = {
            name: np.array([on_ladder(decay, name, ladder) for decay in here])
            for name in (*CURVES, *(f"{name}_std" for name in CURVES))
        }
        doubted = np.logical_or.reduce(
            [unsettled(ladder, start, read[name], read[f"{name}_std"]) for name in CURVES]
        )
        left_out[k] = doubted.sum(axis=0)
        for name in CURVES:
            value, std = (np.where(doubted, np.nan, read[part]) for part in (name, f"{name}_std"))
            for kind, found in _mean(value, std).items():
                values[f"{name}{kind}"][k] = found
            count[k] = np.isfinite(value).sum(axis=0)
    curves = xr.Dataset(
        {name: (("level", "amplitude"), values[name], _attrs(name)) for name in values},
        coords={
            "amplitude": (
                "amplitude", ladder,
                {"units": "m", "long_name": "displacement amplitude at the sensor"},
            ),
            "mode": ("level", [mode for mode, _ in levels], {"units": "", "long_name": "mode"}),
            "force": (
                "level", [force for _, force in levels],
                {"units": "N", "long_name": "axial force"},
            ),
        },
        attrs={"simulated": max((int(d.attrs.get("simulated", 0)) for d in decays), default=0)},
    )  # fmt: skip
    return curves.assign(
        records=(("level", "amplitude"), count, {"units": "1", "long_name": "records that reach"}),
        unsettled=(
            ("level", "amplitude"),
            left_out,
            {"units": "1", "long_name": "records whose first cycles are left out"},
        ),
    )


def _names() -> list[str]:
    return [f"{name}{part}" for name in CURVES for part in KINDS]


def _attrs(name: str) -> dict[str, str]:
    base = next(known for known in CURVES if name.startswith(known))
    units, text = CURVES[base]
    kind = KINDS[name.removeprefix(base)]
    return {"units": units, "long_name": f"{kind} {text}", "source": "eq. 3.11"}


def ladder_of(decays: Sequence[xr.Dataset], points_a_decade: int) -> Float[ndarray, " amplitude"]:
    """Amplitudes evenly spaced in their logarithm, at places that no record can shift."""
    if not decays:
        return np.zeros(0)
    low = min(float(decay["amplitude"].min()) for decay in decays)
    high = max(float(decay["amplitude"].max()) for decay in decays)
    first = np.ceil(points_a_decade * np.log10(low))
    last = np.floor(points_a_decade * np.log10(high))
    return 10.0 ** (np.arange(first, last + 1) / points_a_decade)


def on_ladder(decay: xr.Dataset, name: str, ladder: ndarray) -> Float[ndarray, " amplitude"]:
    """A record's curve at the ladder's amplitudes, NaN beyond what it reaches."""
    value, amplitude = decay[name].values, decay["amplitude"].values
    known = np.isfinite(value) & np.isfinite(amplitude)
    if known.sum() < 2:
        return np.full(ladder.size, np.nan)
    order = np.argsort(amplitude[known])
    x, y = np.log(amplitude[known][order]), value[known][order]
    return np.interp(np.log(ladder), x, y, left=np.nan, right=np.nan)


def _mean(
    value: Float[ndarray, "record amplitude"], std: Float[ndarray, "record amplitude"]
) -> dict[str, Float[ndarray, " amplitude"]]:
    """Mean over records, its standard errors and the scatter between records, by `KINDS`.

    The value of a record is its own level plus a change with amplitude that all of them share.
    Levels are taken off before the mean and their mean is put back, so that a record that begins or
    ends makes no step.
    """
    level = _levels(value, _weights(value, std)[0])
    with np.errstate(divide="ignore"):
        level_std = _precision(value, std).sum(axis=1) ** -0.5
    middle, middle_std, levels_scatter = _weighted(level[:, None], level_std[:, None])
    change, change_std, scatter = _weighted(value - level[:, None], std)
    return {
        "": change + middle,
        "_std": np.hypot(change_std, middle_std),
        "_change_std": change_std,
        "_scatter": np.hypot(scatter, levels_scatter),
    }


def _levels(
    value: Float[ndarray, "record amplitude"], weight: Float[ndarray, "record amplitude"]
) -> Float[ndarray, " record"]:
    """How far each record lies above the others: least squares of record + amplitude.

    They sum to zero over records that are linked by common amplitudes; others are not compared.
    """
    value = np.where(weight > 0.0, value, 0.0)
    total = weight.sum(axis=0)
    share = weight / np.where(total > 0.0, total, 1.0)
    normal = np.diag(weight.sum(axis=1)) - share @ weight.T
    right = (weight * (value - (share * value).sum(axis=0))).sum(axis=1)
    return np.linalg.pinv(normal, rcond=1e-12, hermitian=True) @ right


def _weighted(value: ndarray, std: ndarray) -> tuple[ndarray, ndarray, ndarray]:
    """Weighted mean over records, its standard error, and the scatter between them."""
    weight, between = _weights(value, std)
    known = weight > 0.0
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = (weight * np.where(known, value, 0.0)).sum(axis=0) / weight.sum(axis=0)
        mean_std = weight.sum(axis=0) ** -0.5
    scatter = np.where(known.sum(axis=0) > 1, np.sqrt(between), np.nan)
    return mean, np.where(known.any(axis=0), mean_std, np.nan), scatter


def _weights(value: ndarray, std: ndarray) -> tuple[ndarray, ndarray]:
    """Weights within and between records, zero where unknown, and the variance between them."""
    precision = _precision(value, std)
    known = precision > 0.0
    value = np.where(known, value, 0.0)
    count, total = known.sum(axis=0), precision.sum(axis=0)
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = (precision * value).sum(axis=0) / total
        misfit = (precision * (value - mean) ** 2).sum(axis=0) - (count - 1)
        between = np.maximum(misfit, 0.0) / (total - (precision**2).sum(axis=0) / total)
        between = np.where(count > 1, between, 0.0)
        return np.where(known, 1.0 / (1.0 / precision + between), 0.0), between


def _precision(value: ndarray, std: ndarray) -> ndarray:
    """Inverse variance of each value, zero where it is unknown."""
    known = np.isfinite(value) & np.isfinite(std) & (std > 0.0)
    return np.where(known, 1.0 / np.where(known, std, 1.0) ** 2, 0.0)
