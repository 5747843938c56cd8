"""The product's own stages on one record, in one process, by their scripts."""

import importlib.util
import json
import sys
import time
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import xarray as xr

SCRIPTS = Path(__file__).resolve().parents[2] / "workflow" / "scripts"
SETTINGS = {"record": {"end": "noise"}, "decay": {"estimator": "blocks", "damping": "hysteretic"}}
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


@cache
def stage(name: str):
    """The main function of a stage's script."""
    if str(SCRIPTS) not in sys.path:
        sys.path.insert(0, str(SCRIPTS))
    spec = importlib.util.spec_from_file_location(f"stage_{name}", SCRIPTS / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.main


def load(path: Path) -> xr.Dataset:
    with xr.open_dataset(path) as data:
        return data.load()


def curves_of(decay: xr.Dataset) -> dict[str, np.ndarray]:
    """Points of the curves in the order of the record, finite ones only."""
    if any(name not in decay for name in NEEDED):
        return {}
    found = {name: np.atleast_1d(decay[name].values).astype(float) for name in (*NEEDED, "time")}
    finite = np.all([np.isfinite(values) for values in found.values()], axis=0)
    return {name: values[finite] for name, values in found.items()} if finite.any() else {}


def follow(record: Path, folder: Path) -> dict[str, np.ndarray]:
    stage("decay")(
        record=str(record), settings=json.dumps(SETTINGS["decay"]), decay=str(folder / "decay.nc"),
        plateau=str(folder / "plateau.nc"),
    )  # fmt: skip
    return curves_of(load(folder / "decay.nc"))


def analysed(entry: dict, folder: Path) -> Answer:
    """Record and decay stage on an entry of `sheet.campaign`."""
    record, start = folder / "record.nc", time.process_time()
    try:
        stage("record")(
            raw=str(entry["raw"]), facts=json.dumps(entry["facts"]), campaign="drawn",
            settings=json.dumps(SETTINGS["record"]), output=str(record),
        )  # fmt: skip
        curves, crash = follow(record, folder), ""
    except Exception as error:  # a crash is a result of the product under test
        return Answer("crash", [], "", {}, time.process_time() - start, repr(error)[:300])
    spent = time.process_time() - start
    judged = load(record)
    findings = [str(name) for name in np.atleast_1d(judged["finding_id"].values)]
    decay = load(folder / "decay.nc")
    if "pff_agrees" in decay and int(decay["pff_agrees"]) == 0:
        findings.append("peak-fitting-differs")
    told = str(judged.attrs.get("reason", ""))
    return Answer(str(judged.attrs["verdict"]), findings, told, curves, spent, crash)


def unchecked(folder: Path) -> dict[str, np.ndarray]:
    """The curves of the record that was dropped last, as if no check had spoken; none if it cannot.

    What a check has masked counts again; what was subtracted stays so.
    """
    judged = load(folder / "record.nc")
    if judged.sizes.get("time", 0) < 100:
        return {}
    judged.attrs |= {"verdict": "usable", "reason": "", "findings": ""}
    if "usable" in judged:
        judged["usable"] = xr.ones_like(judged["usable"])
    judged = judged.isel(finding=slice(0, 0)) if "finding" in judged.dims else judged
    judged.drop_encoding().to_netcdf(folder / "unchecked.nc")
    try:
        return follow(folder / "unchecked.nc", folder)
    except Exception:  # without a curve there is nothing to compare
        return {}
