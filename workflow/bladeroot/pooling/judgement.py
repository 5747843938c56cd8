"""What was found wrong in a campaign's records, and how two estimators agree on each."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from bladeroot.loads import AXIAL_FORCE, at_load, load_attrs, load_facts_of, shown, value_of
from bladeroot.pooling.repeats import unlike_repeats
from bladeroot.pooling.sensors import (
    close_elsewhere,
    passed_ends,
    shared_steps,
    unlike_sensors,
)
from bladeroot.variables import dataset

# Columns of a record's finding table, as `bladeroot.quality.integrity` makes it.
FINDING_COLUMNS = {"id": str, "statistic": float, "threshold": float, "consequence": str,
                   "text": str, "from_s": float, "to_s": float}  # fmt: skip
# Relative difference of sampling frequencies of one event, at most: as between file and sheet.
TIME_BASE_TOLERANCE = 1e-4
# What a second estimator (peak fitting) says of each record.
SECOND_OPINION = (
    "pff_frequency_difference",
    "pff_frequency_difference_z",
    "pff_loss_factor_difference",
    "pff_loss_factor_difference_z",
    "pff_agrees",
    "pff_finding",
)


def judgement(
    records: Sequence[xr.Dataset], decays: Sequence[xr.Dataset], plateaus: Sequence[xr.Dataset]
) -> xr.Dataset:
    """The findings of all records in one table, and the second opinion on every record.

    records: free decays with their findings (dim finding). decays: curves of the same records in
    the same order, with the scalars of `bladeroot.quality.agreement.compare`. plateaus: of the
    same.

    Returns:
        dim finding: finding_record and the columns of the findings, with those that only the
        records together show (`bladeroot.pooling.repeats`) after each record's own; dim record:
        mode, force (N), verdict, masked (part of the decay's samples without weight), and the
        differences between peak fitting and FREEVIB.
    """
    names = [str(record.attrs["record"]) for record in records]
    together = _of_repeats(decays, plateaus) + _of_events(records) + _of_sensors(records, decays)
    together += _of_close_modes(records, decays)
    together += _of_steps(records) + _of_ends(records, decays)
    columns = {
        f"finding_{name}": np.concatenate(
            [
                np.zeros(0, kind),
                *(record[f"finding_{name}"].values for record in records),
                [finding[name] for _, finding in together],
            ]
        ).astype(kind)
        for name, kind in FINDING_COLUMNS.items()
    }
    owners = np.repeat(names, [record.sizes["finding"] for record in records]).tolist()
    owners += [names[k] for k, _ in together]
    first = records[0]
    made = {
        name: ("finding", values, first[name].attrs if name in first else {})
        for name, values in columns.items()
    }
    for name in SECOND_OPINION:
        attrs = decays[0][name].attrs
        made[name] = ("record", np.array([decay[name].item() for decay in decays]), attrs)
    load = load_facts_of(records)
    facts = {
        "record": names,
        "finding_record": np.array(owners, str),
        "mode": [str(record.attrs["mode"]) for record in records],
        "force": [value_of(record.attrs) for record in records],
        "verdict": [str(decay.attrs["verdict"]) for decay in decays],
        "masked": [_masked(record) for record in records],
    }
    simulated = max(int(record.attrs["simulated"]) for record in records)
    whole = dataset("pooling/judgement", facts).assign(made)
    whole["force"].attrs = load_attrs(load)
    return whole.assign_attrs(simulated=simulated, **load)


def _of_repeats(
    decays: Sequence[xr.Dataset], plateaus: Sequence[xr.Dataset]
) -> list[tuple[int, dict[str, float | str]]]:
    """Findings on records that are unlike their repeats, each with the record's number."""
    found = []
    for k, apart, allowed in unlike_repeats(decays, plateaus):
        facts = plateaus[k].attrs
        text = (
            f"lies {100.0 * apart:+.2f} % from the other records of mode {facts['mode']}"
            f"{at_load(facts)} (in clamping {facts['hold']}): sampling rate, mode or "
            f"{_wrong(facts)} wrong? It counts all the same; column exclude of records.csv leaves "
            "it out"
        )
        found.append((k, _warning("unlike-repeats", abs(apart), allowed, text)))
    return found


def _wrong(facts: Mapping) -> str:
    """What may be wrong with a record's load, in a word; another group where there is no load."""
    name = shown(facts)[2]
    return ("force" if name == AXIAL_FORCE else name) or "group"


def _of_events(records: Sequence[xr.Dataset]) -> list[tuple[int, dict[str, float | str]]]:
    """Findings on records of one event, which is one motion, in another time base."""
    first: dict[str, int] = {}
    found = []
    for k, record in enumerate(records):
        event = str(record.attrs.get("event", ""))
        if not event or not np.isfinite(rate := float(record.attrs["sampling_Hz"])):
            continue
        own = first.setdefault(event, k)
        apart = abs(rate / float(records[own].attrs["sampling_Hz"]) - 1.0)
        if apart > TIME_BASE_TOLERANCE:
            text = (
                f"event {event} is one motion, but it is sampled at {rate:.9g} Hz here and at "
                f"{float(records[own].attrs['sampling_Hz']):.9g} Hz in record "
                f"{records[own].attrs['record']}: another event, or a wrong sampling_Hz?"
            )
            found.append((k, _warning("event-time-base", apart, TIME_BASE_TOLERANCE, text)))
    return found


def _of_sensors(
    records: Sequence[xr.Dataset], decays: Sequence[xr.Dataset]
) -> list[tuple[int, dict[str, float | str]]]:
    """Findings on records that show another motion than other sensors of their event."""
    found = []
    for k, other, apart in unlike_sensors(records, decays):
        own, there = (float(decays[n]["frequency"].median()) for n in (k, other))
        facts, sensor = records[k].attrs, records[other].attrs.get("sensor", "")
        text = (
            f"event {facts['event']} is one motion, but mode {facts['mode']} has another frequency "
            f"or damping here ({own:.5g} Hz in the median) than at sensor {sensor} "
            f"({there:.5g} Hz), by {apart:.1f} times 4 stated errors of both for a "
            "quarter of the time, or 10 for a twentieth: another mode near a node of this one, one "
            "that beats with it, or files that do not begin together?"
        )
        found.append((k, _warning("unlike-sensors", apart, 1.0, text)))
    return found


def _of_close_modes(
    records: Sequence[xr.Dataset], decays: Sequence[xr.Dataset]
) -> list[tuple[int, dict[str, float | str]]]:
    """Findings on records in which a close mode is not seen that another sensor sees."""
    found = []
    for k, other, line_Hz in close_elsewhere(records, decays):
        facts, sensor = records[k].attrs, records[other].attrs.get("sensor", "")
        text = (
            f"event {facts['event']} is one motion, in which sensor {sensor} sees another mode "
            f"near {line_Hz:.5g} Hz beside mode {facts['mode']}: here it is not seen apart, and "
            "what of it is in the curve is not known; name it among the campaign's modes"
        )
        found.append((k, _warning("not-apart", np.nan, np.nan, text)))
    return found


def _of_steps(records: Sequence[xr.Dataset]) -> list[tuple[int, dict[str, float | str]]]:
    """Findings on records that share a step with other sensors of their event."""
    found = []
    for k, ratio, moment, count in shared_steps(records):
        facts = records[k].attrs
        text = (
            f"event {facts['event']}: {count} sensors see mode {facts['mode']} step at "
            f"{moment:.4g} s of the record, as if something touched the specimen; too little here "
            "to be told by this record alone: nothing masked"
        )
        since = moment - float(facts["start_s"])
        found.append((k, _warning("shared-step", ratio, 1.0, text, since)))
    return found


def _of_ends(
    records: Sequence[xr.Dataset], decays: Sequence[xr.Dataset]
) -> list[tuple[int, dict[str, float | str]]]:
    """Findings on records whose curve goes on where other sensors of the event are disturbed."""
    found = []
    for k, moment, count in passed_ends(records, decays):
        facts = records[k].attrs
        text = (
            f"event {facts['event']}: {count} other sensors see mode {facts['mode']} disturbed at "
            f"{moment:.4g} s of the record, and end there: this one sees too little of it and goes "
            "on; end_s in records.csv ends it there"
        )
        since = moment - float(facts["start_s"])
        found.append((k, _warning("shared-end", float(count), 2.0, text, since)))
    return found


def _warning(
    name: str, statistic: float, threshold: float, text: str, at_s: float = np.nan
) -> dict[str, float | str]:
    """A finding that warns, of the whole decay or of a moment in it (s from its start)."""
    values = (name, statistic, threshold, "warn", text, at_s, at_s)
    return dict(zip(FINDING_COLUMNS, values, strict=True))


def _masked(record: xr.Dataset) -> float:
    usable = record["usable"].values
    return float(1.0 - usable.mean()) if usable.size else 0.0
