"""What amplitude curves can tell of kn and kt: Fisher's bound under stated trust.

    python benchmarks/amplitude_information.py results [campaign] [structure]

Takes a campaign's stick frequencies and curves as the workflow left them, and the joint posterior's
MAP estimate with curves under its own law. There it prints the standard deviations of ln kn and
ln kt at 12 kN that the information gives, with one thing known better in each row: the curves,
where on the flanks the pressure is high, the clampings' friction, the friction's own parameters,
the model's bias, the gauge. No row is reachable by another inference from the same data under the
same trust.
"""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import xarray as xr
from bladeroot.rom.joint import joint_of_reduced
from bladeroot.stiffness import softening as curve_errors
from bladeroot.stiffness.amplitude import level_names
from bladeroot.stiffness.curve_fit import fit_curves
from bladeroot.stiffness.information import covariance_of_k, scaled
from bladeroot.stiffness.interpolation import ForceGauge
from bladeroot.stiffness.joint import freest, models_of
from bladeroot.stiffness.model import curve_term, map_estimate, predict
from bladeroot.stiffness.priors import FRICTION, REFERENCE_FORCE
from bladeroot.stiffness.simulated_curves import (
    along,
    by_friction,
    by_level,
    by_unevenness,
    levels_at,
)
from bladeroot.stiffness.softening import DISCREPANCY, covariance, softening_of

BIAS, GAUGE = {"1B": 0.005, "2B": 0.005}, ForceGauge(1253.0, 0.01, "full-scale")
LASERS = {"1B": 0.0, "2B": -0.07}  # m
FLOOR = 1e-3  # relative, of curves that are trusted fully
NOTHING = 1e-6
CASES = {
    "frequencies alone": {"curves": False},
    "with curves, as trusted": {},
    "simulated curves trusted to 2 %": {"discrepancy": 0.02},
    "to 1 %": {"discrepancy": 0.01},
    "fully": {"discrepancy": NOTHING},
    "the pressure's place on the flanks known": {"uneven": 0.0},
    "all clampings with one friction": {"clamping": 0.0},
    "friction law and its parameters known": {"friction": NOTHING},
    "all of these": {
        "discrepancy": NOTHING,
        "uneven": 0.0,
        "clamping": 0.0,
        "friction": NOTHING,
    },
    "gauge without error, frequencies alone": {"gauge": 1e-3, "curves": False},
    "gauge without error, with curves": {"gauge": 1e-3},
    "model's bias a fifth, frequencies alone": {"bias": 0.2, "curves": False},
    "bias a fifth, with curves": {"bias": 0.2},
    "gauge without error and bias a fifth, with curves": {"gauge": 1e-3, "bias": 0.2},
}


def main(results: str, campaign: str = "rig", structure: str = "dovetail-HB") -> None:
    """Print the table."""
    folder = Path(results)

    def load(path: str) -> xr.Dataset:
        return xr.open_dataset(folder / path).load()

    joint = joint_of_reduced(load(f"structures/{structure}/reduced.nc"))
    stick = load(f"{campaign}/stick.nc")
    models = models_of(load(f"structures/{structure}/parametric.nc"), stick, GAUGE, BIAS)
    levels = level_names(next(iter(models.values())))
    softening = softening_of(load(f"{campaign}/observations.nc"), levels)
    alone = {name: map_estimate(model) for name, model in models.items()}
    best = freest(alone)
    fit = fit_curves(joint, models[best], alone[best], softening, levels, LASERS, DISCREPANCY)
    both = {n: map_estimate(replace(one, curves=fit.term)) for n, one in models.items()}
    law = freest(both)
    found, bare = both[law], models[law]
    z = predict(bare, found.parameters[None]).logarithms[0]
    at = levels_at(joint, softening, levels, LASERS, z)
    said = along(joint, at, fit.friction)
    of_friction = by_friction(joint, at, fit.friction, *said)
    moved = by_unevenness(joint, at, fit.friction)
    row = np.arange(len(said[0]))
    slope = np.zeros((len(row), len(levels), 3))
    slope[row, np.tile(softening.level, 2)] = by_level(joint, at, fit.friction, *said)
    size = np.concatenate([softening.fall, softening.rise])
    spread = np.array([entry[1] for entry in FRICTION.values()])

    def doubt(
        discrepancy=DISCREPANCY, uneven=1.0, clamping=curve_errors.CLAMPING_SCATTER, friction=1.0,
        bias=1.0, gauge=1.0, curves=True,
    ) -> np.ndarray:  # fmt: skip
        """Covariance of (ln kn, ln kt) at the reference force."""
        biases = tuple(n for n in bare.names if n.startswith("bias_"))
        gauges = tuple(n for n in bare.names if n.startswith("force_"))
        model = scaled(scaled(bare, biases, bias), gauges, gauge)
        if curves:
            own = curve_errors.CLAMPING_SCATTER
            curve_errors.CLAMPING_SCATTER = clamping
            errors = covariance(softening, levels, discrepancy) + np.diag((FLOOR * size) ** 2)
            curve_errors.CLAMPING_SCATTER = own
            errors += uneven**2 * moved @ moved.T
            errors += (of_friction * (friction * spread) ** 2) @ of_friction.T
            term = curve_term(z, np.zeros(len(row)), slope.reshape(len(row), -1), errors)
            model = replace(model, curves=term)
        return covariance_of_k(model, found.parameters, found.scales, REFERENCE_FORCE)

    first = doubt(curves=False)
    print(f"{campaign}, {structure}, law {law}, {len(row)} numbers of curves; std of ln k at 12 kN")
    for name, given in CASES.items():
        here = doubt(**given)
        std = np.sqrt(np.diag(here))
        narrower = np.sqrt(np.diag(first)) / std
        area = np.sqrt(np.linalg.det(first) / np.linalg.det(here))
        print(
            f"{name:50s} kn {std[0]:.4f} kt {std[1]:.4f} correlation "
            f"{here[0, 1] / std.prod():+.2f}; narrower kn {narrower[0]:.2f} kt {narrower[1]:.2f} "
            f"area {area:.2f}"
        )


if __name__ == "__main__":
    main(*sys.argv[1:])
