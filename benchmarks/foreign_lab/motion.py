"""Ring-downs by slow flow: amplitude and phase of each mode, harmonics, other modes, noise."""

from collections.abc import Sequence

import numpy as np

from foreign_lab.design import Bench
from foreign_lab.effect import Effect
from foreign_lab.sheet import Record

GRID = np.linspace(0.0, -9.0, 640)  # ln of the amplitude over its start


def backbone(record: Record, loss: float, effects: Sequence[Effect], x: np.ndarray) -> dict:
    """Frequency (rad/s), loss factor and relative harmonics of displacement at amplitudes x (m)."""
    total = {name: np.zeros(len(x)) for name in ("ln_f", "eta", "even", "odd")}
    for effect in effects:
        for name, change in (effect.call("curve", record, x) or {}).items():
            total[name] = total[name] + change
    return {
        "omega": record.omega * np.exp(total["ln_f"]),
        "eta": loss + total["eta"],
        "even": np.minimum(total["even"], 0.1),
        "odd": np.minimum(total["odd"], 0.1),
    }


def free_decay(
    record: Record, loss: float, effects: Sequence[Effect], after: np.ndarray, phase: float
) -> np.ndarray:
    """Velocity (m/s) at the times after release, from the record's start amplitude."""
    x = record.at("start") * np.exp(GRID)
    b = backbone(record, loss, effects, x)
    rate = -0.5 * b["eta"] * b["omega"]
    steps = np.diff(GRID)
    time = np.concatenate([[0.0], np.cumsum(steps * 0.5 * (1 / rate[1:] + 1 / rate[:-1]))])
    angle = np.diff(time) * 0.5 * (b["omega"][1:] + b["omega"][:-1])
    angle = np.concatenate([[0.0], np.cumsum(angle)])
    turned = phase + _cubic(after, time, angle, b["omega"])
    ln_a = _cubic(after, time, GRID, rate)
    size = record.at("start") * np.exp(ln_a) * np.interp(ln_a, GRID[::-1], b["omega"][::-1])
    even, odd = (np.interp(ln_a, GRID[::-1], b[name][::-1]) for name in ("even", "odd"))
    shape = -np.sin(turned)
    if even.any():
        shape = shape - 2 * even * np.sin(2 * turned)
    if odd.any():
        shape = shape - 3 * odd * np.sin(3 * turned)
    return size * shape


def _cubic(at: np.ndarray, x: np.ndarray, y: np.ndarray, slope: np.ndarray) -> np.ndarray:
    """Hermite's cubics through values and slopes; straight on beyond the end."""
    k = np.clip(np.searchsorted(x, at, side="right") - 1, 0, len(x) - 2)
    h = x[k + 1] - x[k]
    u = (at - x[k]) / h
    inside = (
        y[k] * (1 + 2 * u) * (1 - u) ** 2
        + slope[k] * h * u * (1 - u) ** 2
        + y[k + 1] * u**2 * (3 - 2 * u)
        - slope[k + 1] * h * u**2 * (1 - u)
    )
    return np.where(u <= 1, inside, y[-1] + slope[-1] * (at - x[-1]))


def raw_record(
    rng: np.random.Generator, record: Record, bench: Bench, effects: Sequence[Effect]
) -> tuple[np.ndarray, float]:
    """Velocity in digits of 16 bits, and the digit (m/s)."""
    _sheet, mode = record.sheet, record.mode
    fs, seconds = bench.sampling_Hz, bench.seconds[mode]
    t = np.arange(int(seconds * fs)) / fs
    release = float(rng.uniform(0.05, 0.3))
    after = t - release
    on = after >= 0
    loss = bench.loss[mode] * np.exp(record.at("ln_eta"))
    phase = 0.5 * np.pi if bench.hammer else float(rng.uniform(0, 2 * np.pi))
    v = np.zeros(len(t))
    v[on] = free_decay(record, loss, effects, after[on], phase)
    start = record.at("start") * record.omega
    _others(rng, v, t, after, on, record, bench, start)
    if bench.hammer:
        width = 1.5e-4 * rng.uniform(0.7, 1.5)
        pulse = np.abs(after + width) < width
        v[pulse] += 0.5 * start * np.cos(0.5 * np.pi * (after[pulse] + width) / width)
    else:
        first = backbone(record, loss, effects, np.array([record.at("start")]))
        turned = first["omega"][0] * after[~on] + phase
        v[~on] = -start * (
            np.sin(turned)
            + 2 * first["even"][0] * np.sin(2 * turned)
            + 3 * first["odd"][0] * np.sin(3 * turned)
        )
    for effect in effects:
        changed = effect.call("signal", record, rng, t, v)
        v = v if changed is None else changed
    nominal = bench.start[mode]
    v = v + nominal * 10 ** (-bench.noise_dB / 20) * rng.normal(size=len(v))
    digit = 2.5 * nominal / 32767
    return np.clip(np.round(v / digit), -32767, 32767).astype(np.int16), digit


def _others(rng, v, t, after, on, record, bench, start) -> None:
    """Other modes, linear, added in place."""
    sheet = record.sheet
    largest = 0.3 if bench.hammer else 0.06
    others = []
    for mode, surface in sheet.specimen.surfaces.items():
        if mode != record.mode:
            f = np.exp(surface.ln_frequency(*record.point) + record.at("ln_f"))
            others.append((float(f), largest * rng.uniform(0.1, 1.0), bench.loss.get(mode, 2e-3)))
    first = np.exp(sheet.specimen.surfaces["1B"].ln_frequency(*record.point))
    for ratio, part in bench.strangers:
        others.append((float(ratio * first), part * rng.uniform(0.3, 1.0), 3e-3))
    for f, part, loss in others:
        if f < 0.45 * bench.sampling_Hz:
            omega = 2 * np.pi * f
            decay = np.exp(-0.5 * loss * omega * after[on])
            v[on] += start * part * decay * np.sin(omega * after[on] + rng.uniform(0, 6.28))
