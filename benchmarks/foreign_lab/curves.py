"""The quick tier: the curves of a campaign's records with the errors that their analysis leaves.

What a line through the phases of a window cannot know, larger towards a curve's ends and in truth
larger than stated. Faults of the record itself (`signal` hooks) do not show here.
"""

import numpy as np
import xarray as xr

from foreign_lab.case import Case
from foreign_lab.motion import backbone
from foreign_lab.sheet import Record

LADDER = 10.0 ** (np.arange(-112, -55) / 14)  # amplitudes, m
WINDOW, ALIKE = 1.8, 0.6  # of ln A: what a point is made from, and over which errors are alike
AT_ENDS, END = 4.0, 0.35  # errors grow by so much within so much of ln A
ACTUAL = 1.3  # true errors over stated ones
FLOOR = 2.0  # noise's rms at which a record ends
FLAT = (2e-5, 0.02)  # relative changes of frequency and loss factor that leave a plateau
READING = 0.1  # K, of a thermometer
FEWEST = 3  # points of a curve, and of a plateau
QUANTITIES = ("frequency", "loss_factor")


def shows(case: Case) -> bool:
    """Whether curves can show all that is hidden: no fault of the record itself."""
    return not any(hasattr(one.law, "signal") for one in case.effects)


def observations(case: Case, thermometer: bool = False) -> xr.Dataset:
    """What the diagnosis reads of a campaign (`observations.nc`), with the sheet's temperatures."""
    sheet, bench = case.sheet, case.bench
    count, rng = len(sheet.mode), np.random.default_rng([case.seed, 99])
    points = {
        q + e: np.full((count, LADDER.size), np.nan) for q in QUANTITIES for e in ("", "_std")
    }
    numbers = {f"stick_{name}": np.full(count, np.nan) for name in points}
    numbers["onset_amplitude"] = np.full(count, np.nan)
    reached = np.zeros(count, np.int8)
    apart = np.subtract.outer(np.log(LADDER), np.log(LADDER)) / ALIKE
    root = np.linalg.cholesky(np.exp(-0.5 * apart**2) + 1e-9 * np.eye(LADDER.size))
    for k in range(count):
        one = Record(sheet, k)
        loss = bench.loss[one.mode] * np.exp(one.at("ln_eta"))
        f, noise = one.omega / (2 * np.pi), bench.start[one.mode] * 10 ** (-bench.noise_dB / 20)
        rate = loss * one.omega / 2
        top = one.at("start")
        bottom = max(
            FLOOR * noise / one.omega, top * np.exp(-0.85 * bench.seconds[one.mode] * rate)
        )
        seen = (top >= LADDER) & (bottom <= LADDER)
        if seen.sum() < FEWEST:
            continue
        std = np.sqrt(24 / (bench.sampling_Hz * (WINDOW / rate) ** 3)) * noise / one.omega / LADDER
        made = backbone(one, loss, case.effects, LADDER)
        clean = {"frequency": made["omega"] / (2 * np.pi), "loss_factor": made["eta"]}
        per = {"frequency": 1 / (2 * np.pi), "loss_factor": 2 / one.omega}
        left = np.abs(clean["frequency"] / f - 1) > FLAT[0]
        left |= np.abs(clean["loss_factor"] / loss - 1) > FLAT[1]
        flat = seen & ~np.logical_or.accumulate(left)
        reached[k] = flat.sum() >= FEWEST
        for q, value in clean.items():
            error = std * per[q] * _towards_the_ends(seen)
            off = ACTUAL * error * (root @ rng.standard_normal(LADDER.size))
            points[q][k, seen], points[q + "_std"][k, seen] = (value + off)[seen], error[seen]
        if reached[k]:
            mean = np.sqrt(WINDOW * 14 / np.log(10) / (1 / std[flat] ** 2).sum())
            for q, true in (("frequency", f), ("loss_factor", loss)):
                error = float(mean * per[q])
                numbers[f"stick_{q}"][k] = true + error * rng.standard_normal()
                numbers[f"stick_{q}_std"][k] = error
            if (seen & ~flat).any():
                numbers["onset_amplitude"][k] = LADDER[flat].max()
    seen = _dataset(case, points, numbers | {"plateau_reached": reached}, rng)
    if thermometer:
        read = (
            21.0
            + sheet.temperature
            + READING * np.random.default_rng([case.seed, 98]).normal(size=count)
        )
        seen["temperature"] = ("record", np.round(read, 1))
    return seen


def _towards_the_ends(seen: np.ndarray) -> np.ndarray:
    place = np.log(LADDER)
    inside = place[seen]
    to_end = np.minimum(np.abs(place - inside.min()), np.abs(place - inside.max()))
    return 1 + AT_ENDS * np.exp(-to_end / END)


def _dataset(case: Case, points: dict, numbers: dict, rng: np.random.Generator) -> xr.Dataset:
    sheet, bench, count = case.sheet, case.bench, len(case.sheet.mode)
    way = np.where(sheet.direction > 0, "up", "down")
    if bench.hides_direction:
        hidden = bench.hides_direction == "all" or rng.random(count) < 0.3
        way = np.where(hidden, "", way)
    newtons = 10.0 * bench.piston_cm2
    text = {
        "mode": sheet.mode, "hold": [f"c{h}" for h in sheet.hold], "direction": way,
        "findings": [""] * count, "verdict": ["usable"] * count,
    }  # fmt: skip
    data = {name: ("record", np.array(values, dtype=str)) for name, values in text.items()}
    data |= {name: ("record", values) for name, values in numbers.items()}
    data |= {
        "force": ("record", np.round(sheet.reading / newtons) * newtons),
        "time": ("record", sheet.time - (np.nan if bench.hides_time else sheet.time.min())),
        "correlation_decades": ("record", np.full(count, WINDOW)),
        "laser_x_m": ("sensor_mode", [case.specimen.laser[m] for m in ("1B", "2B")]),
    }  # fmt: skip
    data |= {name: (("record", "amplitude"), values) for name, values in points.items()}
    return xr.Dataset(
        data,
        {"record": [f"m{k + 1:03d}" for k in range(count)], "amplitude": LADDER,
         "sensor_mode": ["1B", "2B"]},
        {"simulated": 0, "campaign": f"c{case.seed}", "gauge_full_scale_std_N": 3000.0,
         "gauge_relative_std": 0.01, "gauge_resolution_N": newtons},
    )  # fmt: skip
