"""What the diagnosis reads of a campaign: one table of records, with curves on a common ladder."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.loads import load_attrs
from bladeroot.pooling.groups import group_differences
from bladeroot.pooling.level_curve import COUPLING_VARIABLES, ladder_of, on_ladder, on_one_ladder
from bladeroot.variables import dataset, names

POINTS_A_DECADE = 14
# Steps (bar, or microstrain) to which a gauge may have been read.
READINGS = (100.0, 50.0, 10.0, 5.0, 2.0, 1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01)


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


def observations(
    stick: xr.Dataset,
    decays: Sequence[xr.Dataset],
    integrity: xr.Dataset | None,
    facts: Mapping,
) -> xr.Dataset:
    """The records of a campaign as the diagnosis takes them, and how its groups differ.

    stick: from `bladeroot.pooling.stick`; decays: curves of the same records, empty where the
    campaign begins at a table, whose rows are then the records. integrity: from
    `bladeroot.pooling.judgement`. facts: `same_everywhere` (load's unit), `of_reading` and `scale`
    of the gauge, `laser_x` (m, by mode), `time` (s since the campaign began) and `temperature` (C)
    by record, as of `bladeroot.io.facts.observation_facts`.

    Returns:
        dims record and amplitude (m, `POINTS_A_DECADE` a decade, common to all, 0 long for a
        table) with the variables of the tables record and point, laser_x_m over sensor_mode, and
        the gauge's errors in the attributes. Nothing is extrapolated: NaN beyond what a record
        reaches.
    """
    rows = _of_records(stick) if len(decays) else _of_table(stick)
    record = rows["record"]
    rejected = set(record[rows["verdict"] == "rejected"])
    by_name = {str(decay.attrs["record"]): decay for decay in decays}
    curves = [by_name.get(name) for name in record]
    bad = [one is not None and one.attrs.get("verdict", "usable") != "usable" for one in curves]
    rows["verdict"] = np.where(bad, "rejected", rows["verdict"])
    # a sheet without holds names each record's own; with several sensors, each event's
    rows["hold"] = np.where(rows["hold"] == record, "", rows["hold"])
    found = _findings(integrity)
    rows["findings"] = np.array([";".join(sorted(found.get(name, ()))) for name in record], str)
    for name in ("time", "temperature"):
        rows[name] = np.array([facts[name].get(one, np.nan) for one in record], float)
    rows["correlation_decades"] = np.array(
        [np.nan if one is None else correlation_length(one) for one in curves]
    )
    curves = [None if one is None or one.sizes["point"] < 2 else one for one in curves]
    ladder = ladder_of([one for one in curves if one is not None], POINTS_A_DECADE)
    points = on_one_ladder(curves, ladder) | coupling(curves, rows, ladder)
    made = {name: rows[name] for name in names("diagnosis/record")}
    seen = dataset("diagnosis/record", made | {"record": record})
    seen["force"].attrs |= load_attrs(stick.attrs)
    seen = seen.assign(dataset("diagnosis/point", points | {"amplitude": ladder}))
    placed = facts["laser_x"]
    more = {"laser_x_m": np.array([*placed.values()], float), "sensor_mode": [*placed]}
    if "stick_frequency_scatter" in rows:
        more["stick_frequency_scatter"] = rows["stick_frequency_scatter"]
    seen = seen.assign(dataset("diagnosis/observations", more))
    differences = group_differences(decays, [one.attrs["record"] in rejected for one in decays])
    seen = seen if differences is None else seen.merge(differences)
    step = reading_step(rows["force"], facts["scale"]) if facts["scale"] else 0.0
    return seen.assign_attrs(
        {
            "simulated": int(stick.attrs.get("simulated", 0)),
            "campaign": str(stick.attrs.get("campaign", "")),
            **{n: stick.attrs[n] for n in ("load_name", "load_unit") if n in stick.attrs},
            "gauge_full_scale_std_N": float(facts["same_everywhere"]),
            "gauge_relative_std": float(facts["of_reading"]),
            "gauge_resolution_N": float(step),
        }
    )


def _of_records(stick: xr.Dataset) -> dict[str, ndarray]:
    names = {
        "record": "record", "verdict": "verdict",
        "mode": "record_mode", "force": "record_force", "hold": "hold", "direction": "direction",
        "stick_frequency": "stick_frequency", "stick_frequency_std": "stick_frequency_std",
        "stick_loss_factor": "record_loss_factor", "onset_amplitude": "record_onset_amplitude",
        "stick_loss_factor_std": "record_loss_factor_std", "plateau_reached": "plateau_reached",
        "group": "record_group", "event": "event", "sensor": "sensor",
    }  # fmt: skip
    nothing = np.full(stick.sizes["record"], "")
    rows = {
        name: np.array(stick[own].values.tolist()) if own in stick else nothing
        for name, own in names.items()
    }
    rejected = np.char.startswith(rows["verdict"], "rejected")
    return rows | {"verdict": np.where(rejected, "rejected", "usable")}


def _of_table(stick: xr.Dataset) -> dict[str, ndarray]:
    """The rows of a table as records, and what each scatters about a smooth law (Hz).

    Where most loads have several modes, the rows of a load are of one clamping, or means over the
    same ones, whose contact all modes feel. Series of one mode each may meet at a load by chance.
    """
    mode, force = stick["mode"].values.astype(str), stick["force"].values.astype(float)
    level, modes = np.unique(force, return_inverse=True, return_counts=True)[1:]
    together = bool(mode.size) and np.median(modes) > 1.0
    unit, nothing = stick.attrs.get("load_unit", "N"), np.full(mode.size, "")
    return dict.fromkeys(("direction", "group", "event", "sensor"), nothing) | {
        "hold": np.array([f"load {k}" for k in level], str) if together else nothing,
        "record": np.array([f"{m}-{f:.0f}{unit}" for m, f in zip(mode, force, strict=True)], str),
        "mode": mode,
        "force": force,
        "stick_frequency": stick["frequency"].values.astype(float),
        "stick_frequency_std": stick["stated_std"].values.astype(float),
        "stick_frequency_scatter": stick["scatter_std"].values.astype(float),
        "stick_loss_factor": stick["loss_factor"].values.astype(float),
        "stick_loss_factor_std": stick["loss_factor_stated_std"].values.astype(float),
        "onset_amplitude": np.full(mode.size, np.nan),
        "plateau_reached": np.ones(mode.size, int),
        "verdict": np.full(mode.size, "usable"),
    }


def _findings(integrity: xr.Dataset | None) -> dict[str, set[str]]:
    found: dict[str, set[str]] = {}
    if integrity is None or "finding_id" not in integrity:
        return found
    parts = (integrity[name].values.astype(str) for name in ("finding_id", "finding_record"))
    for name, owner in zip(*parts, strict=True):
        found.setdefault(owner, set()).add(name)
    return found


def coupling(
    decays: Sequence[xr.Dataset | None],
    facts: Mapping[str, ndarray],
    ladder: Float[ndarray, " amplitude"],
) -> dict[str, Float[ndarray, "record amplitude"]]:
    """Error of ln f and of the loss factor by the event's other modes at the same sensor.

    After a blow several modes ring at once, and what one of them does to a joint that they share,
    the others feel: a small mode softens with the amplitude of a large one. No law over a mode's
    own amplitude holds that, so it is an error of the curve, not a cause: for each other mode its
    own change since small amplitudes, by its share of the displacement at the sensor.

    Args:
        decays: curves of the records, None where there is none.
        facts: `event`, `sensor` and `mode` of each record.
        ladder: amplitudes, m.
    """
    made = {name: np.zeros((len(decays), ladder.size)) for name in COUPLING_VARIABLES}
    place = list(zip(facts["event"], facts["sensor"], strict=True))
    for i, own in enumerate(decays):
        others = [
            other
            for k, other in enumerate(decays)
            if place[k] == place[i] and facts["mode"][k] != facts["mode"][i] and other is not None
        ]
        if own is None or not place[i][0] or not others:
            continue
        for name, curve in zip(COUPLING_VARIABLES, ("frequency", "loss_factor"), strict=True):
            error = sum(_by(other, own, curve) for other in others)
            at = on_ladder(own.assign({name: ("point", error)}), name, ladder)
            made[name][i] = np.nan_to_num(at)
    return made


def _by(other: xr.Dataset, own: xr.Dataset, curve: str) -> Float[ndarray, " point"]:
    """The other mode's change at the times of this one's points, by its share of the motion."""
    value = other[curve].values
    value = np.log(value) if curve == "frequency" else value
    log_a = np.log(other["amplitude"].values)
    known = np.flatnonzero(np.isfinite(value) & np.isfinite(log_a))
    time = own["time"].values + own.attrs["start_s"]
    if known.size < 2:
        return np.zeros(time.size)
    small = log_a[known] <= np.median(log_a[known])
    change = np.abs(value[known] - np.median(value[known][small]))
    clock = other["time"].values[known] + other.attrs["start_s"]
    amplitude = np.exp(np.interp(time, clock, log_a[known], right=-np.inf))
    return np.interp(time, clock, change) * amplitude / (amplitude + own["amplitude"].values)


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
