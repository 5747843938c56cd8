"""What a further measurement would decide: Gaussian cases, and a small campaign."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from bladeroot.diagnosis import curve_model, next_measurement, stick_model
from bladeroot.diagnosis.causes import places
from bladeroot.diagnosis.diagnose import Settings, diagnose
from bladeroot.diagnosis.next_measurement import (
    Rival,
    _gained,
    _more_curves,
    _rivals,
    following,
    nats,
    next_measurements,
)
from bladeroot.diagnosis.plausibility import sizes
from bladeroot.diagnosis.posterior import UNKNOWN
from bladeroot.mechanisms.catalogue import catalogue
from bladeroot.report.next_measurement import next_sentence
from diagnosis_bench import campaign, programme, simulated
from stiffness_beam import _model

FEW = ("load-dependent-stiffness", "incomplete-contact")


def gaussian(mean, std):
    return np.array([mean], float), np.array([[std**2]], float)


def test_alike_predictions_decide_nothing_and_distant_ones_all():
    assert nats([gaussian(0, 1), gaussian(0, 1)], np.full(2, 0.5)) == pytest.approx(0.0, abs=1e-12)
    distant = [gaussian(0, 1), gaussian(50, 1), gaussian(-50, 1)]
    assert nats(distant, np.full(3, 0.2)) == pytest.approx(0.6 * np.log(3.0))
    assert nats([gaussian(0, 1)], np.ones(1)) == 0.0


@pytest.mark.parametrize(("gap", "std"), [(1.0, 1.0), (2.0, 1.0), (0.0, 5.0), (3.0, 2.0)])
def test_what_is_decided_is_the_mutual_information(gap, std):
    y = np.linspace(-30.0, 30.0, 200001)
    both = [
        np.exp(-0.5 * ((y - m) / s) ** 2) / (s * np.sqrt(2 * np.pi))
        for m, s in ((0.0, 1.0), (gap, std))
    ]
    middle = 0.5 * (both[0] + both[1])
    inside = [p * np.log(np.maximum(p, 1e-300) / np.maximum(middle, 1e-300)) for p in both]
    exact = 0.5 * sum(np.trapezoid(part, y) for part in inside)
    found = nats([gaussian(0, 1), gaussian(gap, std)], np.full(2, 0.5))
    assert found == pytest.approx(exact, abs=0.035)


@pytest.fixture(scope="module")
def made():
    rows = programme(cycles=1, records=1)
    seen = campaign(_model(False), "exponent", 0.4, rows=rows, curves=False)
    candidates = [one for one in catalogue() if one.id in FEW]
    return diagnose(seen, simulated(seen, _model(False)), Settings(), candidates)


@pytest.fixture(scope="module")
def found(made):
    return next_measurements(made)


def test_every_measurement_helps_and_none_hurts(found):
    assert found["decided"].attrs["rivals"] == "incomplete-contact;load-dependent-stiffness"
    now, others = found.isel(option=0), found.isel(option=slice(1, None))
    assert float(now["decided"]) == 0.0
    assert float(now["size_std"]) == 1.0
    assert (others["decided"] >= 0.0).all()
    assert (others["decided"] <= 1.0).all()
    rate = (others["decided"] / others["hours"]).values
    assert (np.diff(rate) <= 0.0).all()
    assert (others["size_std"] <= 1.0).all()
    assert (others["expected_ln_std"] <= now["expected_ln_std"] + 1e-12).all()


def test_higher_forces_tell_a_power_from_seating_better_than_repeats(found):
    """Far above its seating force a contact is full, where a power goes on."""
    loads = found["new_force"].where(found["kind"] == "another load")
    high = found["option"].values[int(np.nanargmax(loads.values))]
    again = "the whole campaign once more"
    assert found["decided"].sel(option=high) > found["decided"].sel(option=again)


def test_no_force_below_that_of_full_contact_is_proposed(made):
    changed = replace(made, settings=replace(made.settings, least_force=1700.0))
    options = [str(option) for option in next_measurements(changed)["option"].values]
    proposed = [float(one.split(" at ")[1].split()[0]) for one in options if " at " in one]
    assert proposed
    assert min(proposed) >= 1.7e3
    assert max(proposed) <= 30e3


def test_a_small_drag_shows_more_at_larger_amplitudes():
    """Its loss grows with the amplitude, which tells it from nothing."""
    seen = campaign(_model(False), "drag", 1.0, rows=programme(cycles=1))
    candidates = [x for x in catalogue() if x.id == "quadratic-drag"]
    made = diagnose(seen, simulated(seen, _model(False)), Settings(), candidates)
    (curve,) = [one for one in made.found if one.channel.name == "curve"]
    models = [((), curve.baseline), (candidates, curve.alone["quadratic-drag"].fit)]
    even, decides = [Rival(tuple(some), one, 0.5, 1.0) for some, one in models], []
    for times in (1.0, 2.0):
        data, old, new = _more_curves(made.curves, 8e3, times)
        problems = [curve_model.problem(data, one.mechanisms) for one in even]
        decides.append(_gained(even, problems, old, new))
    assert 0.0 < decides[0] < 0.9 * decides[1]


def test_what_is_of_no_catalogue_is_no_rival(made):
    """It is not the simulation as it is, which predicts that nothing is missing."""
    (power, seating), nothing = map(lambda n: frozenset({n}), FEW), frozenset()
    sets = {power: 0.5, frozenset({UNKNOWN}): 0.3, seating: 0.1, power | {UNKNOWN}: 0.1}
    found = replace(made.found[0], probabilities=sets)
    odds = [one.probability for one in _rivals(found, set(FEW))]
    assert odds == [0.5, 0.1]
    assert nothing in found.models


def test_noise_that_a_law_makes_up_for_is_no_prediction(made):
    fitted, n = made.found[0].baseline, made.data.ln_f.size
    louder = replace(fitted, scales=fitted.scales + 1.0)
    even = [Rival((), one, 0.5, 1.0) for one in (fitted, louder)]
    again = made.data.hold.max() + 1 + made.data.hold
    data = next_measurement._joined(made.data, made.data.records, again)
    problems = [stick_model.problem(data, made.simulated)] * 2
    old, new = np.arange(n), np.arange(n, data.ln_f.size)
    assert _gained(even, problems, old, new) == pytest.approx(0.0, abs=1e-9)


def test_what_decides_next_to_nothing_is_not_proposed(made, monkeypatch):
    monkeypatch.setattr(next_measurement, "_LEAST", 10.0)
    assert following(next_measurements(made), made) == []


def test_what_no_measurement_speaks_of_leaves_the_next_question(made, monkeypatch):
    open_ = {"incomplete-contact", "load-dependent-stiffness"}
    asks = [{"force-dependent-damping"}, open_]
    monkeypatch.setattr(next_measurement, "_asked", lambda made: asks)
    found = next_measurements(made)
    assert found["decided"].attrs["rivals"] == ";".join(sorted(open_))
    assert following(found, made)


def test_known_odds_leave_little_to_decide():
    """A test that settles a question settles all of it, whatever the odds."""
    far, odds = [gaussian(0, 1), gaussian(60, 1)], np.array([0.95, 0.05])
    assert nats(far, odds) == pytest.approx(-odds @ np.log(odds))
    assert nats([gaussian(0, 1)] * 2, odds) == pytest.approx(0.0, abs=1e-12)


def test_a_test_beside_the_campaign_tells_presence_by_its_error():
    even = np.array([0.5, 0.5])
    assert nats([gaussian(0.0, 1e-3), gaussian(0.0, 1.0)], even) == pytest.approx(
        np.log(2.0), abs=0.02
    )
    assert 0.0 <= nats([gaussian(0.0, 1.0), gaussian(0.0, 1.1)], even) < 0.02
    assert nats([gaussian(0.0, 1e-3), gaussian(0.0, 1.0)], np.array([1.0, 0.0])) == 0.0


def test_evidence_that_is_divided_decides_less():
    pair, even = [gaussian(0, 1), gaussian(3, 1)], np.array([0.5, 0.5])
    left = [nats(pair, even, heat) for heat in (1.0, 4.0, 16.0)]
    assert left[0] > left[1] > left[2] > 0.0


def test_costs_of_the_campaign_change_the_order(made):
    dear = {"clamping": 50.0, "load cell": 0.1}
    changed = replace(made, settings=replace(made.settings, costs=dear))
    first = following(next_measurements(made), made)
    assert first
    for one in following(next_measurements(changed), changed):
        assert one["load"] is None or one["hours"] >= 50.0


def test_what_may_not_be_named_yet_asks_for_what_tells_it_from_others(made):
    """Also where no option can be weighed, as without stick frequencies."""
    found = replace(made.found[0], insufficient=next(iter(made.found[0].alone)))
    barred = replace(made, found=(found, *made.found[1:]))
    (one,) = following(xr.Dataset(), barred)
    told = found.alone[found.insufficient].causes[0].splitter
    assert one["what"] == made.terms.say(told)
    assert one["hours"] is None


def test_where_nothing_is_open_nothing_is_decided(made, monkeypatch):
    """As where one cause is named and nothing rivals it: its size is what is left to measure."""
    monkeypatch.setattr(next_measurement, "_asked", lambda made: [set()])
    found = next_measurements(made)
    assert np.isnan(found["decided"].values).all()
    assert following(found, made) == []
    (said,) = next_sentence(found)
    assert "decide" not in said
    assert "known" in said


@pytest.mark.parametrize(
    ("effect", "size", "film", "name"),
    [
        ("exponent", 0.4, 300.0, "load-dependent-stiffness"),
        ("seating", 8e3, 8.3e3, "incomplete-contact"),
    ],
)
def test_a_pressure_film_tells_seating_from_a_stiffness_that_grows(effect, size, film, name):
    rows = programme(cycles=1, records=1)
    seen = campaign(_model(False), effect, size, rows=rows, curves=False)
    candidates = [one for one in catalogue() if one.id in FEW]
    settings = Settings(splits={"pressure film": (film, 500.0)})
    (found,) = diagnose(seen, simulated(seen, _model(False)), settings, candidates).found[:1]
    assert [cause.credible for cause in found.causes] == [(name,)]
    if film > 1e3:
        one = found.causes[0].mechanism
        ((value, std), *_) = sizes(one, found.final, places([one], found.channel.base)[0])
        assert abs(value - film) < 2.0 * 500.0
        assert std <= 500.0
