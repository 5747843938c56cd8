"""The product's own stages on the records of an event: the functions that its scripts call."""

import time
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import xarray as xr
from bladeroot.decay.from_file import from_file
from bladeroot.decay.record import estimate
from bladeroot.pooling.sensors import close_elsewhere, passed_ends, shared_steps, unlike_sensors

CUTTING = {"end": "noise"}
ESTIMATION = {"damping": "hysteretic"}
NEEDED = ("amplitude", "frequency", "loss_factor", "frequency_std", "loss_factor_std")


@dataclass
class Answer:
    """What came out: the curves (or none), what was told, CPU seconds, and a crash's text."""

    verdict: str
    findings: list[str]
    told: str
    curves: dict[str, np.ndarray]
    cpu_s: float
    crash: str = ""
    judged: xr.Dataset = field(default_factory=xr.Dataset)
    decay: xr.Dataset = field(default_factory=xr.Dataset)


def curves_of(decay: xr.Dataset) -> dict[str, np.ndarray]:
    """Points of the curves in the order of the record, finite ones only."""
    if any(name not in decay for name in NEEDED):
        return {}
    found = {name: np.atleast_1d(decay[name].values).astype(float) for name in (*NEEDED, "time")}
    finite = np.all([np.isfinite(values) for values in found.values()], axis=0)
    return {name: values[finite] for name, values in found.items()} if finite.any() else {}


def analysed(entry: dict) -> Answer:
    """The ring-down stage on an entry of `sheet.campaign`."""
    start = time.process_time()
    try:
        judged, decay, _ = from_file(Path(entry["raw"]), entry["facts"], CUTTING, ESTIMATION)
    except Exception as error:  # a crash is a result of the product under test
        return Answer("crash", [], "", {}, time.process_time() - start, repr(error)[:300])
    spent = time.process_time() - start
    findings = [str(name) for name in np.atleast_1d(judged["finding_id"].values)]
    if "pff_agrees" in decay and int(decay["pff_agrees"]) == 0:
        findings.append("peak-fitting-differs")
    told = str(judged.attrs.get("reason", ""))
    verdict, curves = str(judged.attrs["verdict"]), curves_of(decay)
    return Answer(verdict, findings, told, curves, spent, judged=judged, decay=decay)


def judged_together(answers: list[Answer]) -> None:
    """What only an event's records together show, among the findings of each."""
    made = [one for one in answers if not one.crash]
    records, decays = [one.judged for one in made], [one.decay for one in made]
    for name, found in (
        ("unlike-sensors", unlike_sensors(records, decays)),
        ("not-apart", close_elsewhere(records, decays)),
        ("shared-step", shared_steps(records)),
        ("shared-end", passed_ends(records, decays)),
    ):
        for number, *_ in found:
            made[number].findings.append(name)


def unchecked(answer: Answer) -> dict[str, np.ndarray]:
    """The curves of a record that was dropped, as if no check had spoken; none if it cannot.

    What a check has masked counts again; what was subtracted stays so.
    """
    judged = answer.judged
    if judged.sizes.get("time", 0) < 100:
        return {}
    judged = judged.assign_attrs(verdict="usable", reason="", findings="")
    if "usable" in judged:
        judged["usable"] = xr.ones_like(judged["usable"])
    judged = judged.isel(finding=slice(0, 0)) if "finding" in judged.dims else judged
    try:
        return curves_of(estimate(judged, **ESTIMATION))
    except Exception:  # without a curve there is nothing to compare
        return {}
