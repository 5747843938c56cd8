"""The simulation extended by its causes: a model file, and the file applied.

The file says the baseline's stiffness law and each cause with its parameters; hooks are found in
the catalogue by the cause's id. The stages take it as `extension`.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy import ndarray

from bladeroot.diagnosis.causes import places
from bladeroot.diagnosis.diagnose import Diagnosis
from bladeroot.diagnosis.plausibility import sizes
from bladeroot.mechanisms.mechanism import CurveEffect, Mechanism, Points
from bladeroot.mechanisms.per_mode import modes_of, of_modes
from bladeroot.rom.changed import changed_model
from bladeroot.rom.parametric import ritz_of
from bladeroot.rom.sensitivity import Change
from bladeroot.stiffness.priors import REFERENCE_FORCE

SCHEMA = "bladeroot-extension-1"


def model_file(made: Diagnosis) -> dict:
    """What `model.yaml` holds: the law of the contact stiffness and the causes."""
    law, mechanisms = {}, []
    for found in made.found:
        theta, causes = found.final.parameters, [one.mechanism for one in found.causes]
        if found.channel.name == "stick" and made.simulated.kind == "structure":
            law = {
                "reference_force_N": REFERENCE_FORCE,
                "kn_N_per_m": float(np.exp(theta[0])),
                "kt_N_per_m": float(np.exp(theta[1])),
                "exponent": float(theta[2]),
                "bias": {mode: float(theta[3 + k]) for k, mode in enumerate(made.data.modes)},
            }
        for one, own in zip(causes, places(causes, found.channel.base), strict=True):
            values = zip(one.parameters, sizes(one, found.final, own), strict=True)
            parameters = {
                p.name: {"value": value, "std": std, "unit": p.unit} for p, (value, std) in values
            }
            mechanisms.append({"mechanism": one.id, "form": one.form, "parameters": parameters})
    return {
        "schema": SCHEMA,
        "campaign": str(made.seen.attrs.get("campaign", "")),
        "structure": made.simulated.structure,
        "contact": law,
        "mechanisms": mechanisms,
    }


@dataclass(frozen=True)
class Extension:
    """A model file with its mechanisms and the values of their parameters."""

    contact: dict
    causes: tuple[tuple[Mechanism, ndarray], ...]


def read(document: Mapping, catalogue: Sequence[Mechanism]) -> Extension:
    """A model file's content; of a cause without a form the mechanism's first.

    ValueError for a mechanism or a form that the catalogue lacks.
    """
    by_id = {one.id: one for one in catalogue}
    causes = []
    for entry in document["mechanisms"]:
        if entry["mechanism"] not in by_id:
            raise ValueError(
                f"the extension names {entry['mechanism']!r}, which is not in the catalogue"
            )
        one = by_id[entry["mechanism"]]
        one = one.of_form(entry.get("form", one.form))
        one = of_modes(one, modes_of(one, set(entry["parameters"])))
        if lacks := [p.name for p in one.parameters if p.name not in entry["parameters"]]:
            raise ValueError(f"the extension's {one.id} lacks {', '.join(lacks)}")
        values = [entry["parameters"][p.name]["value"] for p in one.parameters]
        causes.append((one, np.array(values, float)))
    return Extension(dict(document["contact"]), tuple(causes))


def matrices(extension: Extension, model: xr.Dataset, mode: str) -> Change:
    """Lasting change of stiffness and mass in the basis of one mode of the parametric model."""
    ritz = ritz_of(model, mode)
    stiffness, mass = np.zeros_like(ritz.beam), np.zeros_like(ritz.beam)
    for one, values in extension.causes:
        if one.structure is not None:
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


def structure_of(extension: Extension, model: xr.Dataset) -> xr.Dataset:
    """The parametric model with the causes that change the matrices; the same if none does."""
    if not any(one.structure is not None for one, _ in extension.causes):
        return model
    modes = [str(mode) for mode in model["mode"].values]
    return changed_model(model, {mode: matrices(extension, model, mode) for mode in modes})


def amplitude_causes(extension: Extension) -> list[str]:
    """Causes that change frequency and damping over amplitude."""
    return [one.id for one, _ in extension.causes if one.curve is not None]


def curves_of(extension: Extension, simulated: xr.Dataset) -> xr.Dataset:
    """Simulated curves, from `bladeroot.nonlinear.backbone`, with the causes over amplitude.

    A mode that the diagnosis did not have is counted with its other modes.
    """
    order = list(extension.contact.get("bias", sorted(simulated["mode"].values)))
    whole = simulated["loss_factor"].transpose("mode", "force", "amplitude")
    names, force, amplitude = np.meshgrid(
        *(whole[name].values for name in whole.dims), indexing="ij"
    )
    number = {name: order.index(name) if name in order else len(order) for name in names[:, 0, 0]}
    stuck = np.broadcast_to(whole.values[:, :, :1], whole.shape)
    points = Points(
        np.array([number[name] for name in names.ravel()]),
        force.ravel(),
        amplitude.ravel(),
        np.nan_to_num(stuck).ravel(),
    )
    effect = curves(extension, points)
    loss = whole.copy(data=effect.loss.reshape(whole.shape))
    factor = whole.copy(data=np.exp(effect.ln_f).reshape(whole.shape))
    result = simulated.copy()
    for name, value in (
        ("frequency", simulated["frequency"] * factor),
        ("loss_factor", simulated["loss_factor"] + loss),
        ("damping_ratio", simulated["damping_ratio"] + loss / 2.0),
    ):
        result[name] = value.transpose(*simulated[name].dims).assign_attrs(simulated[name].attrs)
    return result.assign_attrs(extended_by=";".join(amplitude_causes(extension)))
