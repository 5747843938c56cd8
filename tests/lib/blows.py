"""Struck specimens: modes that ring at once, seen by one sensor."""

import numpy as np
from bladeroot.decay.free_decay import free_decay
from bladeroot.decay.record import estimate
from bladeroot.io.recording import recording

RATE = 6400.0  # Hz
NOISE = 2e-5  # m/s
MODES = [(80.0, 0.0015, 0.07), (297.0, 0.001, 0.024), (846.0, 0.0024, 0.013), (14.0, 0.003, 0.004)]


def decay(line_Hz, zeta, size, time, phase=0.3):
    """A viscously damped wave of this size, zeta: damping ratio."""
    omega = 2.0 * np.pi * line_Hz
    return size * np.exp(-zeta * omega * time) * np.cos(omega * np.sqrt(1 - zeta**2) * time + phase)


def blow(modes, before_s=0.02, length_s=4.0, seed=0):
    """Velocity of a struck specimen: modes as (Hz, damping ratio, size), and noise."""
    time = np.arange(int(length_s * RATE)) / RATE - before_s
    wave = sum(decay(*mode, np.maximum(time, 0.0), phase=-np.pi / 2) for mode in modes)
    wave = np.where(time >= 0.0, wave, 0.0)
    return wave + NOISE * np.random.default_rng(seed).standard_normal(time.size)


def curve(velocity, expected_Hz, others=()):
    """The free decay that is cut out of a record, and its curve."""
    record = recording(velocity, "m/s", "here", sampling_Hz=RATE)
    judged = free_decay(record, expected_Hz, others)
    return judged, estimate(judged.assign_attrs(expected_Hz=expected_Hz), damping="viscous")
