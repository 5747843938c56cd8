"""The simulation extended by its causes: a model file, and the file applied.

The file says the baseline's stiffness law and each cause with its parameters; hooks are found in
the catalogue by the cause's id. The stages take it as `extension`.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.diagnosis.diagnose import Diagnosis
from bladeroot.mechanisms.mechanism import CurveEffect, Mechanism, Points, Records
from bladeroot.stiffness.laws import REFERENCE_FORCE
from bladeroot.structure.parametric import ritz_of
from bladeroot.structure.ritz import solve
from bladeroot.structure.sensitivity import Change

SCHEMA = "bladeroot-extension-1"


def model_file(made: Diagnosis) -> dict:
    """What `model.yaml` holds: the law of the contact stiffness and the causes."""
    law, mechanisms = {}, []
    for found in made.found:
        theta, first = found.final.parameters, found.channel.base
        if found.channel.name == "stick":
            law = {
                "reference_force_N": REFERENCE_FORCE,
                "kn_N_per_m": float(np.exp(theta[0])),
                "kt_N_per_m": float(np.exp(theta[1])),
                "exponent": float(theta[2]),
                "bias": {mode: float(theta[3 + k]) for k, mode in enumerate(made.data.modes)},
            }
        for cause in found.causes:
            own = slice(first, first + len(cause.mechanism.parameters))
            first = own.stop
            values, chain = cause.mechanism.values(theta[own])
            mechanisms.append(
                {
                    "mechanism": cause.mechanism.id,
                    "parameters": {
                        p.name: {"value": float(v), "std": float(s), "unit": p.unit}
                        for p, v, s in zip(
                            cause.mechanism.parameters, values, chain * found.final.std[own],
                            strict=True,
                        )
                    },
                }
            )  # fmt: skip
    return {
        "schema": SCHEMA,
        "campaign": str(made.seen.attrs.get("campaign", "")),
        "structure": made.structure,
        "contact": law,
        "mechanisms": mechanisms,
    }


@dataclass(frozen=True)
class Extension:
    """A model file with its mechanisms and the values of their parameters."""

    contact: dict
    causes: tuple[tuple[Mechanism, ndarray], ...]


def read(document: Mapping, catalogue: Sequence[Mechanism]) -> Extension:
    """A model file's content. ValueError for a mechanism that the catalogue lacks."""
    by_id = {one.id: one for one in catalogue}
    causes = []
    for entry in document["mechanisms"]:
        if entry["mechanism"] not in by_id:
            raise ValueError(
                f"the extension names {entry['mechanism']!r}, which is not in the catalogue"
            )
        one = by_id[entry["mechanism"]]
        values = [entry["parameters"][p.name]["value"] for p in one.parameters]
        causes.append((one, np.array(values, float)))
    return Extension(dict(document["contact"]), tuple(causes))


def situation(extension: Extension, records: Records) -> dict[str, Float[ndarray, " record"]]:
    """ln kn, ln kt, true axial force (N) and further change of ln f of records, extended."""
    contact = extension.contact
    x = np.log(records.force / contact["reference_force_N"])
    whole = {
        "ln_kn": np.log(contact["kn_N_per_m"]) + contact["exponent"] * x,
        "ln_kt": np.log(contact["kt_N_per_m"]) + contact["exponent"] * x,
        "force": records.force.copy(),
        "ln_f": np.zeros(records.force.size),
    }
    for one, values in extension.causes:
        if one.stick is not None:
            for name, change in one.stick(records, values).changes.items():
                whole[name] = whole[name] + change
    return whole


def matrices(extension: Extension, model: xr.Dataset, mode: str) -> Change:
    """Lasting change of stiffness and mass in the basis of one mode of the parametric model."""
    ritz = ritz_of(model, mode)
    stiffness, mass = np.zeros_like(ritz.beam), np.zeros_like(ritz.beam)
    for one, values in extension.causes:
        if one.structure is not None and one.course is None:
            change, _ = one.structure(ritz, values)
            stiffness, mass = stiffness + change.stiffness, mass + change.mass
    return Change(stiffness, mass)


def curves(extension: Extension, points: Points) -> CurveEffect:
    """Change of ln f and of the loss factor over amplitude."""
    ln_f, loss = np.zeros(points.mode.size), np.zeros(points.mode.size)
    for one, values in extension.causes:
        if one.curve is not None:
            effect = one.curve(points, values)
            ln_f, loss = ln_f + effect.ln_f, loss + effect.loss
    none = np.zeros((points.mode.size, 0))
    return CurveEffect(ln_f, loss, none, none)


def corrected(extension: Extension, stick: xr.Dataset, model: xr.Dataset) -> xr.Dataset:
    """Stick frequencies as the unextended model can take them: with it, any stage reruns extended.

    The axial force of each level becomes the true one; what changed matrices do to the frequency
    is taken off it, at the extension's own kn and kt. Laws of the contact stiffness need no
    correction: the stiffness stage finds kn and kt at each force.
    """
    mode, force = stick["mode"].values.astype(str), stick["force"].values.astype(float)
    none = np.zeros(force.size)
    records = Records(np.zeros(force.size, dtype=int), force, none, none, none, 0.0, 0.0)
    at = situation(extension, records)
    points = np.stack([at["ln_kn"], at["ln_kt"], at["force"]], axis=1)
    low, high = model["box"].values
    shift = at["ln_f"]
    for name in np.unique(mode):
        mine = mode == name
        change, ritz = matrices(extension, model, str(name)), ritz_of(model, str(name))
        pairs = solve(ritz, np.clip(points[mine], low, high))
        y, kept = pairs.shape, slice(0, ritz.own)
        stiff, mass = (
            np.einsum("pi,ij,pj->p", y, part[kept, kept], y)
            for part in (change.stiffness, change.mass)
        )
        shift[mine] += 0.5 * (np.log1p(stiff / pairs.value) - np.log1p(mass))
    factor = np.exp(-shift)
    result = stick.copy()
    result["force"] = stick["force"].copy(data=at["force"])
    for name in ("frequency", "frequency_std", "within_std"):
        result[name] = stick[name] * factor
        result[name].attrs = stick[name].attrs
    return result
