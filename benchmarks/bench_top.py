"""Curves and stick frequencies of drawn bench-top events beside their truth.

    python benchmarks/bench_top.py --records 300 --seed 2001

Two to four modes x = A cos(phi) with A' = -delta(A) A and phi' = omega(A) are struck, let go from
rest, or one of them is driven and released; one sensor sees them. By whom laws, sizes and this file
were drawn had not read the library. Frequency and loss factor are true by (3.11), from the laws
themselves. A curve is wrong where more than two points, or a twentieth of them, are off by more
than 500 ppm (frequency) or a tenth (loss factor) and three stated errors; a stick frequency where
it is off by more than 100 ppm and four.
"""

import argparse
import collections
from collections.abc import Callable
from dataclasses import dataclass

import bladeroot as br
import numpy as np
from numpy import ndarray
from scipy.integrate import solve_ivp

RATES = (50, 100, 200, 500, 1000, 2048, 5000, 10000, 25600, 51200, 1e5, 2e5, 5e5, 1e6)
KINDS = ("blow", "step", "drive")
QUANTITIES = ("velocity", "displacement", "acceleration")
STEP = 1e-4  # of ln A, for derivatives of the laws
CALM = 1e-15  # m: an amplitude at which no law acts


@dataclass(frozen=True)
class Mode:
    """Its rates of phase and of -ln A (1/s) over amplitude (m)."""

    omega: Callable[[ndarray], ndarray]
    delta: Callable[[ndarray], ndarray]

    def slopes(self, a: ndarray) -> tuple[ndarray, ndarray]:
        """Derivatives of both rates by amplitude."""
        high, low = a * (1.0 + STEP), a * (1.0 - STEP)
        return tuple((rate(high) - rate(low)) / (high - low) for rate in (self.omega, self.delta))

    def truth(self, a: ndarray) -> tuple[ndarray, ndarray]:
        """Frequency (Hz) and loss factor by (3.11)."""
        w, d = self.omega(a), self.delta(a)
        w_a, d_a = self.slopes(a)
        square = w**2 - d**2 - a * d * d_a
        return np.sqrt(square) / (2.0 * np.pi), (2.0 * w * d + w_a * d * a) / square

    def motion(self, start: float, since: ndarray, phase: float, quantity: str) -> ndarray:
        """Displacement, velocity or acceleration, from its amplitude at time zero on."""

        def rates(_, state):
            return [-self.delta(np.exp(state[0])), self.omega(np.exp(state[0]))]

        known = {"rtol": 1e-11, "atol": 1e-9, "method": "DOP853", "dense_output": True}
        log, turned = solve_ivp(rates, (0.0, since[-1]), [np.log(start), 0.0], **known).sol(since)
        a, turned = np.exp(log), turned + phase
        w, d = self.omega(a), self.delta(a)
        w_a, d_a = self.slopes(a)
        if quantity == "displacement":
            return a * np.cos(turned)
        if quantity == "velocity":
            return -a * (d * np.cos(turned) + w * np.sin(turned))
        bend, chirp = d * d + a * d * d_a, -w_a * d * a
        return a * (bend - w * w) * np.cos(turned) + a * (2.0 * d * w - chirp) * np.sin(turned)


def drawn_mode(rng: np.random.Generator, hertz: float, scale: float) -> Mode:
    """A viscous mode, a power law that saturates, a quadratic one, or slip with a smooth corner."""
    loss, most = 10.0 ** rng.uniform(-3.2, -1.8), 2.0 * np.pi * hertz
    power, rise, soft = rng.uniform(0.4, 1.0), rng.uniform(0.5, 4.0), rng.uniform(-0.005, 0.02)
    corner = rng.uniform(2.0, 6.0)

    def power_law(a):
        grown = (a / scale) ** power
        return grown / (1.0 + 0.3 * grown)

    def quadratic(a):
        return (a / scale) ** 2 / (1.0 + (a / scale) ** 2)

    def slip(a):
        return 1.0 - (1.0 + (a / scale) ** corner) ** (-1.0 / corner)

    law, losing = (
        (lambda a: 0.0 * a, lambda g: 0.0 * g),
        (power_law, lambda g: g),
        (quadratic, lambda g: 0.0 * g),
        (slip, lambda g: 4.0 * g * (1.0 - g)),
    )[rng.integers(4)]

    def omega(a):
        return most * (1.0 - soft * law(a))

    return Mode(omega, lambda a: 0.5 * loss * (1.0 + rise * losing(law(a))) * omega(a))


@dataclass(frozen=True)
class Event:
    """A record (SI), its sampling frequency, all modes, and which is asked for."""

    samples: ndarray
    sampling_Hz: float
    quantity: str
    kind: str
    modes: list[Mode]
    asked: int


def drawn(seed: int, number: int) -> Event:
    """A drawn event."""
    rng = np.random.default_rng([seed, number])
    lines = [10.0 ** rng.uniform(0.5, 3.3)]
    for _ in range(rng.integers(1, 4)):
        lines.append(lines[-1] * rng.uniform(1.25, 3.2))
    scales = [10.0 ** rng.uniform(-6.5, -4.0) * 100.0 / lines[0] / (1 + k) ** 2
              for k in range(len(lines))]  # fmt: skip
    modes = [drawn_mode(rng, *one) for one in zip(lines, scales, strict=True)]
    starts = [scale * rng.uniform(0.6, 20.0) for scale in scales]
    kind, quantity = str(rng.choice(KINDS)), str(rng.choice(QUANTITIES))
    rate = float(next(one for one in RATES if one > 4.0 * lines[-1]))
    lasts = 12.0 / modes[0].delta(np.array(CALM))
    seconds = min(30.0, max(0.3, lasts), 4e5 / rate)
    before = seconds * (rng.uniform(0.05, 0.3) if kind == "drive" else rng.uniform(0.01, 0.1))
    asked = int(rng.integers(len(modes)))
    power = {"displacement": 0, "velocity": 1, "acceleration": 2}[quantity]
    if kind == "drive":  # one mode is driven, of the others the release leaves little
        starts = [
            one if k == asked
            else starts[asked] * rng.uniform(0.002, 0.04) * (lines[asked] / lines[k]) ** power
            for k, one in enumerate(starts)
        ]  # fmt: skip
    time = np.arange(int(seconds * rate)) / rate - before - 0.37 / rate
    after = time >= 0.0
    x = np.zeros(time.size)
    for k, (mode, start) in enumerate(zip(modes, starts, strict=True)):
        phase = {"blow": -0.5 * np.pi, "step": 0.0, "drive": 0.9 + 1.3 * k}[kind]
        one = mode.motion(start, time[after], phase, quantity)
        if kind == "blow":
            contact = np.clip(time[after] / 0.3 / 2.0 / np.pi * mode.omega(np.array(start)), 0, 1)
            one = one * contact**2 * (3.0 - 2.0 * contact)
        x[after] += one
        w = float(mode.omega(np.array(start)))
        if kind == "drive" and k == asked:
            turn = phase + w * time[~after] + 0.5 * np.pi * power
            x[~after] += start * w**power * np.cos(turn)
        if kind == "step" and quantity == "displacement":
            x[~after] += start
    peak = np.abs(x).max()
    x += peak * 10.0 ** rng.uniform(-4.0, -2.3) * rng.standard_normal(x.size)
    x += peak * (rng.choice([0.0, 0.01]) + rng.choice([0.0, 0.01]) * time / seconds)
    x += peak * rng.choice([0.0, 1e-3]) * np.sin(2.0 * np.pi * 50.0 * time + 0.7)
    bits = [None, 12, 16, 24][rng.integers(4)]
    if bits:
        step = 2.0 * rng.uniform(1.05, 4.0) * np.abs(x).max() / 2**bits
        x = np.round(x / step) * step
    return Event(x, rate, quantity, kind, modes, asked)


def judged(event: Event, seed: int, number: int) -> tuple[str, str, str]:
    """What the library makes of it: class of the curves, of the stick frequency, and a line."""
    rng = np.random.default_rng([seed, number, 1])
    lines = [float(one.truth(np.array(CALM))[0]) for one in event.modes]
    own = lines.pop(event.asked)
    made = br.ringdown(
        event.samples, own * rng.uniform(0.98, 1.01), sampling_Hz=event.sampling_Hz,
        quantity=event.quantity, other_modes_Hz=lines,
    )  # fmt: skip
    mode, curves = event.modes[event.asked], made.curves
    if not curves.sizes["point"]:
        return "no curve", "none", made.verdict
    off = []
    true = mode.truth(curves["amplitude"].values)
    names = ("frequency", "loss_factor")
    for name, value, least in zip(names, true, (5e-4, 0.1), strict=True):
        error = np.abs(curves[name].values - value)
        beyond = (error > least * value) & (error > 3.0 * curves[f"{name}_std"].values)
        off.append(np.count_nonzero(beyond))
    wrong = max(off) > max(2, 0.05 * curves.sizes["point"])
    kind = ("wrong, told" if made.findings else "wrong in silence") if wrong else "right"
    value, std = made.stick_frequency
    error = abs(value - own)
    stick = "none" if np.isnan(value) else "right"
    if error > 1e-4 * own and error > 4.0 * std:
        stick = f"wrong by {1e6 * error / own:.0f} ppm, {error / std:.0f} stated errors"
    return kind, stick, f"points off {off}; {'; '.join(made.findings)[:120]}"


def main() -> None:
    """Print counts, and a line for what is wrong."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--records", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    chosen = parser.parse_args()
    counts: dict[str, collections.Counter] = {kind: collections.Counter() for kind in KINDS}
    sticks = collections.Counter()
    for number in range(chosen.records):
        event = drawn(chosen.seed, number)
        if not np.isfinite(event.samples).all():
            continue  # a law that cannot be
        curves, stick, line = judged(event, chosen.seed, number)
        counts[event.kind][curves] += 1
        sticks[stick.partition(" by")[0]] += 1
        if curves.startswith("wrong") or stick.startswith("wrong"):
            print(f"{number} {event.kind} {event.quantity}: {curves}; stick {stick}; {line}")
    for kind, found in counts.items():
        print(f"{kind}: {dict(found)}")
    print(f"stick frequencies: {dict(sticks)}")


if __name__ == "__main__":
    np.seterr(all="ignore")
    main()
