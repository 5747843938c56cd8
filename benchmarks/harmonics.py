"""What a ring-down's harmonics tell of its joint: a bar of three modes, integrated in time.

    python benchmarks/harmonics.py

The joint slips (elements in parallel), parts on one side, or stops on both; shares no code with the
product. Printed are the second and third harmonic of the first mode's velocity over the first, in
a window while it is loud, by noise, by the sensor's own distortion and by a mode beside them.
"""

import numpy as np
from numba import njit

RATE, STEPS = 12800.0, 4  # Hz, and steps of the integration a sample
SECONDS, FIRST_HZ = 0.8, 163.0
DAMPING, JOINT = np.array([0.8e-3, 1.0e-3, 1.2e-3]), np.array([1.0, -0.7, 0.5])
START = 0.06 * np.array([1.0, 0.3, 0.2])  # m/s
LOUD = slice(800, 3200)  # samples that are looked at
KINDS = ("linear", "slip", "one side", "stops")


@njit
def _joint(kind: int, u: float, held: np.ndarray, moved: float, limits: np.ndarray) -> float:
    """Force of the joint over its stiffness: of sliders that were `held` before it moved so far."""
    if kind == 1:
        return np.minimum(np.maximum(held + moved, -limits), limits).mean()
    if kind == 2:
        return min(u, 0.6 * limits[0])
    return u**3 / limits[0] ** 2 if kind == 3 else 0.0


@njit
def _ring(kind: int, omega: np.ndarray, stiffness: float, limits: np.ndarray) -> np.ndarray:
    """Velocities (sample, mode) by Runge and Kutta's fourth order."""
    step, y = 1.0 / RATE / STEPS, np.concatenate((np.zeros(3), START))
    held, out = np.zeros(limits.size), np.empty((int(SECONDS * RATE), 3))
    k = np.zeros((5, 6))
    for i in range(out.shape[0] * STEPS):
        if i % STEPS == 0:
            out[i // STEPS] = y[3:]
        before = (JOINT * y[:3]).sum()
        for s, part in enumerate((0.0, 0.5, 0.5, 1.0)):
            at = y + part * step * k[s]
            u = (JOINT * at[:3]).sum()
            force = stiffness * _joint(kind, u, held, u - before, limits)
            k[s + 1, :3] = at[3:]
            k[s + 1, 3:] = -2 * DAMPING * omega * at[3:] - omega**2 * at[:3] - JOINT * force
        y = y + step / 6 * (k[1] + 2 * k[2] + 2 * k[3] + k[4])
        moved = (JOINT * y[:3]).sum() - before
        held = np.minimum(np.maximum(held + moved, -limits), limits)
    return out


def ring(kind: str, size: float, third_Hz: float) -> np.ndarray:
    """Velocity at the sensor; `size` is the joint's stiffness over the first mode's."""
    omega = 2 * np.pi * np.array([FIRST_HZ, 421.0, third_Hz])
    top = START[0] / omega[0]
    spread = np.exp(np.random.default_rng(1).normal(-0.2, 0.8, 24))
    limits = top * (spread if kind == "slip" else np.ones(1))
    return _ring(KINDS.index(kind), omega, omega[0] ** 2 * size, limits) @ [1.0, 0.6, -0.5]


def _line(v: np.ndarray) -> np.ndarray:
    """The first mode alone, as an analytic signal."""
    at = np.fft.fftfreq(v.size, 1 / RATE)
    return np.fft.ifft(np.where(abs(at - FIRST_HZ) < 0.3 * FIRST_HZ, 2 * np.fft.fft(v), 0))


def harmonics(v: np.ndarray) -> list[float]:
    """Second and third harmonic over the first, locked to its phase."""
    line, window = _line(v)[LOUD], np.blackman(LOUD.stop - LOUD.start)
    found = []
    for order in (2, 3):
        lock = abs(line) * np.exp(1j * order * np.angle(line)) * window
        found.append(float(2 * abs(np.vdot(lock, v[LOUD])) / np.vdot(lock, lock / window).real))
    return found


def softer(v: np.ndarray) -> float:
    """Relative change of the first mode's frequency, loud over quiet."""
    phase = np.unwrap(np.angle(_line(v)))
    rates = [
        np.polyfit(np.arange(n), phase[k : k + n], 1)[0] for k, n in ((800, 600), (7000, 2400))
    ]
    return float(rates[0] / rates[1] - 1)


def main() -> None:
    """The table."""
    cases = [
        (kind, size, 777.0) for kind, size in zip(KINDS, (0.0, 0.006, 0.006, 0.002), strict=True)
    ]
    cases += [("slip", 0.006, 331.0), ("one side", 0.006, 331.0), ("slip", 0.006, 492.0)]
    print("| joint | third mode | change of f | noise | sensor | 2nd | 3rd |\n" + "|---" * 7 + "|")
    for kind, size, third_Hz in cases:
        v = ring(kind, size, third_Hz)
        top = abs(v).max()
        for decibel, bent in ((60, 0.0), (70, 0.0), (80, 0.0), (80, 1e-3)):
            noise = top * 10 ** (-decibel / 20) * np.random.default_rng(decibel).normal(size=v.size)
            second, third = harmonics(v + bent * (v**2 / top + v**3 / top**2) + noise)
            print(
                f"| {kind} | {third_Hz:g} Hz | {1e6 * softer(v):.0f} ppm | -{decibel} dB "
                f"| {bent:g} | {second:.1e} | {third:.1e} |"
            )


if __name__ == "__main__":
    main()
