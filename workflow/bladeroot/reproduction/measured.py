"""Quantities of chapters 2 and 3: stick frequencies, and the model of 1 degree of freedom."""

import numpy as np
import pandas as pd

from bladeroot.reproduction.entry import Computed, Evidence
from bladeroot.reproduction.slider import Slider

ADHESION = 12e3  # N, above which the thesis takes the joint to stick
_BAR = 1e5


def piston_area(evidence: Evidence) -> Computed:
    """mm^2: the largest area on which every measured force is a whole number of bars."""
    forces = evidence.stages["stick"]["force"].values
    step = np.gcd.reduce(np.round(forces).astype(int))
    return {"": np.array([step / _BAR * 1e6])}


def largest_force(evidence: Evidence) -> Computed:
    """kN."""
    return {"": np.array([float(evidence.stages["stick"]["force"].max()) / 1e3])}


def gauge_percent(evidence: Evidence) -> Computed:
    """Per cent of the smallest FE force that the gauge's full-scale error is."""
    fe_forces = evidence.stages["fe_forces"]
    smallest = float(fe_forces["force"].min())
    return {"": np.array([100.0 * fe_forces.attrs["gauge_full_scale_std_N"] / smallest])}


def table_5_1(evidence: Evidence, mode: str) -> Computed:
    """Hz: errors of the interpolated frequencies for each reading of the gauge."""
    fe_forces = evidence.stages["fe_forces"]
    forces = 1e3 * evidence.tables["5_1"]["force_kN"].to_numpy()
    there = fe_forces["frequency_std"].reindex(force=forces)
    return {
        f"1 % of {kind.replace('-', ' ')}": there.sel(force_error=kind, mode=mode).values
        for kind in fe_forces["force_error"].values
    }


def percent_of(evidence: Evidence, table: str, part: str, whole: str) -> Computed:
    """100 times the quotient of two printed columns."""
    rows = evidence.tables[table]
    return {"": 100.0 * (rows[part] / rows[whole]).to_numpy()}


def mean_stiffness_percent(evidence: Evidence) -> Computed:
    """Mean of the printed relative errors of Table 5.2, kn and kt."""
    columns = evidence.tables["5_2"][["kn_delta_percent", "kt_delta_percent"]]
    return {"": np.array([columns.to_numpy().mean()])}


def _sticks(evidence: Evidence, mode: str) -> pd.DataFrame:
    stick = evidence.stages["stick"]
    rows = stick[["mode", "force", "frequency", "loss_factor"]].to_dataframe()
    return rows[rows["mode"] == mode].sort_values("force")


def _slope(rows: pd.DataFrame) -> float:
    """Slope of f^2 over the axial force, Hz^2/N; NaN for a single force."""
    if rows["force"].nunique() < 2:
        return np.nan
    return float(np.polyfit(rows["force"], rows["frequency"] ** 2, 1)[0])


def slope_over_beam(evidence: Evidence, mode: str, above: bool) -> Computed:
    """Slope of the measured f^2 over force, over the clamped beam's of Appendix B.

    Below 12 kN the first point above it closes the range.
    """
    beam = evidence.tables["b"]
    beam = beam[beam["mode"] == int(mode[0])].rename(
        columns={"force_N": "force", "frequency_Hz": "frequency"}
    )
    rows = _sticks(evidence, mode)
    stuck = rows["force"] > ADHESION
    chosen = rows[stuck] if above else rows[~stuck | (stuck.cumsum() == 1)]
    return {"": np.array([_slope(chosen) / _slope(beam)])}


def damping_trend(evidence: Evidence, mode: str, least_force: float) -> Computed:
    """Rank correlation of the loss factor with the force, from `least_force` (N) on."""
    rows = _sticks(evidence, mode)
    rows = rows[rows["force"] >= least_force]
    return {"": np.array([rows["force"].rank().corr(rows["loss_factor"].rank())])}


def force_of_largest_damping(evidence: Evidence) -> Computed:
    """kN, second mode."""
    rows = _sticks(evidence, "2B")
    return {"": np.array([rows["force"].to_numpy()[rows["loss_factor"].argmax()] / 1e3])}


def slider_frequency(evidence: Evidence) -> Computed:
    """Hz, in full adhesion."""
    return {"": np.array([Slider().stick_frequency])}


def slider_critical_amplitude(evidence: Evidence) -> Computed:
    """Micrometres."""
    return {"": np.array([Slider().critical_amplitude * 1e6])}


def freevib_error(evidence: Evidence, which: int) -> Computed:
    """Per cent, without sign: of the frequency (0), loss factor (1), critical amplitude (2)."""
    return {"": 100.0 * np.abs(evidence.stages["slider"]["found_error"].values)[[which]]}


def harmonic_balance(evidence: Evidence) -> Computed:
    """Per cent: largest difference of FREEVIB's frequency from (3.19), 20 to 95 times X_cr."""
    return {"": np.array([100.0 * float(evidence.stages["slider"]["balance_error"])])}
