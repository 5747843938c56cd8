"""Do the regions of (ln kn, ln kt) hold simulated truths as often as they say?

    python benchmarks/joint_coverage.py [draws] [seed]

A truth is another mesh of the structure with a law of stiffness, biases of the frequencies, a
gauge's offset and gain, and a scatter of every clamping, all drawn from the priors that the
inference states. The inference's bias counts the mesh too, as a user's must: how far frequencies
of two sound meshes lie apart, in quadrature. The regions are those of `joint.nc` (`region_share`),
from fewer draws. Beside them stand Laplace's ellipse and the thesis's way: two frequencies
interpolated to one force, the root nearest to the truth, and the covariance of the measurement
alone (5.8-5.24).
"""

import os
import sys
import time
from dataclasses import replace
from pathlib import Path

os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"

import numpy as np
import yaml
from bladeroot.fem.geometry import structure_from_mapping
from bladeroot.fem.mesh import build_mesh
from bladeroot.fem.prestress import prestress
from bladeroot.inference.sampling import sample
from bladeroot.rom.chebyshev import at_force, trimmed
from bladeroot.rom.joint import joint_of_reduced
from bladeroot.rom.parametric import parametric_model, surface_of
from bladeroot.rom.reduction import reduce_structure
from bladeroot.stiffness.interpolation import interpolate_to
from bladeroot.stiffness.laws import LAWS
from bladeroot.stiffness.levels import Levels
from bladeroot.stiffness.map import all_frequencies
from bladeroot.stiffness.model import level_model, map_estimate, predict
from bladeroot.stiffness.priors import REFERENCE_FORCE, SCATTER
from bladeroot.stiffness.region import SHARES, share_within
from bladeroot.stiffness.roots import newton
from bladeroot.stiffness.search import ln_covariance

ROOT = Path(__file__).resolve().parents[1]
FORCES = {"1B": [5370, 6802, 7697, 10382, 12530, 16110, 24165],
          "2B": [5370, 6265, 7160, 8950, 10740, 12530, 14320, 16110, 18795, 21480, 23449]}  # fmt: skip # noqa: E501
NOISE = 1e-4  # of the frequency
BIAS, GAUGE = np.array([0.005, 0.005]), (1253.0, 0.01)
MESH = 0.002  # relative difference of frequencies between two meshes; `main` prints the true one
OTHER_MESH = {"span_element_mm": 20.0, "jaw_elements": 3}


def surface(changes: dict):
    """The parametric model of geometry HB on its own mesh, or with a part of it changed."""
    data = yaml.safe_load((ROOT / "resources/structures/dovetail-HB.yaml").read_text())
    data["mesh"] = data["mesh"] | changes
    structure = structure_from_mapping(data)
    mesh = build_mesh(structure)
    reduced = reduce_structure(structure, mesh, prestress(structure, mesh))
    return trimmed(surface_of(parametric_model(joint_of_reduced(reduced))))


def levels() -> Levels:
    mode = np.repeat([0, 1], [len(FORCES["1B"]), len(FORCES["2B"])])
    force = np.array(FORCES["1B"] + FORCES["2B"], float)
    count = len(force)
    return Levels(
        ("1B", "2B"), mode, force, np.zeros(count), np.full(count, NOISE), np.arange(count),
        np.ones(count), np.zeros(2), np.zeros(2),
    )  # fmt: skip


def draw(model, rng):
    """A truth from the priors and what would be measured of it."""
    while True:
        theta = model.prior.mean + model.prior.std * rng.standard_normal(len(model.names))
        said = predict(model, theta[None])
        if said.allowed[0]:
            break
    size = np.exp(SCATTER[0] + SCATTER[1] * rng.standard_normal())
    scatter = size * rng.standard_normal((len(model.levels.force), 2))
    noise = NOISE * rng.standard_normal(len(scatter))
    measured = said.ln_frequency[0] + (said.slope[0, :, :2] * scatter).sum(axis=1) + noise
    return theta, measured


def joint_region(model, truth):
    """Shares of the regions that the truth lies on the edge of, by draws and by Laplace; std of
    ln kn and ln kt; how many independent draws these are worth.
    """
    found = map_estimate(model, (-0.6, 0.6))
    draws = sample(found, (0, 1))
    ln_k = draws.parameters[:, :2]
    by_draws = share_within(ln_k, truth[None])[0]
    by_laplace = ellipse(truth - found.parameters[:2], found.covariance[:2, :2])
    return by_draws, by_laplace, ln_k.std(axis=0), draws.effective


def ellipse(off, covariance):
    """Share of the normal distribution within the ellipse through a point."""
    return 1.0 - np.exp(-0.5 * off @ np.linalg.solve(covariance, off))


def thesis_region(model, data: Levels, truth):
    """Share of the ellipse about the root at 12 kN by the covariance of (5.22); nan without one."""
    target, std = np.empty(2), np.empty(2)
    for m in range(2):
        own = data.mode == m
        f = np.exp(data.ln_frequency[own])
        lines = interpolate_to(np.array([REFERENCE_FORCE]), data.force[own], f)
        target[m] = lines.value[0]
        std[m] = np.sqrt(lines.covariance(NOISE * f, 0.01 * data.force[own])[0, 0])
    cut = at_force(model, REFERENCE_FORCE)
    box = (float(cut.low[0]), float(cut.high[0]))
    ends, good = newton(cut, target[None], truth[None], box)
    if not good[0]:
        return np.nan, std
    jacobian = all_frequencies(cut, ends)[1][0]
    covariance = ln_covariance(jacobian, target, std, np.zeros(2))[0]
    return ellipse(truth - ends[0], covariance), np.sqrt(np.diag(covariance))


def main(draws: int, seed: int) -> None:
    start = time.process_time()
    model, other = surface({}), surface(OTHER_MESH)
    blank = levels()
    law = LAWS["two powers"]
    theirs = level_model(other, blank, law, BIAS, np.zeros(2), GAUGE)
    ours = level_model(model, blank, law, np.hypot(BIAS, MESH), np.zeros(2), GAUGE)
    between = predict(theirs, theirs.prior.mean[None]).ln_frequency
    between = between - predict(ours, ours.prior.mean[None]).ln_frequency
    print(f"models built in {time.process_time() - start:.0f} s; the other mesh's frequencies are "
          f"{100 * between.min():+.3f} to {100 * between.max():+.3f} % off")  # fmt: skip
    start = time.process_time()
    rows = []
    for k in range(draws):
        rng = np.random.default_rng([seed, k])
        theta, measured = draw(theirs, rng)
        data = replace(blank, ln_frequency=measured)
        truth = ours.ln_k(theta[None], np.array([REFERENCE_FORCE]))[0, 0]
        by_draws, by_laplace, std, count = joint_region(replace(ours, levels=data), truth)
        thesis, thesis_std = thesis_region(model, data, truth)
        rows.append([by_draws, by_laplace, thesis, *std, *thesis_std, count])
    rows = np.array(rows)
    print(f"{draws} truths, seed {seed}, {time.process_time() - start:.0f} s")
    print("regions of (ln kn, ln kt) at 12 kN that hold the truth     68 %   95 %")
    for name, column in (("joint posterior, densest region", 0), ("joint, Laplace's ellipse", 1),
                         ("per force, measurement error only", 2)):  # fmt: skip
        inside = [100 * np.mean(np.nan_to_num(rows[:, column], nan=1.0) < c) for c in SHARES]
        print(f"{name:55s} {inside[0]:6.1f} {inside[1]:6.1f}")
    rooted = np.isfinite(rows[:, 2])
    inside = [100 * np.mean(rows[rooted, 2] < c) for c in SHARES]
    print(f"{'  the same, of the ' + str(rooted.sum()) + ' with a root':55s} "
          f"{inside[0]:6.1f} {inside[1]:6.1f}")  # fmt: skip
    error = 100 * np.sqrt(0.25 / draws)
    print(f"sampling error of a share: up to {error:.1f} points")
    print("median std of ln kn, ln kt: joint "
          f"{np.median(rows[:, 3]):.2f}, {np.median(rows[:, 4]):.2f}; per force "
          f"{np.median(rows[rooted, 5]):.3f}, {np.median(rows[rooted, 6]):.3f}")  # fmt: skip
    print(f"independent draws of a posterior: least {rows[:, 7].min():.0f}, "
          f"median {np.median(rows[:, 7]):.0f}")  # fmt: skip


if __name__ == "__main__":
    numbers = [int(text) for text in sys.argv[1:]]
    main(*(numbers + [200, 20261122][len(numbers) :]))
