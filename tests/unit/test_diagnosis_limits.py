"""Limits of records that reach no plateau, and what they are worth."""

import numpy as np
import pytest
import xarray as xr
from bladeroot.diagnosis.diagnose import Settings, diagnose
from bladeroot.diagnosis.limits import limits
from bladeroot.diagnosis.verdict import verdict
from bladeroot.mechanisms.catalogue import catalogue
from bladeroot.rom.parametric_build import parametric_model
from diagnosis_bench import campaign, programme, simulated
from stiffness_beam import beam_joint

AMPLITUDE = np.geomspace(1e-8, 1e-5, 43)


def curves(power, size=3e-4, std=1e-7):
    ln_f = np.log(500.0) - size * (AMPLITUDE / AMPLITUDE[-1]) ** power
    f = np.exp(ln_f)[None]
    return xr.Dataset(
        {"frequency": (("record", "amplitude"), f),
         "frequency_std": (("record", "amplitude"), std * f)},
        coords={"amplitude": AMPLITUDE},
    )  # fmt: skip


@pytest.mark.parametrize("power", [0.5, 0.8, 1.0, 1.5])
def test_the_limit_lies_within_its_errors_whatever_the_power(power):
    found = limits(curves(power))
    off = found.ln_f[0] - np.log(500.0)
    assert abs(off) < 3.0 * np.hypot(found.std[0], found.shared[0])
    if power == 1.0:
        assert abs(off) < 1e-8


def test_a_flat_curve_has_nothing_to_share():
    found = limits(curves(1.0, size=0.0))
    assert found.ln_f[0] == pytest.approx(np.log(500.0), abs=1e-9)
    assert found.shared[0] < 1e-8


def test_a_curve_of_few_points_has_no_limit():
    seen = curves(1.0)
    seen["frequency"][0, 3:] = np.nan
    assert np.isnan(limits(seen).ln_f[0])


@pytest.mark.slow
def test_causes_are_found_where_no_record_has_a_plateau():
    model = parametric_model(beam_joint(), stiffness=(1e8, 1e11), tolerance=1e-6)
    seen = campaign(model, "exponent", 0.6, 1, rows=programme(cycles=1, records=1))
    slope = 1e-4 * (seen["amplitude"].values / 1e-5) ** 0.8
    seen["frequency"] = seen["frequency"] * np.exp(-slope)
    for name in ("stick_frequency", "stick_frequency_std", "stick_loss_factor"):
        seen[name][:] = np.nan
    seen["plateau_reached"][:] = 0
    made = diagnose(seen, simulated(seen, model), Settings(), catalogue())
    assert made.data.ln_f.size == seen.sizes["record"]
    causes = {one["mechanism"]: one for one in verdict(made)["causes"]}
    assert "load-dependent-stiffness" in causes
