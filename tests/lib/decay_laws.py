"""Blocks of decays that follow a given law, as `freevib` hands them on, without the record."""

import numpy as np
import xarray as xr
from decay_bench import coulomb, course, levels

FREQUENCY_HZ, SAMPLING_HZ = 250.0, 25600.0


def slip(onset, power):
    """Hinge: zero up to the onset (relative to the start), one at the start."""
    return lambda a: (np.maximum(0.0, a / onset - 1.0) / (1.0 / onset - 1.0)) ** power


def power_law(power):
    return lambda a: a**power


def logarithm(a):
    return np.log(a / 1e-6) / np.log(1e6)


def blocks(
    seed, law, softening=0.01, noise_db=60.0, eta=0.005, rise=0.7, duration_s=4.0, lowest=None,
    frequency_Hz=FREQUENCY_HZ, largest=1.0, wander=0.0,
):  # fmt: skip
    """Curves and blocks of a decay whose frequency and damping follow `law` of A over its start.

    wander: rad, of an error that neighbouring blocks share. The record ends at the amplitude
    `lowest` (over the start), after `duration_s`, or in the noise.
    """
    rng = np.random.default_rng(seed)

    def omega(a):
        return 2 * np.pi * frequency_Hz * (1.0 - softening * law(a))

    def alpha(a):
        return -np.pi * frequency_Hz * eta * (1.0 + rise * law(a))

    def motion(time):
        return course(alpha, omega, time, levels(14.0, count=8001))

    time = (np.arange(int(duration_s * frequency_Hz)) + 0.5) / frequency_Hz
    log, _ = motion(time)
    time, log = time[log >= np.log(lowest or 1e-6)], log[log >= np.log(lowest or 1e-6)]
    std = 10 ** (-noise_db / 20) / np.exp(log) * np.sqrt(frequency_Hz / SAMPLING_HZ)
    # blocks grow in the noise, as those of records do
    index, edges = 0, []
    while index < time.size:
        edges.append(index)
        index += max(1, int(np.ceil(min((std[index] / 0.1) ** 2, 0.4 * frequency_Hz / 4.0))))
    count = np.diff([*edges, time.size])
    time = np.add.reduceat(time, edges) / count
    log, _ = motion(time)
    std = np.hypot(std[edges] / np.sqrt(count), 1e-6)
    time, log, std = time[std < 0.15], log[std < 0.15], std[std < 0.15]
    y = np.stack([log + np.log(largest), motion(time)[1]])
    slow = np.sin(2 * np.pi * (rng.uniform(0.7, 1.5, (2, 1)) * time + rng.random((2, 1))))
    y += std * rng.standard_normal(y.shape) + wander * slow
    curve = {
        "time": ("point", time), "amplitude": ("point", largest * np.exp(log)),
        "frequency": ("point", omega(np.exp(log)) / (2 * np.pi)),
        "frequency_std": ("point", np.full(time.size, 1e-3 * frequency_Hz)),
        "block_time": ("block", time), "block_log_amplitude": ("block", y[0]),
        "block_phase": ("block", y[1]), "block_std": ("block", std),
    }  # fmt: skip
    return xr.Dataset(curve, attrs={"verdict": "usable"})


def bending(seed):
    """A decay that bends all the way down: A^p with 0.3 < p < 1.6, ln A or A / (A + b)."""
    rng = np.random.default_rng([seed, 1])
    power, b = rng.uniform(0.3, 1.6), rng.uniform(0.1, 1.0)
    laws = [power_law(power), logarithm, lambda a: a / (a + b) * (1.0 + b)]
    return blocks(
        seed, laws[rng.integers(3)], softening=10 ** rng.uniform(-2.7, -1.7),
        noise_db=rng.choice([40, 60]), eta=rng.uniform(0.003, 0.008), rise=rng.uniform(0.2, 1.5),
    )  # fmt: skip


def sticking(seed, noise_db=40.0):
    """A decay with a plateau over at least a factor of three, its onset and stick frequency."""
    rng = np.random.default_rng([seed, 2])
    onset = float(np.exp(rng.uniform(np.log(0.06), np.log(0.6))))
    kind = rng.integers(5)
    lost = coulomb(onset)
    law = slip(onset, (0.7, 1.0, 1.5, 2.0)[kind]) if kind < 4 else lambda a: lost(a) / lost(1.0)
    lowest = onset / 3.0 / rng.uniform(1.0, 1.5) if rng.random() < 0.5 else None
    eta = rng.uniform(0.003, 0.008)
    decay = blocks(
        seed, law, softening=10 ** rng.uniform(-2.7, -1.7), noise_db=noise_db, lowest=lowest,
        eta=eta, rise=rng.uniform(0.2, 1.5),
    )  # fmt: skip
    return decay, onset, FREQUENCY_HZ * np.sqrt(1.0 - 0.25 * eta**2)
