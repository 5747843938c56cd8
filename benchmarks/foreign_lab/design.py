"""Messy designs: loads unevenly repeated, records lost, hammer or shaker, a noise of its own."""

from dataclasses import dataclass

import numpy as np

from foreign_lab.sheet import Sheet
from foreign_lab.specimen import Specimen

LEAST, MOST = 39, 112  # records


@dataclass(frozen=True)
class Bench:
    """How a campaign is recorded; by mode: loss factors, start (m/s), seconds."""

    piston_cm2: float
    sampling_Hz: float
    noise_dB: float
    hammer: bool
    loss: dict[str, float]
    start: dict[str, float]
    seconds: dict[str, float]
    strangers: tuple[tuple[float, float], ...]  # frequency over 1B's and part of unlisted modes
    scatter: float  # of ln k between clampings
    heavy: bool
    hides_direction: str  # "", "some", "all"
    hides_time: bool


def draw_bench(rng: np.random.Generator, specimen: Specimen) -> Bench:
    """Recording and scatter; nothing here knows of effects."""
    modes = ("1B", "2B")
    f = {
        m: float(np.exp(specimen.surfaces[m].ln_frequency(specimen.ln_kn, specimen.ln_kt, 12e3)))
        for m in modes
    }
    noise = float(rng.uniform(40, 80))
    loss = {m: float(np.exp(rng.uniform(np.log(8e-4), np.log(5e-3)))) for m in modes}
    fall = min(noise, 55) / 20 * np.log(10) + 1.0
    seconds = {m: min(0.35 + fall / (np.pi * f[m] * loss[m]), 3.5) for m in modes}
    strangers = []
    for _ in range(int(rng.integers(0, 3))):
        ratio = float(np.exp(rng.uniform(np.log(0.3), np.log(5.0))))
        if all(abs(np.log(ratio * f["1B"] / f[m])) > 0.18 for m in modes):
            strangers.append((ratio, float(rng.uniform(0.01, 0.15))))
    return Bench(
        float(rng.choice([12.3, 17.9, 21.4])),
        float(rng.choice([s for s in (6400.0, 12800.0, 20000.0, 25600.0) if s > 6 * f["2B"]][:2])),
        noise,
        bool(rng.random() < 0.4),
        loss,
        {m: float(np.exp(rng.uniform(np.log(0.015), np.log(0.12)))) for m in modes},
        {m: float(np.ceil(10 * s) / 10) for m, s in seconds.items()},
        tuple(strangers),
        float(np.exp(rng.uniform(np.log(0.01), np.log(0.1)))),
        bool(rng.random() < 0.5),
        str(rng.choice(["", "some", "all"], p=[0.75, 0.15, 0.1])),
        bool(rng.random() < 0.07),
    )


def draw_sheet(rng: np.random.Generator, specimen: Specimen, bench: Bench) -> Sheet:
    """Records in the order in which they were made, state still undisturbed."""
    rows = _rows(rng)
    rows = np.sort(rng.permutation(len(rows))[: int(rng.integers(LEAST, MOST + 1))]), rows
    kept = [rows[1][k] for k in rows[0]]
    column = {name: np.array([row[name] for row in kept]) for name in kept[0]}
    newtons = bench.piston_cm2 * 10.0
    bars = np.round(column["load"] * 24e3 / newtons)
    mode = column["mode"]
    omega = {
        m: 2 * np.pi * np.exp(s.ln_frequency(specimen.ln_kn, specimen.ln_kt, 12e3))
        for m, s in specimen.surfaces.items()
    }
    start = np.array([bench.start[m] / omega[m] for m in mode]) * column["drive"]
    reading = bars * newtons
    return Sheet(
        specimen,
        mode,
        reading,
        column["hold"],
        column["direction"],
        column["time"],
        column["in_hold"],
        column["group"],
        start,
        np.where(column["direction"] > 0, reading.min(), reading.max()),
        column["hold"].astype(float),
        _temperature(rng, column["time"]),
        float(np.median(reading)),
    )


def undisturbed(rng: np.random.Generator, sheet: Sheet, bench: Bench, bias: float) -> dict:
    """The state of each record without any effect: scatter by clamping, gauge's step, bias.

    `bias`: standard deviation of each mode's ln f that no change of the records explains.
    """
    holds, where = np.unique(sheet.hold, return_inverse=True)
    draws = rng.standard_t(3, (3, len(holds))) / np.sqrt(3) if bench.heavy else None
    draws = rng.normal(size=(3, len(holds))) if draws is None else draws
    alike = rng.uniform(0, 0.7)
    ln_kt = alike * draws[0] + np.sqrt(1 - alike**2) * draws[1]
    newtons = bench.piston_cm2 * 10.0
    off = {m: bias * rng.normal() for m in sheet.specimen.surfaces}
    size, count = bench.scatter, len(sheet.mode)
    return {
        "ln_kn": sheet.specimen.ln_kn + size * draws[0][where],
        "ln_kt": sheet.specimen.ln_kt + size * ln_kt[where],
        "force": sheet.reading + newtons * rng.uniform(-0.5, 0.5, len(holds))[where],
        "ln_f": np.array([off[m] for m in sheet.mode]) + 1.5e-5 * rng.normal(size=count),
        "ln_eta": 0.03 * draws[2][where] + 0.005 * rng.normal(size=count),
        "bias": np.array([off[m] for m in sheet.mode]),
    }


def _rows(rng: np.random.Generator) -> list[dict]:
    """More rows than are needed: passes over the loads, some loads twice, some passes cut short."""
    loads = np.sort(rng.choice(np.arange(8, 101), int(rng.integers(5, 9)), replace=False)) / 100
    loads[-1] = max(loads[-1], 0.7)
    weight = rng.uniform(0.3, 1.0, len(loads))
    two_ways = rng.random() < 0.8
    turn = 3 + int(6 * rng.random())  # clampings until the other operator takes over
    rows, clock, hold, way = [], 0.0, 0, 1
    while len(rows) < MOST + 20:
        order = range(len(loads)) if way > 0 else range(len(loads))[::-1]
        for k in order:
            if rng.random() > weight[k]:
                continue
            hold += 1
            clock += rng.uniform(600, 2400)
            since = rng.uniform(60, 400)
            for mode in rng.permutation(["1B", "2B"] * int(rng.integers(1, 3))):
                rows.append(
                    {
                        "mode": str(mode),
                        "load": loads[k],
                        "hold": hold,
                        "direction": way,
                        "time": clock + since,
                        "in_hold": since,
                        "group": int((hold // turn) % 2),
                        "drive": float(rng.choice([0.7, 1.0, 1.4]) * rng.uniform(0.85, 1.15)),
                    }
                )
                since += rng.uniform(100, 500)
            clock += since
        way = -way if two_ways else 1
        clock += 5e4 if rng.random() < 0.2 else 0.0
    return rows


def _temperature(rng: np.random.Generator, time: np.ndarray) -> np.ndarray:
    day = np.sin(2 * np.pi * time / 86400 + rng.uniform(0, 2 * np.pi))
    steps = np.sqrt(np.maximum(np.diff(time, prepend=time[0]), 0.0) / 3600)
    return 1.5 * day + 0.3 * np.cumsum(steps * rng.normal(size=len(time)))
