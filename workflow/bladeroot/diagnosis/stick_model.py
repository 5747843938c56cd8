"""Stick frequencies of all records: the baseline simulation, with any mechanisms added to it.

What is simulated is the simulation's to say (`bladeroot.diagnosis.simulation`); the records scatter
about it by clampings, by what differs between records of one, and by their own errors.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import partial

import numpy as np
import xarray as xr
from jaxtyping import Bool, Float, Int
from numpy import ndarray

from bladeroot.diagnosis.causes import Causes, causes, places, with_causes, with_smooth
from bladeroot.diagnosis.clampings import clampings, directions, hold_names, thinned
from bladeroot.diagnosis.guards import RECORDS, TRUST
from bladeroot.diagnosis.limits import OWN, limits
from bladeroot.diagnosis.simulation.interface import Said, Simulation
from bladeroot.diagnosis.thermometer import course
from bladeroot.inference.problem import Problem, Slopes, State
from bladeroot.mechanisms.mechanism import Mechanism, Records

# ln of laws' own errors over TRUST, of which they rather have less: a law that bends to what it
# does not say explains anything.
LAWS = (-1.0, 1.0)
# ln of the scatter of frequency between records of one clamping.
NOISE = (np.log(1e-5), 2.0)
FORCE_LENGTH = 0.7  # of ln F, over which a smooth law's error varies
TIME_LENGTH = 0.3  # of the campaign, by time or by its clampings
KELVIN = 3.0  # of temperature
READING = 0.14  # K by which a thermometer is off the beam, alike for an hour
HOUR = 3600.0  # s
UNTIMED_READING = 0.14  # K by which a reading is off, beside that, where records have no time
LEAST_KELVIN = 0.01  # K from the mean: smaller differences of temperature are none
# Part of its own effect by which a law of the time in a clamping differs from clamping to clamping:
# nobody states the time from the clamping to its first record.
OF_HOLD = 0.3
LEAST_LIMIT = 5e-3  # of a frequency: a limit that is known worse says less than a clamping scatters
BEST = 1e-7  # of a frequency: no stick frequency is trusted further
# Where so many of the records have a time, the others are left out rather than all laws of time.
MOSTLY = 0.8
# Records that are fitted at most: the cost grows with their cube. Clampings scatter much more than
# the records of one, of which two of a mode say nearly as much as all.
MOST_RECORDS = 300


@dataclass(frozen=True)
class StickData:
    """The records with a stick frequency.

    std: relative, within the record. shared: relative error of those that do not reach their
    plateau by the law that takes them to it (`bladeroot.diagnosis.limits`), one of a mode's. hold:
    number of the clamping. rounding: standard deviation of the reading's rounding, N. row: number
    in the observations. group: number of each record's group, None where there is one only. jumped:
    holds that count as two clampings. unheld: records whose hold is not stated. untimed: records
    left out for want of a time. thinned: those left out as others say nearly as much (`thinned`).
    temperature_covariance: K^2, of what is unknown of the records' temperature, if any is known.
    kernels: those already worked out (`trust_kernel`).
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
    group: Int[ndarray, " record"] | None = None
    jumped: tuple[str, ...] = ()
    unheld: int = 0
    untimed: int = 0
    thinned: int = 0
    shared: Float[ndarray, " record"] | None = None
    temperature_covariance: Float[ndarray, "record record"] | None = None
    kernels: dict = field(default_factory=dict, init=False, repr=False)


def stick_data(seen: xr.Dataset, modes: Sequence[str], least_force: float = 0.0) -> StickData:
    """The usable records at or above a force (N), from `bladeroot.diagnosis.observations`."""
    mode = seen["mode"].values.astype(str)
    frequency, std = seen["stick_frequency"].values, seen["stick_frequency_std"].values
    usable = np.isin(mode, modes) & (seen["verdict"].values.astype(str) == "usable")
    frequency, std, shared = _with_limits(seen, frequency, std)
    usable &= np.isfinite(frequency) & np.isfinite(std)
    row = np.flatnonzero(usable & (seen["force"].values >= least_force))
    timed = _timed(row, seen["time"].values, seen["force"].values, mode)
    hold, record, way = (seen[name].values.astype(str) for name in ("hold", "record", "direction"))
    unheld = int((hold[timed] == "").sum())
    holds = hold_names(hold, record, seen["force"].values, way, seen["time"].values)
    groups = seen["group"].values.astype(str) if "group" in seen else np.full(mode.size, "")
    levels = np.array([groups, way, seen["force"].values.astype(str)])
    kept = thinned(timed, mode, holds, levels, seen["time"].values, MOST_RECORDS)
    untimed, row = row.size - timed.size, kept
    force, time = seen["force"].values[row].astype(float), seen["time"].values[row]
    called, hold = np.unique(holds[row], return_inverse=True)
    known = bool(np.isfinite(time).all()) and row.size > 0
    time = time - time.min() if known else np.zeros(row.size)
    since = np.array([t - time[hold == h].min() for t, h in zip(time, hold, strict=True)])
    group = np.unique(groups[row], return_inverse=True)[1]
    ln_f, error = np.log(frequency[row]), np.maximum(std[row] / frequency[row], BEST)
    jumped: list[int] = []
    if known:
        hold, jumped = clampings(mode[row], hold, time, ln_f, error)
    kelvin, unknown = _kelvin(seen, row), None
    if kelvin is not None:
        unknown = UNTIMED_READING**2 * np.eye(row.size)
        if known and np.ptp(kelvin) > 0.0:
            kelvin, unknown = course(time, kelvin)
    records = Records(
        mode=np.array([list(modes).index(one) for one in mode[row]], dtype=int),
        force=force,
        sign=directions(way, holds)[row],
        time=time,
        since=since,
        span=float(time.max(initial=0.0)),
        hold_span=float(since.max(initial=0.0)),
        temperature=kelvin,
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
        group if group.max(initial=0) > 0 else None,
        tuple(called[jumped].tolist()),
        unheld,
        untimed,
        timed.size - row.size,
        shared[row],
        unknown,
    )


def _kelvin(seen: xr.Dataset, row: ndarray) -> Float[ndarray, " record"] | None:
    """Temperatures off their mean, K; None where one is not known."""
    known = seen["temperature"].values[row] if "temperature" in seen else np.full(row.size, np.nan)
    return known - known.mean() if row.size and np.isfinite(known).all() else None


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
    of_mode = np.eye(len(data.modes))[records.mode]
    here = simulated.of_records(records, data.hold, data.rounding)
    base, kinds = here.prior.mean.size, len(here.scales)
    prior = with_causes(here.prior.mean, here.prior.std, mechanisms)
    rows = np.arange(n)

    def beyond_level(one: Mechanism, values: ndarray) -> ndarray:
        """What a mechanism of levels changes beside each mode's mean, which it does not miss."""
        if one.kind != "level":
            return values
        return values - of_mode @ ((of_mode.T @ values).T / np.maximum(of_mode.sum(axis=0), 1.0)).T

    def predict(theta: ndarray) -> State:
        own = theta[:base]
        made = causes(mechanisms, theta[base:], records, partial(here.structures, own))
        said = here.at(own, made.changes, made.by_place)
        whole = np.column_stack([said.gradient, np.ones(n)])
        columns = [said.slope]
        columns += [np.einsum("nc,ncp->np", whole, slope) for slope in made.slopes]
        effects = np.einsum("nc,knc->kn", whole, made.effects)
        facts = {"gradient": said.gradient, "effects": effects}
        turns = None if said.turning is None else partial(turned, said, made, effects)
        mean = said.mean + made.changes[:, 3]
        return State(mean, np.hstack(columns), facts, made.inside, turns)

    def turned(
        said: Said, made: Causes, effects: ndarray, scales: ndarray, vector: ndarray,
        matrix: ndarray,
    ) -> tuple[ndarray, ndarray]:  # fmt: skip
        """The covariance's derivatives by the parameters, as `State` says."""
        by_law, by_change = said.turning()
        by_cause = [np.einsum("nap,nab->npb", slope[:, :3], by_change) for slope in made.slopes]
        turn = np.concatenate([by_law, *by_cause], axis=1)
        times, traces = here.turned(said.gradient, turn, scales[:kinds], vector, matrix)
        trusted, owns = TRUST * np.exp(scales[kinds + 1]), places(mechanisms, base)
        whole = np.column_stack([said.gradient, np.ones(n)])
        for k, (one, own, kernel) in enumerate(zip(mechanisms, owns, trust, strict=True)):
            grown = np.einsum("npb,nb->np", turn, made.effects[k][:, :3])
            grown[:, own] += np.einsum("nc,ncp->np", whole, made.slopes[k])
            parts = (beyond_level(one, part) for part in (effects[k], grown))
            by_error = own_error_turned(trusted, kernel, *parts, vector, matrix)
            times, traces = times + by_error[0], traces + by_error[1]
        return times, traces

    beyond = _of_limits(data)
    trust = [trust_kernel(data, one.over) for one in mechanisms]

    def covariance(state: State, scales: ndarray) -> tuple[ndarray, Slopes]:
        noise = np.exp(scales[kinds])
        whole, of_clampings = here.scatter(state.facts["gradient"], scales[:kinds])
        of_laws = np.zeros((n, n))
        for effect, kernel, one in zip(state.facts["effects"], trust, mechanisms, strict=True):
            e = beyond_level(one, effect)
            of_laws += np.outer(TRUST**2 * e, e) * kernel
        of_laws *= np.exp(2.0 * scales[kinds + 1])
        whole += of_laws
        if beyond is not None:
            whole += beyond
        whole[rows, rows] += data.std**2 + noise**2
        parts = [
            np.exp(2.0 * scale) * unit
            for scale, (unit, _) in zip(scales[kinds + 2 :], extra, strict=True)
        ]
        for part in parts:
            whole += part

        def slopes() -> list[ndarray]:
            own = np.full(n, 2.0 * noise**2)
            return [*of_clampings(), own, 2.0 * of_laws, *(2.0 * part for part in parts)]

        return whole, slopes

    scales = with_smooth([*here.scales, NOISE, LAWS], extra)
    return Problem(data.ln_f, predict, covariance, prior, scales)


def _of_limits(data: StickData) -> Float[ndarray, "record record"] | None:
    """Covariance by the law that takes records to the plateau they do not reach."""
    if data.shared is None or not data.shared.any():
        return None
    alike = same_mode(data) * near(np.log(data.records.force), FORCE_LENGTH)
    return np.outer(data.shared, data.shared) * alike


def trust_kernel(data: StickData, over: Sequence[str]) -> Float[ndarray, "record record"]:
    """Correlation of a law's own errors between records: alike situations have alike errors."""
    if tuple(over) in data.kernels:
        return data.kernels[tuple(over)]
    records = data.records
    kernels = {
        "force": lambda: near(np.log(records.force), FORCE_LENGTH),
        "time": lambda: kinked(records.time, TIME_LENGTH * max(records.span, 1.0)),
        "clamping": lambda: kinked(records.clamping, TIME_LENGTH),
        "since": lambda: kinked(records.since, max(records.hold_span, 1.0)),
        "sign": lambda: (records.sign[:, None] == records.sign).astype(float),
        "temperature": lambda: _of_thermometer(data),
    }
    whole = same_mode(data).astype(float)
    for name in over:
        whole = whole * kernels[name]()
    if "since" in over:  # what a clamping loses more or less than others, all its modes see
        whole += (OF_HOLD / TRUST) ** 2 * (data.hold[:, None] == data.hold) * kernels["since"]()
    return data.kernels.setdefault(tuple(over), whole)


def _of_thermometer(data: StickData) -> Float[ndarray, "record record"]:
    """Correlation of the errors of a law of temperature, with those of the temperature, which are
    as large at the mean.
    """
    kelvin = data.records.temperature
    kelvin = np.where(np.abs(kelvin) < LEAST_KELVIN, LEAST_KELVIN, kelvin)
    off = READING**2 * near(data.records.time, HOUR) + data.temperature_covariance
    return near(kelvin, KELVIN) + off / TRUST**2 / np.outer(kelvin, kelvin)


def own_error_turned(
    trust: float, kernel: ndarray, effect: ndarray, slope: ndarray, vector: ndarray, matrix: ndarray
) -> tuple[ndarray, ndarray]:
    """How the covariance of a law's own error, a part `trust` of its effect, turns as the effect
    grows with parameters by `slope`: as `State.turns` says.
    """
    times = slope * (kernel @ (effect * vector))[:, None]
    times += effect[:, None] * (kernel @ (slope * vector[:, None]))
    return trust**2 * times, 2.0 * trust**2 * ((kernel * matrix) @ effect) @ slope


def same_mode(data: StickData) -> Bool[ndarray, "record record"]:
    """Which records are of one mode."""
    return data.records.mode[:, None] == data.records.mode


def near(values: Float[ndarray, " record"], length: float) -> Float[ndarray, "record record"]:
    """Correlation that falls with the distance of values, 0.6 at `length`."""
    return np.exp(-0.5 * ((values[:, None] - values) / length) ** 2)


def kinked(values: Float[ndarray, " record"], length: float) -> Float[ndarray, "record record"]:
    """The same of what is differentiable but once, as a law with a kink is (Matern 3/2)."""
    away = np.sqrt(3.0) * np.abs(values[:, None] - values) / length
    return (1.0 + away) * np.exp(-away)
