"""The lap joint as the diagnosed structure: its stiffnesses, its causes, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from bladeroot.diagnosis.interfaces import interface_stiffness, stiffness_problem
from bladeroot.diagnosis.judged import judge
from bladeroot.diagnosis.simulation.parametric import of_assembly
from bladeroot.diagnosis.stick_model import problem, stick_data
from bladeroot.inference.gaussian import best_fit, cost, fit
from bladeroot.mechanisms.catalogue import catalogue
from bladeroot.report.diagnosis_tables import stiffness_tables
from bladeroot.rom.bodies import reduce_bodies
from bladeroot.rom.parametric import ln_frequencies, solved_of
from bladeroot.rom.whole import parametric_structure
from lap_coarse import lap_assembly, lap_model
from turning import by_differences

MODES = ("bend1", "bend2", "bend3")
CURVES = ("frequency", "frequency_std", "loss_factor", "loss_factor_std")
LOADS = (3e3, 6e3, 9e3, 12e3)
# ln k of outer and middle bolts
TRUE = np.log([4e9, 1.4e9, 1.6e9, 0.6e9])
BIAS = np.array([0.001, -0.001, 0.0005])


def seen(exponent=0.0, factor=1.0, seed=1, noise=2e-5):
    """A campaign's observations: four preloads, up and down, clamped anew each time."""
    rng = np.random.default_rng(seed)
    rows = [(m, load, hold, way) for hold, (load, way) in enumerate(
        [(load, "up") for load in LOADS] + [(load, "down") for load in LOADS[::-1]]
    ) for m in range(3)]  # fmt: skip
    mode, load, hold, way = (np.array(part) for part in zip(*rows, strict=True))
    scatter = 0.03 * rng.standard_normal((8, 1))[hold]
    points = np.column_stack([TRUE + exponent * np.log(load / 6e3)[:, None] + scatter, load])
    ln_f = ln_frequencies(solved_of(lap_model()), points)[0][np.arange(mode.size), mode]
    ln_f = ln_f + BIAS[mode] + noise * rng.standard_normal(mode.size)
    frequency, count = factor * np.exp(ln_f), mode.size
    none = np.full(count, np.nan)
    return xr.Dataset(
        {
            "mode": ("record", np.array(MODES)[mode]), "force": ("record", load),
            "hold": ("record", [f"h{k}" for k in hold]), "direction": ("record", way),
            "stick_frequency": ("record", frequency),
            "stick_frequency_std": ("record", noise * frequency),
            "stick_loss_factor": ("record", none), "stick_loss_factor_std": ("record", none),
            "onset_amplitude": ("record", none), "plateau_reached": ("record", np.ones(count, int)),
            "verdict": ("record", np.full(count, "usable")),
            "time": ("record", 180.0 * np.arange(count)),
            "findings": ("record", np.full(count, "")),
            "correlation_decades": ("record", np.ones(count)),
            "laser_x_m": ("sensor_mode", [0.34] * 3),
        }
        | {name: (("record", "amplitude"), np.zeros((count, 0))) for name in CURVES},
        coords={"record": [f"r{k:02d}" for k in range(count)], "amplitude": np.zeros(0),
                "sensor_mode": list(MODES)},
        attrs={"campaign": "lap", "gauge_full_scale_std_N": 0.0, "gauge_relative_std": 0.01,
               "gauge_resolution_N": 0.0, "load_name": "bolt preload", "load_unit": "N"},
    )  # fmt: skip


def told(observations):
    expected = {"bend1": 160.0, "bend2": 580.0, "bend3": 1150.0}
    return judge(observations, lap_model(), {"expected_Hz": expected}, catalogue())


@pytest.fixture(scope="module")
def null():
    return told(seen())


@pytest.mark.slow
def test_no_cause_is_named_where_there_is_none(null):
    _, said, model = null
    assert said["answer"] != "named", said["reason"]
    assert said["structure"] == "lap-joint"
    assert model is None


def test_what_an_assembly_does_not_have_is_not_judged(null):
    """It has no slots; a mass may sit on it."""
    by_id = {one.id: one for one in catalogue()}
    simulated = of_assembly(lap_model(), {}, {}, 0.005)
    assert "nothing that it would change" in simulated.silent(by_id["rig-compliance"])
    assert simulated.silent(by_id["added-mass"]) == simulated.silent(by_id["drift"]) == ""
    assert "rig-compliance" not in null[1]["possible"]
    assert "rig-compliance not judged" in null[1]["reason"]


def test_true_stiffnesses_lie_in_their_intervals(null):
    low, *_, high = null[0]["interface_k"].values.T
    assert list(null[0]["stiffness"].values) == ["kn outer", "kt outer", "kn middle", "kt middle"]
    assert (low < np.exp(TRUE)).all()
    assert (np.exp(TRUE) < high).all()
    assert null[0].attrs["interface_effective_draws"] > 50


def test_one_stiffness_is_found_where_all_others_are_known():
    outer, middle = lap_assembly().interfaces
    kn, kt, *others = np.exp(TRUE)
    known = (replace(outer, kn=kn), replace(middle, kn=others[0], kt=others[1]))
    reduced = reduce_bodies(replace(lap_assembly(), interfaces=known))
    simulated = of_assembly(parametric_structure(reduced, {"force_kN": (0.0, 30.0)}), {}, {}, 0.005)
    data = stick_data(seen(), MODES)
    asked = problem(data, simulated)
    fitted = best_fit(asked, [asked.prior.mean])
    found = interface_stiffness(data, simulated, [fitted], [], asked.prior.mean.size)
    assert list(found["stiffness"].values) == ["kt outer"]
    assert found["interface_ln_covariance"].dims == ("stiffness", "stiffness_")
    low, *_, high = found["interface_k"].values[0]
    assert low < kt < high


def test_stiffnesses_are_those_in_the_middle_of_the_loads_whatever_a_law_is_stated_at():
    data, simulated = stick_data(seen(exponent=0.5), MODES), of_assembly(lap_model(), {}, {}, 0.005)
    law = next(one for one in catalogue() if one.id == "load-dependent-stiffness")
    base = problem(data, simulated).prior.mean.size
    asked = problem(data, simulated, [law])
    fitted = best_fit(asked, [asked.prior.mean])
    found = interface_stiffness(data, simulated, [fitted], [law], base)
    middle = np.exp(np.mean(np.log(LOADS)))
    assert float(found["interface_load"]) == pytest.approx(middle)
    # kt of the outer bolts, which the frequencies fix; at the law's own 12 kN it is a third larger
    low, _, median, _, high = found["interface_k"].values[1]
    true = np.exp(TRUE[1]) * np.sqrt(middle / 6e3)
    assert low < true < high
    assert abs(np.log(median / true)) < 0.15
    of_campaign = {"load_name": "bolt preload", "load_unit": "N"}
    (table,) = stiffness_tables([found.assign(law_k=0.0).assign_attrs(of_campaign)])
    assert "at a bolt preload of 6.64 kN (geometric mean" in table.caption


@pytest.mark.parametrize("causes", [("load-dependent-stiffness", "added-mass"), ("drift",)])
def test_slopes_and_the_turn_of_the_covariance_are_differences(causes):
    """Of matrices the change's derivative by the place where the shape turns is in the slope."""
    observed = seen(exponent=0.3)
    simulated = of_assembly(lap_model(), {}, {}, 0.005)
    by_id = {one.id: one for one in catalogue()}
    made = problem(stick_data(observed, MODES), simulated, [by_id[name] for name in causes])
    rng, scales = np.random.default_rng(3), made.scales.mean
    theta = made.prior.mean + 0.3 * made.prior.std * rng.standard_normal(made.prior.mean.size)
    theta[-1] = 0.012 if "added-mass" in causes else theta[-1]  # not where the line has a node
    state = made.predict(theta)
    n = state.mean.size
    vector, matrix = rng.standard_normal(n), rng.standard_normal((n, n))
    matrix = matrix + matrix.T
    turned, traces = state.turns(scales, vector, matrix)
    size = np.abs(made.covariance(state, scales)[0]).max()
    steps = 1e-5 * made.prior.std
    for k, change in enumerate(by_differences(made, theta, scales, steps)):
        step = np.eye(theta.size)[k] * steps[k]
        rise = (made.predict(theta + step).mean - made.predict(theta - step).mean) / (2 * steps[k])
        # The tension's error and a mass are as of the first order.
        assert state.slope[:, k] == pytest.approx(rise, abs=0.02 * np.abs(rise).max() + 1e-9)
        near = 0.02 * np.abs(change).max() + 1e-4 * size / made.prior.std[k]
        assert turned[:, k] == pytest.approx(change @ vector, abs=near * np.sqrt(n))
        assert traces[k] == pytest.approx((change * matrix).sum(), abs=near * n)


def test_fits_of_a_bent_valley_end_alike_from_wherever_they_begin():
    """Frequencies known to 1e-6 leave a narrow valley of four stiffnesses, and one beside it."""
    data = stick_data(seen(exponent=0.4, noise=1e-6), MODES)
    law = next(one for one in catalogue() if one.id == "load-dependent-stiffness")
    made = problem(data, of_assembly(lap_model(), {}, {}, 0.005), [law])
    rng, ends = np.random.default_rng(4), []
    for far in (0.0, 0.5, 0.5, 0.5):
        away = far * made.prior.std * rng.standard_normal(made.prior.mean.size)
        ends.append(fit(made, made.prior.mean + away).log_evidence)
    beside, *same = sorted(ends)
    assert np.ptp(same) < 1.5
    assert same[0] - beside < 10.0


@pytest.mark.slow
def test_stiffening_over_the_preload_is_named():
    whole, said, _ = told(seen(exponent=0.5))
    shown = [one["mechanism"] for one in said["causes"] if one["shown"]]
    assert shown == ["load-dependent-stiffness"]
    exponent = said["causes"][0]["parameters"][0]
    assert abs(exponent["value"] - 0.5) < 3 * exponent["std"] + 0.05
    assert "bolt preload" in said["reason"]
    low, *_, high = whole["interface_k"].values.T
    in_the_middle = np.exp(TRUE) * np.sqrt(float(whole["interface_load"]) / 6e3)
    assert (low < in_the_middle).all()
    assert (in_the_middle < high).all()


def test_another_machine_is_refused_in_one_sentence():
    _, said, _ = told(seen(factor=0.7))
    assert said["answer"] == "insufficient-data"
    assert said["causes"] == []
    assert said["reason"].startswith("lap-joint cannot be this specimen")


def test_the_stiffnesses_alone_are_the_problem_with_all_else_integrated_out():
    data = stick_data(seen(), MODES)
    simulated = of_assembly(lap_model(), {}, {}, 0.005)
    asked = problem(data, simulated)
    fitted = best_fit(asked, [asked.prior.mean])
    alone = stiffness_problem(data, simulated, fitted, [], asked.prior.mean.size)
    theta, rest = fitted.parameters.copy(), slice(4, None)
    values, steps = [], np.array([[0.0] * 4, [0.1, -0.2, 0.05, 0.3]])
    for step in steps:
        # the others, normal about a mean: at their peak, and the determinant of what they are
        theta[:4] = fitted.parameters[:4] + step
        for _ in range(3):
            state = asked.predict(theta)
            whole, _ = asked.covariance(state, fitted.scales)
            by = np.linalg.solve(whole, state.slope[:, rest])
            curve = state.slope[:, rest].T @ by + np.diag(asked.prior.std[rest] ** -2.0)
            pull = by.T @ (data.ln_f - state.mean)
            pull -= (theta - asked.prior.mean)[rest] / asked.prior.std[rest] ** 2
            theta[rest] += np.linalg.solve(curve, pull)
        values.append(cost(asked, theta, fitted.scales) + 0.5 * np.linalg.slogdet(curve)[1])
    mine = [cost(alone, fitted.parameters[:4] + step, fitted.scales) for step in steps]
    assert mine[1] - mine[0] == pytest.approx(values[1] - values[0], rel=1e-3, abs=1e-2)
