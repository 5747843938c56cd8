"""The inference with amplitude curves: its likelihood, its data, and a truth that it must find."""

from dataclasses import replace
from types import SimpleNamespace

import bladeroot.stiffness.amplitude as stage
import numpy as np
import pytest
import scipy.stats
import xarray as xr
from bladeroot.inference.gaussian import cost, fit
from bladeroot.nonlinear.fast_loading import softening_curve
from bladeroot.nonlinear.uneven import uneven_sliders
from bladeroot.stiffness import curve_fit
from bladeroot.stiffness.amplitude import level_names
from bladeroot.stiffness.curve_fit import FRICTION_PRIOR, fit_curves, friction_problem
from bladeroot.stiffness.model import curve_term, map_estimate, predict, problem_of
from bladeroot.stiffness.simulated_curves import (
    along,
    by_friction,
    by_unevenness,
    friction_of,
    levels_at,
)
from bladeroot.stiffness.softening import Softening, covariance, softening_of
from nonlinear_systems import coarse_joint
from stiffness_bench import GAUGE, HIGH, LOW, drawn, surface
from stiffness_bench import stick as stick_of

LASERS = {"1B": 0.0, "2B": -0.07}


def term_of(count, seed=2):
    rng = np.random.default_rng(seed)
    center = np.array([20.5, 21.0, 9.0]) + 0.1 * rng.standard_normal((count, 3))
    slope, rest = rng.standard_normal((8, 3 * count)), rng.standard_normal(8)
    half = rng.standard_normal((8, 8))
    return curve_term(center, rest, slope, half @ half.T + np.eye(8)), (slope, rest, half)


def test_curve_term_is_the_normal_likelihood():
    """Of many numbers, too: what the rows leave out is its constant."""
    for seed in (2, 3):
        term, (slope, rest, half) = term_of(2, seed)
        z = term.center + 0.3 * np.random.default_rng(5).standard_normal((2, 3))
        away = (z - term.center).ravel()
        wanted = scipy.stats.multivariate_normal(cov=half @ half.T + np.eye(8)).logpdf(
            rest - slope @ away
        )
        of_rows = scipy.stats.norm.logpdf(term.rest - term.slope @ away).sum()
        assert of_rows + term.constant == pytest.approx(wanted)
        assert len(term.rest) == 6


def test_slopes_of_the_model_with_curves():
    bare, theta = drawn()
    problem = problem_of(replace(bare, curves=term_of(len(bare.levels.force))[0]))
    step = 1e-4 * bare.prior.std
    up, down = (
        np.array([one.mean for one in problem.states(theta + side * np.diag(step))])
        for side in (1.0, -1.0)
    )
    numeric = ((up - down) / (2.0 * step[:, None])).T * bare.prior.std
    found = problem.predict(theta).slope * bare.prior.std
    np.testing.assert_allclose(found, numeric, atol=1e-5 * np.abs(numeric).max())
    assert len(problem.data) > len(bare.levels.force)


def records(falls=(0.0, 1e-2)):
    """Two records of one level whose stick frequencies differ; the frequency falls as ln A."""
    amplitude, stuck = np.geomspace(1e-7, 1e-5, 60), np.array([500.0, 505.0])
    plateau, shape = np.array([3e-3, 4e-3]), np.clip(np.log(amplitude / 1e-6), 0.0, None)
    over = ("record", "amplitude")
    return xr.Dataset(
        {
            "mode": ("record", ["1B"] * 2),
            "force": ("record", [4e3] * 2),
            "hold": ("record", ["h0", ""]),
            "verdict": ("record", ["usable"] * 2),
            "plateau_reached": ("record", [1, 1]),
            "correlation_decades": ("record", [0.5] * 2),
            "stick_frequency": ("record", stuck),
            "stick_frequency_std": ("record", [1e-3] * 2),
            "stick_loss_factor": ("record", plateau),
            "stick_loss_factor_std": ("record", [1e-5] * 2),
            "frequency": (over, np.outer(stuck, 1.0 - falls[1] * shape)),
            "frequency_std": (over, np.full((2, 60), 1e-3)),
            "loss_factor": (over, plateau[:, None] + 0.02 * shape),
            "loss_factor_std": (over, np.full((2, 60), 1e-5)),
        },
        coords={"record": ["r0", "r1"], "amplitude": amplitude},
    )


def test_each_record_is_counted_from_its_own_stick_frequency():
    found = softening_of(records(), [("2B", 4e3), ("1B", 4e3)])
    assert set(found.level) == {1}
    assert np.all(found.clampings == 2)
    assert found.amplitude.min() > 1e-6
    shape = np.log(found.amplitude / 1e-6)
    np.testing.assert_allclose(found.fall, -1e-2 * shape, atol=1e-9)
    np.testing.assert_allclose(found.rise, 2e-2 * shape, atol=1e-9)
    size = np.sqrt(np.diag(found.noise))[: found.fall.size] * 505.0
    # two records of 1 mHz, with the plateaus' 1 mHz: sqrt(2) / sqrt(2)
    np.testing.assert_allclose(size, 1e-3, rtol=0.1)


def test_a_frequency_that_does_not_fall_gives_no_points():
    assert not len(softening_of(records(falls=(0.0, 0.0)), [("1B", 4e3)]).level)


def test_a_record_that_ends_leaves_no_step():
    seen = records()
    whole = softening_of(seen, [("1B", 4e3)])
    seen["frequency"][0, 50:] = np.nan
    seen["loss_factor"][0, 50:] = np.nan
    found = softening_of(seen, [("1B", 4e3)])
    np.testing.assert_array_equal(found.amplitude, whole.amplitude)
    np.testing.assert_allclose(found.fall, whole.fall, atol=1e-9)
    assert sorted(set(found.clampings)) == [1.0, 2.0]


def made_up(levels, size=8):
    level = np.repeat(np.arange(len(levels)), size)
    amplitude = np.tile(np.geomspace(4e-6, 6e-5, size), len(levels))
    nothing = np.zeros(level.size)
    noise = 1e-12 * np.eye(2 * level.size)
    return Softening(level, amplitude, nothing, nothing, nothing + 2.0, noise)


def test_errors_of_the_curves_are_a_covariance():
    levels = [("1B", 4e3), ("2B", 4e3), ("1B", 8e3)]
    one = made_up(levels)
    one = replace(one, fall=-100.0 * one.amplitude, rise=50.0 * one.amplitude)
    errors = covariance(one, levels, 0.05)
    np.testing.assert_allclose(errors, errors.T)
    assert np.linalg.eigvalsh(errors)[0] > 0.0
    largest = np.sqrt(np.diag(errors))[7] / np.abs(one.fall[7])
    assert 0.05 < largest < 0.1
    smallest = np.sqrt(np.diag(errors))[0] / np.abs(one.fall[0])
    assert smallest > 2.0 * largest


def test_slopes_of_simulated_curves():
    joint, levels = coarse_joint(), [("1B", 4e3)]
    z = np.array([[np.log(0.6e9), np.log(0.9e9), np.log(4e3)]])
    friction = np.log([0.4, 0.06, 0.7, 0.4])
    one = made_up(levels)
    at = levels_at(joint, one, levels, LASERS, z)
    found = by_friction(joint, at, friction, *along(joint, at, friction))
    for k, apart in enumerate((0.05, 0.3, 0.3, 0.3)):  # one-sided but for the first
        step = 0.1 * np.eye(4)[k]
        up, down = (along(joint, at, friction + side * step)[0] for side in (1.0, -1.0))
        numeric = (up - down) / 0.2
        # all pairs of this joint lie at the edges: two of the parameters change nothing
        atol = 1e-12 + apart * np.abs(numeric).max()
        np.testing.assert_allclose(found[:, k], numeric, atol=atol)


def test_uneven_pressure_moves_curves_as_a_contact_pressed_harder_does():
    joint, levels = coarse_joint(), [("1B", 4e3)]
    z = np.array([[np.log(0.6e9), np.log(0.9e9), np.log(4e3)]])
    friction, one = np.log([0.4, 0.06, 0.7, 0.4]), made_up(levels)
    at = levels_at(joint, one, levels, LASERS, z)
    found = by_unevenness(joint, at, friction)
    system, h = at[0].systems[0], 0.05
    sliders = uneven_sliders(joint, system, at[0].force, friction_of(friction))
    total = (system.count * sliders.preload.sum(axis=1)).sum()
    contact = int(np.argmax(np.abs(found).sum(axis=0)[system.pair]))
    curves = []
    for sign in (1.0, -1.0):
        preload = sliders.preload.copy()
        preload[contact] *= np.exp(sign * h)
        preload *= total / (system.count * preload.sum(axis=1)).sum()
        pressed = replace(sliders, preload=preload)
        curves.append(softening_curve(system, pressed, at[0].amplitude)[0].ravel())
    wanted = 0.4 / np.sqrt(system.count[contact]) * (curves[0] - curves[1]) / (2.0 * h)
    np.testing.assert_allclose(
        found[:, system.pair[contact]], wanted, atol=0.1 * np.abs(wanted).max()
    )
    others = np.setdiff1d(np.arange(found.shape[1]), system.pair)
    assert not found[:, others].any()


@pytest.fixture
def campaign(monkeypatch):
    """What `amplitude` reads, with curves of all levels; their fit says which modes came to it."""
    box = xr.Dataset(
        {
            "ln_frequency": (("mode", "kn", "kt", "f"), surface(0.003).coefficients),
            "box": (("end", "coordinate"), np.stack([LOW, HIGH])),
        },
        {"mode": ["1B", "2B"]},
        {"structure": "toy"},
    )
    made, theta = drawn("one power", 0.003)
    frequencies = stick_of(np.exp(predict(made, theta[None]).ln_frequency[0]))
    monkeypatch.setattr(stage, "softening_of", lambda seen, levels: made_up(levels, 2))

    def fails(joint, model, alone, softening, levels, lasers, discrepancy):
        modes = sorted({levels[k][0] for k in softening.level})
        raise RuntimeError(f"the contacts of {' and '.join(modes)} did not settle")

    monkeypatch.setattr(stage, "fit_curves", fails)
    bias = {"1B": 0.005, "2B": 0.005}

    def run(lasers):
        nothing = xr.Dataset()
        return stage.amplitude(
            coarse_joint(), box, frequencies, nothing, lasers, GAUGE, [12e3], bias
        )

    return run


@pytest.mark.parametrize(
    ("lasers", "reason"),
    [
        (LASERS, "the contacts of 1B and 2B did not settle"),
        ({"1B": 1.0, "2B": 0.0}, "1B: the laser must stand on the beam"),
    ],
)
def test_curves_that_cannot_be_simulated_are_an_answer(campaign, lasers, reason):
    found = campaign(lasers)
    assert found.attrs["law"] == ""
    assert found.attrs["reason"].startswith(reason)
    if lasers["1B"] == 1.0:
        assert "2B: the laser stands at a node of 2B" in found.attrs["reason"]


def test_a_posterior_that_is_no_number_is_an_answer(campaign, monkeypatch):
    def fails(*_):
        raise ValueError("Probability function returned NaN")

    monkeypatch.setattr(stage, "fit_curves", lambda *_: SimpleNamespace(term=None))
    monkeypatch.setattr(stage, "posterior_of", fails)
    found = campaign(LASERS)
    assert found.attrs["law"] == ""
    assert "cannot be drawn from: Probability function" in found.attrs["reason"]


@pytest.mark.wrong_shape
def test_a_friction_that_cannot_be_simulated_is_not_taken(monkeypatch):
    prior = FRICTION_PRIOR
    best = prior.mean[0] - 2.0 * prior.std[0]

    def curves_of(joint, at, friction):
        if friction[0] < best - 0.1:
            raise RuntimeError("the contacts did not settle")
        return np.array([friction[0]]), np.zeros(1)

    monkeypatch.setattr(curve_fit, "along", curves_of)
    problem = friction_problem(None, [], np.array([best - 1.0]), np.array([[1e-3]]))
    assert curve_fit._start(problem)[0] == pytest.approx(best)


def test_a_friction_far_from_all_that_is_known_is_not_tried():
    """With it pressures overflow."""
    joint, levels = coarse_joint(), [("1B", 4e3)]
    z = np.array([[np.log(0.6e9), np.log(0.9e9), np.log(4e3)]])
    at = levels_at(joint, made_up(levels), levels, LASERS, z)
    problem = friction_problem(joint, at, np.zeros(16), np.eye(16))
    for sign in (1.0, -1.0):
        edge = problem.prior.mean + sign * (curve_fit._FARTHEST_FRICTION - 0.1) * problem.prior.std
        assert np.isfinite(along(joint, at, edge)[0]).all()
        assert cost(problem, edge + sign * problem.prior.std) == np.inf


def test_friction_is_fitted_to_curves_that_it_made():
    joint, levels = coarse_joint(), [("1B", 4e3)]
    z = np.array([[np.log(0.6e9), np.log(0.9e9), np.log(4e3)]])
    one = made_up(levels)
    at = levels_at(joint, one, levels, LASERS, z)
    truth = np.log([0.4, 0.06, 0.6, 0.4])
    value = along(joint, at, truth)[0]
    errors = np.diag(np.full(value.size, 1e-2 * np.abs(value).max()) ** 2)
    problem = friction_problem(joint, at, value, errors)
    found = fit(problem, curve_fit._start(problem), least=1e-2)
    assert found.state.mean == pytest.approx(value, abs=0.02 * np.abs(value).max())
    assert cost(problem, found.parameters) < cost(problem, truth) + 0.05


@pytest.mark.slow
def test_curves_find_stiffness_and_friction_that_made_them():
    joint = coarse_joint()
    made, theta = drawn("two powers", bent=0.0)
    truth = predict(made, theta[None]).logarithms[0]
    levels = level_names(made)[:3]
    one = made_up(levels)
    friction = np.log([0.3, 0.06, 0.6, 0.4])
    at = levels_at(joint, one, levels, LASERS, truth)
    fall, rise = along(joint, at, friction)[0].reshape(2, -1)
    one = replace(one, fall=fall - 1e-5, rise=rise + 1e-5)
    alone = map_estimate(made)
    found = fit_curves(joint, made, alone, one, level_names(made), LASERS, 0.03)
    assert found.converged
    both = map_estimate(replace(made, curves=found.term))
    before, after = (one.std[:2] for one in (alone, both))
    assert np.all(after < before)
    assert after[1] < 0.6 * before[1]
    assert np.all(np.abs(both.parameters - theta)[:2] < 3.0 * after)
