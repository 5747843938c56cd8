"""The fast tier: the bench's own curves with the errors that the analysis of raw records leaves.

The errors are calibrated on raw cases (`docs/blind.md`): what a line through the phases of a window
cannot know, over a window that is longer the fainter the record.
"""

from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr
from bladeroot import artifacts
from jaxtyping import Float
from numpy import ndarray

POINTS_A_DECADE = 14
LADDER = 10.0 ** (np.arange(-112, -55) / POINTS_A_DECADE)
# Window in ln A that a point is made from, and length over which the errors of points are one.
WINDOW, CORRELATION = 1.8, 0.6
# Errors grow towards a curve's ends, so many times over such a length in ln A.
END_GROWTH, END_LENGTH = 4.0, 0.35
# Real errors over stated ones.
ACTUAL = 1.3
# The curve ends where velocity falls to so many times the noise's rms, or with the record.
FLOOR = 2.0
# A plateau is one where frequency or damping leave their stuck value by no more than this.
PLATEAU_FREQUENCY, PLATEAU_LOSS = 2e-5, 0.02


def observations(
    curves: xr.Dataset,
    bench: dict,
    sheet: pd.DataFrame,
    chance: np.random.Generator,
    seen: dict[str, tuple[str, str]] | None = None,
) -> xr.Dataset:
    """What the diagnosis reads, from true curves over LADDER.

    `seen` gives findings (joined by semicolons) and verdict of records; without it all are clean.
    """
    rows = sheet.to_dict("records")
    count = len(rows)
    made = {name: np.full((count, LADDER.size), np.nan) for name in POINT}
    record = {name: np.full(count, np.nan) for name in NUMBERS}
    spread = np.abs(np.subtract.outer(np.log(LADDER), np.log(LADDER))) / CORRELATION
    root = np.linalg.cholesky(np.exp(-0.5 * spread**2) + 1e-9 * np.eye(LADDER.size))
    for k in range(count):
        at = curves.isel(record=k)
        omega = 2 * np.pi * float(at["stuck_frequency"])
        own = float(at["stuck_loss_factor"])
        top = float(at["top"])
        std = ideal_error(bench, omega, own)
        constant = bench["recording"]["time_constant_s"][rows[k]["mode"]]
        lasted = bench["recording"]["decay_time_constants"] * constant * own * omega / 2
        least = FLOOR * bench["laser"]["noise_m_per_s"] / omega
        bottom = max(least, top * np.exp(-lasted))
        reached = (top >= LADDER) & (bottom <= LADDER)
        clean = {"frequency": at["frequency"].values, "loss_factor": at["loss_factor"].values}
        unit = {"frequency": 1 / (2 * np.pi), "loss_factor": 2 / omega}
        for name, values in clean.items():
            error = std * unit[name] * _towards_the_ends(reached)
            noise = ACTUAL * error * (root @ chance.standard_normal(LADDER.size))
            made[name][k, reached] = (values + noise)[reached]
            made[f"{name}_std"][k, reached] = error[reached]
        flat = _plateau(clean, float(at["stuck_frequency"]), own) & reached
        record["plateau_reached"][k] = float(flat.any())
        if flat.any():
            weight = 1 / std[flat] ** 2
            # Points of one correlation length count once.
            error = np.sqrt(WINDOW * POINTS_A_DECADE / np.log(10) / weight.sum())
            for name, true in (("frequency", omega / (2 * np.pi)), ("loss_factor", own)):
                error_here = float(error * unit[name])
                record[f"stick_{name}"][k] = true + error_here * chance.standard_normal()
                record[f"stick_{name}_std"][k] = error_here
            if not flat[reached].all():
                record["onset_amplitude"][k] = LADDER[flat].max()
    return _dataset(made, record, bench, sheet, seen or {})


def ideal_error(bench: dict, omega: float, loss: float) -> Float[ndarray, " amplitude"]:
    """Standard error (rad/s) of a frequency from the window of a point."""
    window = WINDOW / (loss * omega / 2)
    ratio = bench["laser"]["noise_m_per_s"] / (omega * LADDER)
    return np.sqrt(24 / (bench["recording"]["sampling_Hz"] * window**3)) * ratio


def _towards_the_ends(reached: ndarray) -> Float[ndarray, " amplitude"]:
    """Factor of the errors: 1 inside a curve, more towards its ends."""
    place = np.log(LADDER)
    inside = place[reached] if reached.any() else place
    to_end = np.minimum(np.abs(place - inside.min()), np.abs(place - inside.max()))
    return 1 + END_GROWTH * np.exp(-to_end / END_LENGTH)


def _plateau(clean: dict, frequency: float, loss: float) -> ndarray:
    """Amplitudes up to the first at which a curve has left its stuck value."""
    left = np.abs(clean["frequency"] / frequency - 1) > PLATEAU_FREQUENCY
    left |= np.abs(clean["loss_factor"] / loss - 1) > PLATEAU_LOSS
    return ~np.logical_or.accumulate(left)


POINT = {
    "frequency": ("Hz", "undamped natural frequency"),
    "frequency_std": ("Hz", "standard error of frequency"),
    "loss_factor": ("1", "loss factor"),
    "loss_factor_std": ("1", "standard error of loss_factor"),
}
NUMBERS = {
    "stick_frequency": ("Hz", "frequency of the stick plateau"),
    "stick_frequency_std": ("Hz", "its standard error within the record"),
    "stick_loss_factor": ("1", "loss factor of the stick plateau"),
    "stick_loss_factor_std": ("1", "its standard error within the record"),
    "onset_amplitude": ("m", "amplitude where sticking ends"),
    "plateau_reached": ("1", "1 where the record reaches its stick plateau"),
}


def _dataset(made: dict, record: dict, bench: dict, sheet: pd.DataFrame, seen: dict) -> xr.Dataset:
    newton_per_bar = bench["gauge"]["piston_area_cm2"] * 1e-4 * 1e5
    names = list(sheet["record"])
    findings, verdict = zip(*(seen.get(name, ("", "usable")) for name in names), strict=True)
    text = {
        "mode": list(sheet["mode"]),
        "hold": list(sheet["hold"]),
        "direction": list(sheet["direction"]),
        "findings": list(findings),
        "verdict": list(verdict),
    }
    plain = {"units": "", "long_name": "see the sheet of records"}
    data = {name: ("record", np.array(values, dtype=str), plain) for name, values in text.items()}
    for name, (unit, meaning) in NUMBERS.items():
        values = record[name].astype(np.int8) if name == "plateau_reached" else record[name]
        data[name] = ("record", values, {"units": unit, "long_name": meaning})
    for name, values, unit in (
        ("force", sheet["pressure_bar"].to_numpy(float) * newton_per_bar, "N"),
        ("time", sheet["time_s"].to_numpy(float), "s"),
        ("correlation_decades", np.full(len(names), WINDOW), "1"),
    ):
        data[name] = ("record", values, {"units": unit, "long_name": name})
    for name, (unit, meaning) in POINT.items():
        data[name] = (("record", "amplitude"), made[name], {"units": unit, "long_name": meaning})
    laser = bench["laser"]["x_mm"]
    data["laser_x_m"] = (
        "sensor_mode",
        np.array([1e-3 * x for x in laser.values()]),
        {"units": "m", "long_name": "position of the laser from mid-span"},
    )
    return xr.Dataset(
        data,
        {
            "record": names,
            "amplitude": ("amplitude", LADDER, {"units": "m", "long_name": "amplitude"}),
            "sensor_mode": list(laser),
        },
        {
            "simulated": 1,
            "campaign": "blind",
            "gauge_full_scale_std_N": 0.0,
            "gauge_relative_std": 0.01,
            "gauge_resolution_N": newton_per_bar * bench["gauge"]["resolution_bar"],
        },
    )


def save(dataset: xr.Dataset, path: Path) -> None:
    artifacts.save(dataset, path)
