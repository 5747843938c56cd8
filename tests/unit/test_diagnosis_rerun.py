"""A model file in the stages: law and gauge of the joint inference, matrices of the structure."""

import numpy as np
import pytest
import xarray as xr
import yaml
from bladeroot.diagnosis.diagnose import Settings, diagnose
from bladeroot.diagnosis.extension import model_file, read
from bladeroot.diagnosis.rerun import (
    amplitude_causes,
    curves_of,
    gauge_of,
    law_of,
    left_out,
    structure_of,
)
from bladeroot.mechanisms.catalogue import catalogue
from bladeroot.mechanisms.mechanism import Records
from bladeroot.rom.parametric import frequencies, surface_of
from bladeroot.schema import check, read_yaml
from bladeroot.stiffness.interpolation import ForceGauge
from bladeroot.stiffness.joint import joint, ln_stiffness
from bladeroot.stiffness.levels import levels_of
from bladeroot.stiffness.posterior import problem_of
from bladeroot.stiffness.summit import find_summit
from diagnosis_bench import campaign, programme
from stiffness_beam import _model
from stiffness_bench import levels, surface

CATALOGUE = catalogue()
BIAS, EXPONENT = {"1B": 0.005, "2B": 0.005}, 0.5
FORCE = np.array([2e3, 5e3, 12e3, 24e3])


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


def theta_of(law, *sizes):
    return np.array([np.log(1.2e9), np.log(8e8), 0.03, *sizes])


POWER = {"load_dependent_stiffness": (0.6, -0.1)}
SEATING = {"incomplete_contact": (6e3, 1.3)}


@pytest.mark.parametrize(
    ("mechanisms", "sizes"),
    [({}, ()), (POWER, (0.6, -0.1)), (SEATING, (np.log(6e3), np.log(1.3))),
     ({**POWER, **SEATING}, (0.6, -0.1, np.log(6e3), np.log(1.3)))],
)  # fmt: skip
def test_law_at_the_files_values_is_the_extension(mechanisms, sizes):
    extended = extension(**mechanisms)
    law = law_of(extended)
    made = problem_of(surface(), levels(), law, np.ones(2), np.zeros(2), (1.0, 1.0))
    theta = np.zeros(len(made.names))
    theta[: len(law.parameters)] = theta_of(law, *sizes)
    none = np.zeros(FORCE.size)
    records = Records(none.astype(int), FORCE, none, none, none, 0.0, 0.0)
    contact = extended.contact
    powers = contact["exponent"] * np.log(FORCE / contact["reference_force_N"])
    wanted = np.log([[contact["kn_N_per_m"], contact["kt_N_per_m"]]]) + powers[:, None]
    for one, values in extended.causes:
        changes = one.stick(records, values).changes
        wanted = wanted + np.stack([changes["ln_kn"], changes["ln_kt"]], axis=1)
    np.testing.assert_allclose(ln_stiffness(made, theta[None], FORCE)[0], wanted, rtol=1e-12)


def test_law_is_exact_for_a_power_and_of_second_order_for_seating():
    law = law_of(extension(**POWER))
    moved = law_of(extension(load_dependent_stiffness=(0.9, 0.2)))
    at = [one.functions(FORCE) @ one.weights(theta_of(one, 0.9, 0.2)).T for one in (law, moved)]
    np.testing.assert_allclose(at[0], at[1], rtol=1e-12)
    errors = []
    for step in (0.1, 0.05):
        straight, exact = (
            law_of(extension(**SEATING)),
            law_of(extension(incomplete_contact=(6e3 * np.exp(step), 1.3))),
        )
        sizes = (np.log(6e3) + step, np.log(1.3))
        both = [one.functions(FORCE) @ one.weights(theta_of(one, *sizes)).T
                for one in (straight, exact)]  # fmt: skip
        errors.append(np.abs(both[0] - both[1]).max())
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.2)


def test_slopes_of_the_laws_functions_are_their_derivatives():
    law = law_of(extension(**POWER, **SEATING))
    step = 1e-3 * FORCE
    numeric = (law.functions(FORCE + step) - law.functions(FORCE - step)) / (2 * step[:, None])
    np.testing.assert_allclose(law.slopes(FORCE), numeric, rtol=1e-4, atol=1e-9)


def test_a_gauges_cause_widens_the_gauge_and_none_narrows_it():
    stated = ForceGauge(1253.0, 0.01, "full-scale")
    assert gauge_of(extension(**POWER), stated) == stated
    wide = gauge_of(extension(force_gain=(0.1,), force_offset=(900.0,)), stated)
    assert (wide.relative_std, wide.full_scale_std, wide.primary) == (0.12, 2500.0, "full-scale")
    reading = gauge_of(extension(force_offset=(900.0,)), ForceGauge(1253.0, 0.01, "reading"))
    assert (reading.full_scale_std, reading.primary) == (2500.0, "full-scale")


def test_what_the_joint_inference_cannot_take_is_said():
    extended = extension(**POWER, drift=_start("drift"), loading_hysteresis=(0.2,),
                         added_mass=(0.01, 0.0), force_gain=(0.1,))  # fmt: skip
    assert left_out(extended) == ["drift", "loading-hysteresis"]
    assert law_of(extended).name == "smooth contact with load-dependent-stiffness"


def _start(name):
    return tuple(p.mean for one in CATALOGUE if one.id == name for p in one.parameters)


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
    """A campaign with an exponent, the model file of its diagnosis as read back, its levels."""
    rows = programme(cycles=1, records=1)
    seen = campaign(_model(False), "exponent", EXPONENT, rows=rows, curves=False)
    few = [one for one in CATALOGUE if one.id in ("load-dependent-stiffness", "force-gain")]
    made = diagnose(seen, _model(False), Settings(BIAS), few)
    written = yaml.safe_load(yaml.safe_dump(model_file(made)))
    check(written, "model", "model.yaml")
    return read(written, few), _levels(seen)


def test_from_a_campaign_by_its_verdict_to_the_joint_posterior(named):
    """The diagnosis names the power, and the posterior under its law finds the exponent again."""
    extended, stick = named
    assert [one.id for one, _ in extended.causes] == ["load-dependent-stiffness"]
    levels = levels_of(stick, ("1B", "2B"))
    surface = surface_of(structure_of(extended, _model(False)))
    bias = np.array([0.005, 0.005])
    with_cause, without = (
        find_summit(problem_of(surface, levels, law, bias, np.zeros(2), (200.0, 0.01)), (0.0,))
        for law in (law_of(extended), law_of(extension()))
    )
    k = with_cause.problem.names.index("load-dependent-stiffness exponent")
    off = with_cause.theta[k] + 0.02 - EXPONENT  # smooth contact has some of it
    assert abs(off) < 4.0 * np.sqrt(with_cause.theta_covariance[k, k])
    assert with_cause.log_evidence > without.log_evidence + 5.0


@pytest.mark.slow
def test_joint_inference_is_in_full_under_the_extension(named):
    extended, stick = named
    gauge = ForceGauge(200.0, 0.01, "full-scale")
    found = joint(
        structure_of(extended, _model(False)), stick, gauge, [5e3, 12e3], BIAS, steps=60,
        extension=law_of(extended),
    )  # fmt: skip
    assert found.attrs["law"] == "smooth contact with load-dependent-stiffness"
    assert "constant" in found["law"].values
    assert "load-dependent-stiffness exponent" in found["parameter"].values


def _levels(seen):
    """Means over a force and mode, as the stage before makes them."""
    rows = []
    for mode in ("1B", "2B"):
        for force in np.unique(seen["force"].values):
            mine = (seen["mode"].values == mode) & (seen["force"].values == force)
            f = seen["stick_frequency"].values[mine]
            rows.append((mode, force, f.mean(), np.unique(seen["hold"].values[mine]).size))
    mode, force, frequency, holds = (np.array(part) for part in zip(*rows, strict=True))
    n = frequency.size
    return xr.Dataset(
        {
            "mode": ("level", mode), "force": ("level", force.astype(float)),
            "frequency": ("level", frequency), "frequency_std": ("level", 1e-5 * frequency),
            "within_std": ("level", 1e-5 * frequency),
            "between_record_std": ("level", 1e-5 * frequency),
            "between_hold_std": ("level", np.zeros(n)),
            "hold_freedom": ("level", np.zeros(n, int)), "records": ("level", np.full(n, 4)),
            "holds": ("level", holds), "record_force": ("record", seen["force"].values),
            "record_mode": ("record", seen["mode"].values), "hold": ("record", seen["hold"].values),
            "plateau_reached": ("record", np.ones(seen.sizes["record"], int)),
        }
    )  # fmt: skip


def test_curves_with_an_amplitude_cause_follow_its_law():
    """geometric-hardening: ln f by 3/8 alpha A^2, in the other mode times the ratio."""
    made = document(geometric_hardening=(4e6, 0.5), load_dependent_stiffness=(0.6, -0.1))
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
        np.testing.assert_allclose(here["loss_factor"], 3e-3 * (1 - 2 * ratio * rise), rtol=1e-12)
        np.testing.assert_allclose(2 * here["damping_ratio"], here["loss_factor"], rtol=1e-12)
    assert better.attrs["extended_by"] == "geometric-hardening"
