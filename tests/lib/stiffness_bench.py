"""Joint inference on made-up surfaces: levels drawn from the priors, and what it is given."""

from dataclasses import replace

import numpy as np
import xarray as xr
from bladeroot.rom.chebyshev import Surface
from bladeroot.stiffness.interpolation import ForceGauge
from bladeroot.stiffness.laws import LAWS
from bladeroot.stiffness.levels import Levels
from bladeroot.stiffness.model import level_model, predict

GAUGE = ForceGauge(200.0, 0.01, "full-scale")
BIAS = {"1B": 0.005, "2B": 0.005}
LOW, HIGH = np.array([np.log(1e8)] * 2 + [0.0]), np.array([np.log(1e12)] * 2 + [30e3])
FORCE = np.array([4e3, 7e3, 12e3, 18e3, 24e3])


def surface(bent=0.0, modes=2):
    """ln f of modes that see kn and kt differently; straight, or bent by small terms."""
    c = np.zeros((modes, 4, 4, 3))
    for m, (base, normal, tangential) in enumerate(
        [(6.3, 0.20, 0.10), (7.25, 0.15, 0.18), (7.9, 0.05, 0.25)][:modes]
    ):
        c[m, 0, 0, 0], c[m, 1, 0, 0], c[m, 0, 1, 0], c[m, 0, 0, 1] = base, normal, tangential, 0.02
    bends = np.random.default_rng(3).normal(size=c.shape)
    bends[:, 0, 0, 0] = 0.0
    return Surface(c + bent * bends, LOW, HIGH)


def levels(noise=1e-3, shared=True, holds=2.0):
    count = len(FORCE)
    clamping = np.tile(np.arange(count), 2) if shared else np.arange(2 * count)
    return Levels(
        ("1B", "2B"), np.repeat([0, 1], count), np.tile(FORCE, 2), np.zeros(2 * count),
        np.full(2 * count, noise), clamping, np.full(2 * count, holds), np.array([1e-3, 2e-3]),
        np.array([3.0, 4.0]),
    )  # fmt: skip


def drawn(law="two powers", bent=0.01, gauge=(300.0, 0.01), **of_levels):
    """A model whose data were drawn from its own prior, and the truth."""
    made = level_model(
        surface(bent), levels(**of_levels), LAWS[law], np.array([0.005, 0.004]), np.zeros(2), gauge
    )
    rng = np.random.default_rng(11)
    theta = made.prior.mean + 0.5 * made.prior.std * rng.standard_normal(len(made.names))
    y = predict(made, theta[None]).ln_frequency[0] + 3e-3 * rng.standard_normal(2 * len(FORCE))
    return replace(made, levels=replace(made.levels, ln_frequency=y)), theta


def stick(frequency, std=0.05, **more):
    count = len(FORCE)
    nothing = np.zeros(0)
    return xr.Dataset(
        {
            "mode": ("level", np.repeat(["1B", "2B"], count)),
            "force": ("level", np.tile(FORCE, 2)),
            "frequency": ("level", frequency),
            "frequency_std": ("level", np.full(2 * count, std)),
            "within_std": ("level", np.full(2 * count, 0.03)),
            "between_record_std": ("level", np.full(2 * count, 0.08)),
            "between_hold_std": ("level", np.full(2 * count, 0.5)),
            "hold_freedom": ("level", np.zeros(2 * count, int)),
            "records": ("level", np.full(2 * count, 4)),
            "holds": ("level", np.full(2 * count, 2)),
            "record_force": ("record", nothing),
            "record_mode": ("record", nothing.astype(str)),
            "hold": ("record", nothing.astype(str)),
            "plateau_reached": ("record", nothing.astype(int)),
        }
    ).assign(more)


def powers_model():
    return level_model(surface(0.003), levels(), LAWS["one power"], np.full(2, 0.005), np.zeros(2),
                       (200.0, 0.01))  # fmt: skip
