"""What the diagnosis reads of a campaign: one table of records, with curves on a common ladder."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.loads import load_attrs
from bladeroot.pooling.coupling import coupling
from bladeroot.pooling.groups import group_differences
from bladeroot.pooling.level_curve import ladder_of, on_one_ladder
from bladeroot.variables import dataset, names

POINTS_A_DECADE = 14
# Steps (bar, or microstrain) to which a gauge may have been read.
READINGS = (100.0, 50.0, 10.0, 5.0, 2.0, 1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01)


@dataclass(frozen=True)
class Gauge:
    """Errors of the force gauge: of the full scale (N), of the reading, and its rounding (N)."""

    full_scale_std: float
    relative_std: float
    resolution: float = 0.0


def reading_step(force: Float[ndarray, " record"], scale: float) -> float:
    """The coarsest usual step (N) in whose multiples all forces were read; 0 if none.

    scale: newtons per unit of the gauge's reading.
    """
    units = np.asarray(force, float) / scale
    for step in READINGS:
        whole = units / step
        if whole.size and np.all(np.abs(whole - np.round(whole)) < 1e-4):
            return step * scale
    return 0.0


def observed(
    stick: xr.Dataset,
    decays: Sequence[xr.Dataset],
    integrity: xr.Dataset | None,
    facts: Mapping,
) -> xr.Dataset:
    """`observations` with what the campaign says of itself, and how its groups differ.

    facts: `same_everywhere` (load's unit), `of_reading` and `scale` of the gauge, `laser_x` (m, by
    mode), `time` (s) and `temperature` (C) by record, as of `bladeroot.io.facts.observation_facts`.
    """
    forces = stick["record_force" if len(decays) else "force"].values
    step = reading_step(forces, facts["scale"]) if facts["scale"] else 0.0
    gauge = Gauge(facts["same_everywhere"], facts["of_reading"], step)
    by_record = {name: facts.get(name, {}) for name in ("time", "temperature")}
    seen = observations(stick, decays, integrity, gauge, facts["laser_x"], by_record)
    bad = np.char.startswith(stick["verdict"].values.astype(str), "rejected")
    rejected = dict(zip(stick["record"].values.astype(str), bad.tolist(), strict=True))
    differences = group_differences(decays, [rejected[one.attrs["record"]] for one in decays])
    return seen if differences is None else seen.merge(differences)


def observations(
    stick: xr.Dataset,
    decays: Sequence[xr.Dataset],
    integrity: xr.Dataset | None,
    gauge: Gauge,
    laser_x: Mapping[str, float],
    by_record: Mapping[str, Mapping[str, float]] | None = None,
) -> xr.Dataset:
    """The records of a campaign as the diagnosis takes them.

    stick: from `bladeroot.pooling.stick`; decays: curves of the same records, empty where the
    campaign begins at a table, whose rows are then the records. integrity: from
    `bladeroot.pooling.judgement`. laser_x: m, by mode. by_record: `time` (s since the campaign
    began) and `temperature` (C) of records.

    Returns:
        dims record and amplitude (m, `POINTS_A_DECADE` a decade, common to all, 0 long for a
        table) with the variables of the tables record and point, laser_x_m over sensor_mode, and
        the gauge's errors in the attributes. Nothing is extrapolated: NaN beyond what a record
        reaches.
    """
    rows, scatter = _table_rows(stick) if not len(decays) else (_record_rows(stick), None)
    by_name = {str(decay.attrs["record"]): decay for decay in decays}
    found = _findings(integrity)
    for row in rows:
        decay = by_name.get(row["record"])
        row["findings"] = ";".join(sorted(found.get(row["record"], ())))
        for name in ("time", "temperature"):
            row[name] = float((by_record or {}).get(name, {}).get(row["record"], np.nan))
        # a sheet without holds names each record's own; with several sensors, each event's
        if row["hold"] == row["record"]:
            row["hold"] = ""
        if decay is not None and decay.attrs.get("verdict", "usable") != "usable":
            row["verdict"] = "rejected"
        row["correlation_decades"] = correlation_length(decay) if decay is not None else np.nan
    chosen = [by_name.get(row["record"]) for row in rows]
    chosen = [None if d is None or d.sizes["point"] < 2 else d for d in chosen]
    ladder = ladder_of([decay for decay in chosen if decay is not None], POINTS_A_DECADE)
    points = on_one_ladder(chosen, ladder)
    points |= coupling(chosen, rows, ladder)
    made = {name: np.array([row[name] for row in rows]) for name in names("diagnosis/record")}
    seen = dataset("diagnosis/record", made | {"record": [row["record"] for row in rows]})
    seen["force"].attrs |= load_attrs(stick.attrs)
    more = {"laser_x_m": np.array([float(x) for x in laser_x.values()])}
    if scatter is not None:
        more["stick_frequency_scatter"] = scatter
    seen = seen.assign(dataset("diagnosis/point", points | {"amplitude": ladder}))
    seen = seen.assign(dataset("diagnosis/observations", more | {"sensor_mode": list(laser_x)}))
    return seen.assign_attrs(
        {
            "simulated": int(stick.attrs.get("simulated", 0)),
            "campaign": str(stick.attrs.get("campaign", "")),
            **{n: stick.attrs[n] for n in ("load_name", "load_unit") if n in stick.attrs},
            "gauge_full_scale_std_N": float(gauge.full_scale_std),
            "gauge_relative_std": float(gauge.relative_std),
            "gauge_resolution_N": float(gauge.resolution),
        }
    )


def _record_rows(stick: xr.Dataset) -> list[dict]:
    names = {
        "mode": "record_mode", "force": "record_force", "hold": "hold", "direction": "direction",
        "stick_frequency": "stick_frequency", "stick_frequency_std": "stick_frequency_std",
        "stick_loss_factor": "record_loss_factor", "onset_amplitude": "record_onset_amplitude",
        "stick_loss_factor_std": "record_loss_factor_std", "plateau_reached": "plateau_reached",
        "group": "record_group", "event": "event", "sensor": "sensor",
    }  # fmt: skip
    rows = []
    for i, record in enumerate(stick["record"].values.astype(str)):
        row = {
            name: stick[own].values[i].item() if own in stick else "" for name, own in names.items()
        }
        rejected = str(stick["verdict"].values[i]).startswith("rejected")
        verdict = "rejected" if rejected else "usable"
        rows.append(row | {"record": str(record), "verdict": verdict})
    return rows


def _table_rows(stick: xr.Dataset) -> tuple[list[dict], Float[ndarray, " record"]]:
    """The rows of a table as records, and what each scatters about a smooth law (Hz).

    Where most loads have several modes, the rows of a load are of one clamping, or means over the
    same ones, whose contact all modes feel. Series of one mode each may meet at a load by chance.
    """
    mode, force = stick["mode"].values.astype(str), stick["force"].values
    level, modes = np.unique(force, return_inverse=True, return_counts=True)[1:]
    together = bool(mode.size) and np.median(modes) > 1.0
    rows = [
        dict.fromkeys(("direction", "group", "event", "sensor"), "")
        | {
            "hold": f"load {level[i]}" if together else "",
            "record": f"{mode[i]}-{force[i]:.0f}{stick.attrs.get('load_unit', 'N')}",
            "mode": mode[i],
            "force": float(force[i]),
            "stick_frequency": float(stick["frequency"].values[i]),
            "stick_frequency_std": float(stick["stated_std"].values[i]),
            "stick_loss_factor": float(stick["loss_factor"].values[i]),
            "stick_loss_factor_std": float(stick["loss_factor_stated_std"].values[i]),
            "onset_amplitude": np.nan,
            "plateau_reached": 1,
            "verdict": "usable",
        }
        for i in range(mode.size)
    ]
    return rows, stick["scatter_std"].values.astype(float)


def _findings(integrity: xr.Dataset | None) -> dict[str, set[str]]:
    found: dict[str, set[str]] = {}
    if integrity is None or "finding_id" not in integrity:
        return found
    for name, owner in zip(
        integrity["finding_id"].values.astype(str),
        integrity["finding_record"].values.astype(str),
        strict=True,
    ):
        found.setdefault(owner, set()).add(name)
    return found


def correlation_length(decay: xr.Dataset) -> float:
    """Length in ln A over which the errors of a record's curve are correlated.

    A straight line through the phases of blocks of spacing dt and standard error s, over a window
    W, knows its slope to var = 12 s^2 dt / W^3. The window that has the curve's own standard error
    of frequency is the one that was smoothed over; the decay crosses it in W d(ln A)/dt.
    """
    known = np.isfinite(decay["frequency_std"].values) & (decay["frequency_std"].values > 0.0)
    blocks = decay.get("block_std")
    if known.sum() < 2 or blocks is None or blocks.size < 3:
        return np.nan
    time, std = decay["time"].values[known], decay["frequency_std"].values[known]
    block_time = decay["block_time"].values
    block = np.interp(time, block_time, blocks.values)
    spacing = np.median(np.diff(block_time))
    window = (12.0 * block**2 * spacing / (2.0 * np.pi * std) ** 2) ** (1.0 / 3.0)
    rate = np.abs(np.gradient(np.log(decay["amplitude"].values[known]), time))
    span = np.ptp(np.log(decay["amplitude"].values[known]))
    return float(np.clip(np.median(window * rate), 1e-3 * span, span))
