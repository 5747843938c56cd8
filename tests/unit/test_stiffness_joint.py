"""The joint inference on surfaces and campaigns whose answers are known."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.stats
import xarray as xr
from bladeroot.inference.gaussian import cost
from bladeroot.inference.sampling import sample
from bladeroot.rom.chebyshev import Surface, trimmed
from bladeroot.stiffness.information import expected_information
from bladeroot.stiffness.joint import freest, joint, models_of, surfaces_of
from bladeroot.stiffness.laws import LAWS, powers, slopes
from bladeroot.stiffness.levels import LEAST_FREQUENCY_STD, levels_of
from bladeroot.stiffness.model import map_estimate, predict, problem_of
from bladeroot.stiffness.posterior import combinations, share_within
from bladeroot.stiffness.priors import PRIORS, REFERENCE_FORCE
from stiffness_bench import (
    BIAS,
    FORCE,
    GAUGE,
    HIGH,
    LOW,
    drawn,
    powers_model,
    stick,
    surface,
)


def test_powers_have_their_slopes():
    step = 1e-3
    numeric = (powers(FORCE + step) - powers(FORCE - step)) / (2 * step)
    np.testing.assert_allclose(slopes(FORCE), numeric, rtol=1e-6, atol=1e-12)


@pytest.mark.parametrize("name", LAWS)
def test_laws_give_what_their_parameters_say(name):
    law = LAWS[name]
    value = {"ln_kn": 20.0, "ln_kt": 21.0, "exponent": 0.7, "exponent_kn": 0.6, "exponent_kt": 0.4,
             "bend_kn": 0.1, "bend_kt": -0.2}  # fmt: skip
    theta = np.array([[value[p] for p in law.parameters]])
    found = law.ln_k(theta, np.array([REFERENCE_FORCE, np.e * REFERENCE_FORCE]))[0]
    rise = {"constant": (0, 0), "one power": (0.7, 0.7), "two powers": (0.6, 0.4),
            "bent powers": (0.7, 0.2)}[name]  # fmt: skip
    np.testing.assert_allclose(found, [[20, 21], [20 + rise[0], 21 + rise[1]]])
    assert set(law.parameters) <= set(PRIORS)


@pytest.mark.parametrize("law", LAWS)
def test_slope_of_the_model_is_its_derivative(law):
    made, theta = drawn(law)
    problem, step = problem_of(made), 1e-4 * made.prior.std
    up, down = (
        np.array([one.mean for one in problem.states(theta + side * np.diag(step))])
        for side in (1.0, -1.0)
    )
    numeric = ((up - down) / (2.0 * step[:, None])).T * made.prior.std
    found = problem.predict(theta).slope * made.prior.std
    np.testing.assert_allclose(found, numeric, atol=1e-5 * np.abs(numeric).max())


def test_beyond_the_box_the_model_goes_on_and_is_not_believed():
    made, theta = drawn()
    far = theta + 6.0 * made.prior.std * (np.arange(len(theta)) == 0)
    problem = problem_of(made)
    assert problem.predict(theta).inside
    assert not problem.predict(far).inside
    assert problem.predict(far).mean[0] > problem.predict(theta).mean[0]
    assert cost(problem, far) == np.inf


@pytest.mark.parametrize("shared", [True, False])
def test_cost_is_a_multivariate_normal_with_the_scatter_in_its_covariance(shared):
    made, theta = drawn(shared=shared)
    made = replace(made, levels=replace(made.levels, clamping_freedom=np.zeros(2)))
    problem, scales = problem_of(made), np.array([np.log(0.03)])
    state = problem.predict(theta)
    slope = state.facts["slope"][:, :2]
    alike = made.levels.clamping[:, None] == made.levels.clamping
    covariance = 1e-6 * np.eye(len(slope)) + 0.03**2 / 2.0 * (slope @ slope.T) * alike
    np.testing.assert_allclose(problem.covariance(state, scales)[0], covariance, rtol=1e-10)
    rest = made.levels.ln_frequency - state.mean
    expected = scipy.stats.multivariate_normal(cov=covariance).logpdf(rest)
    expected += 0.5 * len(rest) * np.log(2.0 * np.pi)
    for prior, value in ((made.prior, theta), (problem.scales, scales)):
        expected -= 0.5 * (((value - prior.mean) / prior.std) ** 2).sum()
    assert -cost(problem, theta, scales) == pytest.approx(expected, rel=1e-9)


def test_regions_hold_their_share_of_a_bent_distribution():
    rng = np.random.default_rng(4)
    x = rng.normal(size=(6000, 2)) * [1.0, 0.1]
    x[:, 1] += 0.7 * x[:, 0] ** 2
    draws, others = np.split(x, 2)
    inside = share_within(draws, others)
    for share in (0.68, 0.95):
        assert np.mean(inside < share) == pytest.approx(share, abs=0.02)
    assert share_within(draws, np.array([[0.0, 2.0]]))[0] > 0.995  # within an ellipse of 95 %


def test_repeats_pull_the_scatter_to_what_they_show():
    made, _ = drawn()
    told = replace(made, levels=replace(made.levels, clamping_freedom=np.full(2, 400.0)))
    found = map_estimate(told, (0.0,))
    slope = found.state.facts["slope"][:, :2]
    gain = [(slope[told.levels.mode == m] ** 2).sum(axis=1).mean() for m in range(2)]
    shown = np.mean(told.levels.clamping_std**2 / gain)
    assert np.exp(2 * found.scales[0]) == pytest.approx(shown, rel=0.1)


def straight():
    """Constant stiffness, exact forces: linear but for the scatter."""
    return drawn("constant", bent=0.0, gauge=(0.0, 0.0))[0]


def test_straight_surface_gives_the_closed_form():
    """At the scatter found: generalised least squares with a prior."""
    made = straight()
    found, prior = map_estimate(made), made.prior
    problem = problem_of(made)
    zero = problem.predict(prior.mean)
    weight = np.linalg.inv(problem.covariance(zero, found.scales)[0])
    exact = np.linalg.inv(zero.slope.T @ weight @ zero.slope + np.diag(prior.std**-2.0))
    mean = prior.mean + exact @ zero.slope.T @ weight @ (problem.data - zero.mean)
    np.testing.assert_allclose((found.parameters - mean) / prior.std, 0.0, atol=1e-3)
    np.testing.assert_allclose(found.std, np.sqrt(np.diag(exact)), rtol=1e-3)


def test_draws_agree_with_curvature_where_the_posterior_is_normal_and_repeat():
    found = map_estimate(straight())
    draws, again = sample(found, (0, 1)), sample(found, (0, 1))
    np.testing.assert_array_equal(draws.parameters, again.parameters)
    assert draws.effective > 1000.0
    np.testing.assert_allclose(draws.parameters[:, :2].std(axis=0), found.std[:2], rtol=0.2)
    away = draws.parameters[:, :2].mean(axis=0) - found.parameters[:2]
    assert np.all(np.abs(away) < 0.3 * found.std[:2])


def test_the_freest_law_that_is_not_improbable_is_taken():
    fits = {name: map_estimate(drawn(name)[0], (0.0,)) for name in ("one power", "two powers")}
    fits = {
        name: replace(fit, log_evidence=value)
        for (name, fit), value in zip(fits.items(), (10.0, 8.0), strict=True)
    }
    assert freest(fits) == "two powers"
    fits["two powers"] = replace(fits["two powers"], log_evidence=6.0)
    assert freest(fits) == "one power"


def test_a_better_gauge_or_a_further_mode_never_hurts():
    made, _ = drawn()
    third = Surface(surface(0.01, 3).coefficients[2:], LOW, HIGH)
    best = map_estimate(made, (0.0,))
    found = expected_information(made, best, REFERENCE_FORCE, third, ("3B",))
    base = found["worth_ln_std"].sel(option="as measured")
    for option in found["option"].values:
        assert np.all(found["worth_ln_std"].sel(option=option) <= base * (1 + 1e-9)), option
    assert (found["worth_ln_std"].sel(option="mode 3B measured too") < 0.95 * base).all()


def test_stiff_and_sloppy_combinations():
    std, weights = combinations(np.array([[1.0, -0.9], [-0.9, 1.0]]))
    np.testing.assert_allclose(std**2, [0.1, 1.9])
    np.testing.assert_allclose(np.abs(weights), np.full((2, 2), np.sqrt(0.5)))
    assert weights[0].prod() > 0 > weights[1].prod()


def test_trimming_changes_no_frequency_by_more_than_it_says():
    whole = surface(1e-9)
    cut = trimmed(whole)
    assert cut.coefficients.size < whole.coefficients.size
    c = np.zeros_like(whole.coefficients)
    c[tuple(slice(0, n) for n in cut.coefficients.shape)] = cut.coefficients
    assert np.abs(whole.coefficients - c).sum(axis=(1, 2, 3)).max() < 1e-5


def test_levels_know_which_share_a_clamping():
    f = np.full(2 * len(FORCE), 500.0)
    records = {
        "record_force": ("record", [4e3, 4e3, 7e3, 7e3]),
        "record_mode": ("record", ["1B", "2B", "1B", "2B"]),
        "hold": ("record", ["a", "a", "b", "c"]),
        "plateau_reached": ("record", [1, 1, 1, 1]),
        "hold_freedom": ("level", np.full(2 * len(FORCE), 3)),
    }
    found = levels_of(stick(f).drop_dims("record").assign(records), ("1B", "2B"))
    assert found.clamping[0] == found.clamping[5]
    assert found.clamping[1] != found.clamping[6]
    assert found.clamping[0] != found.clamping[1]
    kept = records | {
        "hold": ("record", ["a", "a", "a", "c"])
    }  # the next load on the same clamping
    over_loads = levels_of(stick(f).drop_dims("record").assign(kept), ("1B", "2B"))
    assert over_loads.clamping[0] == over_loads.clamping[1] != over_loads.clamping[6]
    np.testing.assert_allclose(found.std, 0.05 / 500.0)  # sqrt(0.03^2 + (0.08 / 2)^2)
    np.testing.assert_allclose(found.clamping_std, 1e-3)
    # its own scatter of clampings is not the joint inference's, even where no force repeats one
    once = records | {"hold_freedom": ("level", np.zeros(2 * len(FORCE), int))}
    alone = levels_of(stick(f).drop_dims("record").assign(once), ("1B", "2B"))
    np.testing.assert_allclose(alone.std, found.std)
    np.testing.assert_allclose(levels_of(stick(f, 0.07), ("1B", "2B")).std, 0.07 / 500.0)


def test_one_clean_record_a_mode_and_force_of_one_clamping_has_a_posterior(model):
    """Nothing repeats, and the records' own errors are rounding."""
    made = powers_model()
    f = np.exp(predict(made, made.prior.mean[None]).ln_frequency[0])
    records = {
        "record_force": ("record", np.tile(FORCE, 2)),
        "record_mode": ("record", np.repeat(["1B", "2B"], len(FORCE))),
        "hold": ("record", np.full(len(f), "a")),
        "plateau_reached": ("record", np.ones(len(f), int)),
        "within_std": ("level", np.full(len(f), 1e-7)),
        "between_record_std": ("level", np.full(len(f), np.nan)),
        "records": ("level", np.ones(len(f), int)),
        "holds": ("level", np.ones(len(f), int)),
    }
    given = stick(f).drop_dims("record").assign(records)
    assert levels_of(given, ("1B", "2B")).std.min() == LEAST_FREQUENCY_STD
    found = map_estimate(models_of(model, given, GAUGE, BIAS)["one power"], (0.0,))
    draws = sample(found, (0, 1), 200)
    assert np.isfinite(draws.parameters).all()
    assert draws.effective > 50.0


def test_a_frequency_without_error_is_refused():
    with pytest.raises(ValueError, match=r"positive error, got 0\.0 for mode 1B at 4000 N"):
        levels_of(stick(np.full(10, 500.0), 0.0), ("1B", "2B"))


@pytest.fixture(scope="module")
def model():
    bent = np.pad(surface(0.003, 3).coefficients, ((0, 0), (0, 1), (0, 0), (0, 0)))
    bent[2, -1, 0, 0] = 0.01  # the further mode takes one order more than those that are used
    return xr.Dataset(
        {
            "ln_frequency": (("mode", "kn", "kt", "f"), bent),
            "box": (("end", "coordinate"), np.stack([LOW, HIGH])),
            "error_bound": ("mode", np.full(3, 1e-8)),
        },
        coords={"mode": ["1B", "2B", "3B"]},
        attrs={"structure": "toy", "springs": "by area"},
    )


def test_joint_holds_the_truth_and_survives_netcdf(model, tmp_path):
    bias, tilt = (0.003, -0.002), (2e-4, -1e-4)
    theta = np.array([[np.log(1.5e9), np.log(2.0e9), 0.6, *bias, *tilt, 100.0, 0.005]])
    f = np.exp(predict(powers_model(), theta).ln_frequency[0])
    found = joint(model, stick(f), GAUGE, [12e3, 18e3], BIAS)
    low, high = (found["k_quantile"].sel(quantile=q, force=12e3).values for q in (0.025, 0.975))
    assert np.all((low < [1.5e9, 2.0e9]) & (high > [1.5e9, 2.0e9]))
    nearest = found["region_share"].sel(region_kn=1.5e9, region_kt=2.0e9, method="nearest")
    assert nearest < 0.95 < found["region_share"].max()
    assert found["log_evidence"].sel(law="constant") < found["log_evidence"].max() - 3
    assert "mode 3B measured too" in found["option"].values
    assert np.abs(found["level_misfit"]).max() < 1e-3
    for key, variable in found.data_vars.items():
        assert {"units", "long_name"} <= set(variable.attrs), key
    found.to_netcdf(tmp_path / "joint.nc")
    high_only = joint(model, stick(f), GAUGE, [12e3], BIAS, least_force=10e3)
    assert high_only.sizes["level"] == 6
    assert "all forces" in high_only["variation"].values


def test_a_further_mode_of_a_higher_order_joins_those_that_are_used(model):
    made = models_of(model, stick(np.full(10, 500.0)), GAUGE, BIAS)["constant"]
    _, third, others = surfaces_of(model, tuple(BIAS))
    assert others == ("3B",)
    best = map_estimate(made, (0.0,))
    found = expected_information(made, best, REFERENCE_FORCE, third, others)
    assert "mode 3B measured too" in found["option"].values


def test_no_frequency_no_posterior(model):
    given = stick(np.full(10, 500.0))
    one_mode = given.isel(level=np.flatnonzero(given["mode"].values == "1B"))
    for lacking in (given.isel(level=slice(0, 0)), one_mode):
        assert joint(model, lacking, GAUGE, [12e3], BIAS).attrs["law"] == ""
    assert joint(model, given, GAUGE, [12e3], BIAS, least_force=50e3).attrs["law"] == ""


def test_a_mode_that_was_not_measured_is_left_out(model):
    given = stick(np.full(10, 500.0))
    made = models_of(model, given, GAUGE, {**BIAS, "3B": 0.005, "4B": 0.005})["constant"]
    assert made.levels.modes == tuple(BIAS)


def test_modes_and_forces_that_are_not_there_are_named(model):
    given = stick(np.full(10, 500.0))
    with pytest.raises(ValueError, match="lacks modes 2B"):
        joint(model.sel(mode=["1B", "3B"]), given, GAUGE, [12e3], BIAS)
    with pytest.raises(ValueError, match="no stick frequency at 50000 N or above"):
        models_of(model, given, GAUGE, BIAS, least_force=50e3)


def test_copies_of_weighted_draws_count_as_weight():
    rng = np.random.default_rng(6)
    some, points = rng.normal(size=(400, 4)), rng.normal(size=(50, 4))
    once, thrice = share_within(some, points), share_within(np.repeat(some, 3, axis=0), points)
    np.testing.assert_allclose(thrice, once, atol=1e-9)
