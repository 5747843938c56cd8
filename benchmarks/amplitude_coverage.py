"""Do kn, kt from frequencies and amplitude curves hold truths drawn blind, and how narrow are they?

    python benchmarks/amplitude_coverage.py results/structures/dovetail-HB --truths 20

A truth is a virtual bench whose stiffness law, friction, pressure, waviness, gauge and deviation
from the model are drawn; its curves are those of `tests/blind/bench_curves.py`, one quasi-static
cycle in place of records, with errors as records leave them. The inference gets stick frequencies
and curves only.
Printed by truth and in all: which law was taken, how much narrower the curves make ln kn, ln kt and
the area of their ellipse, and the share of the region on whose edge the truth lies, for three ways
to choose the law.

How the specimen deviates from the model: `told`, each mode's frequencies by a draw of their own,
which is what the inference is told; `material`, by modulus and an added mass, which move both modes
by as much but mostly alike; `none`. With `--alone` there are no curves.
"""

import argparse
import os
import secrets
import sys
import time
from dataclasses import replace
from pathlib import Path

os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"

import numpy as np
import xarray as xr
import yaml
from bladeroot.bench.conditions import baseline, reading
from bladeroot.bench.joint import parts
from bladeroot.diagnosis.observations import observations
from bladeroot.inference.sampling import sample
from bladeroot.plateau.plateau import RECORD_VARIABLES
from bladeroot.pooling.stick import stick_from_records
from bladeroot.rom.joint import joint_of_reduced
from bladeroot.stiffness.amplitude import level_names
from bladeroot.stiffness.curve_fit import fit_curves
from bladeroot.stiffness.interpolation import ForceGauge
from bladeroot.stiffness.joint import freest, models_of
from bladeroot.stiffness.model import map_estimate
from bladeroot.stiffness.posterior import REGION_SHARES, share_within
from bladeroot.stiffness.priors import REFERENCE_FORCE
from bladeroot.stiffness.softening import DISCREPANCY, softening_of

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "blind"))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "lib"))
from bench_curves import campaign_curves, few_dofs
from programme import programme

ROOT = Path(__file__).resolve().parents[1]

LADDER = np.geomspace(1e-7, 2e-4, 67)  # m
GAUGE = ForceGauge(1253.0, 0.01, "full-scale")
BIAS = {"1B": 0.005, "2B": 0.005}
NOISE, LOSS_NOISE = 5e-6, 2e-3  # relative, of a point of a curve; a tenth of it on the plateau
DRAWS = 3000  # for regions
WORTH = 1e-3  # odds below which a law is not sampled


def draw(rng) -> dict:
    """A bench: that of the campaign `rig` with all that the inference is asked about drawn."""
    bench = yaml.safe_load((ROOT / "resources/bench/rig.yaml").read_text())
    bench["seed"] = int(rng.integers(2**31))
    joint, friction, real = bench["joint"], bench["friction"], bench["specimen"]
    for name in ("kn", "kt"):
        joint[f"{name}_N_per_m"] = float(np.exp(rng.uniform(*np.log([0.7e9, 3e9]))))
        joint[f"{name}_exponent"] = float(rng.uniform(0.4, 1.0))
    friction["coefficient"] = float(np.exp(rng.uniform(*np.log([0.2, 0.6]))))
    friction["edge_pressure"] = float(np.exp(rng.uniform(*np.log([0.004, 0.06]))))
    friction["spread"] = float(rng.uniform(0.2, 0.7))
    # Together 0.5 % of each mode's frequency (rms of 60 draws), with a correlation of 0.8.
    real["modulus_factor"] = float(np.exp(0.007 * rng.standard_normal()))
    real["added_mass_kg"] = float(0.004 * rng.standard_normal())
    real["added_mass_x_mm"] = float(rng.uniform(0.0, 70.0))
    bench["gauge"]["gain"] = float(1.0 + 0.008 * rng.standard_normal())
    return bench


def deviate(bench: dict, deviation: str, rng) -> dict[str, float]:
    """Makes the specimen deviate as asked; factors on what is measured of each mode's frequency."""
    if deviation != "material":
        bench["specimen"] |= {"modulus_factor": 1.0, "added_mass_kg": 0.0}
    size = deviation == "told"
    return {mode: float(np.exp(size * std * rng.standard_normal())) for mode, std in BIAS.items()}


def measured(
    bench: dict, factors: dict[str, float], ladder: np.ndarray, whole, few, rng
) -> tuple[xr.Dataset, xr.Dataset]:
    """Stick frequencies, and the records' curves, as the stages before the inference give them."""
    plateaus, decays = [], []
    for _, sheet in programme(bench).groupby("pressure_bar"):
        rows = sheet.to_dict("records")
        true = [baseline(bench, row) for row in rows]
        curves = campaign_curves(bench, whole, few, sheet, true, ladder)
        for k, row in enumerate(rows):
            at = curves.isel(record=k)
            for name in ("frequency", "stuck_frequency"):
                at[name] = at[name] * factors[row["mode"]]
            plateau, decay = _record(row, at, ladder, reading(bench, row), rng)
            plateaus.append(plateau)
            decays.append(decay)
    stick = stick_from_records(plateaus)
    facts = {
        "same_everywhere": 0.0, "of_reading": 0.0, "scale": 0.0,
        "laser_x": {}, "time": {}, "temperature": {},
    }  # fmt: skip
    return stick, observations(stick, decays, None, facts)


def _record(row: dict, at: xr.Dataset, ladder, force: float, rng) -> tuple[xr.Dataset, xr.Dataset]:
    known = np.isfinite(at["frequency"].values)
    data: dict[str, tuple] = {"amplitude": ("point", ladder[known])}
    plateau = {name: ((), np.nan) for name in RECORD_VARIABLES}
    for name, stuck, size in (
        ("frequency", "stick_frequency", NOISE),
        ("loss_factor", "loss_factor", LOSS_NOISE),
    ):
        value, own = at[name].values[known], float(at[f"stuck_{name}"])
        data[name] = ("point", value + size * own * rng.standard_normal(value.size))
        data[f"{name}_std"] = ("point", np.full(value.size, size * own))
        plateau[stuck] = ((), own * (1.0 + 0.1 * size * rng.standard_normal()))
        plateau[f"{stuck}_std"] = ((), 0.1 * size * own)
    plateau["plateau_reached"], plateau["verdict"] = ((), 1), ((), "plateau")
    attrs = {"record": row["record"], "mode": row["mode"], "hold": row["hold"],
             "direction": row["direction"], "force_N": force}  # fmt: skip
    return xr.Dataset(plateau, attrs=attrs), xr.Dataset(data, attrs=attrs)


def with_curves(joint, models, alone, seen, lasers):
    """Models and fits of every law with curves, from those without, and the fit of the curves."""
    best = freest(alone)
    levels = level_names(models[best])
    softening = softening_of(seen, levels)
    fit = fit_curves(joint, models[best], alone[best], softening, levels, lasers, DISCREPANCY)
    models = {name: replace(one, curves=fit.term) for name, one in models.items()}
    return models, {name: map_estimate(one) for name, one in models.items()}, fit


def of_k(model, fit) -> np.ndarray:
    """Draws of (ln kn, ln kt) at the reference force."""
    theta = sample(fit, (0, 1)).parameters
    return model.ln_k(theta, np.array([REFERENCE_FORCE]))[:, 0]


def regions(models, fits, truth) -> tuple[dict[str, float], dict[str, np.ndarray]]:
    """Share of the region with the truth on its edge, and draws, by way to choose the law."""
    weight = {name: one.log_evidence for name, one in fits.items()}
    best = max(weight, key=lambda name: weight[name])
    weight = {name: np.exp(value - weight[best]) for name, value in weight.items()}
    draws = {name: of_k(models[name], one) for name, one in fits.items() if weight[name] > WORTH}
    rng, whole = np.random.default_rng(0), sum(weight[name] for name in draws)
    mixed = [rng.choice(one, round(DRAWS * weight[name] / whole)) for name, one in draws.items()]
    ways = {
        "most evidence": draws[best],
        "averaged": np.concatenate(mixed),
        "freest of 20:1": draws[freest(fits)],
    }
    shares = {}
    for name, found in ways.items():
        some = found[:: max(1, len(found) // DRAWS)]
        shares[name] = float(share_within(some, truth[None])[0])
    return shares, ways


def narrowing(before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """How much narrower ln kn, ln kt and the area of their ellipse are, from one law's draws."""
    area = np.sqrt(np.linalg.det(np.cov(before.T)) / np.linalg.det(np.cov(after.T)))
    return np.array([*before.std(axis=0) / after.std(axis=0), area])


def summary(rows: list[dict], stages: tuple[str, ...]) -> None:
    """Prints how many regions hold their truth, and the narrowing."""
    for stage in stages:
        for way in rows[0][stage]:
            inside = np.array([one[stage][way] for one in rows])
            held = ", ".join(f"{np.sum(inside < c)} in {100 * c:g} %" for c in REGION_SHARES)
            print(f"  {stage:7s} {way:15s} {held} of {len(rows)}")
    if "curves" in stages:
        narrower = np.array([one["narrower"] for one in rows])
        middle, low, high = (np.quantile(narrower, q, axis=0) for q in (0.5, 0.1, 0.9))
        for k, name in enumerate(("ln kn", "ln kt", "area")):
            print(
                f"  narrower {name}: median {middle[k]:.2f}, {low[k]:.2f} to {high[k]:.2f} "
                "(10, 90 %)"
            )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", help="of a structure's artifacts: reduced.nc, parametric.nc")
    parser.add_argument("--truths", type=int, default=20)
    parser.add_argument("--seed", type=int, help="repeat a run; drawn afresh if not given")
    parser.add_argument("--deviation", choices=("told", "material", "none"), default="told")
    parser.add_argument("--alone", action="store_true", help="without curves")
    options = parser.parse_args()
    seed = secrets.randbits(31) if options.seed is None else options.seed
    reduced = xr.open_dataset(f"{options.folder}/reduced.nc").load()
    model = xr.open_dataset(f"{options.folder}/parametric.nc").load()
    joint, whole = joint_of_reduced(reduced), parts(reduced)
    few = few_dofs(whole)
    stages = ("alone",) if options.alone else ("alone", "curves")
    ladder = LADDER[:3] if options.alone else LADDER
    print(f"{options.truths} truths, seed {seed}, deviation {options.deviation}")
    rows, drawn = [], 0
    while len(rows) < options.truths:
        rng = np.random.default_rng([seed, drawn])
        drawn += 1
        bench = draw(rng)
        factors = deviate(bench, options.deviation, rng)
        began = time.process_time()
        try:
            stick, seen = measured(bench, factors, ladder, whole, few, rng)
        except ValueError as error:  # a specimen so soft that its modes change places
            print(f"  drawn again: {error}")
            continue
        models = {"alone": models_of(model, stick, GAUGE, BIAS)}
        fits = {"alone": {name: map_estimate(each) for name, each in models["alone"].items()}}
        told = ""
        if not options.alone:
            lasers = {mode: 1e-3 * x for mode, x in bench["laser"]["x_mm"].items()}
            models["curves"], fits["curves"], fit = with_curves(
                joint, models["alone"], fits["alone"], seen, lasers
            )
            told = f"; {fit.term.points} numbers" + ("" if fit.converged else ", NOT CONVERGED")
        truth = np.log([bench["joint"][f"{name}_N_per_m"] for name in ("kn", "kt")])
        one: dict = {}
        for stage in stages:
            one[stage], ways = regions(models[stage], fits[stage], truth)
        law, after = freest(fits[stages[-1]]), ways["freest of 20:1"]
        if not options.alone:
            one["narrower"] = narrowing(of_k(models["alone"][law], fits["alone"][law]), after)
            told += "; narrower kn {:.2f} kt {:.2f} area {:.2f}".format(*one["narrower"])
        rows.append(one)
        std, away = after.std(axis=0), (after.mean(axis=0) - truth) / after.std(axis=0)
        print(
            f"{drawn - 1:3d} kn, kt {' '.join(f'{1e-9 * k:.2f}' for k in np.exp(truth))} GN/m, mu "
            f"{bench['friction']['coefficient']:.2f}; {law}{told}; std {std[0]:.3f} {std[1]:.3f}, "
            f"off by {away[0]:+.1f} {away[1]:+.1f} of them; shares "
            + ", ".join(
                f"{stage} " + " ".join(f"{share:.3f}" for share in one[stage].values())
                for stage in stages
            )
            + f"; CPU s {time.process_time() - began:.0f}",
            flush=True,
        )
    summary(rows, stages)


if __name__ == "__main__":
    main()
