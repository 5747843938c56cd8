"""A campaign's diagnosis with whatever it is judged against: dataset, verdict and model file."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import pandas as pd
import xarray as xr

from bladeroot.diagnosis import guards
from bladeroot.diagnosis.dataset import dataset
from bladeroot.diagnosis.diagnose import (
    Settings,
    diagnose,
    with_lower_forces,
)
from bladeroot.diagnosis.extension import SCHEMA as EXTENSION
from bladeroot.diagnosis.extension import model_file
from bladeroot.diagnosis.next_measurement import following, next_measurements
from bladeroot.diagnosis.possible import impossible, impossible_table
from bladeroot.diagnosis.simulation.interface import Simulation
from bladeroot.diagnosis.simulation.linear import JOINT, JOINT_DOUBT, SPEED, Linear
from bladeroot.diagnosis.simulation.own_range import (
    dataset_in_own,
    in_catalogue,
    own_range,
    verdict_in_own,
)
from bladeroot.diagnosis.simulation.parametric import Parametric, of_assembly, of_structure
from bladeroot.diagnosis.simulation.table import Table, moved, table_of, with_loads
from bladeroot.diagnosis.verdict import SCHEMA, records_of, verdict
from bladeroot.loads import shown
from bladeroot.mechanisms.mechanism import Mechanism
from bladeroot.pooling.groups import group_sentences
from bladeroot.terms import Terms
from bladeroot.variables import dataset as tabled

BASELINE = "linear baseline"
SILENT = (
    "A linear mode's level is free: mass, modulus, contact stiffness and all else that is the same "
    "in all records are not spoken of"
)
SILENT_LOAD = "; so is its line over the load, and with it the scale and the zero of the reading"
CONTACT_LAWS = ("load-dependent-stiffness", "incomplete-contact", "loading-hysteresis")
AS_IF = (
    f". Sizes of laws of the joint's stiffness are as if {100.0 * JOINT:.0f} % of the modes' "
    f"stiffness went through it; their errors hold a factor of {JOINT_DOUBT:g} in that"
)
Made = tuple[xr.Dataset, dict, dict | None]
# Standard deviation of a model's frequencies where nothing is stated, per cent.
BIAS_PERCENT = 0.5


def judge(
    seen: xr.Dataset,
    simulation: xr.Dataset | pd.DataFrame | None,
    facts: Mapping,
    candidates: Sequence[Mechanism],
) -> Made:
    """A campaign's diagnosis, with whatever it is judged against.

    simulation: a structure's parametric model, a table of simulated frequencies
    (`bladeroot.io.table`), or None for linear modes. facts: as of
    `bladeroot.io.facts.diagnosis_facts`. candidates: `bladeroot.mechanisms.catalogue`.
    """
    expected = facts.get("expected_Hz", {})
    usual = dict.fromkeys(("1B", "2B"), BIAS_PERCENT)
    bias, offset = (
        {mode: percent / 100 for mode, percent in facts.get(name, default).items()}
        for name, default in (("fe_bias_percent", usual), ("fe_offset_percent", {}))
    )
    settings = Settings(
        1000.0 * facts.get("full_contact_from_kN", 0.0),
        _independent(facts.get("independent", []), seen), facts.get("costs", {}),
    )  # fmt: skip
    if simulation is None:
        linear = _linear(seen, expected)
        return judged(seen, linear, settings, [x for x in candidates if not linear.silent(x)])
    usual, found = BIAS_PERCENT / 100, frequencies(seen, expected)
    if isinstance(simulation, pd.DataFrame):
        table = table_of(simulation, simulation.attrs["name"], {"": usual} | bias, offset)
        reason = impossible_table(table, found)
        if reason:
            return refused(seen, table.structure, reason)
        return judged(seen, table, settings, candidates)
    name, assembly = simulation.attrs["structure"], simulation.attrs.get("kind") == "assembly"
    lacks = facts.get("structure_lacks", "")
    stated = {mode: bias.get(mode, usual) for mode in expected} if assembly else bias
    reason = impossible(simulation, found, stated)
    if reason or lacks:
        return refused(seen, name, reason or f"{name} cannot be compared with: {lacks}")
    if assembly:
        known = simulation["mode"].isin(seen["mode"].values.astype(str))
        made = of_assembly(simulation.isel(mode=known.values), stated, offset, usual)
    else:
        made = of_structure(simulation, seen["mode"].values.astype(str), bias, offset)
    return judged(seen, made, settings, candidates)


def _independent(measured: Sequence[Mapping], seen: xr.Dataset) -> dict[str, tuple[float, float]]:
    """Value and standard deviation of each independent measurement.

    A load cell's zero is where the line through its loads meets no load: a gauge whose gain is not
    the same at all loads bends that line, by the part of its effect to which laws are exact.
    """
    found = {one["measurement"]: (one["value"], one["std"]) for one in measured}
    if {"load cell scale", "load cell zero"} <= found.keys():
        gain, (zero, std) = found["load cell scale"][0], found["load cell zero"]
        bend = guards.TRUST * abs(gain) * float(seen["force"].max())
        found["load cell zero"] = zero, float(np.hypot(std, bend))
    return found


def _linear(seen: xr.Dataset, expected: Mapping[str, float]) -> Linear:
    """Linear modes, those expected that were measured."""
    modes = tuple(mode for mode in expected if mode in set(seen["mode"].values.astype(str)))
    own = own_range(seen)
    at = np.array([expected[mode] for mode in modes], float)
    power = 2.0 if own.unit == SPEED else 1.0
    return Linear(modes, at, bool(own.name), power, own.shift * own.per_load)


def judged(
    seen: xr.Dataset, simulated: Simulation, settings: Settings, candidates: Sequence[Mechanism]
) -> Made:
    """Against any simulation, in the campaign's own range of load and amplitude."""
    own = own_range(seen)
    if simulated.kind == "structure":  # which the priors are made for
        own = replace(own, per_load=1.0, shift=0.0, per_metre=1.0)
    if isinstance(simulated, Parametric):
        simulated = replace(simulated, per_load=own.per_load, shift=own.shift)
    if isinstance(simulated, Table):
        simulated = with_loads(simulated, own.per_load, own.shift, own.per_metre)
    scaled = in_catalogue(seen, own)
    least = (settings.least_force + own.shift) * own.per_load if settings.least_force else 0.0
    terms = Terms(own.name, simulated.kind != "none")
    asked = replace(settings, least_force=least)
    made = diagnose(scaled, simulated, asked, candidates, terms=terms)
    factor, unit, _ = shown(_load(seen))
    further = next_measurements(
        made,
        lambda force: f"{factor * (force / own.per_load - own.shift):.3g} {unit}".strip(),
        lambda size: f"{size / own.per_load:.3g} {own.unit}".strip(),
    )
    dovetail = simulated.kind == "structure"
    said = verdict(made, with_lower_forces(scaled, simulated, asked, candidates) if dovetail
                   else None)  # fmt: skip
    whole = dataset_in_own(dataset(made, said).merge(further), own)
    said = verdict_in_own(said | {"next": following(further, made)}, own)
    if simulated.kind == "none":
        silent = SILENT + (SILENT_LOAD if own.name else "")
        if any(one["mechanism"] in CONTACT_LAWS for one in said["causes"] if one["shown"]):
            silent += AS_IF
        said["reason"] = ". ".join(filter(None, (said["reason"], silent)))
    if isinstance(simulated, Table):
        stick = [one.final for one in made.found if one.channel.name == "stick"]
        far = [moved(simulated, made.data.records, made.data.ln_f, one) for one in stick]
        said["reason"] = ". ".join([said["reason"], *far])
    said = _with_groups(said | {"structure": simulated.structure or None}, seen)
    whole.attrs |= {"structure": simulated.structure or BASELINE, "reason": said["reason"],
                    "kind": simulated.kind, **_load(seen)}  # fmt: skip
    return whole, said, model_file(made) if dovetail else None


def refused(seen: xr.Dataset, structure: str, reason: str) -> Made:
    """The answer where a structure cannot be the specimen: one sentence, and no cause."""
    said = {
        "schema": SCHEMA, "campaign": str(seen.attrs.get("campaign", "")),
        "structure": structure,
        "answer": "insufficient-data", "refused": True, "probabilities": {},
        "causes": [], "shortfall": [], "gain": {},
        "records": records_of(seen), "reason": reason, "possible": {}, "next": [],
    }  # fmt: skip
    empty = np.array([], dtype=str)
    names = ("candidate", "class", "channel", "sentence", "barred")
    nothing = {"log_evidence": np.zeros(0), "is_named": np.zeros(0, int)}
    whole = tabled("diagnosis/ranking", nothing | dict.fromkeys(names, empty))
    whole.attrs = {"structure": structure, "answer": said["answer"], "reason": reason, "named": "",
                   "lacks": "", "least_force_N": 0.0, "refused": 1}  # fmt: skip
    unchanged = {"schema": EXTENSION, "campaign": said["campaign"], "structure": structure,
                 "contact": {}, "mechanisms": []}  # fmt: skip
    return whole, said, unchanged


def _load(seen: xr.Dataset) -> dict[str, str]:
    return {k: str(seen.attrs[k]) for k in ("load_name", "load_unit") if k in seen.attrs}


def frequencies(seen: xr.Dataset, expected: Mapping[str, float]) -> dict[str, float]:
    """Median stick frequency (Hz) of each mode, or the expected one where there is none."""
    mode, value = seen["mode"].values.astype(str), seen["stick_frequency"].values
    usable = np.isfinite(value) & (seen["verdict"].values.astype(str) == "usable")
    found = {n: float(np.median(value[usable & (mode == n)])) for n in np.unique(mode[usable])}
    return {name: float(own) for name, own in expected.items()} | found


def _with_groups(said: dict, seen: xr.Dataset) -> dict:
    """A verdict with what differs between groups, which no cause of the catalogue explains."""
    if "compared_mode" not in seen:
        return said
    rows = []
    for k in np.flatnonzero(seen["told"].values):
        one = seen.isel(comparison=int(k))
        quantity = str(one["compared_quantity"].item()).replace("_", " ")
        largest = float(one["largest"])
        at_one = np.isfinite(largest)
        size = largest if at_one else float(one["difference"])
        high, low = (
            one[f"largest_{end}" if at_one else f"{end}_group"].item() for end in ("high", "low")
        )
        rows.append(
            {
                "quantity": quantity, "mode": str(one["compared_mode"].item()),
                "trend": f"differs between groups at the same amplitude by up to "
                f"{100.0 * size:.2g} %, {high} over {low}",
                "size": float(np.log1p(size)), "unit": "1", "explained": False,
            }
        )  # fmt: skip
    lines = group_sentences(seen)
    if not lines:
        return said
    lines = [f"{line[0].upper()}{line[1:]}" for line in lines]
    answer = "unexplained" if said["answer"] == "nothing-missing" else said["answer"]
    return said | {
        "answer": answer,
        "shortfall": [*said["shortfall"], *rows],
        "reason": f"{'. '.join(lines)}. {said['reason']}",
    }
