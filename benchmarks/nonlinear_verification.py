"""Harmonic balance and quasi-static curves against decays integrated in time, read by FREEVIB.

    python benchmarks/nonlinear_verification.py results/structures/dovetail-HB/reduced.nc
    python benchmarks/nonlinear_verification.py results/structures/dovetail-HB/reduced.nc --small

The first bending mode at 4 and 24 kN, pressure uneven as the measured curves ask for, from the
plateau past the hump of damping. Prints, for each range of amplitude, the largest differences of
frequency and loss factor. Then the cases where they differ most, slip that sets in abruptly and the
second mode past partial slip, each with two tests of why: FREEVIB's resolution (its reading of a
decay made from the curve itself, against that curve), and the vibration of the other modes (the
same case with their loss factor five times as high). `--small` takes one force and fewer harmonics
(about a minute).
"""

import argparse
import time
from dataclasses import replace
from itertools import pairwise

import numpy as np
import xarray as xr
from bladeroot.decay.freevib import freevib
from bladeroot.nonlinear.curves import mode_curve
from bladeroot.nonlinear.harmonic_balance import nonlinear_mode
from bladeroot.nonlinear.one_step import exact, hysteretic
from bladeroot.nonlinear.system import system_of
from bladeroot.nonlinear.time_integration import free_decay
from bladeroot.nonlinear.uneven import Uneven, uneven_sliders
from bladeroot.structure.joint import joint_of_reduced
from scipy.integrate import cumulative_trapezoid
from scipy.interpolate import PchipInterpolator

# Axial force (N), kn, kt (N/m) as identified near it, and the highest amplitude of a decay (m).
CASES = ((4e3, 0.5e9, 0.9e9, 120e-6), (24e3, 2.5e9, 3.6e9, 400e-6))
LOSS = 0.004
SAMPLING, SUBSTEPS = 51200.0, 4
LAW = Uneven(friction=0.42, keep=0.01, exponent=0.7, spread=0.45)
# Name, mode, the laser's place (m), law, case, and ranges of amplitude (m).
ABRUPT = Uneven(friction=0.42, keep=0.01, exponent=0.15, spread=0.0)
HARD = (
    ("abrupt slip, 4 kN", "1B", 0.0, ABRUPT, (4e3, 0.5e9, 0.9e9, 600e-6), (95, 112, 130, 164)),
    ("2B, 4 kN", "2B", -0.07, LAW, (4e3, 0.5e9, 0.9e9, 45e-6), (1, 4, 8, 16, 24)),
)
DAMPED = 0.02


def compare(joint, case, harmonics, other_loss=LOSS, mode="1B", laser=0.0, law=LAW) -> dict:
    """Curves of one case by every method, with wall times (s)."""
    force, kn, kt, highest = case
    system = system_of(joint, np.array([np.log(kn), np.log(kt), force]), mode, laser, LOSS)
    loss = np.full(len(system.loss), other_loss)
    loss[0] = LOSS
    system = replace(system, loss=loss)
    sliders = uneven_sliders(joint, system, force, law)
    ladder = np.geomspace(highest / 40, highest, 50)
    took = {}
    begin = time.perf_counter()
    balance = mode_curve(system, sliders, ladder, "harmonic-balance", harmonics)
    took["harmonic balance"] = time.perf_counter() - begin
    begin = time.perf_counter()
    masing = mode_curve(system, sliders, ladder)
    took["quasi-static"] = time.perf_counter() - begin
    master = ladder / abs(system.laser[0])
    state = nonlinear_mode(system, sliders, master[-3:-1], (1, 3)).solutions[-1]
    omega, zeta = hysteretic(np.sqrt(system.values), system.loss)
    step = exact(omega, zeta, 1.0 / SAMPLING / SUBSTEPS)
    duration = 1.4 * np.log(40) / (0.5 * LOSS * omega[0])
    begin = time.perf_counter()
    samples = int(duration * SAMPLING)
    decay = free_decay(
        system, sliders, step, state.modal[:, 0::2].sum(axis=1), samples * SUBSTEPS, SUBSTEPS
    )
    took["time integration"] = time.perf_counter() - begin
    velocity = decay.velocity[int(0.004 * SAMPLING) :]  # the release shakes other modes, too
    found = read(velocity, omega[0] / 2 / np.pi)
    return {
        "ladder": ladder, "balance": balance, "masing": masing, "freevib": found, "took": took,
        "energy": decay.energy_error,
    }  # fmt: skip


def read(velocity: np.ndarray, frequency: float) -> xr.Dataset:
    """FREEVIB's curves of a decay with a little noise."""
    noise = 1e-6 * np.abs(velocity).max()
    noisy = velocity + noise * np.random.default_rng(0).standard_normal(velocity.size)
    return freevib(noisy, SAMPLING, frequency, noise)


def decay_of_curve(ladder: np.ndarray, curve, start: float) -> np.ndarray:
    """Velocity of the decay whose curves (3.11) are these: Y'' + omega_n^2 (1 + i eta) Y = 0.

    ln Y has the slope p = p0 - p0' / (2 p0) with p0 = i omega_n sqrt(1 + i eta), slowly varying.
    """
    known = np.isfinite(curve.frequency)
    fine = np.linspace(np.log(ladder[known][0]), np.log(start), 4000)
    f, eta = (
        PchipInterpolator(np.log(ladder[known]), values[known])(fine)
        for values in (curve.frequency, curve.loss_factor)
    )
    first = 2j * np.pi * f * np.sqrt(1.0 + 1j * eta)
    slope = first - np.gradient(first, fine) * first.real / (2.0 * first)
    clock = cumulative_trapezoid(1.0 / slope.real, fine, initial=0.0)
    clock -= clock[-1]  # from the start, the largest amplitude
    turned = cumulative_trapezoid(slope.imag / slope.real, fine, initial=0.0)
    times = np.arange(0.0, clock[0], 1.0 / SAMPLING)
    at = (
        PchipInterpolator(clock[::-1], part[::-1])(times)
        for part in (fine, turned, slope.real, slope.imag)
    )
    ln_size, angle, real, imaginary = at
    return ((real + 1j * imaginary) * np.exp(ln_size + 1j * angle)).real


def differences(ladder, curve, found: xr.Dataset, low: float, high: float) -> tuple[float, float]:
    """Largest relative differences of frequency and loss factor, FREEVIB over curve less one."""
    size = found["amplitude"].values
    own = (size >= low) & (size < high)
    if not own.any():
        return np.nan, np.nan
    known = np.isfinite(curve.frequency)
    place, ln = np.log(size[own]), np.log(ladder[known])
    f = found["frequency"].values[own] / np.interp(place, ln, curve.frequency[known])
    e = found["loss_factor"].values[own] / np.interp(place, ln, curve.loss_factor[known])
    return float(np.abs(f - 1).max()), float(np.abs(e - 1).max())


def main() -> None:
    """Print the table."""
    options = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    options.add_argument("reduced", help="reduced.nc")
    options.add_argument("--small", action="store_true")
    asked = options.parse_args()
    joint = joint_of_reduced(xr.open_dataset(asked.reduced).load())
    harmonics = (1, 3, 5) if asked.small else (1, 3, 5, 7)
    for case in CASES[1:] if asked.small else CASES:
        got = compare(joint, case, harmonics)
        eta = got["balance"].loss_factor
        hump = got["ladder"][np.nanargmax(eta)]
        took = ", ".join(f"{name} {seconds:.1f} s" for name, seconds in got["took"].items())
        frequency = got["balance"].frequency
        print(
            f"{case[0] / 1e3:g} kN: hump of {np.nanmax(eta):.4f} at {1e6 * hump:.1f} um, frequency "
            f"falls by {1e2 * (1 - np.nanmin(frequency) / frequency[0]):.2f} %, energy error "
            f"{got['energy']:.1e}; {took}; {got['balance'].reason}"
        )
        for low, high in ((0.05, 0.2), (0.2, 0.4), (0.4, 0.7), (0.7, 1.0), (1.0, 1.5)):
            by = [
                differences(got["ladder"], got[name], got["freevib"], low * hump, high * hump)
                for name in ("balance", "masing")
            ]
            print(
                f"  {low:.2f} to {high:.2f} of the hump: harmonic balance {1e6 * by[0][0]:4.0f} "
                f"ppm {1e2 * by[0][1]:5.2f} %; quasi-static {1e6 * by[1][0]:5.0f} ppm "
                f"{1e2 * by[1][1]:5.2f} %"
            )
    for name, mode, laser, law, case, micrometres in () if asked.small else HARD:
        got = compare(joint, case, harmonics, LOSS, mode, laser, law)
        damped = compare(joint, case, harmonics, DAMPED, mode, laser, law)
        curve, ladder = got["balance"], got["ladder"]
        start = 1e-6 * micrometres[-1] * 1.3
        own = read(decay_of_curve(ladder, curve, start), curve.frequency[0])
        print(f"{name}, by the decay's amplitude: {curve.reason}")
        edges = 1e-6 * np.array(micrometres)
        for low, high in pairwise(edges):
            pairs = (
                ("harmonic balance", differences(ladder, curve, got["freevib"], low, high)),
                ("FREEVIB's resolution", differences(ladder, curve, own, low, high)),
                (
                    f"others' loss factor {DAMPED:g}",
                    differences(ladder, damped["balance"], damped["freevib"], low, high),
                ),
            )
            at = int(np.searchsorted(ladder, high)) - 1
            print(
                f"  {1e6 * low:3.0f} to {1e6 * high:3.0f} um, loss factor to "
                f"{curve.loss_factor[at]:.4f}: "
                + "; ".join(f"{what} {1e6 * f:4.0f} ppm {1e2 * e:5.2f} %" for what, (f, e) in pairs)
            )


if __name__ == "__main__":
    main()
