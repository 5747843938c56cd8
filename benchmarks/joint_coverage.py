"""Do the regions of (ln kn, ln kt) hold simulated truths as often as they say?

    python benchmarks/joint_coverage.py [draws] [seed]
    python benchmarks/joint_coverage.py --structure lap-joint [draws] [seed]

A truth is another mesh of the structure with a law of stiffness, biases of the frequencies, a
gauge's offset and gain, and a scatter of every clamping, all drawn from the priors that the
inference states. The inference's bias counts the mesh too, as a user's must: how far frequencies
of two sound meshes lie apart, in quadrature. The regions are those of `joint.nc` (`region_share`),
from fewer draws. Beside them stand Laplace's ellipse and the thesis's way: two frequencies
interpolated to one force, the root nearest to the truth, and the covariance of the measurement
alone (5.8-5.24).

With a structure of several interfaces the regions are those of all its contact stiffnesses together
(`bladeroot.diagnosis.interfaces`), beside Laplace's ellipsoid, from stick frequencies of all its
modes at four loads, each with two clampings: once where the truth has the same mesh, once where it
has another, whose difference of each mode the inference's bias counts.
"""

import os
import sys
import time
from dataclasses import replace
from pathlib import Path

os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"

import numpy as np
import yaml
from bladeroot.diagnosis.interfaces import DRAWS, stiffness_problem
from bladeroot.diagnosis.simulation.parametric import of_assembly
from bladeroot.diagnosis.stick_model import StickData, problem
from bladeroot.fem.geometry import structure_from_mapping
from bladeroot.fem.mesh import build_mesh
from bladeroot.fem.prestress import prestress
from bladeroot.inference.gaussian import about, fit, maxima_of
from bladeroot.inference.sampling import sample
from bladeroot.mechanisms.mechanism import Records
from bladeroot.rom.bodies import reduce_bodies
from bladeroot.rom.chebyshev import at_force, trimmed
from bladeroot.rom.joint import joint_of_reduced
from bladeroot.rom.lap_joint import lap_joint_assembly
from bladeroot.rom.parametric import ln_frequencies, solved_of, surface_of
from bladeroot.rom.parametric_build import parametric_model
from bladeroot.rom.reduction import reduce_structure
from bladeroot.rom.whole import parametric_structure
from bladeroot.stiffness.interpolation import interpolate_to
from bladeroot.stiffness.laws import LAWS
from bladeroot.stiffness.levels import Levels
from bladeroot.stiffness.model import level_model, map_estimate, predict
from bladeroot.stiffness.posterior import REGION_SHARES, share_within
from bladeroot.stiffness.priors import REFERENCE_FORCE, SCATTER
from bladeroot.stiffness.roots import newton
from bladeroot.stiffness.search import ln_covariance
from bladeroot.stiffness.surface import all_frequencies
from scipy.stats import chi2

ROOT = Path(__file__).resolve().parents[1]
FORCES = {"1B": [5370, 6802, 7697, 10382, 12530, 16110, 24165],
          "2B": [5370, 6265, 7160, 8950, 10740, 12530, 14320, 16110, 18795, 21480, 23449]}  # fmt: skip # noqa: E501
NOISE = 1e-4  # of the frequency
BIAS, GAUGE = np.array([0.005, 0.005]), (1253.0, 0.01)
MESH = 0.002  # relative difference of frequencies between two meshes; `main` prints the true one
OTHER_MESH = {"span_element_mm": 20.0, "jaw_elements": 3}
LOADS, HOLDS = (3e3, 6e3, 9e3, 12e3), 2  # of an assembly's campaign: N, clampings at each
OTHER_LAP_MESH = {"span_element_mm": 40.0, "width_elements": 4}


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
        inside = [100 * np.mean(np.nan_to_num(rows[:, column], nan=1.0) < c) for c in REGION_SHARES]
        print(f"{name:55s} {inside[0]:6.1f} {inside[1]:6.1f}")
    rooted = np.isfinite(rows[:, 2])
    inside = [100 * np.mean(rows[rooted, 2] < c) for c in REGION_SHARES]
    print(f"{'  the same, of the ' + str(rooted.sum()) + ' with a root':55s} "
          f"{inside[0]:6.1f} {inside[1]:6.1f}")  # fmt: skip
    error = 100 * np.sqrt(0.25 / draws)
    print(f"sampling error of a share: up to {error:.1f} points")
    print("median std of ln kn, ln kt: joint "
          f"{np.median(rows[:, 3]):.2f}, {np.median(rows[:, 4]):.2f}; per force "
          f"{np.median(rows[rooted, 5]):.3f}, {np.median(rows[rooted, 6]):.3f}")  # fmt: skip
    print(f"independent draws of a posterior: least {rows[:, 7].min():.0f}, "
          f"median {np.median(rows[:, 7]):.0f}")  # fmt: skip


def assembly_model(name: str, changes: dict):
    """The parametric model of an assembly on its own mesh, or with a part of it changed."""
    data = yaml.safe_load((ROOT / f"resources/structures/{name}.yaml").read_text())
    data["mesh"] = data["mesh"] | changes
    reduced = reduce_bodies(lap_joint_assembly(data, name))
    return parametric_structure(reduced, {"force_kN": (0.0, 30.0)})


def assembly_data(modes: tuple[str, ...]) -> StickData:
    """A campaign without its frequencies."""
    load = np.repeat(LOADS, HOLDS * len(modes))
    hold = np.repeat(np.arange(len(LOADS) * HOLDS), len(modes))
    mode, none = np.tile(np.arange(len(modes)), len(LOADS) * HOLDS), np.zeros(load.size)
    records = Records(mode, load, none, none, none, 0.0, 0.0)
    noise = np.full(load.size, NOISE)
    return StickData(modes, records, none, noise, hold, 0.0, np.arange(load.size), False, False)


def drawn_frequencies(true, rng) -> tuple[np.ndarray, np.ndarray]:
    """Parameters drawn from the priors, and ln f with the scatter that the model states."""
    theta = true.prior.mean + true.prior.std * rng.standard_normal(true.prior.mean.size)
    scales = true.scales.mean + true.scales.std * rng.standard_normal(true.scales.mean.size)
    state = true.predict(theta)
    covariance, _ = true.covariance(state, scales)
    return theta, rng.multivariate_normal(state.mean, covariance, method="eigh")


def of_structure(name: str, draws: int, seed: int) -> None:
    start = time.process_time()
    models = [assembly_model(name, changes) for changes in ({}, OTHER_LAP_MESH)]
    print(f"models built in {time.process_time() - start:.0f} s")
    box = models[0]["box"].values
    points = np.random.default_rng(seed).uniform(*box, (50, box.shape[1]))
    apart = np.subtract(*(ln_frequencies(solved_of(one), points)[0] for one in models[::-1]))
    size = dict(zip(models[0]["mode"].values, np.sqrt((apart**2).mean(axis=0)), strict=True))
    told = ", ".join(f"{mode} {100 * one:.3f} %" for mode, one in size.items())
    print(f"the other mesh's frequencies are off by {told} (rms over the box)")
    alone = of_assembly(models[0], {}, {}, BIAS[0])
    counted = {mode: float(np.hypot(BIAS[0], one)) for mode, one in size.items()}
    ours, other = of_assembly(models[0], counted, {}, 0.0), of_assembly(models[1], {}, {}, BIAS[0])
    coverage("truths of the same mesh", alone, alone, draws, seed)
    coverage("truths of the other mesh", other, ours, draws, seed + 1)


def coverage(title: str, true, ours, draws: int, seed: int) -> None:
    """Draw campaigns of one model, infer with another, and count."""
    start, blank, count = time.process_time(), assembly_data(ours.modes), len(ours.stiffnesses)
    shares, below, stds, effective = [], [], [], []
    for k in range(draws):
        rng = np.random.default_rng([seed, k])
        theta, ln_f = drawn_frequencies(problem(blank, true), rng)
        data, truth = replace(blank, ln_f=ln_f), theta[:count]
        asked = problem(data, ours)
        starts = [asked.prior.mean, *about(asked.prior, count)]
        found, *others = maxima_of([fit(asked, start) for start in starts], count)
        off, covariance = truth - found.parameters[:count], found.covariance[:count, :count]
        laplace = chi2.cdf(off @ np.linalg.solve(covariance, off), count)
        alone = stiffness_problem(data, ours, found, [], asked.prior.mean.size)
        ends = [fit(alone, one.parameters[:count], one.scales) for one in (found, *others)]
        best, *others = maxima_of(ends, count)
        drawn = sample(best, range(count), DRAWS, others=others)
        shares.append([share_within(drawn.parameters, truth[None])[0], laplace])
        below.append((drawn.parameters < truth).mean(axis=0))
        stds.append(drawn.parameters.std(axis=0) / asked.prior.std[:count])
        effective.append(drawn.effective)
    seconds = time.process_time() - start
    print(f"{title}: {draws}, seed {seed}, {seconds:.0f} s; effective draws from "
          f"{min(effective):.0f}, median {np.median(effective):.0f}")  # fmt: skip
    for way, column in zip(("by draws", "by Laplace"), np.array(shares).T, strict=True):
        inside = [100 * np.mean(column < c) for c in REGION_SHARES]
        print(f"  region of all ln k {way}: 68 % {inside[0]:.1f}, 95 % {inside[1]:.1f}; sampling "
              f"error up to {100 * np.sqrt(0.25 / draws):.1f} points")  # fmt: skip
    inside = [100 * np.mean(abs(np.array(below) - 0.5) < c / 2, axis=0) for c in REGION_SHARES]
    for one in zip(ours.stiffnesses, *inside, np.median(stds, axis=0), strict=True):
        print("  {}: 68 % {:.0f}, 95 % {:.0f}; median std over the prior's {:.2f}".format(*one))


if __name__ == "__main__":
    words = sys.argv[1:]
    structure = words[1] if words[:1] == ["--structure"] else ""
    numbers = [int(text) for text in (words[2:] if structure else words)]
    numbers += [200, 20261122][len(numbers) :]
    if structure:
        of_structure(structure, *numbers)
    else:
        main(*numbers)
