"""Stick frequencies of all records: the baseline simulation, with any mechanisms added to it.

ln f = ln f_model(ln kn, ln kt, F) + the model's bias. Contact stiffness is one law over all forces;
each clamping of the specimen changes kn and kt at random, and the gauge is read to a step.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import xarray as xr
from jaxtyping import Bool, Float, Int
from numpy import ndarray

from bladeroot.diagnosis.gaussian import Prior, Problem, Slopes, State
from bladeroot.diagnosis.guards import TRUST
from bladeroot.diagnosis.structures import Structures
from bladeroot.mechanisms.mechanism import Mechanism, Records
from bladeroot.stiffness.joint import trimmed
from bladeroot.stiffness.laws import PRIORS, REFERENCE_FORCE
from bladeroot.stiffness.posterior import BIAS_TILT
from bladeroot.structure import chebyshev
from bladeroot.structure.chebyshev import Surface
from bladeroot.structure.parametric import ritz_of, surface_of
from bladeroot.structure.ritz import Ritz

# Constant over force: another exponent, smooth contact's 0.05 (6.16) too, is a cause's to explain.
EXPONENT = (0.0, 0.005)
# ln of the scatter of k between clampings, 2 to 14 %, and of frequency between records of one.
SCATTER = (np.log(0.04), 0.6)
CORRELATION = (0.5, 0.7)  # atanh of that of kn and kt
NOISE = (np.log(1e-5), 2.0)
FORCE_LENGTH = 0.7  # of ln F, over which a smooth law's error varies
TIME_LENGTH = 0.3  # of the campaign
TRIM = 1e-6  # of a frequency, that coefficients of the surface may be left out for
JUMP = 30.0  # times the usual difference of a hold's records: beyond it, something let go
BEST = 1e-7  # of a frequency: no stick frequency is trusted further
_STEP = 1e-4  # of a force, for slopes by differences
SCALES = ("ln_scatter_kn", "ln_scatter_kt", "atanh_correlation", "ln_noise")


@dataclass(frozen=True)
class StickData:
    """The records with a stick frequency.

    std: relative, within the record. hold: number of the clamping. rounding: standard deviation of
    the reading's rounding, N. row: number in the observations. jumped: holds that count as two
    clampings.
    """

    modes: tuple[str, ...]
    records: Records
    ln_f: Float[ndarray, " record"]
    std: Float[ndarray, " record"]
    hold: Int[ndarray, " record"]
    rounding: float
    row: Int[ndarray, " record"]
    direction_known: bool
    time_known: bool
    jumped: tuple[str, ...] = ()


@dataclass(frozen=True)
class Simulation:
    """The baseline: frequencies over (ln kn, ln kt, F), bias (std) by mode, projected problems.

    shapes: those already worked out (`Structures`).
    """

    surface: Surface
    ritz: tuple[Ritz, ...]
    bias: Float[ndarray, " mode"]
    offset: Float[ndarray, " mode"]
    shapes: dict = field(default_factory=dict)


def simulation(
    model: xr.Dataset, modes: Sequence[str], bias: Sequence[float], offset: Sequence[float]
) -> Simulation:
    """From `bladeroot.structure.parametric`; bias and offset relative, by mode."""
    here = model.sel(mode=list(modes))
    ritz = tuple(ritz_of(model, mode) for mode in modes)
    return Simulation(trimmed(surface_of(here), TRIM), ritz, np.array(bias), np.array(offset))


def stick_data(seen: xr.Dataset, modes: Sequence[str], least_force: float = 0.0) -> StickData:
    """The usable records at or above a force (N), from `bladeroot.diagnosis.observations`."""
    mode = seen["mode"].values.astype(str)
    frequency, std = seen["stick_frequency"].values, seen["stick_frequency_std"].values
    usable = np.isin(mode, modes) & (seen["verdict"].values.astype(str) == "usable")
    usable &= (seen["plateau_reached"].values == 1) & np.isfinite(frequency) & np.isfinite(std)
    row = np.flatnonzero(usable & (seen["force"].values >= least_force))
    holds = seen["hold"].values.astype(str)[row]
    names = seen["record"].values.astype(str)[row]
    called, hold = np.unique(np.where(holds == "", "record " + names, holds), return_inverse=True)
    time = seen["time"].values[row]
    known = bool(np.isfinite(time).all()) and row.size > 0
    time = time - time.min() if known else np.zeros(row.size)
    since = np.array([t - time[hold == h].min() for t, h in zip(time, hold, strict=True)])
    ln_f, error = np.log(frequency[row]), np.maximum(std[row] / frequency[row], BEST)
    hold, jumped = _clampings(mode[row], hold, time, ln_f, error)
    direction = seen["direction"].values.astype(str)[row]
    records = Records(
        mode=np.array([list(modes).index(one) for one in mode[row]], dtype=int),
        force=seen["force"].values[row].astype(float),
        sign=np.where(direction == "up", 1.0, np.where(direction == "down", -1.0, 0.0)),
        time=time,
        since=since,
        span=float(time.max(initial=0.0)),
        hold_span=float(since.max(initial=0.0)),
    )
    return StickData(
        tuple(modes),
        records,
        ln_f,
        error,
        hold,
        float(seen.attrs["gauge_resolution_N"]) / np.sqrt(12.0),
        row,
        bool((records.sign > 0).any() and (records.sign < 0).any()),
        known,
        tuple(called[jumped].tolist()),
    )


def _clampings(
    mode: ndarray, hold: ndarray, time: ndarray, ln_f: ndarray, std: ndarray
) -> tuple[ndarray, list[int]]:
    """Numbers of the clampings, where a hold counts as two if a frequency jumps within it, and the
    numbers of such holds.

    One jump would pass for noise of all records, and what tells causes in time from others, how
    little records of a hold differ, would be lost.
    """
    split, jumped = hold.copy(), []
    for one in np.unique(mode):
        order = np.flatnonzero(mode == one)
        order = order[np.lexsort((time[order], hold[order]))]
        before, after = order[:-1], order[1:]
        within = hold[before] == hold[after]
        before, after = before[within], after[within]
        if not after.size:
            continue
        change = ln_f[after] - ln_f[before]
        off = np.abs(change - np.median(change))
        far = off / np.hypot(np.median(off), np.hypot(std[before], std[after]))
        for k in np.flatnonzero(far > JUMP):
            number = int(hold[after[k]])
            if number not in jumped:
                jumped.append(number)
                split[(hold == number) & (time >= time[after[k]])] = hold.max() + len(jumped)
    return split, jumped


def ln_frequency(
    surface: Surface, points: Float[ndarray, "point 3"]
) -> tuple[Float[ndarray, "point mode"], Float[ndarray, "point mode 3"]]:
    """ln f and its gradient; straight on outside the box."""
    inside = np.clip(points, surface.low, surface.high)
    value, slope = chebyshev.evaluate(surface, inside, order=1)
    return value + np.einsum("pma,pa->pm", slope, points - inside), slope


def problem(
    data: StickData,
    simulated: Simulation,
    mechanisms: Sequence[Mechanism] = (),
    extra: Sequence[tuple[ndarray, float]] = (),
) -> Problem:
    """Baseline with mechanisms; `extra`: covariances of unit size of a smooth competitor, each with
    the size that is likely beforehand.
    """
    records, n = data.records, data.ln_f.size
    modes = len(data.modes)
    x = np.log(records.force / REFERENCE_FORCE)
    of_mode = np.eye(modes)[records.mode]
    bias_rows = np.hstack([of_mode, of_mode * x[:, None]])
    level_n, level_t = PRIORS["ln_kn"], PRIORS["ln_kt"]
    bias = simulated.bias
    prior = Prior(
        np.concatenate(
            [[level_n[0], level_t[0], EXPONENT[0]], np.log1p(simulated.offset), np.zeros(modes),
             *(m.start for m in mechanisms)]
        ),
        np.concatenate(
            [[level_n[1], level_t[1], EXPONENT[1]], bias, BIAS_TILT * bias,
             *(m.std for m in mechanisms)]
        ),
    )  # fmt: skip
    base = 3 + 2 * modes
    rows = np.arange(n)
    structures = Structures(records, simulated.ritz, simulated.surface, simulated.shapes)

    def predict(theta: ndarray) -> State:
        ln_kn, ln_kt = (theta[k] + theta[2] * x for k in (0, 1))
        direct = bias_rows @ theta[3:base]
        told, first = [], base
        for one in mechanisms:
            own = slice(first, first + len(one.parameters))
            first = own.stop
            told.append((one, *one.values(theta[own])))
        nothing = dict.fromkeys(_COORDINATES, np.zeros(n))
        parts = [dict(nothing) for _ in told]  # what each changes
        by_law = [dict(nothing) for _ in told]  # and what laws of the force make of it
        slopes: list[dict] = [{} for _ in told]
        laws = [k for k, (one, *_) in enumerate(told) if one.stick is not None]
        for k in laws:
            changes, slopes[k] = _effect(*told[k], records)
            parts[k].update(changes)
        force = records.force + sum(changes["force"] for changes in parts)
        moving = [k for k in laws if "force" in slopes[k]]
        for k in laws if moving else ():
            if k in moving or "force" not in told[k][0].over:
                continue
            # A law of the force goes by the force that there is, not by what the gauge says.
            changes, slopes[k] = _effect(*told[k], replace(records, force=force))
            beyond, _ = _effect(*told[k], replace(records, force=(1.0 + _STEP) * force))
            parts[k].update(changes)
            for name, change in changes.items():
                rate = (beyond[name] - change) / (_STEP * force)
                for i in moving:
                    by_law[i][name] = by_law[i][name] + rate * parts[i]["force"]
                    indirect = rate[:, None] * slopes[i]["force"]
                    slopes[i][name] = slopes[i].get(name, 0.0) + indirect
        ln_kn = ln_kn + sum(changes["ln_kn"] for changes in parts)
        ln_kt = ln_kt + sum(changes["ln_kt"] for changes in parts)
        for k, (one, values, chain) in enumerate(told):
            if one.structure is None:
                continue
            change, slope = structures(one, values, ln_kn, ln_kt)
            if one.course is not None:
                factor = one.course(records)
                change, slope = factor * change, factor[:, None] * slope
            parts[k]["ln_f"], slopes[k] = change, {"ln_f": slope * chain}
        direct = direct + sum(changes["ln_f"] for changes in parts)
        points, where = np.unique(
            np.stack([ln_kn, ln_kt, force], axis=1), axis=0, return_inverse=True
        )
        value, gradient = ln_frequency(simulated.surface, points)
        where = where.reshape(-1)
        mean = value[where, records.mode] + direct
        g = gradient[where, records.mode]
        columns = [g[:, :1], g[:, 1:2], (g[:, :2].sum(axis=1) * x)[:, None], bias_rows]
        for by in slopes:
            block = 0.0
            for axis, name in enumerate(_COORDINATES):
                if name in by:
                    block = block + (g[:, axis : axis + 1] if axis < 3 else 1.0) * by[name]
            columns.append(block)
        whole = np.column_stack([g, np.ones(n)])
        effects = [
            sum(whole[:, axis] * (c[name] + law[name]) for axis, name in enumerate(_COORDINATES))
            for c, law in zip(parts, by_law, strict=True)
        ]
        facts = {"gradient": g, "effects": np.array(effects).reshape(len(parts), n)}
        return State(mean, np.hstack(columns), facts)

    same_hold = data.hold[:, None] == data.hold
    trust = [trust_kernel(data, one.over) for one in mechanisms]

    def covariance(state: State, scales: ndarray) -> tuple[ndarray, Slopes]:
        g = state.facts["gradient"]
        s_n, s_t, noise = np.exp(scales[0]), np.exp(scales[1]), np.exp(scales[3])
        r = np.tanh(scales[2])
        normal, tangential = s_n**2 * _AXES[0], s_t**2 * _AXES[1]
        both = s_n * s_t * _AXES[2]

        def of_hold(scatter: ndarray) -> ndarray:
            return (g @ scatter @ g.T) * same_hold

        read = np.diag([0.0, 0.0, data.rounding**2])
        whole = of_hold(normal + tangential + r * both + read)
        for effect, kernel, one in zip(state.facts["effects"], trust, mechanisms, strict=True):
            e = effect - of_mode @ _means(of_mode, effect) if one.kind == "level" else effect
            whole += np.outer(TRUST**2 * e, e) * kernel
        whole[rows, rows] += data.std**2 + noise**2
        parts = [
            np.exp(2.0 * scale) * unit for scale, (unit, _) in zip(scales[4:], extra, strict=True)
        ]
        for part in parts:
            whole += part

        def slopes() -> list[ndarray]:
            return [
                of_hold(2.0 * normal + r * both),
                of_hold(2.0 * tangential + r * both),
                of_hold((1.0 - r**2) * both),
                np.diag(np.full(n, 2.0 * noise**2)),
                *(2.0 * part for part in parts),
            ]

        return whole, slopes

    scales = [SCATTER, SCATTER, CORRELATION, NOISE]
    scales += [(np.log(size), 1.5) for _, size in extra]
    means, stds = (np.array(part, float) for part in zip(*scales, strict=True))
    return Problem(data.ln_f, predict, covariance, prior, Prior(means, stds))


_COORDINATES = ("ln_kn", "ln_kt", "force", "ln_f")
# Of (ln kn, ln kt, F): scatter of kn, of kt, and of both together.
_AXES = (
    np.diag([1.0, 0.0, 0.0]),
    np.diag([0.0, 1.0, 0.0]),
    np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]]),
)


def _effect(
    one: Mechanism, values: ndarray, chain: ndarray, records: Records
) -> tuple[dict[str, ndarray], dict[str, ndarray]]:
    """What a mechanism changes of records, and the slopes by the fit's coordinates."""
    effect = one.stick(records, values)
    return dict(effect.changes), {name: slope * chain for name, slope in effect.slopes.items()}


def _means(of_mode: ndarray, values: ndarray) -> ndarray:
    return (of_mode.T @ values) / np.maximum(of_mode.sum(axis=0), 1.0)


def trust_kernel(data: StickData, over: Sequence[str]) -> Float[ndarray, "record record"]:
    """Correlation of a law's own errors between records: alike situations have alike errors."""
    records = data.records
    kernels = {
        "force": lambda: near(np.log(records.force), FORCE_LENGTH),
        "time": lambda: near(records.time, TIME_LENGTH * max(records.span, 1.0)),
        "since": lambda: near(records.since, max(records.hold_span, 1.0)),
        "sign": lambda: (records.sign[:, None] == records.sign).astype(float),
    }
    whole = same_mode(data).astype(float)
    for name in over:
        whole = whole * kernels[name]()
    return whole


def same_mode(data: StickData) -> Bool[ndarray, "record record"]:
    """Which records are of one mode."""
    return data.records.mode[:, None] == data.records.mode


def near(values: Float[ndarray, " record"], length: float) -> Float[ndarray, "record record"]:
    """Correlation that falls with the distance of values, 0.6 at `length`."""
    return np.exp(-0.5 * ((values[:, None] - values) / length) ** 2)
