"""Cramer-Rao bound of a stick plateau: no unbiased estimator scatters less.

The plateau, from the onset to the end of the record, is v = V exp(alpha t) cos(omega t + phi) in
white noise of known rms, with V, phi, alpha and omega unknown. Other modes are taken as known and
what happens above the onset as uninformative.
"""

import numpy as np
from synthetic import SAMPLING_HZ, Case


def decaying_sinusoid(
    amplitude: float, alpha: float, omega: float, noise: float, sampling_Hz: float, count: int
) -> tuple[float, float]:
    """Smallest standard errors of alpha and omega (1/s) from `count` samples."""
    time = np.arange(count) / sampling_Hz
    wave = amplitude * np.exp((alpha + 1j * omega) * time)
    # derivatives by ln V and phi, alpha and omega: v, i v, t v, i t v
    jacobian = np.stack([wave.real, -wave.imag, time * wave.real, -time * wave.imag], axis=1)
    scale = np.sqrt((jacobian**2).sum(axis=0))
    unit = jacobian / scale
    covariance = np.linalg.inv(unit.T @ unit) * noise**2 / scale[:, None] / scale
    return float(np.sqrt(covariance[2, 2])), float(np.sqrt(covariance[3, 3]))


def plateau_bound(case: Case) -> tuple[float, float]:
    """Smallest standard errors of stick frequency (Hz) and plateau loss factor of a record."""
    alpha, omega, *_ = (float(rate) for rate in case.law.rates(np.array(0.5 * case.law.onset)))
    count = case.velocity.size - int(np.ceil(case.motion.onset_s * SAMPLING_HZ))
    speed = case.start_m * case.law.onset * abs(alpha + 1j * omega)
    alpha_std, omega_std = decaying_sinusoid(speed, alpha, omega, case.noise, SAMPLING_HZ, count)
    return omega_std / (2.0 * np.pi), 2.0 * alpha_std / omega
