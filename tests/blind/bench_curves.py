"""Curves of a whole campaign without moving it in time: what ideal analysis of records gives."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pandas as pd
import xarray as xr
from bladeroot.bench.bench import course_of, sine_force
from bladeroot.bench.clamping import Clamping, clamp
from bladeroot.bench.conditions import Conditions, baseline
from bladeroot.bench.forces import no_forces
from bladeroot.bench.joint import Parts, project, specimen, stuck_stiffness
from cycle import cycle_curves, loss_factor
from jaxtyping import Float
from numpy import ndarray
from scipy.linalg import eigh, svd

# Corners between which a specimen may lie: axial force (N), contact stiffness (N/m), slots.
_FORCES = (0.0, 30e3)
_STIFFNESS = (2e8, 1e9, 5e9)
_SLOTS = (0.7, 1.0)
_MODES = 6
_SMALLEST = 1e-7


def few_dofs(whole: Parts) -> Parts:
    """The parts in the few displacements that the lowest stuck modes are made of.

    Modes of specimens at the corners of force, contact stiffness and slots span them; frequencies
    in between are right to a millionth.
    """
    seen = []
    for force in _FORCES:
        for kn in _STIFFNESS:
            for kt in _STIFFNESS:
                slot = _SLOTS[len(seen) % 2]
                body = specimen(whole, force, slot_factor=slot)
                shapes = eigh(
                    stuck_stiffness(body, kn, kt)[0], body.mass, subset_by_index=(0, _MODES - 1)
                )[1]
                seen.append(shapes)
    left, values, _ = svd(np.hstack(seen), full_matrices=False)
    return project(whole, left[:, values > _SMALLEST * values[0]])


def campaign_curves(
    bench: dict,
    whole: Parts,
    few: Parts,
    sheet: pd.DataFrame,
    conditions: Sequence[Conditions],
    ladder: Float[ndarray, " amplitude"],
) -> xr.Dataset:
    """True frequency (Hz) and loss factor of each record over the ladder of amplitudes (m).

    `conditions` are those of the sheet's rows. NaN above the amplitude that the record's drive
    reaches; slip is worked out at the lowest, middle and highest pressure of the sheet alone and
    scaled, since it depends on amplitude over force.
    """
    rows = sheet.to_dict("records")
    shape = (len(rows), ladder.size)
    frequency, loss = np.full(shape, np.nan), np.full(shape, np.nan)
    stuck = np.zeros((len(rows), 4))
    by_slip: dict = {}
    for k, (row, true) in enumerate(zip(rows, conditions, strict=True)):
        here = clamp(bench, few, row, true, slipping=False)
        own = float(here.loss_factor[here.number])
        curves = cycle_curves(here.modes, here.number, own, here.forces, np.full(1, np.inf), ladder)
        if np.isfinite(true.friction):
            curves = _with_slip(bench, whole, sheet, row, here, curves, ladder, by_slip)
        top = _reached(bench, here, float(row["drive_A"]), ladder, curves[1])
        below = ladder <= top
        frequency[k, below] = curves[0][below]
        loss[k, below] = loss_factor(*curves, ladder)[below]
        stuck[k] = here.frequency, own, top, true.force
    return xr.Dataset(
        {
            "frequency": (("record", "amplitude"), frequency, {"units": "Hz"}),
            "loss_factor": (("record", "amplitude"), loss, {"units": "1"}),
            "stuck_frequency": ("record", stuck[:, 0], {"units": "Hz"}),
            "stuck_loss_factor": ("record", stuck[:, 1], {"units": "1"}),
            "top": ("record", stuck[:, 2], {"units": "m"}),
            "force": ("record", stuck[:, 3], {"units": "N"}),
        },
        {"record": list(sheet["record"]), "amplitude": ladder},
    )


def _reached(
    bench: dict,
    here: Clamping,
    drive: float,
    ladder: Float[ndarray, " amplitude"],
    rate: Float[ndarray, " amplitude"],
) -> float:
    """Amplitude (m) at release: the sine gives what damping takes, less what is still rising."""
    omega = here.modes.omega[here.number]
    seen = abs(here.modes.tip_shape[here.number] * here.modes.laser_shape[here.number])
    driven = sine_force(bench, here, drive) * seen / (2 * omega)
    steady = float(np.interp(driven, np.maximum.accumulate(ladder * rate), ladder))
    rising = float(np.interp(steady, ladder, rate)) * course_of(bench, here).drive
    return steady * float(1 - np.exp(-rising))


def _with_slip(bench, whole, sheet, row, here, curves, ladder, known):
    """Curves with the share of slip, by the nearest of three pressures."""
    pressures = np.unique(sheet["pressure_bar"])
    worked = pressures[[0, len(pressures) // 2, -1]]
    near = worked[np.argmin(np.abs(np.log(worked / row["pressure_bar"])))]
    key = (row["mode"], near)
    if key not in known:
        stand_in = {**row, "pressure_bar": near}
        true = here.conditions
        at = baseline(bench, stand_in)
        slipping = clamp(bench, whole, stand_in, replace(true, force=at.force))
        none = no_forces(slipping.modes.omega.size)
        reach = np.geomspace(ladder[0] / 30, ladder[-1] * 30, 400)
        free = cycle_curves(slipping.modes, slipping.number, 0.0, none, slipping.limit, reach)
        scale = at.force * true.friction
        known[key] = (reach / scale, free[0] / slipping.frequency, free[1])
    reach, softer, extra = known[key]
    at = ladder / (here.conditions.force * here.conditions.friction)
    factor = np.interp(at, reach, softer)
    return curves[0] * factor, curves[1] + np.interp(at, reach, extra)
