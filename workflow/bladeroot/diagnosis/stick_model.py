"""Stick frequencies of all records: the baseline simulation, with any mechanisms added to it.

ln f = ln f_model(ln kn, ln kt, F) + the model's bias. Contact stiffness is one law over all forces;
each clamping of the specimen changes kn and kt at random, and the gauge is read to a step.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import xarray as xr
from jaxtyping import Bool, Float, Int
from numpy import ndarray

from bladeroot.diagnosis.causes import causes
from bladeroot.diagnosis.clampings import clampings, hold_names
from bladeroot.diagnosis.gaussian import Prior, Problem, Slopes, State
from bladeroot.diagnosis.guards import RECORDS, TRUST
from bladeroot.diagnosis.limits import OWN, limits
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
LEAST_LIMIT = 5e-3  # of a frequency: a limit that is known worse says less than a clamping scatters
BEST = 1e-7  # of a frequency: no stick frequency is trusted further
# Where so many of the records have a time, the others are left out rather than all laws of time.
MOSTLY = 0.8
SCALES = ("ln_scatter_kn", "ln_scatter_kt", "atanh_correlation", "ln_noise")


@dataclass(frozen=True)
class StickData:
    """The records with a stick frequency.

    std: relative, within the record. shared: relative error of those that do not reach their
    plateau by the law that takes them to it (`bladeroot.diagnosis.limits`), one of a mode's. hold:
    number of the clamping. rounding: standard deviation of the reading's rounding, N. row: number
    in the observations. jumped: holds that count as two clampings. unheld: records whose hold is
    not stated. untimed: records left out for want of a time.
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
    unheld: int = 0
    untimed: int = 0
    shared: Float[ndarray, " record"] | None = None


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
    frequency, std, shared = _with_limits(seen, frequency, std)
    usable &= np.isfinite(frequency) & np.isfinite(std)
    row = np.flatnonzero(usable & (seen["force"].values >= least_force))
    every = row
    row = _timed(row, seen["time"].values, seen["force"].values, mode)
    force, time = seen["force"].values[row].astype(float), seen["time"].values[row]
    hold, record, way = (seen[name].values.astype(str) for name in ("hold", "record", "direction"))
    unheld = int((hold[row] == "").sum())
    holds = hold_names(hold, record, seen["force"].values, way, seen["time"].values)
    called, hold = np.unique(holds[row], return_inverse=True)
    known = bool(np.isfinite(time).all()) and row.size > 0
    time = time - time.min() if known else np.zeros(row.size)
    since = np.array([t - time[hold == h].min() for t, h in zip(time, hold, strict=True)])
    ln_f, error = np.log(frequency[row]), np.maximum(std[row] / frequency[row], BEST)
    jumped: list[int] = []
    if known:
        hold, jumped = clampings(mode[row], hold, time, ln_f, error)
    records = Records(
        mode=np.array([list(modes).index(one) for one in mode[row]], dtype=int),
        force=force,
        sign=np.where(way == "up", 1.0, np.where(way == "down", -1.0, 0.0))[row],
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
        unheld,
        every.size - row.size,
        shared[row],
    )


def _with_limits(seen: xr.Dataset, frequency: ndarray, std: ndarray) -> tuple[ndarray, ...]:
    """Stick frequencies and errors (Hz), with the limits of records that reach no plateau, and the
    relative error that these share.
    """
    reached = (seen["plateau_reached"].values == 1) & np.isfinite(frequency) & np.isfinite(std)
    if reached.all():
        return frequency, std, np.zeros(frequency.size)
    found = limits(seen)
    own = np.hypot(found.std, OWN * found.shared)
    own[~(np.hypot(own, found.shared) < LEAST_LIMIT)] = np.nan
    limit = np.exp(found.ln_f)
    shared = np.where(reached, 0.0, np.nan_to_num(found.shared))
    return np.where(reached, frequency, limit), np.where(reached, std, own * limit), shared


def _timed(
    row: Int[ndarray, " record"], time: ndarray, force: ndarray, mode: ndarray
) -> Int[ndarray, " timed"]:
    """The records with a time, where they are nearly all and without the others nothing lacks."""
    timed = row[np.isfinite(time[row])]
    if timed.size < max(MOSTLY * row.size, RECORDS):
        return row
    levels = [{(mode[k], force[k]) for k in some} for some in (row, timed)]
    return timed if levels[0] == levels[1] else row


def _distinct(points: Float[ndarray, "point 3"]) -> tuple[ndarray, ndarray]:
    """The different points, and which of them each is; `np.unique` of rows takes far longer."""
    order = np.lexsort(points.T)
    placed = points[order]
    new = np.ones(len(points), dtype=bool)
    new[1:] = (placed[1:] != placed[:-1]).any(axis=1)
    where = np.empty(len(points), dtype=int)
    where[order] = np.cumsum(new) - 1
    return placed[new], where


def ln_frequency(
    surface: Surface, points: Float[ndarray, "point 3"]
) -> tuple[Float[ndarray, "point mode"], Float[ndarray, "point mode 3"]]:
    """ln f and its gradient; straight on outside the box."""
    inside = np.clip(points, surface.low, surface.high)
    value, slope = chebyshev.evaluate(surface, inside, order=1)
    return value + np.einsum("pma,pa->pm", slope, points - inside), slope


def biases(modes: int) -> slice:
    """Where the model's biases and their tilts stand among the parameters."""
    return slice(3, 3 + 2 * modes)


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
    own = biases(modes)
    base = own.stop
    rows = np.arange(n)
    structures = Structures(records, simulated.ritz, simulated.surface, simulated.shapes)

    def predict(theta: ndarray) -> State:
        ln_k = theta[:2, None] + theta[2] * x
        made = causes(mechanisms, theta[base:], records, structures, ln_k)
        ln_kn, ln_kt = ln_k + made.changes[:, :2].T
        places = np.stack([ln_kn, ln_kt, records.force + made.changes[:, 2]], axis=1)
        points, where = _distinct(places)
        value, gradient = ln_frequency(simulated.surface, points)
        mean = value[where, records.mode] + bias_rows @ theta[own] + made.changes[:, 3]
        g = gradient[where, records.mode]
        whole = np.column_stack([g, np.ones(n)])
        columns = [g[:, :1], g[:, 1:2], (g[:, :2].sum(axis=1) * x)[:, None], bias_rows]
        columns += [np.einsum("nc,ncp->np", whole, slope) for slope in made.slopes]
        effects = np.einsum("nc,knc->kn", whole, made.effects)
        facts = {"gradient": g, "effects": effects}
        return State(mean, np.hstack(columns), facts)

    same_hold = data.hold[:, None] == data.hold
    beyond = _of_limits(data)
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
        whole += beyond
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
                np.full(n, 2.0 * noise**2),
                *(2.0 * part for part in parts),
            ]

        return whole, slopes

    scales = [SCATTER, SCATTER, CORRELATION, NOISE]
    scales += [(np.log(size), 1.5) for _, size in extra]
    means, stds = (np.array(part, float) for part in zip(*scales, strict=True))
    return Problem(data.ln_f, predict, covariance, prior, Prior(means, stds))


def _of_limits(data: StickData) -> Float[ndarray, "record record"]:
    """Covariance by the law that takes records to the plateau they do not reach."""
    if data.shared is None or not data.shared.any():
        return np.zeros((data.ln_f.size, data.ln_f.size))
    alike = same_mode(data) * near(np.log(data.records.force), FORCE_LENGTH)
    return np.outer(data.shared, data.shared) * alike


# Of (ln kn, ln kt, F): scatter of kn, of kt, and of both together.
_AXES = (
    np.diag([1.0, 0.0, 0.0]),
    np.diag([0.0, 1.0, 0.0]),
    np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]]),
)


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
