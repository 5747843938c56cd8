"""Simulated frequency and damping against amplitude for modes and forces, as an artifact."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.nonlinear.curves import first_slip, mode_curve
from bladeroot.nonlinear.flanks import FlankContact, flank_sliders
from bladeroot.nonlinear.system import system_of
from bladeroot.rom.joint import Joint
from bladeroot.variables import dataset


def backbone(
    joint: Joint,
    points: Float[ndarray, "force 3"],
    lasers: Mapping[str, float],
    contact: FlankContact,
    amplitudes: Float[ndarray, " amplitude"],
    method: str = "quasi-static",
    harmonics: Sequence[int] = (0, 1, 2, 3),
    loss: float = 0.0,
) -> xr.Dataset:
    """f_n(A), eta(A) and slip of modes at axial forces.

    points: (ln kn, ln kt, F) at each force, flank totals in N/m, N. lasers: the laser's place (m)
    for each mode. amplitudes: rising, m, of the first harmonic at the laser. method: one of
    `curves.METHODS`. loss: material loss factor.

    Where a curve ends early, or a mode is not found, `complete` is 0, `reason` says why, and
    `last_amplitude` up to where the curve holds.
    """
    modes = list(lasers)
    shape = (len(modes), len(points))
    curves = np.full((3, *shape, len(amplitudes)), np.nan)
    slip = np.full((*shape, len(amplitudes), len(joint.gap)), np.nan)
    single = np.full((4, *shape), np.nan)  # stick frequency, first slip, last amplitude, turn
    reason = np.full(shape, "", dtype=object)
    for m, mode in enumerate(modes):
        for f, point in enumerate(points):
            try:
                system = system_of(joint, point, mode, lasers[mode], loss, contact.law != "coulomb")
            except ValueError as error:
                reason[m, f] = str(error)
                continue
            sliders = flank_sliders(joint, system, point, contact)
            curve = mode_curve(system, sliders, amplitudes, method, tuple(harmonics))
            curves[:, m, f] = curve.frequency, curve.loss_factor, curve.damping_ratio
            slip[m, f] = curve.slip[:, system.image]
            known = np.flatnonzero(np.isfinite(curve.frequency))
            single[:2, m, f] = np.sqrt(system.values[0]) / (2 * np.pi), first_slip(system, sliders)
            single[2, m, f] = amplitudes[known[-1]] if len(known) else 0.0
            single[3, m, f] = curve.turns[0] if curve.turns else np.nan
            reason[m, f] = curve.reason
    return _dataset(joint, points, modes, amplitudes, curves, slip, single, reason).assign_attrs(
        structure=joint.assembly.attrs["structure"],
        method=method,
        law=contact.law,
        friction=contact.friction,
        pressure=str(contact.pressure),
        preload=contact.preload,
        strips=contact.strips,
        harmonics=[int(h) for h in harmonics],
        material_loss_factor=float(loss),
    )


def amplitude_ladder(low_um: float, high_um: float, per_decade: int) -> ndarray:
    """Amplitudes (m) evenly spaced in the logarithm; ValueError unless 0 < low < high."""
    if not 0.0 < low_um < high_um:
        raise ValueError(f"amplitudes must rise from above 0 um, got {low_um} to {high_um}")
    count = 1 + int(np.ceil(per_decade * np.log10(high_um / low_um)))
    return np.geomspace(1e-6 * low_um, 1e-6 * high_um, count)


def _dataset(joint, points, modes, amplitudes, curves, slip, single, reason) -> xr.Dataset:
    made = dict(zip(("frequency", "loss_factor", "damping_ratio"), curves, strict=True))
    made |= zip(("stick_frequency", "first_slip", "last_amplitude", "turn"), single, strict=True)
    made |= {
        "slip": slip,
        "complete": (np.isfinite(curves[0]).all(axis=2)).astype(np.int8),
        "reason": reason.astype(str),
        "kn": np.exp(points[:, 0]),
        "kt": np.exp(points[:, 1]),
        "mode": modes,
        "force": points[:, 2],
        "amplitude": amplitudes,
    }
    pairs = {"pair_position": "pair_position", "pair_flank": "flank", "pair_weight": "weight"}
    return dataset("nonlinear/backbone", made).assign(
        {name: joint.assembly[own] for name, own in pairs.items()}
    )
