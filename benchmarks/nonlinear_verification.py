"""Harmonic balance and quasi-static curves against decays integrated in time, read by FREEVIB.

    python benchmarks/nonlinear_verification.py results/structures/dovetail-HB/reduced.nc
    python benchmarks/nonlinear_verification.py results/structures/dovetail-HB/reduced.nc --small

The first bending mode at 4 and 24 kN, pressure uneven as the measured curves ask for, from the
plateau past the hump of damping. Prints, for each range of amplitude, the largest differences of
frequency and loss factor. Then the hard cases, slip that sets in abruptly and the second mode past
partial slip, beside FREEVIB's resolution (its reading of a decay made from the curve itself,
against that curve). A decay is released from rest, which shakes the other modes: little in partial
slip, much where most of the joint slides. `--small` takes one force and fewer harmonics (about a
minute).
"""

import argparse
import sys
import time
from itertools import pairwise
from pathlib import Path

import numpy as np
import xarray as xr
from bladeroot.decay.freevib import freevib
from bladeroot.nonlinear.curves import mode_curve
from bladeroot.nonlinear.harmonic_balance import nonlinear_mode
from bladeroot.nonlinear.system import system_of
from bladeroot.nonlinear.uneven import Uneven, uneven_sliders
from bladeroot.rom.joint import joint_of_reduced
from scipy.integrate import cumulative_trapezoid
from scipy.interpolate import PchipInterpolator

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "lib"))
from one_step import exact, hysteretic
from time_integration import free_decay

# Axial force (N), kn, kt (N/m) as identified near it, and the highest amplitude of a decay (m).
CASES = ((4e3, 0.5e9, 0.9e9, 75e-6), (24e3, 2.5e9, 3.6e9, 280e-6))
LOSS = 0.004
SAMPLING, SUBSTEPS = 51200.0, 4
LAW = Uneven(friction=0.42, edge=0.04, exponent=0.7, spread=0.45)
# Name, mode, the laser's place (m), law, case, harmonics, and ranges of amplitude (um). Abrupt slip
# needs as many: with 7 the curves are off by 43 ppm and 1.2 %, with 3 by 540 ppm and 7 %.
SMOOTH = (1, 3, 5, 7)
MANY = tuple(range(1, 16, 2))
ABRUPT = Uneven(friction=0.42, edge=0.5, exponent=0.15, spread=0.0)
SLIP = (95, 112, 130, 145, 164)
HARD = (
    ("abrupt slip, 4 kN", "1B", 0.0, ABRUPT, (4e3, 0.5e9, 0.9e9, 200e-6), MANY, SLIP),
    ("2B, 4 kN", "2B", -0.07, LAW, (4e3, 0.5e9, 0.9e9, 35e-6), SMOOTH, (1, 4, 8, 16, 24)),
)


def compare(joint, case, harmonics, mode="1B", laser=0.0, law=LAW) -> dict:
    """Curves of one case by every method, with wall times (s)."""
    force, kn, kt, highest = case
    system = system_of(joint, np.array([np.log(kn), np.log(kt), force]), mode, laser, LOSS)
    sliders = uneven_sliders(joint, system, force, law)
    ladder = np.geomspace(highest / 40, highest, 150)  # coarser ones miss a sudden onset
    took = {}
    begin = time.perf_counter()
    balance = mode_curve(system, sliders, ladder, "harmonic-balance", harmonics)
    took["harmonic balance"] = time.perf_counter() - begin
    begin = time.perf_counter()
    masing = mode_curve(system, sliders, ladder)
    took["quasi-static"] = time.perf_counter() - begin
    state = nonlinear_mode(system, sliders, ladder[9::10], (1, 3)).solutions[-1]
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
    harmonics = (1, 3, 5) if asked.small else SMOOTH
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
    for name, mode, laser, law, case, harmonics, micrometres in () if asked.small else HARD:
        got = compare(joint, case, harmonics, mode, laser, law)
        curve, ladder = got["balance"], got["ladder"]
        own = read(decay_of_curve(ladder, curve, 1.2e-6 * micrometres[-1]), curve.frequency[0])
        print(f"{name}, by the decay's amplitude: {curve.reason}")
        for low, high in pairwise(1e-6 * np.array(micrometres)):
            pairs = (
                ("harmonic balance", differences(ladder, curve, got["freevib"], low, high)),
                ("FREEVIB's resolution", differences(ladder, curve, own, low, high)),
            )
            at = int(np.searchsorted(ladder, high)) - 1
            print(
                f"  {1e6 * low:3.0f} to {1e6 * high:3.0f} um, loss factor to "
                f"{curve.loss_factor[at]:.4f}: "
                + "; ".join(f"{what} {1e6 * f:4.0f} ppm {1e2 * e:5.2f} %" for what, (f, e) in pairs)
            )


if __name__ == "__main__":
    main()
