"""A model file in the stages: kn and kt with its causes, matrices of the structure, curves."""

import numpy as np
import pytest
import xarray as xr
import yaml
from bladeroot.diagnosis.diagnose import Settings, diagnose
from bladeroot.diagnosis.extended import extended_joint
from bladeroot.diagnosis.extension import (
    amplitude_causes,
    curves_of,
    model_file,
    read,
    structure_of,
)
from bladeroot.mechanisms.catalogue import catalogue
from bladeroot.rom.parametric import frequencies, surface_of
from bladeroot.schema import check, read_yaml
from diagnosis_bench import campaign, programme, simulated
from stiffness_beam import _model

CATALOGUE = catalogue()
EXPONENT = 0.5


def document(**mechanisms):
    """A model file; mechanisms by id (underscores for hyphens), each with its values."""
    by_id = {one.id: one for one in CATALOGUE}
    entries = []
    for name, values in mechanisms.items():
        one = by_id[name.replace("_", "-")]
        entries.append(
            {
                "mechanism": one.id,
                "parameters": {
                    p.name: {"value": v, "std": 0.1, "unit": p.unit}
                    for p, v in zip(one.parameters, values, strict=True)
                },
            }
        )
    law = {"reference_force_N": 12e3, "kn_N_per_m": 1.2e9, "kt_N_per_m": 8e8, "exponent": 0.03}
    return {
        "schema": "bladeroot-extension-1", "campaign": "drawn", "structure": "beam",
        "contact": law, "mechanisms": entries,
    }  # fmt: skip


def extension(**mechanisms):
    made = document(**mechanisms)
    check(made, "model", "model.yaml")
    return read(made, CATALOGUE)


POWER = {"load_dependent_stiffness": (0.6, -0.1)}


def test_matrices_scaled_alike_scale_the_frequency():
    """K, kn and kt times 1.02 and M times 1.01 without force: f times sqrt(1.02 / 1.01)."""
    model = _model(False)
    changed = structure_of(extension(modulus_density=(0.02, 0.01)), model)
    points = np.array([[np.log(1e9), np.log(2e9), 0.0], [np.log(3e9), np.log(1e9), 0.0]])
    stiffer = points + np.array([np.log(1.02), np.log(1.02), 0.0])
    expected = frequencies(surface_of(model), points) * np.sqrt(1.02 / 1.01)
    np.testing.assert_allclose(frequencies(surface_of(changed), stiffer), expected, rtol=1e-5)
    assert float(changed["surface_error"].max()) < 1e-6


def test_mass_at_mid_span_lowers_the_even_mode_alone():
    model = _model(False)
    assert structure_of(extension(**POWER), model) is model
    changed = structure_of(extension(added_mass=(0.01, 0.0)), model)
    points = np.array([[np.log(1e9), np.log(1e9), 12e3]])
    ratio = frequencies(surface_of(changed), points) / frequencies(surface_of(model), points)
    assert ratio[0, 0] < 0.995
    assert ratio[0, 1] == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize(
    ("bad", "expected"),
    [
        (lambda d: d.update(structure=""), "structure"),
        (lambda d: d["mechanisms"][0].pop("parameters"), "parameters"),
        (lambda d: d["contact"].update(kn_N_per_m=-1.0), "contact.kn_N_per_m"),
        (lambda d: d.update(extra=1), "extra"),
    ],
)
def test_a_wrong_model_file_is_refused(tmp_path, bad, expected):
    made = document(load_dependent_stiffness=(0.6, -0.1))
    bad(made)
    path = tmp_path / "model.yaml"
    path.write_text(yaml.safe_dump(made))
    with pytest.raises(ValueError, match=expected):
        read_yaml(path, "model")


def test_an_unknown_mechanism_is_named():
    made = document(load_dependent_stiffness=(0.6, -0.1))
    made["mechanisms"][0]["mechanism"] = "gremlins"
    with pytest.raises(ValueError, match="gremlins"):
        read(made, CATALOGUE)


@pytest.fixture(scope="module")
def named():
    """A campaign with an exponent, and the model file of its diagnosis as read back."""
    rows = programme(cycles=1, records=1)
    seen = campaign(_model(False), "exponent", EXPONENT, rows=rows, curves=False)
    few = [one for one in CATALOGUE if one.id in ("load-dependent-stiffness", "force-gain")]
    made = diagnose(seen, simulated(seen, _model(False)), Settings(), few)
    written = yaml.safe_load(yaml.safe_dump(model_file(made)))
    check(written, "model", "model.yaml")
    return read(written, few), seen


@pytest.mark.slow
def test_from_a_campaign_by_its_verdict_to_the_joint_posterior(named, tmp_path):
    """The diagnosis names the power; the posterior with it finds the exponent again."""
    extended, seen = named
    assert [one.id for one, _ in extended.causes] == ["load-dependent-stiffness"]
    found = extended_joint(seen, simulated(seen, _model(False)), extended, 0.0, [5e3, 12e3], 300)
    assert found.attrs["law"] == "smooth contact with load-dependent-stiffness"
    own = found.sel(parameter="load-dependent-stiffness exponent")
    off = float(own["posterior_mean"]) - EXPONENT
    assert abs(off) < 4.0 * float(own["posterior_std"])
    assert found["posterior_mean"].attrs["units"] == "mixed"
    without, with_cause = found["log_evidence"].values
    assert with_cause > without + 5.0
    rise = np.log(found["k_quantile"].sel(quantile=0.5)).diff("force").squeeze()
    np.testing.assert_allclose(rise / np.log(12.0 / 5.0), EXPONENT, atol=0.15)
    assert found.sizes["level"] == seen.sizes["record"]
    found.to_netcdf(tmp_path / "joint.nc")


def test_causes_of_single_records_are_a_part_of_the_model_and_those_over_amplitude_are_not(named):
    _, seen = named
    hysteresis = read(
        document(loading_hysteresis=(0.02,), geometric_hardening=(4e6, 0.5, 1.0)), CATALOGUE
    )
    found = extended_joint(seen, simulated(seen, _model(False)), hysteresis, 0.0, [12e3], 50)
    assert found.attrs["extended_by"] == "loading-hysteresis"
    assert found.attrs["extension_left_out"] == "geometric-hardening"
    assert any("loading-hysteresis" in str(name) for name in found["parameter"].values)


def test_one_mode_has_no_posterior(named):
    extended, seen = named
    one = seen.isel(record=np.flatnonzero(seen["mode"].values == "1B"))
    assert (
        extended_joint(one, simulated(one, _model(False)), extended, 0.0, [12e3]).attrs["law"] == ""
    )


def test_curves_with_an_amplitude_cause_follow_its_law():
    """geometric-hardening: ln f by 3/8 alpha A^2, in the other mode times the ratio; a spring that
    loses a quarter of what the mode does leaves three quarters of twice that to the loss factor.
    """
    made = document(geometric_hardening=(4e6, 0.5, 0.25), load_dependent_stiffness=(0.6, -0.1))
    made["contact"]["bias"] = {"1B": 0.0, "2B": 0.0}
    extended = read(made, CATALOGUE)
    assert amplitude_causes(extended) == ["geometric-hardening"]
    over = ("mode", "force", "amplitude")
    amplitude = np.array([1e-6, 1e-5, 5e-5])
    flat = xr.Dataset(
        {"frequency": (over, np.full((2, 2, 3), 540.0)),
         "loss_factor": (over, np.full((2, 2, 3), 3e-3)),
         "damping_ratio": (over, np.full((2, 2, 3), 1.5e-3))},
        coords={"mode": ["2B", "1B"], "force": [4e3, 8e3], "amplitude": amplitude},
    )  # fmt: skip
    better = curves_of(extended, flat)
    rise = 0.375 * 4e6 * amplitude**2
    for mode, ratio in (("1B", 1.0), ("2B", 0.5)):
        here = better.sel(mode=mode, force=8e3)
        np.testing.assert_allclose(here["frequency"], 540.0 * np.exp(ratio * rise), rtol=1e-12)
        np.testing.assert_allclose(here["loss_factor"], 3e-3 * (1 - 1.5 * ratio * rise), rtol=1e-12)
        np.testing.assert_allclose(2 * here["damping_ratio"], here["loss_factor"], rtol=1e-12)
    assert better.attrs["extended_by"] == "geometric-hardening"
