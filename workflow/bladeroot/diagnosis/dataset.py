"""The diagnosis as a Dataset: residual maps, evidence, gain, stiffness and curves for a report."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.diagnosis.causes import of_load, places
from bladeroot.diagnosis.curve_model import CurveData
from bladeroot.diagnosis.diagnose import Diagnosis
from bladeroot.diagnosis.interfaces import interface_stiffness
from bladeroot.diagnosis.naming import Found
from bladeroot.diagnosis.verdict import insufficient
from bladeroot.inference.gaussian import Fit
from bladeroot.mechanisms.mechanism import COORDINATES, Mechanism
from bladeroot.stiffness.priors import REFERENCE_FORCE
from bladeroot.terms import spelled
from bladeroot.variables import dataset as tabled

STAGES = ("before", "after")
_GRID = 40


def dataset(made: Diagnosis, said: Mapping) -> xr.Dataset:
    """Parts that the campaign does not have are missing; `before` is the baseline, `after` with
    the named causes. said: from `bladeroot.diagnosis.verdict.verdict`.
    """
    parts = [_ranking(made)]
    for found in made.found:
        if found.channel.name == "stick":
            parts.append(_records(made, found))
            if made.simulated.stiffnesses:
                parts.append(_stiffness(made, found))
            if made.simulated.kind == "assembly":
                named = [cause.mechanism for cause in found.causes]
                fits = (found.final, *found.maxima)
                part = (made.data, made.simulated, fits, named, found.channel.base)
                parts.append(interface_stiffness(*part))
        elif found.channel.name == "damping":
            parts.append(_damping(made, found))
        else:
            parts.append(_curves(made, found))
    whole = xr.merge(parts, compat="override", join="outer", combine_attrs="drop_conflicts")
    return whole.assign_attrs(
        structure=made.simulated.structure,
        answer=said["answer"],
        reason=said["reason"],
        named=";".join(one["mechanism"] for one in said["causes"] if one["shown"]),
        lacks=made.terms.say(";".join(made.lacks)),
        not_judged=made.terms.say(made.not_judged),
        insufficient=made.terms.say(". ".join(insufficient(made, spelled))),
        insufficient_causes=";".join(found.insufficient for found in made.found),
        least_force_N=made.settings.least_force,
    )


def _sides(found: Found) -> tuple[Fit, Fit]:
    return found.baseline, found.final


def _misses(found: Found) -> tuple[np.ndarray, np.ndarray]:
    """Data less mean of both stages, plain and in standard deviations without the causes' own."""
    plain = np.array([fit.problem.data - fit.state.mean for fit in _sides(found)])
    own = found.final.problem.covariance(found.final.state, found.final.scales)[0]
    return plain, plain / np.sqrt(np.diag(own))


def _records(made: Diagnosis, found: Found) -> xr.Dataset:
    """What each record's stick frequency misses, and the mean of each mode and force."""
    data = made.data
    plain, scaled = _misses(found)
    names = made.seen["record"].values.astype(str)[data.row]
    records = data.records
    forces = np.unique(records.force)
    level = np.full((2, len(data.modes), forces.size), np.nan)
    for m in range(len(data.modes)):
        for k, f in enumerate(forces):
            mine = (records.mode == m) & (records.force == f)
            if mine.any():
                level[:, m, k] = plain[:, mine].mean(axis=1)
    return tabled(
        "diagnosis/stick",
        {
            "stick_mode": np.array(data.modes)[records.mode],
            "stick_force": records.force,
            "stick_time": records.time,
            "stick_direction": records.sign,
            "stick_hold": data.hold,
            "stick_frequency": np.exp(data.ln_f),
            "stick_simulated": np.array([np.exp(fit.state.mean) for fit in _sides(found)]),
            "stick_residual": plain,
            "stick_residual_scaled": scaled,
            "level_residual": level,
            "stage": list(STAGES),
            "stick_record": names,
            "mode": list(data.modes),
            "force": forces,
        },
    )


def _damping(made: Diagnosis, found: Found) -> xr.Dataset:
    plain, scaled = _misses(found)
    names = made.seen["record"].values.astype(str)[made.damping.stick.row]
    made = {"damping_residual": plain, "damping_residual_scaled": scaled}
    made |= {"stage": list(STAGES), "damping_record": names}
    return tabled("diagnosis/damping", made)


def _curves(made: Diagnosis, found: Found) -> xr.Dataset:
    """Excess over the plateau, measured and simulated, at the points that were used."""
    data = made.curves
    n = data.points.mode.size
    own = np.sqrt(np.diag(data.noise))
    value = data.value - level_offsets(data, data.value - found.final.state.mean)
    entries = {
        "curve_mode": np.array(data.modes)[data.points.mode],
        "curve_force": data.points.force,
        "curve_amplitude": data.points.amplitude,
        "curve_records": data.records,
        "stage": list(STAGES),
    }
    for name, mine in (("curve_frequency", slice(n)), ("curve_loss", slice(n, 2 * n))):
        entries[name], entries[f"{name}_std"] = value[mine], own[mine]
        entries[f"{name}_simulated"] = np.array([fit.state.mean[mine] for fit in _sides(found)])
    return tabled("diagnosis/curve", entries)


def level_offsets(data: CurveData, residual: Float[ndarray, " datum"]) -> Float[ndarray, " datum"]:
    """Mean residual of the smaller amplitudes of each level, where the plateau is or would be.

    A level's offset is free, and without a plateau its zero is arbitrary.
    """
    offset, weight = np.zeros(residual.size), 1.0 / np.diag(data.noise)
    level = np.concatenate([data.level, data.level + data.level.max() + 1])
    amplitude = data.twice.amplitude
    for one in np.unique(level):
        mine = level == one
        small = mine & (amplitude <= np.median(amplitude[mine]))
        offset[mine] = np.average(residual[small], weights=weight[small])
    return offset


def _ranking(made: Diagnosis) -> xr.Dataset:
    """First round of each channel: everything that was compared, and the record faults."""
    rows = []
    for found in made.found:
        step = found.steps[0]
        named = {cause.mechanism.id for cause in found.causes}
        barred = {**found.known.barred, **found.known.ruled_out}
        for one in found.channel.candidates:
            rows.append((one.id, one.kind, found.channel.name, step.mechanisms[one.id],
                         one.id in named, made.terms.say(barred.get(one.id, ""))))  # fmt: skip
        rows += [
            (made.terms.say(f"smooth in {name.replace('force', '{force}')}"), "smooth",
             found.channel.name, value, False, "no mechanism")
            for name, value in step.smooth.items()
        ]  # fmt: skip
    rows += [
        (one.mechanism.id, "record", "record", one.log_odds, one.named, "") for one in made.faulty
    ]
    rows.sort(key=lambda row: -row[3])
    sentences = {one.id: one.sentence for found in made.found for one in found.channel.candidates}
    sentences |= {one.mechanism.id: one.mechanism.sentence for one in made.faulty}
    said = [made.terms.say(sentences.get(row[0], "any smooth function")) for row in rows]
    kinds = {"candidate": str, "class": str, "channel": str, "log_evidence": float,
             "is_named": np.int8, "barred": str}  # fmt: skip
    made = {
        name: np.array([row[k] for row in rows], dtype=kind)
        for k, (name, kind) in enumerate(kinds.items())
    }
    return tabled("diagnosis/ranking", made | {"sentence": np.array(said, dtype=str)})


def _stiffness(made: Diagnosis, found: Found) -> xr.Dataset:
    """Contact stiffness over the campaign's loads by the law before and after, with covariance."""
    records, simulated = made.data.records, made.simulated
    force = np.linspace(records.force.min(), records.force.max(), _GRID)
    if simulated.kind == "structure":
        force = np.sort(np.append(force, REFERENCE_FORCE))
    names = simulated.stiffnesses
    k, std = (np.zeros((2, len(names), force.size)) for _ in range(2))
    correlation = np.zeros((2, force.size))
    whole = np.zeros((2, force.size, len(names), len(names)))
    pivot = simulated.pivot_of(records)
    for stage, fitted in enumerate(_sides(found)):
        causes = [cause.mechanism for cause in found.causes] if stage else []
        value, rows = stiffness_law(
            fitted.parameters, found.channel.base, causes, force, names, pivot
        )
        covariance = np.einsum("sfp,pq,tfq->fst", rows, fitted.covariance, rows)
        k[stage] = np.exp(value)
        std[stage] = np.sqrt(np.diagonal(covariance, axis1=1, axis2=2)).T
        whole[stage] = covariance
        if len(names) > 1:
            first = std[stage, :2].prod(axis=0)
            correlation[stage] = covariance[:, 0, 1] / first
    made = {"law_k": k, "law_ln_std": std, "law_correlation": correlation}
    made |= {"law_ln_covariance": whole, "law_force": force, "stage": list(STAGES)}
    made |= {"stiffness": list(names), "stiffness_": list(names)}
    return tabled("diagnosis/law", made)


def stiffness_law(
    theta: Float[ndarray, " parameter"],
    base: int,
    causes: Sequence[Mechanism],
    force: Float[ndarray, " force"],
    names: Sequence[str] = ("kn", "kt"),
    pivot: float = REFERENCE_FORCE,
) -> tuple[Float[ndarray, "stiffness force"], Float[ndarray, "stiffness force parameter"]]:
    """ln k of the named stiffnesses over loads at parameters of a fit, and derivatives by these.

    Of the causes those that are laws of the load alone.
    """
    count, x = len(names), np.log(force / pivot)
    changes, slopes = of_load(causes, theta[base:], force)
    axes = [COORDINATES.index(f"ln_{name[:2]}") for name in names]
    value = theta[:count, None] + theta[count] * x + changes[:, axes].T
    rows = np.zeros((count, force.size, theta.size))
    rows[np.arange(count), :, np.arange(count)] = 1.0
    rows[:, :, count] = x
    for own, slope in zip(places(causes, base), slopes, strict=True):
        rows[:, :, own] = slope[:, axes].swapaxes(0, 1)
    return value, rows
