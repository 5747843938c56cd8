"""Diagnosis without a structure: linear modes, a table, and a structure that cannot be it."""

import json
import re
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from bladeroot.diagnosis import guards, judged
from bladeroot.diagnosis.clampings import one_of_each_event
from bladeroot.diagnosis.diagnose import Settings
from bladeroot.diagnosis.possible import impossible, impossible_table
from bladeroot.diagnosis.simulation.linear import BEND, Linear
from bladeroot.diagnosis.simulation.over_load import OverLoad
from bladeroot.diagnosis.simulation.own_range import in_catalogue, own_range
from bladeroot.diagnosis.simulation.table import in_series, table_of
from bladeroot.diagnosis.stick_model import problem, stick_data
from bladeroot.mechanisms.catalogue import catalogue
from bladeroot.report.verdict import answer_of
from bladeroot.rom.parametric import ln_frequencies, surface_of
from bladeroot.rom.parametric_build import parametric_model
from bladeroot.schema import check
from bladeroot.terms import Terms
from diagnosis_bench import FORCES, MODES, campaign, programme
from stiffness_beam import beam_joint

SETTINGS = Settings()
CATALOGUE = catalogue()
BY_ID = {one.id: one for one in CATALOGUE}


@pytest.fixture(scope="module")
def model():
    return parametric_model(beam_joint(), stiffness=(1e8, 1e11), tolerance=1e-6)


@pytest.fixture(scope="module")
def expected(model):
    return dict(zip(MODES, np.exp(_places(model, 12e3)[0][0]), strict=True))


def _places(model, force, ln_k=21.13):
    surface = surface_of(model.sel(mode=list(MODES)))
    return ln_frequencies(surface, np.array([[ln_k, ln_k, force]]))


def dovetail_table(model, forces=FORCES):
    """The structure's own frequencies and sensitivities over the force, as a user's table."""
    rows = []
    for force in np.linspace(0.9 * min(forces), 1.1 * max(forces), 12):
        value, slope = _places(model, force)
        for m, mode in enumerate(MODES):
            rows.append((mode, force, np.exp(value[0, m]), slope[0, m, 0], slope[0, m, 1]))
    frame = pd.DataFrame(rows, columns=["mode", "load", "frequency_Hz", "by_ln_kn", "by_ln_kt"])
    return table_of(frame, "sim.csv", {"": 5e-3}, {})


def of_a_load(seen, name, unit, factor=1.0):
    """The same campaign with another load."""
    made = seen.assign(force=seen["force"] * factor)
    return made.assign_attrs(load_name=name, load_unit=unit, gauge_resolution_N=179.0 * factor)


def names(said):
    return [one["mechanism"] for one in said["causes"] if one["shown"]]


@pytest.mark.parametrize(("power", "zero"), [(1.0, 0.0), (2.0, 500.0)])
def test_slopes_of_the_linear_baseline_are_differences(model, expected, power, zero):
    seen = campaign(model, rows=programme(cycles=1), curves=False)
    data = stick_data(seen, MODES)
    linear = Linear(MODES, np.array([expected[mode] for mode in MODES]), True, power, zero)
    chosen = [BY_ID["load-dependent-stiffness"], BY_ID["drift"], BY_ID["force-relaxation"]]
    made = problem(data, linear, chosen)
    theta = made.prior.mean + 0.3 * made.prior.std * np.random.default_rng(0).standard_normal(
        made.prior.mean.size
    )
    state = made.predict(theta)
    for k in range(theta.size):
        step = np.zeros(theta.size)
        step[k] = 1e-5 * made.prior.std[k]
        rise = (made.predict(theta + step).mean - made.predict(theta - step).mean) / (2 * step[k])
        assert state.slope[:, k] == pytest.approx(rise, abs=1e-3 * np.abs(rise).max() + 1e-12)
    scales = made.scales.mean
    whole, slopes = made.covariance(state, scales)
    for k, slope in enumerate(slopes()):
        step = np.eye(scales.size)[k] * 1e-5
        up, down = (made.covariance(state, scales + sign * step)[0] for sign in (1, -1))
        slope = np.diag(slope) if slope.ndim == 1 else slope
        assert (up - down) / 2e-5 == pytest.approx(slope, abs=1e-6 * np.abs(whole).max())


@pytest.mark.parametrize(("ends", "mode"), [("clamped", 0), ("clamped", 1), ("sprung", 0)])
def test_the_line_over_a_tension_bends_as_that_of_a_clamped_beam(ends, mode):
    """Differences along a beam under tension, between rigid ends and between rotary springs."""
    n = 80
    d2 = np.diff(np.eye(n + 2), 2, axis=0)[:, 1:-1] * (n + 1) ** 2
    bending = d2.T @ d2
    turn = 1e6 if ends == "clamped" else 0.2 * (n + 1)
    bending[[0, -1], [0, -1]] += 2.0 * turn * (n + 1) ** 2
    tension = np.linspace(0.0, 15.0, 9)
    square = np.array([np.linalg.eigvalsh(bending - one * d2)[mode] for one in tension])
    bend, line, _ = np.polyfit(tension, square / square[0], 2)
    assert line * tension[-1] > 0.1
    assert abs(-bend / line**2 - BEND[0]) < 2.0 * BEND[1]


@pytest.mark.parametrize(("unit", "nothing"), [("rpm", True), ("Nm", False)])
def test_a_speed_stiffens_by_its_square(model, expected, unit, nothing):
    """f^2 = f0^2 + B n^2 (Southwell), from standstill on; over any other load that is no line."""
    seen = campaign(model, rows=programme(cycles=2), curves=False)
    speed = 600.0 * np.searchsorted(FORCES, seen["force"].values)
    mode, hold = (np.unique(seen[name], return_inverse=True)[1] for name in ("mode", "hold"))
    rng = np.random.default_rng(2)
    gain = np.array([0.25, 0.08])[mode] * (speed / speed.max()) ** 2
    level = np.array([expected[name] for name in MODES])[mode]
    scatter = 1e-4 * rng.standard_normal(hold.max() + 1)[hold]
    scatter += 3e-6 * rng.standard_normal(hold.size)
    seen["stick_frequency"].values[:] = level * np.sqrt(1.0 + gain) * np.exp(scatter)
    seen["force"].values[:] = speed
    made = of_a_load(seen, "speed", unit)
    _, said, _ = judged.judge(made, None, {"expected_Hz": expected}, CATALOGUE)
    assert (said["answer"] == "nothing-missing") == nothing


@pytest.mark.parametrize("effect", [("", 0.0), ("drift", 6e-3)])
def test_linear_modes_name_what_does_not_need_a_structure(model, expected, effect):
    wanted = {"": [], "drift": ["drift"]}[effect[0]]
    seen = campaign(model, *effect, seed=2, scatter=0.03, rows=programme(cycles=2), curves=False)
    seen = of_a_load(seen, "bolt torque", "Nm", 1e-3)
    made, said, extension = judged.judge(seen, None, {"expected_Hz": expected}, CATALOGUE)
    check(json.loads(json.dumps(said)), "verdict", "linear modes")
    assert names(said) == wanted
    assert (said["structure"], extension) == (None, None)
    assert "smooth in bolt torque" in made["candidate"].values
    ranked = [str(name) for name in made["candidate"].values if str(name).startswith("smooth")]
    assert not re.search(r"\bforce\b", " ".join([*ranked, said["reason"], str(said["next"])]))
    assert "force-gain" not in said["reason"]
    assert made["stick_force"].values.max() == pytest.approx(seen["force"].values.max())


def test_a_size_without_structure_has_the_assumed_part_of_the_joint_in_its_error(model, expected):
    seen = campaign(model, "exponent", 0.5, seed=3, rows=programme(cycles=2), curves=False)
    _, said, _ = judged.judge(seen, None, {"expected_Hz": expected}, CATALOGUE)
    (cause,) = (one for one in said["causes"] if one["mechanism"] == "load-dependent-stiffness")
    exponent, *_ = cause["parameters"]
    assert exponent["value"] < 0.1  # contact carries less than is assumed
    assert abs(exponent["value"] - 0.5) < 3.0 * exponent["std"]
    assert "their errors hold a factor of 10" in said["reason"]


def test_of_curves_of_one_condition_the_likeliest_causes_and_what_would_split_them_is_said(
    model, expected
):
    seen = campaign(model, "slip", 0.02, rows=programme(cycles=2, forces=np.array([6e3])))
    seen["direction"] = seen["direction"].where(False, "")
    seen = of_a_load(seen, "", "", 0.0)
    made, said, _ = judged.judge(seen, None, {"expected_Hz": expected}, CATALOGUE)
    assert said["answer"] == "insufficient-data"
    assert {row["quantity"] for row in said["shortfall"]} >= {"loss factor over amplitude"}
    assert "joint-slip" in said["reason"]
    assert "to decide" in said["reason"].lower()
    told = [
        said["reason"],
        said["shortfall"],
        *(x for x in made.attrs.values() if isinstance(x, str)),
    ]
    words = re.sub(r"\b[a-z]+(-[a-z]+)+\b", "", str(told))
    assert not re.search(r"force|gauge|structure|flank|simulat|kN", words)


def test_a_verdict_says_how_far_the_frequencies_lie_from_the_table(model):
    seen = campaign(model, seed=4, scatter=0.03, rows=programme(cycles=2), curves=False)
    table = dovetail_table(model)
    low = replace(table, ln_f=tuple(ln_f - np.log(1.01) for ln_f in table.ln_f))
    apart = []
    for one in (table, low):
        _, said, _ = judged.judged(seen, one, SETTINGS, CATALOGUE)
        text = re.search(r"lie from the table's by (\S+) % \(1B\), (\S+) % \(2B\)", said["reason"])
        apart.append([float(number) for number in text.groups()])
        assert re.search(r"takes for kn times .*, an FE bias of .* % \(2B\)", said["reason"])
    np.testing.assert_allclose(np.diff(apart, axis=0)[0], 1.0, atol=0.15)


@pytest.mark.slow
def test_a_table_of_the_dovetail_names_what_the_dovetail_names(model, expected):
    seen = campaign(model, "exponent", 0.3, seed=4, rows=programme(cycles=2), curves=False)
    table = dovetail_table(model)
    of_table = judged.judged(seen, table, SETTINGS, CATALOGUE)[1]
    of_structure = judged.judge(seen, model, {"expected_Hz": expected}, CATALOGUE)[1]
    assert names(of_table) == names(of_structure)
    assert of_table["structure"] == "sim.csv"
    low, high = table.load_range
    loads = [one["load"] for one in of_table["next"] if one["load"] is not None]
    assert all(low <= load <= high for load in loads)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (
            lambda rows: rows.assign(frequency_Hz=2.0 * np.pi * rows["frequency_Hz"]),
            r"\(6\.\d+ times it\)",
        ),
        (lambda rows: rows.assign(frequency_Hz=rows["load"], load=rows["frequency_Hz"]), "Hz for"),
        (lambda rows: rows.assign(mode=rows["mode"].map({"1B": "2B", "2B": "1B"})), "Hz for"),
        (lambda rows: rows.assign(frequency_Hz=1.2 * rows["frequency_Hz"]), r"\(\+(19|20)"),
    ],
)
def test_a_table_that_cannot_be_the_specimens_is_refused(model, expected, change, told):
    seen = campaign(model, rows=programme(cycles=1), curves=False)
    seen.attrs |= {"load_name": "axial force", "load_unit": "N"}
    rows = [(mode, force, float(np.exp(_places(model, force)[0][0, m])))
            for m, mode in enumerate(MODES) for force in (2e3, 2.5e4)]  # fmt: skip
    frame = pd.DataFrame(rows, columns=["mode", "load", "frequency_Hz"])
    changed = change(frame)
    changed.attrs["name"] = "sim.csv"
    _, said, _ = judged.judge(seen, changed, {"expected_Hz": expected}, CATALOGUE)
    assert (said["answer"], said["causes"]) == ("insufficient-data", [])
    assert said["reason"].startswith("sim.csv cannot be of this specimen")
    assert re.search(told, said["reason"])
    assert ". " not in said["reason"]
    right = table_of(frame, "sim.csv", {"": 5e-3}, {})
    moved = table_of(changed.assign(by_modulus=10.0), "sim.csv", {"": 5e-3}, {})
    assert impossible_table(right, expected) == impossible_table(moved, expected) == ""


def test_a_table_goes_through_its_loads_and_straight_on_beyond_them():
    loads, values = np.array([1.0, 2.0, 4.0]), np.array([0.0, 1.0, 0.0])
    over = OverLoad(loads, values)
    assert over(loads)[0] == pytest.approx(values)
    (end, beyond), (slope, same) = over(np.array([4.0, 5.0]))
    assert slope == same
    assert beyond == pytest.approx(end + slope)
    (value,), (rate,) = OverLoad(loads[:1], values[:1])(np.array([7.0]))
    assert (value, rate) == (0.0, 0.0)
    np.testing.assert_allclose(OverLoad(loads[:2], values[:2])(np.array([1.5]))[0], [0.5])


@pytest.mark.parametrize("law", [lambda x: 0.05 * np.log(x), lambda x: 0.5 * np.log1p(0.02 * x)])
@pytest.mark.parametrize("count", [5, 9])
def test_between_a_tables_loads_the_error_says_what_the_spline_misses(law, count):
    loads, at = np.geomspace(2.0, 24.0, count), np.linspace(2.0, 24.0, 200)
    over = OverLoad(loads, law(loads))
    miss, (error, _) = np.abs(over(at)[0] - law(at)), over.error(at)
    assert (miss <= 3.0 * error + 1e-9).all()
    assert error.max() < 0.3 * np.abs(np.interp(at, loads, law(loads)) - law(at)).max()
    np.testing.assert_allclose(over.error(loads)[0], 0.0, atol=1e-15)
    step = 1e-5
    numeric = (over(at + step)[0] - over(at - step)[0]) / (2.0 * step)
    np.testing.assert_allclose(over(at)[1][1:-1], numeric[1:-1], rtol=1e-5)


def test_springs_in_series_are_those_of_a_chain():
    """Two springs and a third, whose stiffness stays: f^2 is one over the compliance."""
    softer, own, rest = np.array([0.3, -1.2]), np.array([2.0, 5.0]), 3.0
    compliance = 1.0 / own
    whole = compliance.sum() + 1.0 / rest
    moved = (compliance * np.exp(-softer)).sum() + 1.0 / rest
    change, slope = in_series((compliance / whole)[None], softer[None])
    assert change[0] == pytest.approx(0.5 * np.log(whole / moved))
    for k in range(2):
        ends = [softer + sign * 1e-6 * np.eye(2)[k] for sign in (1, -1)]
        up, down = (in_series((compliance / whole)[None], x[None])[0][0] for x in ends)
        assert slope[0, k] == pytest.approx((up - down) / 2e-6, rel=1e-6)


def test_a_table_without_sensitivities_says_that_it_cannot_tell_contact():
    frame = pd.DataFrame({"mode": ["1B", "1B"], "load": [1e3, 2e4], "frequency_Hz": [500.0, 510.0]})
    table = table_of(frame, "t.csv", {"": 5e-3}, {})
    assert "by_ln_kn" in table.silent(BY_ID["load-dependent-stiffness"])
    assert table.silent(BY_ID["force-gain"]) == ""
    assert not table.knows_contact


def test_a_table_may_hold_slip_of_its_own():
    rows = [("a", load, f, eta, x) for load in (1.0, 2.0)
            for x, f, eta in ((1e-6, 100.0, 0.01), (1e-5, 99.0, 0.02))]  # fmt: skip
    columns = ["mode", "load", "frequency_Hz", "loss_factor", "amplitude_m"]
    table = table_of(pd.DataFrame(rows, columns=columns), "t.csv", {"": 5e-3}, {})
    assert np.exp(table.ln_f[0]) == pytest.approx([100.0, 100.0])
    slip = table.slip.sel(mode="a", force=2.0)
    assert slip["ln_frequency"].values == pytest.approx([0.0, np.log(0.99)])
    assert slip["loss_factor"].values == pytest.approx([0.0, 0.01])


def test_another_machine_is_refused_in_one_sentence_with_the_numbers(model, expected):
    foreign = {"first": 0.2 * expected["1B"], "second": 0.4 * expected["1B"]}
    seen = campaign(model, rows=programme(cycles=1), curves=False)
    seen["mode"] = ("record", np.where(seen["mode"].values == "1B", "first", "second"))
    seen["stick_frequency"] = seen["stick_frequency"] * np.nan
    made, said, extension = judged.judge(seen, model, {"expected_Hz": foreign}, CATALOGUE)
    check(json.loads(json.dumps(said)), "verdict", "refused")
    assert (said["answer"], said["causes"]) == ("insufficient-data", [])
    assert answer_of(said) == "not this specimen"
    check(extension, "model", "refused")
    assert "cannot be this specimen" in said["reason"]
    assert f"{foreign['first']:.4g} Hz" in said["reason"]
    assert ". " not in said["reason"].rstrip(".")
    assert made.sizes["candidate"] == 0


def test_a_structure_that_is_some_per_cent_off_is_not_refused(model, expected):
    error = {"1B": 5e-3, "2B": 5e-3}
    assert impossible(model, {m: 0.97 * f for m, f in expected.items()}, error) == ""
    assert impossible(model, {m: 0.5 * f for m, f in expected.items()}, error) != ""


@pytest.mark.parametrize(
    ("loads", "name"),
    [([5.0, 20.0], "bolt torque"), ([-20.0, 60.0], "temperature"), ([0.0, 0.0], "")],
)
def test_own_range_goes_there_and_back(loads, name):
    seen = xr.Dataset(
        {
            "force": ("record", loads), "onset_amplitude": ("record", [1e-3, np.nan]),
            "frequency": (("record", "amplitude"), [[7.0, 7.1], [7.0, np.nan]]),
        },
        coords={"amplitude": [1e-3, 5e-3]},
        attrs={"load_name": name, "load_unit": "Nm" if name else "",
               "gauge_full_scale_std_N": 1.0, "gauge_resolution_N": 0.0},
    )  # fmt: skip
    own = own_range(seen)
    there = in_catalogue(seen, own)
    assert (there["force"] > 1e3).all()
    assert (there["force"] < 1e5).all()
    back = judged.dataset_in_own(there.rename(force="stick_force"), own)
    assert back["stick_force"].values == pytest.approx(loads)
    factor, unit = own.factor("m/N")
    assert factor == pytest.approx(own.per_load / own.per_metre)
    assert unit == ("m/Nm" if name else "m/")[: len(unit)]
    assert own.factor("1") == (1.0, "1")


def test_sensors_of_one_event_are_one_observation():
    seen = xr.Dataset(
        {name: ("record", values) for name, values in {
            "mode": ["a"] * 4 + ["b"], "event": ["e1", "e1", "e2", "e2", ""],
            "sensor": ["x", "y", "x", "y", "x"], "verdict": ["usable"] * 5}.items()}
        | {"frequency": (("record", "amplitude"), np.full((5, 2), 10.0)),
           "frequency_std": (("record", "amplitude"), [[s, s] for s in (1, 0.1, 1, 0.2, 1.0)])},
        coords={"record": list("pqrst")},
    )  # fmt: skip
    assert one_of_each_event(seen)["record"].values.tolist() == ["q", "s", "t"]


@pytest.mark.parametrize(
    ("text", "load", "said"),
    [
        ("curves at a second {load}", "", "curves at a second preload of the joint"),
        ("curves at a second {load}", "bolt torque", "curves at a second bolt torque"),
        ("rises by 2 % more {than_simulated}", "", "rises by 2 % more than in a linear mode"),
    ],
)
def test_sentences_suit_a_specimen_without_force_and_simulation(text, load, said):
    assert Terms(load, simulated=False).say(text) == said


def test_a_load_cells_zero_is_no_surer_than_its_gauge_is_straight():
    """A gain of 20 % up to 20 kN bends the line through its loads by a part of 4 kN."""
    seen = xr.Dataset({"force": ("record", np.array([5e3, 20e3]))})
    zero = {"measurement": "load cell zero", "value": 400.0, "std": 50.0}
    scale = {"measurement": "load cell scale", "value": -0.2, "std": 0.005}
    assert judged._independent([zero], seen) == {"load cell zero": (400.0, 50.0)}
    both = judged._independent([scale, zero], seen)
    assert both["load cell scale"] == (-0.2, 0.005)
    assert both["load cell zero"] == (400.0, pytest.approx(np.hypot(50.0, guards.TRUST * 4e3)))


def judged_by_a_table(model, expected, unit, candidates):
    """Slip, seen by a sensor where the specimen moves so many times as far."""
    seen = campaign(model, effect="slip", size=0.02, seed=2, rows=programme(cycles=1))
    seen.attrs |= {"load_name": "axial force", "load_unit": "N"}
    rows = [(mode, force, float(np.exp(_places(model, force)[0][0, m])))
            for m, mode in enumerate(MODES) for force in FORCES]  # fmt: skip
    frame = pd.DataFrame(rows, columns=["mode", "load", "frequency_Hz"])
    frame.attrs["name"] = "sim.csv"
    moved = seen.assign_coords(amplitude=unit * seen["amplitude"])
    return judged.judge(moved, frame, {"expected_Hz": expected}, candidates)[1]


@pytest.mark.parametrize("unit", [1e-2, 1.0, 40.0])
def test_slip_is_found_at_whatever_amplitude_a_sensor_sees_it(model, expected, unit):
    said = judged_by_a_table(model, expected, unit, [BY_ID["joint-slip"], BY_ID["quadratic-drag"]])
    assert [one["mechanism"] for one in said["causes"]] == ["joint-slip"]
    size = {one["name"]: one for one in said["causes"][0]["parameters"]}["threshold"]
    assert abs(np.log(size["value"] / (3e-10 * unit))) < 1.0
