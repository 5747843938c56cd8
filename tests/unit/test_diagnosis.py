"""Whole diagnoses of small drawn campaigns: named, unexplained, nothing missing, insufficient."""

import json

import numpy as np
import pytest
import xarray as xr
from bladeroot.diagnosis import guards
from bladeroot.diagnosis.curve_model import curve_data
from bladeroot.diagnosis.dataset import dataset
from bladeroot.diagnosis.diagnose import Settings, diagnose, with_lower_forces
from bladeroot.diagnosis.extension import curves, model_file, read
from bladeroot.diagnosis.families import Known, prepared
from bladeroot.diagnosis.next_measurement import following, next_measurements
from bladeroot.diagnosis.records import faulty_records
from bladeroot.diagnosis.shortfall import _trend
from bladeroot.diagnosis.verdict import verdict
from bladeroot.mechanisms.catalogue import catalogue
from bladeroot.mechanisms.mechanism import Points
from bladeroot.rom.parametric_build import parametric_model
from bladeroot.schema import check
from bladeroot.terms import DOVETAIL
from diagnosis_bench import FORCES, campaign, programme, simulated
from scipy.stats import binom
from stiffness_beam import beam_joint

CATALOGUE = catalogue()


@pytest.fixture(scope="module")
def model():
    return parametric_model(beam_joint(), stiffness=(1e8, 1e11), tolerance=1e-6)


def judged(model, effect="", size=0.0, seed=1, **options):
    options = {"rows": programme(cycles=1), "curves": False} | options
    seen = campaign(model, effect, size, seed, **options)
    made = diagnose(seen, simulated(seen, model), Settings(), CATALOGUE)
    said = verdict(made)
    check(json.loads(json.dumps(said)), "verdict", effect)
    return made, said


def names(said):
    return [one["mechanism"] for one in said["causes"] if len(one["credible_set"]) == 1]


def shown(said):
    return [one for one in said["causes"] if one["shown"]]


def shows_nothing(said):
    """Whether none is the most probable, and what is not excluded only what would not show."""
    sets = said["probabilities"]
    return next(iter(sets)) == "none" and not any(one["shown"] for one in said["causes"])


def test_without_an_effect_nothing_is_missing_but_what_would_not_show(model):
    """A level is as probable as before: two modes do not tell it from kn, kt and the bias."""
    _, said = judged(model)
    assert shows_nothing(said)
    assert said["answer"] == "nothing-missing"
    assert {"none", "modulus-density", "rig-compliance"} <= set(said["possible"])
    assert "show nothing missing" in said["reason"]


def test_with_its_levels_measured_nothing_is_missing(model):
    found = {"free-free": (0.0, 1e-3), "rig stiffness": (0.0, 5e-3), "weighing": (0.0, 5e-4),
             "load cell zero": (0.0, 20.0), "load cell scale": (0.0, 2e-3)}  # fmt: skip
    seen = campaign(model, rows=programme(cycles=1), curves=False)
    said = verdict(diagnose(seen, simulated(seen, model), Settings(splits=found), CATALOGUE))
    assert said["answer"] == "nothing-missing"
    assert not said["causes"]


def test_lower_forces_are_spoken_of_only_where_there_are_some(model):
    seen = campaign(model, rows=programme(cycles=1), curves=False)
    lowest = float(seen["force"].min())
    assert with_lower_forces(seen, simulated(seen, model), Settings(), CATALOGUE) is None
    assert (
        with_lower_forces(seen, simulated(seen, model), Settings(least_force=lowest), CATALOGUE)
        is None
    )
    above = Settings(least_force=1.01 * lowest)
    made = with_lower_forces(seen, simulated(seen, model), above, CATALOGUE)
    assert made.settings.least_force == 0.0
    assert made.data.records.force.min() == lowest
    seen["stick_frequency"][seen["force"].values == lowest] = np.nan
    assert with_lower_forces(seen, simulated(seen, model), above, CATALOGUE) is None


@pytest.mark.parametrize(
    ("rise", "said"),
    [(-1.63, "falls with the force by 80 %"), (1.63, "rises with the force by 410 %"),
     (0.004, "rises with the force by 0.4 %")],
)  # fmt: skip
def test_a_trend_is_a_change_in_per_cent(rise, said):
    x = np.linspace(0.0, 1.0, 3)
    size, text = _trend(x, rise * x, "force")
    assert size == pytest.approx(rise)
    assert DOVETAIL.say(text) == f"{said} more than simulated"


def test_a_bend_is_what_the_simulation_is_off():
    x = np.linspace(-1.0, 1.0, 21)
    for sign, said in ((-1.0, "lower than simulated"), (1.0, "higher than simulated")):
        text = DOVETAIL.say(_trend(x, sign * x**2, "force")[1])
        assert f"{said} at both ends of the force" in text
        assert ("63 %" if sign < 0.0 else "172 %") in text


@pytest.mark.slow
@pytest.mark.parametrize("seed", [2, 3])
def test_without_an_effect_nothing_is_missing_in_the_curves(model, seed):
    assert shows_nothing(judged(model, seed=seed, curves=True)[1])


@pytest.fixture(scope="module")
def stiffening(model):
    """A campaign whose contact stiffens with exponent 0.6."""
    return judged(model, "exponent", 0.6)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("effect", "size", "name"),
    [
        ("hysteresis", 0.3, "loading-hysteresis"),
        ("relaxation", 0.02, "force-relaxation"),
    ],
)
def test_an_effect_on_stick_frequencies_is_named_and_gains(model, effect, size, name):
    _, said = judged(model, effect, size, rows=programme(cycles=2))
    assert said["answer"] == "named"
    assert names(said) == [name]
    assert said["gain"]["log_score"]["after"] > said["gain"]["log_score"]["before"]


@pytest.mark.slow
def test_a_contact_that_gives_way_at_the_turn_would_be_a_coincidence_and_stays_possible(model):
    """One way up and one down: a step just there is a hysteresis' twin."""
    _, said = judged(model, "hysteresis", 0.3)
    assert said["causes"][0]["mechanism"] == "loading-hysteresis"
    assert (
        0.03 < said["probabilities"]["ageing"] < 0.3 * said["probabilities"]["loading-hysteresis"]
    )


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2])
def test_what_lasts_from_turn_to_turn_is_no_hysteresis_that_gives_way_just_there(model, seed):
    rows = programme(cycles=2)
    _, said = judged(model, "spell", 0.3, seed, rows=rows)
    assert names(said) == []
    assert said["answer"] in ("unexplained", "ambiguous")
    assert said["probabilities"]["none-of-these"] > 0.2


def test_what_is_of_no_catalogue_may_be_a_contact_that_any_load_changes(stiffening):
    """It competes with laws of the contact; each mode for itself comes tens of nats behind."""
    (found,) = (one for one in stiffening[0].found if one.channel.name == "stick")
    step = found.steps[0]
    law = step.mechanisms["load-dependent-stiffness"]
    # the baseline has two summits of nearly equal height, at which the contact's share differs
    assert law - 10.0 < step.smooth["force, through the contact"] < law
    assert step.smooth["force"] < step.smooth["force, through the contact"] - 5.0


def test_a_load_dependent_stiffness_is_named_and_halves_the_error_between_forces(stiffening):
    _, said = stiffening
    assert names(said) == ["load-dependent-stiffness"]
    sides = said["gain"]["between_forces"]
    assert sides["after"] < 0.5 * sides["before"]
    exponent = said["causes"][0]["parameters"][0]
    assert abs(exponent["value"] - 0.6) < 3.0 * exponent["std"] + 0.06


@pytest.mark.slow
@pytest.mark.parametrize(
    ("effect", "size", "name"),
    [("slip", 2e-3, "joint-slip"), ("drag", 100.0, "quadratic-drag"),
     ("hardening", 6e6, "geometric-hardening")],
)  # fmt: skip
def test_an_effect_on_the_curves_is_named(model, effect, size, name):
    _, said = judged(model, effect, size, curves=True)
    assert names(said) == [name]
    sides = said["gain"]["within_records"]["frequency" if effect == "hardening" else "loss_factor"]
    assert sides["after"] < 0.6 * sides["before"]


@pytest.mark.slow
def test_a_knee_that_no_mechanism_makes_is_unexplained(model):
    _, said = judged(model, "knee", 1e-3, curves=True)
    assert said["answer"] == "unexplained"
    assert any("loss factor" in row["quantity"] for row in said["shortfall"])


@pytest.mark.slow
def test_a_bump_in_one_mode_is_unexplained(model):
    _, said = judged(model, "bump", 5e-3)
    assert said["answer"] == "unexplained"
    assert "force" in said["reason"]


@pytest.mark.parametrize(
    ("rows", "missing"),
    [
        (programme(cycles=1, modes=("1B",)), "a second mode"),
        (programme(cycles=1, forces=FORCES[:2]), "more axial forces"),
        (programme(cycles=1, records=1)[:14], "repeated clampings"),  # up alone
    ],
)
def test_too_little_data_is_said_with_what_lacks(model, rows, missing):
    _, said = judged(model, rows=rows)
    assert said["answer"] in ("insufficient-data", "ambiguous")
    assert not names(said)
    assert missing in said["reason"]


def test_faulty_records_are_named_beyond_false_alarms(model):
    records = [one for one in CATALOGUE if one.channel == "record"]
    for count, answer in ((1, "nothing-missing"), (20, "named")):
        seen = campaign(model, rows=programme(cycles=1), curves=False)
        seen["findings"] = ("record", np.where(np.arange(56) < count, "mains-hum", ""))
        said = verdict(diagnose(seen, simulated(seen, model), Settings(), records))
        assert said["answer"] == answer
        assert len(said["records"]) == count


@pytest.mark.parametrize("left", [56, 36])
def test_a_mode_that_is_taken_off_is_named_and_leaves_the_curves(model, left):
    """Of what only beats, the curves are not used."""
    seen = campaign(model, rows=programme(cycles=1))
    seen["findings"] = ("record", np.full(56, "close-mode", "<U12"))
    seen["findings"][left:] = "mode-beating"
    said = verdict(diagnose(seen, simulated(seen, model), Settings(), CATALOGUE))
    assert names(said) == ["mode-beating"]
    assert (f"{left} remain" in said["reason"]) == (left < 56)


@pytest.mark.parametrize(("effect", "answer"), [("bump", "unexplained"), ("", "named")])
def test_faulty_records_do_not_name_what_is_missing_besides(model, effect, answer):
    """A smooth bump in one mode stays unexplained, however many records hum."""
    without = [one for one in CATALOGUE if one.channel == "record" or one.id == "drift"]
    seen = campaign(model, effect, 5e-3, rows=programme(cycles=1), curves=False)
    seen["findings"] = ("record", np.where(np.arange(56) < 20, "mains-hum", ""))
    said = verdict(diagnose(seen, simulated(seen, model), Settings(), without))
    assert said["answer"] == answer
    assert names(said) == ["mains-hum"]
    assert "mains-hum: 20 of 56 records" in said["reason"]


@pytest.mark.parametrize(("count", "named"), [(0, False), (1, False), (4, True), (400, True)])
def test_a_fault_of_records_is_named_where_false_alarms_do_not_explain_it(count, named):
    findings = np.where(np.arange(400) < count, "mains-hum", "other")
    seen = xr.Dataset({"findings": ("record", findings)}).isel(record=slice(max(count, 56)))
    one = next(one for one in faulty_records(seen, CATALOGUE) if one.mechanism.id == "mains-hum")
    assert one.named == named
    total = seen.sizes["record"]
    odds = -np.log(total + 1) - binom.logpmf(count, total, 0.003) - guards.PRIOR
    assert count == 0 or one.log_odds == pytest.approx(min(odds, 50.0))


def test_a_clamping_out_of_line_is_in_the_verdict(model):
    seen = campaign(model, rows=programme(cycles=1), curves=False)
    found = np.where(np.arange(seen.sizes["record"]) == 3, "unlike-repeats", "")
    seen["findings"] = ("record", found)
    said = verdict(diagnose(seen, simulated(seen, model), Settings(), CATALOGUE))
    assert shows_nothing(said)
    assert "unlike their repeats are the records r003 of the clampings h01" in said["reason"]


def test_the_verdict_states_probabilities_and_sizes_whatever_the_form(stiffening):
    _, said = stiffening
    sets = said["probabilities"]
    assert sum(sets.values()) == pytest.approx(1.0)
    named = sum(p for key, p in sets.items() if "load-dependent-stiffness" in key.split("+"))
    (cause,) = shown(said)
    assert named == pytest.approx(cause["probability"], abs=1e-3)
    (change,) = cause["sizes"]
    assert change["quantity"] == "stick frequency"
    assert abs(change["value"]) > 3.0 * change["std"]


def test_what_would_not_show_beside_a_cause_stays_open(stiffening):
    """As without the cause: a level is as probable as before, and its test is proposed."""
    made, said = stiffening
    *_, last = said["causes"]
    assert {"none", "modulus-density", "rig-compliance"} <= set(last["credible_set"])
    assert "load-dependent-stiffness" not in last["credible_set"]
    assert "show nothing missing beside load-dependent-stiffness" in said["reason"]
    assert any(
        "free-free" in one["measurement"] for one in following(next_measurements(made), made)
    )


def test_an_independent_measurement_moves_prior_and_evidence():
    modulus = next(one for one in CATALOGUE if one.id == "modulus-density")
    alone, nothing = prepared(modulus, Known())
    assert (alone, nothing) == (modulus, 0.0)
    known, gain = prepared(modulus, Known({"free-free": (0.02, 0.001)}))
    assert known.parameters[0].mean == pytest.approx(0.02, rel=0.01)
    assert gain > 100.0
    assert prepared(modulus, Known({"free-free": (0.0, 0.001)}))[1] < 0.0


def test_dataset_and_model_file_hold_the_cause(stiffening):
    made, _ = stiffening
    whole = dataset(made, verdict(made))
    assert whole.attrs["named"] == "load-dependent-stiffness"
    scaled = np.abs(whole["stick_residual_scaled"]).mean("stick_record")
    assert scaled.sel(stage="after") < 0.5 * scaled.sel(stage="before")
    assert all({"units", "long_name"} <= set(whole[name].attrs) for name in whole.data_vars)
    extension = read(model_file(made), CATALOGUE)
    (_, values), *_ = extension.causes
    assert extension.contact["exponent"] + values[0] == pytest.approx(0.6, abs=0.2)
    with pytest.raises(ValueError, match="not in the catalogue"):
        read(model_file(made), [])


def test_a_cause_of_records_leaves_the_curves_alone():
    document = {
        "contact": {"reference_force_N": 12e3, "kn_N_per_m": 1e9, "kt_N_per_m": 1e9, "exponent": 0},
        "mechanisms": [
            {"mechanism": "force-offset", "parameters": {"offset": {"value": 500.0}}},
        ],
    }
    one = np.ones(1)
    points = Points(np.zeros(1, int), one, one, one)
    assert curves(read(document, CATALOGUE), points).ln_f[0] == 0.0


def test_a_measured_size_stays_what_was_measured(model):
    seen = campaign(model, seed=1, rows=programme(cycles=1), curves=False)
    told = {"free-free": (0.03, 0.001)}
    (cause,) = shown(
        verdict(diagnose(seen, simulated(seen, model), Settings(splits=told), CATALOGUE))
    )
    assert cause["mechanism"] == "modulus-density"
    modulus = cause["parameters"][0]
    assert modulus["value"] == pytest.approx(0.03, abs=3e-3)
    assert modulus["std"] < 1.5e-3


def test_a_load_cell_tells_a_wrong_zero(model):
    seen = campaign(model, "offset", 3000.0, seed=1, rows=programme(cycles=1), curves=False)
    told = {"load cell zero": (2980.0, 50.0)}
    (cause,) = shown(
        verdict(diagnose(seen, simulated(seen, model), Settings(splits=told), CATALOGUE))
    )
    assert cause["credible_set"] == ["force-offset"]
    assert cause["parameters"][0]["value"] == pytest.approx(3000.0, abs=150.0)


@pytest.mark.parametrize(
    ("gain", "choice"), [(-0.2, {"force-gain", "gauge-friction"}), (0.2, {"force-gain"})]
)
def test_one_way_up_friction_of_the_gauge_is_a_gain(model, gain, choice):
    """It only ever takes from what is read: where the load is larger, it is none."""
    rows = [(*row[:3], "up", row[4]) for row in programme()]
    seen = campaign(model, "gain", gain, seed=1, rows=rows, curves=False)
    (cause,) = shown(verdict(diagnose(seen, simulated(seen, model), Settings(), CATALOGUE)))
    assert set(cause["credible_set"]) == choice


def test_what_wants_times_is_said_not_to_be_judged(model):
    seen = campaign(model, seed=1, rows=programme(cycles=1), curves=False)
    seen["time"][5] = np.nan
    reason = verdict(diagnose(seen, simulated(seen, model), Settings(), CATALOGUE))["reason"]
    assert "1 records without a time left out" in reason
    seen["time"][:20] = np.nan
    reason = verdict(diagnose(seen, simulated(seen, model), Settings(), CATALOGUE))["reason"]
    assert "drift, force-relaxation not judged: times of records missing" in reason


def test_no_record_is_left_out_for_its_time_where_the_campaign_then_lacks(model):
    seen = campaign(model, seed=1, rows=programme(cycles=1), curves=False)
    seen["time"][:11] = np.nan
    data = diagnose(seen, simulated(seen, model), Settings(), CATALOGUE).data
    assert (data.ln_f.size, data.untimed, data.time_known) == (56, 0, False)


@pytest.mark.slow
def test_one_missing_time_does_not_hide_a_drift(model):
    seen = campaign(model, "drift", 0.01, seed=1, rows=programme(cycles=1), curves=False)
    seen["time"][5] = np.nan
    said = verdict(diagnose(seen, simulated(seen, model), Settings(), CATALOGUE))
    assert [cause["mechanism"] for cause in shown(said)] == ["drift"]


@pytest.mark.slow
def test_records_without_holds_that_follow_each_other_are_one_clamping(model):
    seen = campaign(model, seed=2, curves=False)
    known = diagnose(seen, simulated(seen, model), Settings(), CATALOGUE).data
    seen["hold"][:] = ""
    said = verdict(made := diagnose(seen, simulated(seen, model), Settings(), CATALOGUE))
    assert shows_nothing(said)
    assert "112 records without a clamping" in said["reason"]
    pairs = [one.hold[:, None] == one.hold for one in (known, made.data)]
    assert (pairs[0] == pairs[1]).all()
    # records that are left out still lie between the others
    few = diagnose(seen, simulated(seen, model), Settings(least_force=FORCES[1]), CATALOGUE).data
    assert np.unique(few.hold).size == 24


@pytest.mark.slow
@pytest.mark.parametrize(
    ("column", "only", "lack"),
    [
        ("force", FORCES[3], "curves at a second axial force"),
        ("mode", "1B", "curves of a second mode"),
    ],
)
def test_curves_of_one_force_or_mode_name_nothing(model, column, only, lack):
    seen = campaign(model, "hardening", 3e7, seed=1)
    other = seen[column].values != only
    for name in ("frequency", "loss_factor"):
        seen[name][other] = np.nan
    said = verdict(diagnose(seen, simulated(seen, model), Settings(), CATALOGUE))
    assert said["answer"] == "insufficient-data"
    assert not names(said)
    assert lack in said["reason"]


def test_the_error_of_a_plateau_is_a_step_where_its_record_ends(model):
    seen = campaign(model, seed=1)
    error = np.full(seen.sizes["record"], 1e-3)
    known = curve_data(seen, ("1B", "2B"))
    doubted = curve_data(seen.assign(stick_frequency_std=("record", error)), ("1B", "2B"))
    more = doubted.noise - known.noise
    n = known.points.mode.size
    first = np.flatnonzero(known.level == 0)
    whole = first[known.records[first] == known.records[first].max()]
    count = known.records[whole[0]]
    f = float(seen["stick_frequency"][0])
    assert more[whole[0], whole[-1]] == pytest.approx((error[0] / f) ** 2 / count, rel=0.01)
    assert np.all(more[n:, n:] == 0.0)
