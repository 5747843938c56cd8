"""Friction in the frequency domain: cost of a force with its Jacobian, and of an amplitude curve.

    python benchmarks/nonlinear.py [reduced.nc]

CPU and wall seconds of this process on one thread, best of several runs, compilation left out.
Without a file the shipped dovetail-HB is meshed and reduced first.
"""

import os
import sys
import time
from functools import partial
from pathlib import Path

os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"

import numpy as np
import xarray as xr
import yaml
from bladeroot.contact.laws.coulomb import coulomb
from bladeroot.fem.geometry import structure_from_mapping
from bladeroot.fem.mesh import build_mesh
from bladeroot.fem.prestress import prestress
from bladeroot.nonlinear.aft import contact_forces, cycle
from bladeroot.nonlinear.curves import mode_curve
from bladeroot.nonlinear.flanks import FlankContact, flank_sliders
from bladeroot.nonlinear.system import system_of
from bladeroot.rom.joint import joint_of_reduced
from bladeroot.rom.reduction import reduce_structure

ROOT = Path(__file__).resolve().parents[1]
HARMONICS = (0, 1, 2, 3)


def timed(work, runs: int) -> tuple[float, float]:
    """Least CPU and wall seconds of a call."""
    work()
    best = np.full(2, np.inf)
    for _ in range(runs):
        cpu, wall = time.process_time(), time.perf_counter()
        work()
        best = np.minimum(best, [time.process_time() - cpu, time.perf_counter() - wall])
    return float(best[0]), float(best[1])


def frequency_time(pairs: int = 96, times: int = 128) -> None:
    """Force and exact Jacobian of node pairs that slip in two directions and lift off."""
    rng = np.random.default_rng(1)
    kn, kt, n0 = rng.uniform(0.5, 2.0, (3, pairs))
    law = coulomb(kn, kt, n0, 0.4)
    motion = rng.normal(0.0, [0.2, 1.0, 0.7, 0.2, 0.1, 0.2, 0.1], (pairs, 3, 7))
    samples = cycle(HARMONICS, times)
    cpu, wall = timed(lambda: contact_forces(law, motion, samples), 30)
    slipped = contact_forces(law, motion, samples)[2].mean()
    print(f"force and Jacobian, {pairs} pairs, 3 harmonics and mean, {times} times:")
    print(f"  {1e3 * cpu:.2f} ms CPU, {1e3 * wall:.2f} ms; {100 * slipped:.0f} % of it in slip")


def reduced_model() -> xr.Dataset:
    if len(sys.argv) > 1:
        return xr.open_dataset(sys.argv[1]).load()
    text = (ROOT / "resources/structures/dovetail-HB.yaml").read_text()
    structure = structure_from_mapping(yaml.safe_load(text))
    mesh = build_mesh(structure)
    return reduce_structure(structure, mesh, prestress(structure, mesh))


def curves(reduced: xr.Dataset, count: int = 30) -> None:
    """A curve of one force and one mode with all flanks, by each method."""
    joint = joint_of_reduced(reduced)
    point = np.array([np.log(2e9), np.log(2e9), 4e3])
    for mode, x, largest in (("1B", 0.0, 150e-6), ("2B", -0.07, 50e-6)):
        setup, _ = timed(partial(system_of, joint, point, mode, x), 3)
        system = system_of(joint, point, mode, x, 1e-3)
        sliders = flank_sliders(joint, system, point, FlankContact("jenkins", 0.42, 3.0))
        amplitudes = np.geomspace(1e-6, largest, count)
        print(f"{mode}, {count} amplitudes from 1 to {1e6 * largest:g} um, {len(joint.gap)} pairs")
        print(f"  the small system, once: {setup:.2f} s CPU")
        found = {}
        for name, method, decaying in (
            ("harmonic balance in decay", "harmonic-balance", True),
            ("harmonic balance, steady", "harmonic-balance", False),
            ("quasi-static", "quasi-static", False),
            ("fixed shape", "fixed-shape", False),
        ):
            work = partial(mode_curve, system, sliders, amplitudes, method, decaying=decaying)
            cpu, wall = timed(work, 3)
            found[name] = work()
            print(f"  {name}: {cpu:.3f} s CPU, {wall:.3f} s {found[name].reason}")
        exact = found.pop("harmonic balance, steady")
        fall = 1.0 - np.nanmin(exact.frequency) / exact.frequency[0]
        low, high = np.nanmin(exact.loss_factor), np.nanmax(exact.loss_factor)
        print(f"  loss factor {low:.4f} to {high:.4f}, frequency falls by {100 * fall:.2f} %")
        for method, curve in found.items():
            f = 1e6 * np.abs(curve.frequency / exact.frequency - 1.0)
            eta = 100.0 * np.abs(curve.loss_factor / exact.loss_factor - 1.0)
            print(f"  {method} against the steady one: at most {np.nanmax(f):.0f} ppm in f, "
                  f"{np.nanmax(eta):.1f} % in eta; median {np.nanmedian(f):.1f} ppm, "
                  f"{np.nanmedian(eta):.2f} %")  # fmt: skip


if __name__ == "__main__":
    frequency_time()
    curves(reduced_model())
