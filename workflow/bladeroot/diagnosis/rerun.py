"""What a model file changes in the stages: the law and the gauge of the joint inference, the
matrices of the parametric model, and the curves over amplitude.

The joint inference takes the form of a cause from the model file and finds its size itself: the
file's size comes from the same frequencies, which would otherwise count twice.
"""

from dataclasses import replace

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.diagnosis.extension import Extension, curves, matrices
from bladeroot.diagnosis.simulation.parametric import EXPONENT
from bladeroot.mechanisms.mechanism import Mechanism, Points, Records
from bladeroot.stiffness.interpolation import ForceGauge
from bladeroot.stiffness.laws import PRIORS, Law, powers, slopes
from bladeroot.structure.changed import changed_model

GAUGE = ("force-gain", "force-offset")
_STIFFNESS = ("ln_kn", "ln_kt")
_SCALES = {(False, False): "", (True, False): "ln ", (False, True): "logit "}  # of a parameter


def law_of(extension: Extension) -> Law:
    """The law of kn and kt with the causes that change them.

    A cause that is not linear in its parameters is made straight about the file's values.
    """
    shaped = [(one, values) for one, values in extension.causes if one.id in _shapers(extension)]
    names = ["ln_kn", "ln_kt", "exponent"]
    origin = "smooth contact stiffens with exponent 0 to 0.07 (6.16)"
    priors = {**PRIORS, "exponent": (*EXPONENT, origin)}
    centres = []
    for one, values in shaped:
        for p, value in zip(one.parameters, values, strict=True):
            name = f"{one.id} {_SCALES[p.log, p.bounded]}{p.name}"
            priors[name] = (p.start, p.std, p.source)
            names.append(name)
            centres.append(p.coordinate(value))
    count, own = 3 + 2 + 2 * len(centres), len(centres)
    matrix, constant = np.zeros((2, count, len(names))), np.zeros((2, count))
    for k in (0, 1):
        matrix[k, 0, k] = matrix[k, 1, 2] = 1.0
        constant[k, 3 + k] = 1.0
        place = 5 + k * own + np.arange(own)
        matrix[k, place, 3 + np.arange(own)] = 1.0
        constant[k, place] = -np.array(centres)

    def functions(force: Float[ndarray, "*point"]) -> Float[ndarray, "*point function"]:
        flat = np.asarray(force, float).ravel()
        change, rows = _effects(shaped, flat)
        whole = np.hstack([powers(flat), change.T, rows[0], rows[1]])
        return whole.reshape(*np.shape(force), count)

    def rises(force: Float[ndarray, "*point"]) -> Float[ndarray, "*point function"]:
        step = 1e-4 * force
        found = (functions(force + step) - functions(force - step)) / (2.0 * step[..., None])
        found[..., :3] = slopes(force)
        return found

    ids = " and ".join(one.id for one, _ in shaped)
    name = f"smooth contact with {ids}" if shaped else "smooth contact"
    return Law(name, tuple(names), matrix, constant, functions, rises, priors)


def _effects(
    shaped: list[tuple[Mechanism, ndarray]], force: Float[ndarray, " point"]
) -> tuple[Float[ndarray, "2 point"], Float[ndarray, "2 point parameter"]]:
    """Changes of ln kn, ln kt by the causes and their derivatives by the fits' coordinates."""
    records = _at(force)
    change, rows = np.zeros((2, force.size)), [np.zeros((2, force.size, 0))]
    for one, values in shaped:
        effect = one.stick(records, values)
        chain = np.array([p.slope(v) for p, v in zip(one.parameters, values, strict=True)])
        block = np.zeros((2, force.size, values.size))
        for k, name in enumerate(_STIFFNESS):
            if name in effect.changes:
                change[k] += effect.changes[name]
                block[k] = effect.slopes[name] * chain
        rows.append(block)
    return change, np.concatenate(rows, axis=2)


def gauge_of(extension: Extension, gauge: ForceGauge) -> ForceGauge:
    """The gauge with the error that a cause allows it, the larger of both."""
    for one, _ in extension.causes:
        std = one.parameters[0].std
        if one.id == "force-gain":
            gauge = replace(gauge, relative_std=max(gauge.relative_std, std))
        elif one.id == "force-offset":
            own = gauge.full_scale_std if gauge.primary == "full-scale" else 0.0
            gauge = replace(gauge, full_scale_std=max(own, std), primary="full-scale")
    return gauge


def structure_of(extension: Extension, model: xr.Dataset) -> xr.Dataset:
    """The parametric model with the causes that change the matrices; the same if none does."""
    if not any(_lasting(one) for one, _ in extension.causes):
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


def left_out(extension: Extension) -> list[str]:
    """Causes that the joint inference cannot take: of single records, time, direction, amplitude.

    Levels are means over a force's records; what loading and unloading or time do to them cancels
    or lies in their scatter.
    """
    taken = {*_shapers(extension), *GAUGE}
    return [one.id for one, _ in extension.causes if not _lasting(one) and one.id not in taken]


def _lasting(one: Mechanism) -> bool:
    """Whether a cause changes the matrices, and for all records alike."""
    return one.structure is not None and one.course is None


def _shapers(extension: Extension) -> set[str]:
    """Ids of the causes that change kn or kt by the force alone."""
    one_force = np.array([1e4])
    return {
        one.id
        for one, values in extension.causes
        if one.stick is not None
        and one.over == ("force",)
        and set(one.stick(_at(one_force), values).changes) & set(_STIFFNESS)
    }


def _at(force: Float[ndarray, " point"]) -> Records:
    """Situations at axial forces (N) with no direction and no time."""
    none = np.zeros(force.size)
    return Records(np.zeros(force.size, dtype=int), force, none, none, none, 0.0, 0.0)
