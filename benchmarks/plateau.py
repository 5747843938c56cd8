"""The stick plateau on decays whose truth is known: accuracy, coverage, verdicts, cost.

python benchmarks/plateau.py [decays a noise level] [decays for the verdicts] [first seed]
"""

import sys
import time

import numpy as np
import scipy.signal
from bladeroot.decay.freevib import freevib
from bladeroot.plateau.plateau import plateau
from bladeroot.pooling.components import pool

SAMPLING_HZ, COUNT, FREQUENCY_HZ, START = 25600.0, 102_400, 250.0, 0.5
LARGEST = START / (2.0 * np.pi * FREQUENCY_HZ)


def coulomb(x):
    """1 - k_eq/k_t and c_eq/k_t of a slider at x times its critical amplitude (3.19)."""
    x = np.maximum(x, 1.0)
    theta = np.arccos(1.0 - 2.0 / x)
    stiffness = (theta - 0.5 * np.sin(2.0 * theta)) / np.pi
    return 1.0 - stiffness, 4.0 / np.pi / x * (1.0 - 1.0 / x)


def slipping(rng):
    """A law with a plateau: onset (relative to the start), softening and damping above it."""
    onset = float(np.exp(rng.uniform(np.log(0.05), np.log(0.6))))
    if rng.random() < 1 / 3:
        top = coulomb(np.array(1.0 / onset))

        def law(a):
            soft, damp = coulomb(a / onset)
            return soft / top[0], damp / max(float(top[1]), 0.1)
    else:
        power = rng.choice([0.7, 1.0, 1.5, 2.0])

        def law(a):
            slip = (np.maximum(0.0, a / onset - 1.0) / (1.0 / onset - 1.0)) ** power
            return slip, slip

    return onset, law


def bending(rng):
    """A law without a plateau: a power of A, a logarithm, or A / (A + b)."""
    kind, two, b = rng.integers(3), rng.uniform(0.3, 1.6, 2), rng.uniform(0.1, 1.0)
    if kind == 0:
        return lambda a: (a ** two[0], a ** two[1])
    if kind == 1:
        return lambda a: (np.log(a / 1e-6) / np.log(1e6),) * 2
    return lambda a: (a / (a + b) * (1.0 + b),) * 2


def decay(rng, law, noise_db):
    """Velocity, noise rms, plateau frequency and loss factor of a decay that follows a law."""
    soft, eta, rise = (
        10 ** rng.uniform(-2.7, -1.7),
        rng.uniform(0.003, 0.008),
        rng.uniform(0.2, 1.5),
    )
    u = np.linspace(0.0, -16.0, 40_001)
    frequency_law, damping_law = law(np.exp(u))
    omega = 2.0 * np.pi * FREQUENCY_HZ * (1.0 - soft * frequency_law)
    alpha = -0.5 * 2.0 * np.pi * FREQUENCY_HZ * eta * (1.0 + rise * damping_law)

    def integrated(rate):
        return np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]))]) * (u[1] - u[0])

    at = integrated(1.0 / alpha)
    turn = integrated(omega / alpha)
    clock = np.arange(COUNT) / SAMPLING_HZ
    a = LARGEST * np.exp(np.interp(clock, at, u))
    lam = np.interp(clock, at, alpha) + 1j * np.interp(clock, at, omega)
    # straight lines between the knots would kink the phase by a part of 1e-7
    phase = np.interp(clock, at, turn) + rng.uniform(0, 2 * np.pi)
    velocity = (lam * a * np.exp(1j * phase)).real
    other = rng.uniform(2.3, 7.0) * FREQUENCY_HZ
    velocity += (
        rng.uniform(0.0, 0.3) * START * np.exp(-np.pi * rng.uniform(0.002, 0.006) * other * clock)
        * np.cos(2 * np.pi * other * clock + rng.uniform(0, 2 * np.pi))
    )  # fmt: skip
    noise = START / np.sqrt(2.0) * 10 ** (-noise_db / 20)
    velocity += noise * rng.standard_normal(COUNT)
    stuck = 2.0 * np.pi * FREQUENCY_HZ
    slow = -0.5 * stuck * eta
    square = stuck**2 - slow**2
    return velocity, noise, np.sqrt(square) / (2.0 * np.pi), -2.0 * stuck * slow / square


def share(z, limit):
    return 100.0 * np.mean(np.abs(z) < limit)


def accuracy(count, seed):
    """Errors and coverage of stick frequency, loss factor and onset, by noise level."""
    print("noise  reached  |f| ppm   68/95 %    |eta| %   68/95 %   |onset| %  68/95 %  plateau ms")
    for noise_db in (60, 40):
        rows, cost = [], []
        for k in range(count):
            rng = np.random.default_rng([seed, noise_db, k])
            onset, law = slipping(rng)
            velocity, noise, frequency, loss = decay(rng, law, noise_db)
            curves = freevib(velocity, SAMPLING_HZ, FREQUENCY_HZ, noise)
            start = time.perf_counter()
            found = plateau(curves)
            cost.append(time.perf_counter() - start)
            rows.append(
                [
                    found["plateau_reached"], found["stick_frequency"] / frequency - 1,
                    (found["stick_frequency"] - frequency) / found["stick_frequency_std"],
                    found["loss_factor"] / loss - 1,
                    (found["loss_factor"] - loss) / found["loss_factor_std"],
                    found["onset_amplitude"] / LARGEST / onset - 1,
                    (found["onset_amplitude"] / LARGEST - onset)
                    / (found["onset_amplitude_std"] / LARGEST),
                    found["onset_low"] < onset * LARGEST < found["onset_high"],
                ]
            )  # fmt: skip
        rows = np.array(rows)
        cells = []
        for column, scale in ((1, 1e6), (3, 1e2), (5, 1e2)):
            error, z = rows[:, column], rows[:, column + 1]
            seen = np.isfinite(error)
            error, z = error[seen], z[seen]
            # the onset, which is not normal, has a 95 % interval of its own
            wide = 100.0 * rows[seen, 7].mean() if column == 5 else share(z, 1.96)
            cells.append(f"{scale * np.median(np.abs(error)):8.2f}  {share(z, 1):3.0f} {wide:3.0f}")
        print(f"{noise_db} dB  {int(rows[:, 0].sum())}/{count} ", "  ".join(cells),
              f"{1e3 * np.median(cost):8.0f}")  # fmt: skip


def verdicts(count, seed):
    """How often a bend without end is called a plateau."""
    wrong = 0
    for k in range(count):
        rng = np.random.default_rng([seed, k, 7])
        velocity, noise, _, _ = decay(rng, bending(rng), rng.choice([40, 60]))
        wrong += plateau(freevib(velocity, SAMPLING_HZ, FREQUENCY_HZ, noise))["plateau_reached"]
    print(f"laws without a plateau: {int(wrong)} of {count} called a plateau")


def pooling(count, seed):
    """Coverage of the pooled frequencies of drawn campaigns, by how often they repeat."""
    print("campaigns        68/95 %   hold scatter found / true")
    for name, holds, records in (
        ("2 holds of 2", (2, 3), (2, 3)), ("4 holds of 3", (4, 5), (3, 4)),
        ("unbalanced", (1, 5), (1, 4)), ("1 or 2 of 1", (1, 3), (1, 2)),
    ):  # fmt: skip
        rng, z, found = np.random.default_rng(seed), [], []
        for _ in range(count):
            hold_std, record_std, own = 10 ** rng.uniform([-1.5, -2.0, -3.0], [0.0, -0.3, -1.0])
            force, hold, y = [], [], []
            for level in range(rng.integers(4, 9)):
                for _ in range(rng.integers(*holds)):
                    clamped = hold_std * rng.standard_normal()
                    number = hold[-1] + 1 if hold else 0
                    for _ in range(rng.integers(*records)):
                        force.append(level)
                        hold.append(number)
                        y.append(clamped + np.hypot(record_std, own) * rng.standard_normal())
            both = np.array(force), np.array(hold)
            pooled = pool(np.array(y), np.full(len(y), own), *both, np.zeros(len(y)))
            if pooled.clamping_freedom:
                z += list(pooled.mean / pooled.std)
                found.append(pooled.clamping_std / hold_std)
        print(f"{name:15s}  {share(z, 1):3.0f} {share(z, 1.96):3.0f}   {np.median(found):.2f}")


def cost(seed):
    """Time of the plateau beside one Hilbert transform of the record."""
    rng = np.random.default_rng(seed)
    velocity, noise, _, _ = decay(rng, slipping(rng)[1], 60)
    curves = freevib(velocity, SAMPLING_HZ, FREQUENCY_HZ, noise)
    times = []
    for work in (lambda: plateau(curves), lambda: scipy.signal.hilbert(velocity)):
        work()
        took = []
        for _ in range(7):
            start = time.perf_counter()
            work()
            took.append(time.perf_counter() - start)
        times.append(min(took))
    print(f"plateau {1e3 * times[0]:.0f} ms, hilbert of the record {1e3 * times[1]:.0f} ms")


if __name__ == "__main__":
    numbers = [int(text) for text in sys.argv[1:]] + [40, 40, 1][len(sys.argv) - 1 :]
    accuracy(numbers[0], numbers[2])
    verdicts(numbers[1], numbers[2])
    pooling(100, numbers[2])
    cost(numbers[2])
