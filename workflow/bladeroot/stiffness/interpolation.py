"""Measured frequencies at the axial forces of the models (eqs 5.13, 5.14)."""

from dataclasses import dataclass

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.variables import dataset

FORCE_ERRORS = ("full-scale", "reading")
QUANTITIES = ("frequency", "loss_factor")


@dataclass(frozen=True)
class ForceGauge:
    """How far a measured axial force may be off, by two readings of one data sheet.

    full_scale_std: the same for every force, N; the thesis's 1 % of 700 bar on 17.9 cm^2 is 1253 N
    (section 3.6). relative_std: share of the reading.
    primary: which of `FORCE_ERRORS` the analysis goes on with.
    """

    full_scale_std: float
    relative_std: float
    primary: str

    def __post_init__(self) -> None:
        """Refuse negative errors and unknown models."""
        if not (self.full_scale_std >= 0.0 and self.relative_std >= 0.0):
            raise ValueError(
                "a gauge's errors must not be negative, got "
                f"{self.full_scale_std} N and {self.relative_std}"
            )
        if self.primary not in FORCE_ERRORS:
            raise ValueError(f"force error must be one of {FORCE_ERRORS}, got {self.primary!r}")

    def std(self, model: str, force: Float[ndarray, " level"]) -> Float[ndarray, " level"]:
        """Standard deviation of measured forces, N, under one of `FORCE_ERRORS`."""
        if model == "full-scale":
            return np.full(np.shape(force), self.full_scale_std)
        return self.relative_std * np.abs(force)


@dataclass(frozen=True)
class Lines:
    """Straight lines between measured levels, read at the FE forces (eqs 5.13, 5.14).

    by_value, by_force: sensitivity of each reading to each level's value and to its force.
    """

    value: Float[ndarray, " force"]
    by_value: Float[ndarray, "force level"]
    by_force: Float[ndarray, "force level"]
    lower: Float[ndarray, " force"]
    upper: Float[ndarray, " force"]

    def covariance(
        self, value_std: Float[ndarray, " level"], force_std: Float[ndarray, " level"]
    ) -> Float[ndarray, "force force"]:
        """Covariance of the readings for independent errors of all levels (eq. 5.14).

        Its diagonal is the square of eq. 5.14; readings that share a level are correlated.
        """
        errors = np.hstack([self.by_value * value_std, self.by_force * force_std])
        outside = np.isnan(self.value)
        whole = errors @ errors.T
        whole[outside] = np.nan
        whole[:, outside] = np.nan
        return whole


def interpolate_to(
    targets: Float[ndarray, " force"],
    forces: Float[ndarray, " level"],
    values: Float[ndarray, " level"],
) -> Lines:
    """Values at the targets on the lines between neighbouring levels (eq. 5.13).

    forces rise strictly. Outside the measured range every value is NaN. At a measured force the
    line is the one from the neighbour below.
    """
    value, lower, upper = np.full((3, len(targets)), np.nan)
    weight, by_force = np.zeros((2, len(targets), len(forces)))
    if len(forces) < 2:
        return Lines(value, weight, by_force, lower, upper)
    inside = np.flatnonzero((targets >= forces[0]) & (targets <= forces[-1]))
    high = np.maximum(np.searchsorted(forces, targets[inside]), 1)
    lower[inside], upper[inside] = forces[high - 1], forces[high]
    share = (targets[inside] - lower[inside]) / (upper - lower)[inside]
    weight[inside, high - 1], weight[inside, high] = 1.0 - share, share
    slope = (values[high] - values[high - 1]) / (upper - lower)[inside]
    by_force[inside] = -weight[inside] * slope[:, None]
    value[inside] = weight[inside] @ values
    return Lines(value, weight, by_force, lower, upper)


def fe_forces(stick: xr.Dataset, forces: Float[ndarray, " force"], gauge: ForceGauge) -> xr.Dataset:
    """Stick frequencies and loss factors at the FE axial forces, one row a mode.

    stick: dim level with `mode`, `force` (N), `frequency`, `frequency_std` (Hz), `loss_factor`,
    `loss_factor_std`. forces: N. Levels without a value are passed over, for frequency and loss
    factor each by itself. Nothing is extrapolated: outside the measured range all is NaN.
    `frequency_covariance` holds what eq. 5.14 leaves out: FE forces between the same two
    measured ones share their errors.
    Raises ValueError when one mode has two levels at one force.
    """
    targets = np.asarray(forces, float)
    modes = list(dict.fromkeys(str(mode) for mode in stick["mode"].values))
    count = len(targets)
    shape = (len(modes), count)
    out = {name: np.full(shape, np.nan) for name in ("lower_force", "upper_force")}
    for name in QUANTITIES:
        out[name] = np.full(shape, np.nan)
        out[f"{name}_only_std"] = np.full(shape, np.nan)
        out[f"{name}_std"] = np.full((len(FORCE_ERRORS), *shape), np.nan)
    out["frequency_covariance"] = np.full((len(FORCE_ERRORS), *shape, count), np.nan)
    for m, mode in enumerate(modes):
        for name in QUANTITIES:
            level_force, value, std = _levels(stick, mode, name)
            lines = interpolate_to(targets, level_force, value)
            out[name][m] = lines.value
            alone = lines.covariance(std, np.zeros_like(level_force))
            out[f"{name}_only_std"][m] = np.sqrt(np.diag(alone))
            for e, model in enumerate(FORCE_ERRORS):
                whole = lines.covariance(std, gauge.std(model, level_force))
                out[f"{name}_std"][e, m] = np.sqrt(np.diag(whole))
                if name == "frequency":
                    out["frequency_covariance"][e, m] = whole
            if name == "frequency":
                out["lower_force"][m], out["upper_force"][m] = lines.lower, lines.upper
    made = dataset("stiffness/fe_forces", out | {"mode": modes, "force": targets,
                                                 "force_error": list(FORCE_ERRORS)})  # fmt: skip
    return made.assign_attrs(
        primary_force_error=gauge.primary,
        gauge_full_scale_std_N=gauge.full_scale_std,
        gauge_relative_std=gauge.relative_std,
    )


def _levels(stick: xr.Dataset, mode: str, name: str) -> tuple[ndarray, ndarray, ndarray]:
    """Forces, values and stds of one mode's usable levels, by rising force."""
    value = stick[name].values
    chosen = np.flatnonzero((stick["mode"].values.astype(str) == mode) & np.isfinite(value))
    chosen = chosen[np.argsort(stick["force"].values[chosen], kind="stable")]
    force = stick["force"].values[chosen].astype(float)
    if np.any(np.diff(force) <= 0.0):
        twice = force[np.flatnonzero(np.diff(force) <= 0.0)[0]]
        raise ValueError(f"mode {mode} has two levels at {twice} N; join them first (eq. 3.21)")
    return force, value[chosen].astype(float), stick[f"{name}_std"].values[chosen].astype(float)
