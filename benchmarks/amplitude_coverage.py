"""Do kn, kt from frequencies and amplitude curves hold truths drawn blind, and how narrow are they?

    python benchmarks/amplitude_coverage.py results/structures/dovetail-HB [truths] [seed] [exact]

A truth is a virtual bench whose stiffness law, friction, pressure, waviness, gauge and deviation
from the model are drawn; its curves are those of `rig/curves.py`, one quasi-static cycle in place
of records, with errors as records leave them. The inference gets stick frequencies and curves only.
Printed by truth and in all: which law was taken, how much narrower the curves make ln kn, ln kt and
the area of their ellipse, and the share of the region on whose edge the truth lies, for three ways
to choose the law. With `exact` the specimen is the model's own: what a deviation that is no
constant bias does to the coverage is seen by leaving it out.
"""

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
from bladeroot.decay.record import RECORD
from bladeroot.decay.stick import stick_from_records
from bladeroot.rig.conditions import baseline, reading
from bladeroot.rig.curves import campaign_curves, few_dofs
from bladeroot.rig.joint import parts
from bladeroot.rig.programme import programme
from bladeroot.stiffness.amplitude import level_names
from bladeroot.stiffness.curve_errors import DISCREPANCY
from bladeroot.stiffness.curve_fit import fit_curves
from bladeroot.stiffness.interpolation import ForceGauge
from bladeroot.stiffness.joint import ln_stiffness, problems_of
from bladeroot.stiffness.laws import REFERENCE_FORCE
from bladeroot.stiffness.region import SHARES, share_within
from bladeroot.stiffness.sampler import sample
from bladeroot.stiffness.softening import softening_of
from bladeroot.stiffness.summit import find_summit, freest
from bladeroot.structure.joint import joint_of_reduced

ROOT = Path(__file__).resolve().parents[1]
LADDER = np.geomspace(1e-7, 2e-4, 67)  # m
GAUGE = ForceGauge(1253.0, 0.01, "full-scale")
BIAS = {"1B": 0.005, "2B": 0.005}
NOISE, LOSS_NOISE = 5e-6, 2e-3  # relative, of a point of a curve; a tenth of it on the plateau
STEPS, DRAWS = 600, 3000  # of the sampler; for regions
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
    # Together some 0.4 % of each mode's frequency, within the 0.5 % that the inference is told.
    real["modulus_factor"] = float(np.exp(0.007 * rng.standard_normal()))
    real["added_mass_kg"] = float(0.004 * rng.standard_normal())
    real["added_mass_x_mm"] = float(rng.uniform(0.0, 70.0))
    bench["gauge"]["gain"] = float(1.0 + 0.008 * rng.standard_normal())
    return bench


def measured(bench: dict, whole, few, rng) -> tuple[xr.Dataset, dict[str, xr.Dataset]]:
    """Stick frequencies and curves by record, as the stages before the inference give them."""
    plateaus, decays = [], {}
    for _, sheet in programme(bench).groupby("pressure_bar"):
        rows = sheet.to_dict("records")
        true = [baseline(bench, row) for row in rows]
        curves = campaign_curves(bench, whole, few, sheet, true, LADDER)
        for k, row in enumerate(rows):
            at = curves.isel(record=k)
            plateau, decay = _record(row, at, reading(bench, row), rng)
            plateaus.append(plateau)
            decays[row["record"]] = decay
    return stick_from_records(plateaus), decays


def _record(row: dict, at: xr.Dataset, force: float, rng) -> tuple[xr.Dataset, xr.Dataset]:
    known = np.isfinite(at["frequency"].values)
    data: dict[str, tuple] = {"amplitude": ("point", LADDER[known])}
    plateau = {name: ((), np.nan) for name in RECORD}
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
    return xr.Dataset(plateau, attrs=attrs), xr.Dataset(data)


def infer(joint, model, stick, decays, lasers):
    """Summits of every law without and with curves, and the fit of the curves."""
    problems = problems_of(model, stick, GAUGE, BIAS)
    levels = level_names(next(iter(problems.values())))
    softening = softening_of(decays, stick, levels)
    alone = {name: find_summit(problem) for name, problem in problems.items()}
    fit = fit_curves(joint, alone[freest(alone)], softening, levels, lasers, DISCREPANCY)
    together = {
        name: find_summit(replace(problem, curves=fit.term)) for name, problem in problems.items()
    }
    return alone, together, fit


def of_k(summit) -> np.ndarray:
    """Draws of (ln kn, ln kt) at the reference force."""
    theta = sample(summit, STEPS)[0]
    return ln_stiffness(summit.problem, theta, np.array([REFERENCE_FORCE]))[:, 0]


def regions(summits, truth) -> tuple[dict[str, float], dict[str, np.ndarray]]:
    """Share of the region with the truth on its edge, and draws, by way to choose the law."""
    weight = {name: one.log_evidence for name, one in summits.items()}
    best = max(weight, key=lambda name: weight[name])
    weight = {name: np.exp(value - weight[best]) for name, value in weight.items()}
    draws = {name: of_k(one) for name, one in summits.items() if weight[name] > WORTH}
    rng, whole = np.random.default_rng(0), sum(weight[name] for name in draws)
    mixed = [rng.choice(one, round(DRAWS * weight[name] / whole)) for name, one in draws.items()]
    ways = {
        "most evidence": draws[best],
        "averaged": np.concatenate(mixed),
        "freest of 20:1": draws[freest(summits)],
    }
    shares = {}
    for name, found in ways.items():
        some = found[:: max(1, len(found) // DRAWS)]
        shares[name] = float(share_within(some, truth[None])[0])
    return shares, ways


def main(folder: str, truths: int, seed: int, exact: bool) -> None:
    reduced = xr.open_dataset(f"{folder}/reduced.nc").load()
    model = xr.open_dataset(f"{folder}/parametric.nc").load()
    joint, whole = joint_of_reduced(reduced), parts(reduced)
    few = few_dofs(whole)
    print(f"{truths} truths, seed {seed}{', exact' if exact else ''}, sampler {STEPS} steps")
    rows, k, drawn = [], 0, 0
    while len(rows) < truths:
        rng = np.random.default_rng([seed, drawn])
        drawn += 1
        bench = draw(rng)
        if exact:
            bench["specimen"] |= {"modulus_factor": 1.0, "added_mass_kg": 0.0}
        lasers = {mode: 1e-3 * x for mode, x in bench["laser"]["x_mm"].items()}
        began = time.process_time()
        try:
            stick, decays = measured(bench, whole, few, rng)
        except ValueError as error:  # a specimen so soft that its modes change places
            print(f"  drawn again: {error}")
            continue
        made = time.process_time() - began
        alone, together, fit = infer(joint, model, stick, decays, lasers)
        truth = np.log([bench["joint"][f"{name}_N_per_m"] for name in ("kn", "kt")])
        one: dict = {"converged": fit.converged, "points": fit.term.points}
        for stage, summits in (("alone", alone), ("curves", together)):
            shares, ways = regions(summits, truth)
            one |= {(stage, way): share for way, share in shares.items()}
            one |= {(stage, way, "draws"): found for way, found in ways.items()}
        law = freest(together)
        before = of_k(alone[law])
        after = one["curves", "freest of 20:1", "draws"]
        one["narrower"] = before.std(axis=0) / after.std(axis=0)
        one["area"] = np.sqrt(np.linalg.det(np.cov(before.T)) / np.linalg.det(np.cov(after.T)))
        one["away"] = (after.mean(axis=0) - truth) / after.std(axis=0)
        rows.append(one)
        std = after.std(axis=0)
        print(
            f"{drawn - 1:3d} kn, kt {' '.join(f'{1e-9 * k:.2f}' for k in np.exp(truth))} GN/m, mu "
            f"{bench['friction']['coefficient']:.2f}; {one['points']} numbers, {law}"
            + ("" if fit.converged else ", NOT CONVERGED")
            + f"; narrower kn {one['narrower'][0]:.2f} kt {one['narrower'][1]:.2f} area "
            f"{one['area']:.2f}; std {std[0]:.3f} {std[1]:.3f}, off by {one['away'][0]:+.1f} "
            f"{one['away'][1]:+.1f} of them; shares alone "
            + " ".join(f"{one['alone', way]:.3f}" for way in shares)
            + ", with curves "
            + " ".join(f"{one['curves', way]:.3f}" for way in shares)
            + f"; CPU s {made:.0f}, {time.process_time() - began - made:.0f}",
            flush=True,
        )
    good = [one for one in rows if one["converged"]]
    print(f"{len(good)} of {len(rows)} converged; of these, regions that hold the truth:")
    for stage in ("alone", "curves"):
        for way in shares:
            inside = np.array([one[stage, way] for one in good])
            held = ", ".join(f"{np.sum(inside < c)} in {100 * c:g} %" for c in SHARES)
            print(f"  {stage:7s} {way:15s} {held}")
    narrower = np.array([[*one["narrower"], one["area"]] for one in good])
    middle, low, high = np.median(narrower, axis=0), *np.quantile(narrower, (0.1, 0.9), axis=0)
    for k, name in enumerate(("ln kn", "ln kt", "area")):
        print(
            f"  narrower {name}: median {middle[k]:.2f}, {low[k]:.2f} to {high[k]:.2f} (10, 90 %)"
        )


if __name__ == "__main__":
    asked = sys.argv[2:]
    main(
        sys.argv[1],
        int(asked[0]) if asked else 20,
        int(asked[1]) if len(asked) > 1 else secrets.randbits(31),
        asked[2:] == ["exact"],
    )
