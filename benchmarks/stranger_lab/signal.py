"""Velocity of a record: slow flow of each mode's amplitude and phase, and what disturbs it."""

import numpy as np
from scipy.interpolate import CubicSpline

from stranger_lab.bench import Bench, State, Visit
from stranger_lab.laws import REFERENCE, Mode, curve

GRID = np.linspace(np.log(1e-10), np.log(1e-3), 260)  # ln of displacement (m)
FALL = np.log(2e4)  # of ln amplitude that is followed
RECORDED = np.log(1500.0)  # of ln amplitude that a record shows, about


def rates(bench: Bench, visit: Visit, state: State, j: int) -> tuple[np.ndarray, np.ndarray]:
    """Angular frequency (rad/s) and loss factor of mode `j` over `GRID`."""
    first = bench.expected_Hz[0]
    damp = bench.damp[visit.day] + 0.5 * np.sin(2 * np.pi * visit.time_s / 50000)
    loss = bench.loss[j] * np.exp(bench.rng.normal(0, 0.015))
    mode = Mode(
        j, np.exp(GRID), bench.largest, state.frequencies_Hz[j], loss,
        first / bench.expected_Hz[j], state.load / REFERENCE, state.by_kn[j], state.by_kt[j], damp,
    )  # fmt: skip
    ln_f, eta = curve(bench.effects, mode)
    return 2 * np.pi * mode.frequency_Hz * np.exp(ln_f), eta


def decay(omega: np.ndarray, eta: np.ndarray, start: float):
    """Time (s), ln amplitude and phase (rad) from ln amplitude `start` on."""
    level = np.linspace(start, start - FALL, 1500)
    rate = np.exp(np.interp(level, GRID, np.log(0.5 * eta * omega)))
    turning = np.interp(level, GRID, omega)
    time = np.cumsum(np.r_[0, -np.diff(level) * 0.5 * (1 / rate[1:] + 1 / rate[:-1])])
    phase = np.cumsum(np.r_[0, np.diff(time) * 0.5 * (turning[1:] + turning[:-1])])
    return time, level, phase


def remembering(omega: np.ndarray, eta: np.ndarray, start: float, rubber: dict, largest: float):
    """The same where stiffness and loss remember the motion for a while, in steps of 4 cycles."""
    step = 8 * np.pi / omega.mean()
    level, phase, memory = [start], [0.0], np.exp(start) / largest
    while level[-1] > start - FALL and len(level) <= 6000:
        memory += step / rubber["memory_s"] * (np.exp(level[-1]) / largest - memory)
        worn = memory / (1 + memory)
        turning = np.interp(level[-1], GRID, omega) * (1 - rubber["soft"] * worn)
        loss = np.interp(level[-1], GRID, eta) * (1 + rubber["loss"] * worn)
        level.append(level[-1] - 0.5 * loss * turning * step)
        phase.append(phase[-1] + turning * step)
    return step * np.arange(len(level)), np.array(level), np.array(phase)


def motion(path: tuple, omega: np.ndarray, since: np.ndarray, turn: float, rate: float):
    """Velocity (m/s) of a mode at times (s) after the release; `turn` is its phase there."""
    time, level, phase = path
    at = np.minimum(since, time[-1])
    ln_a, angle = CubicSpline(time, level)(at), CubicSpline(time, phase)(at) + turn
    falling = np.gradient(ln_a, 1 / rate)
    turning = np.interp(ln_a, GRID, omega)
    return np.exp(ln_a) * (falling * np.cos(angle) - turning * np.sin(angle))


def start_of(bench: Bench, visit: Visit, j: int, loudness: float) -> float:
    """Amplitude (m) from which mode `j` decays; 0 if it is not excited."""
    rng, size = bench.rng, bench.largest * bench.expected_Hz[0] / bench.expected_Hz[j] * loudness
    if j not in visit.modes:
        return 0.0 if bench.excitation == "shaker" else size * rng.uniform(0.003, 0.02)
    return size * (rng.uniform(0.4, 1) if bench.excitation == "hammer" else 1.0)


def velocity(bench: Bench, number: int) -> np.ndarray:
    """Samples of a record (m/s), with noise."""
    visit, state, rng = bench.visits[number], bench.state(number), bench.rng
    loudness = np.exp(rng.normal(0, 0.25)) * rng.choice([0.5, 1.0])
    if visit.operator == "B" and "operator" in bench.effects:
        loudness *= bench.effects["operator"]["soft"]
    driven, rate, moving, length = bench.excitation == "shaker", bench.sampling_Hz, [], 0.0
    for j in range(len(bench.modes)):
        start = start_of(bench, visit, j, loudness)
        if not start:
            continue
        omega, eta = rates(bench, visit, state, j)
        known = (omega, eta, float(np.log(start)))
        rubber = bench.effects.get("rubber")
        largest = bench.largest * bench.expected_Hz[0] / bench.expected_Hz[j]
        path = remembering(*known, rubber, largest) if rubber else decay(*known)
        moving.append((path, omega))
        if j in visit.modes:
            end = known[2] - RECORDED
            length = max(length, np.interp(end, path[1][::-1], path[0][::-1]))
    before = 0.35 if driven else 0.08
    length = float(np.clip(length * rng.uniform(0.8, 1.1), 0.4, 9.0))
    time = np.arange(int((before + length) * rate)) / rate - before
    after, v = time >= 0, np.zeros(len(time))
    for path, omega in moving:
        turn = rng.uniform(0, 2 * np.pi) if driven else 0.0
        v[after] += motion(path, omega, time[after], turn, rate)
        if driven:
            turning = np.interp(path[1][0], GRID, omega)
            v[~after] -= np.exp(path[1][0]) * turning * np.sin(turning * time[~after] + turn)
    if bench.excitation == "hammer":
        width = max(int(0.0012 * rate), 4)
        v[int(before * rate) :][:width] += 0.3 * bench.speed * np.hanning(width)
    return disturbed(bench, visit, state, time, v)


def disturbed(bench: Bench, visit: Visit, state: State, time: np.ndarray, v: np.ndarray):
    """With noise, and with what is hidden in the signal itself."""
    effects, rng, after = bench.effects, bench.rng, time >= 0
    if one := effects.get("hum"):
        for hertz, size in ((50.01, 1.0), (150.03, 0.4)):
            turn = 2 * np.pi * hertz * time + rng.uniform(0, 6)
            v = v + one["size"] * bench.speed * size * np.cos(turn)
    if one := effects.get("beating"):
        j, since = visit.modes[0], time[after]
        hertz = state.frequencies_Hz[j] * (1 + one["sign"] * one["apart"])
        falling = np.exp(-np.pi * bench.loss[j] * hertz * since)
        size = one["size"] * np.abs(v).max()
        v[after] += size * falling * np.cos(2 * np.pi * hertz * since + 1)
    if (one := effects.get("touch")) and rng.random() < one["share"]:
        later = time >= 0.18 * (time[-1] + 1 / bench.sampling_Hz)
        softer = np.where(later, (1 - one["loss"]) * v, v)
        v = np.where(later, np.interp(time + one["shift_s"], time, softer), v)
    v = v + rng.normal(0, bench.noise, len(v))
    if (one := effects.get("clipping")) and rng.random() < one["share"]:
        limit = np.abs(v).max() * (1 - one["part"])
        v = np.clip(v, -limit, limit)
    return v
