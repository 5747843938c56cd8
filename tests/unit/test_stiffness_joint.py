"""The joint inference on surfaces and campaigns whose answers are known."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.stats
import xarray as xr
from bladeroot.rom.chebyshev import Surface
from bladeroot.stiffness.joint import (
    combinations,
    joint,
    ln_stiffness,
    problems_of,
    surfaces_of,
    trimmed,
)
from bladeroot.stiffness.laws import LAWS, PRIORS, REFERENCE_FORCE, powers, slopes
from bladeroot.stiffness.levels import LEAST_STD, levels_of
from bladeroot.stiffness.marginal import marginal, with_biases
from bladeroot.stiffness.posterior import (
    SCATTER,
    bias_rows,
    biases,
    inner_products,
    local,
    log_posterior,
    predict,
    problem_of,
)
from bladeroot.stiffness.region import share_within
from bladeroot.stiffness.sampler import sample
from bladeroot.stiffness.summit import climb, find_summit
from bladeroot.stiffness.worth import worth
from stiffness_bench import FORCE, GAUGE, HIGH, LOW, levels, problem, stick, surface


def test_powers_have_their_slopes():
    step = 1e-3
    numeric = (powers(FORCE + step) - powers(FORCE - step)) / (2 * step)
    np.testing.assert_allclose(slopes(FORCE), numeric, rtol=1e-6, atol=1e-12)


@pytest.mark.parametrize("name", LAWS)
def test_laws_give_what_their_parameters_say(name):
    law = LAWS[name]
    made = problem_of(surface(), levels(), law, np.ones(2), np.zeros(2), (1.0, 1.0))
    value = {"ln_kn": 20.0, "ln_kt": 21.0, "exponent": 0.7, "exponent_kn": 0.6, "exponent_kt": 0.4,
             "bend_kn": 0.1, "bend_kt": -0.2}  # fmt: skip
    theta = np.zeros(len(made.names))
    theta[: len(law.parameters)] = [value[p] for p in law.parameters]
    found = ln_stiffness(made, theta[None], np.array([REFERENCE_FORCE, np.e * REFERENCE_FORCE]))[0]
    rise = {"constant": (0, 0), "one power": (0.7, 0.7), "two powers": (0.6, 0.4),
            "bent powers": (0.7, 0.2)}[name]  # fmt: skip
    np.testing.assert_allclose(found, [[20, 21], [20 + rise[0], 21 + rise[1]]])
    assert set(law.parameters) <= set(PRIORS)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("shared", [True, False])
def test_gradient_is_that_of_the_log_posterior(law, shared):
    made, u = problem(law, shared=shared)
    step = 1e-5
    ends = np.vstack([u + step * np.eye(len(u)), u - step * np.eye(len(u))])
    up, down = np.split(log_posterior(made, ends), 2)
    numeric = (up - down) / (2 * step)
    scale = np.abs(numeric).max()
    np.testing.assert_allclose(local(made, u).gradient, numeric, atol=1e-6 * scale)


@pytest.mark.parametrize("shared", [True, False])
def test_log_posterior_is_a_multivariate_normal_with_the_scatter_in_its_covariance(shared):
    made, u = problem(shared=shared)
    made = replace(made, levels=replace(made.levels, hold_freedom=np.zeros(2)))
    slope = predict(made, u[None]).slope[0, :, :2]
    scatter = np.exp(made.mean[-1] + made.std[-1] * u[-1])
    alike = made.levels.clamping[:, None] == made.levels.clamping
    covariance = 1e-6 * np.eye(len(slope)) + scatter**2 / 2.0 * (slope @ slope.T) * alike
    np.testing.assert_allclose(local(made, u).covariance, covariance, rtol=1e-10)
    rest = made.levels.ln_frequency - predict(made, u[None]).ln_frequency[0]
    expected = scipy.stats.multivariate_normal(cov=covariance).logpdf(rest)
    expected += scipy.stats.norm.logpdf(u).sum()
    assert log_posterior(made, u[None])[0] == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("shared", [True, False])
def test_biases_are_integrated_out_exactly(shared):
    """p(others) = p(others, biases) / p(biases given others), whatever the biases."""
    made, u = problem(shared=shared)
    place = biases(made)
    here = marginal(made, np.delete(u, place)[None])
    covariance = np.linalg.inv(here.information[0])
    given = scipy.stats.multivariate_normal(here.mean[0], covariance)
    expected = log_posterior(made, u[None])[0] - given.logpdf(u[place])
    assert here.log[0] == pytest.approx(expected, rel=1e-9)
    many = with_biases(made, np.tile(np.delete(u, place), (4000, 1)), np.random.default_rng(2))
    np.testing.assert_array_equal(np.delete(many[0], place), np.delete(u, place))
    np.testing.assert_allclose(
        np.cov(many[:, place].T), covariance, atol=0.1 * np.abs(covariance).max()
    )


def test_a_large_scatter_gives_a_number():
    made, u = problem(shared=False)
    u[-1] = 40.0
    assert np.isfinite(log_posterior(made, u[None])[0])


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
    made, u = problem()
    told = replace(made, levels=replace(made.levels, hold_freedom=np.full(2, 400.0)))
    freed = np.ones(len(u), bool)
    freed[-1] = False  # the scatter alone
    end, _ = climb(told, u, held=freed)
    slope = predict(told, u[None]).slope[0, :, :2]
    gain = [(slope[told.levels.mode == m] ** 2).sum(axis=1).mean() for m in range(2)]
    shown = np.mean(told.levels.hold_std**2 / gain)
    assert np.exp(2 * (told.mean[-1] + told.std[-1] * end[-1])) == pytest.approx(shown, rel=0.05)


def test_straight_surface_gives_the_closed_form():
    """Constant stiffness, exact forces, known scatter: generalised least squares with a prior."""
    made, _ = problem("constant", bent=0.0, gauge=(0.0, 0.0))
    held = np.zeros(len(made.names), bool)
    held[-1] = True
    u, here = climb(made, np.zeros(len(held)), held)
    free = np.flatnonzero(~held)
    zero = predict(made, np.zeros((1, len(u)))).ln_frequency[0]
    # the bias enters as ln(1 + b), which is straight to 1e-5 here
    design = here.design[:, free]
    weight = np.linalg.inv(here.covariance)
    exact = np.linalg.inv(design.T @ weight @ design + np.eye(len(free)))
    mean = exact @ design.T @ weight @ (made.levels.ln_frequency - zero)
    np.testing.assert_allclose(u[free], mean, atol=5e-3)
    information = here.information[np.ix_(free, free)]
    np.testing.assert_allclose(np.linalg.inv(information), exact, rtol=1e-6, atol=1e-9)


@pytest.mark.slow
def test_summit_is_one_and_draws_agree_where_the_posterior_is_normal():
    made, _ = problem("constant", bent=0.0, noise=1e-3)
    summit = find_summit(made, (0.0,))
    assert np.abs(local(made, summit.u).gradient).max() < 1e-3
    draws, time = sample(summit, steps=250)
    again, _ = sample(summit, steps=250)
    np.testing.assert_array_equal(draws, again)
    assert 1.0 < time < 200.0
    laplace = np.sqrt(np.diag(summit.theta_covariance))[:2]
    np.testing.assert_allclose(draws[:, :2].std(axis=0), laplace, rtol=0.3)
    assert np.all(np.abs(draws[:, :2].mean(axis=0) - summit.theta[:2]) < 0.5 * laplace)


def test_evidence_is_the_integral_of_the_posterior():
    made, _ = problem("constant", bent=0.0)
    summit = find_summit(made, (0.0,))
    rng = np.random.default_rng(1)
    proposal = scipy.stats.multivariate_t(summit.u, 1.3 * summit.covariance, df=6)
    u = proposal.rvs(4_000, random_state=rng)
    weight = np.exp(log_posterior(made, u) - proposal.logpdf(u) - summit.log_evidence)
    # the scatter's posterior is skew, which Laplace's approximation does not see
    assert weight.mean() == pytest.approx(1.0, abs=0.3)


def test_a_better_gauge_or_a_further_mode_never_hurts():
    made, u = problem()
    theta = made.mean + made.std * u
    third = Surface(surface(0.01, 3).coefficients[2:], LOW, HIGH)
    found = worth(made, theta, REFERENCE_FORCE, third, ("3B",))
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
    np.testing.assert_allclose(found.std, 0.05 / 500.0)  # sqrt(0.03^2 + (0.08 / 2)^2)
    np.testing.assert_allclose(found.hold_std, 1e-3)
    # its own scatter of clampings is not the joint inference's, even where no force repeats one
    once = records | {"hold_freedom": ("level", np.zeros(2 * len(FORCE), int))}
    alone = levels_of(stick(f).drop_dims("record").assign(once), ("1B", "2B"))
    np.testing.assert_allclose(alone.std, found.std)
    np.testing.assert_allclose(levels_of(stick(f, 0.07), ("1B", "2B")).std, 0.07 / 500.0)


def test_one_clean_record_a_mode_and_force_of_one_clamping_has_a_posterior(model):
    """Nothing repeats, and the records' own errors are rounding."""
    made = problem_of(surface(0.003), levels(), LAWS["one power"], np.full(2, 0.005), np.zeros(2),
                      (200.0, 0.01))  # fmt: skip
    f = np.exp(predict(made, np.zeros((1, len(made.names)))).ln_frequency[0])
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
    assert levels_of(given, ("1B", "2B")).std.min() == LEAST_STD
    problems = problems_of(model, given, GAUGE, BIAS)
    summit = find_summit(problems["one power"], starts=(0.0,))
    draws, _ = sample(summit, steps=20)
    assert np.isfinite(draws).all()
    # each frequency in a clamping of its own, and the largest scatter: as by the whole covariance
    alone = problems["one power"]
    alone = replace(alone, levels=replace(alone.levels, clamping=np.arange(len(f))))
    u = np.zeros((1, len(alone.names)))
    u[:, -1] = 4.0
    slope = predict(alone, u).slope
    columns = bias_rows(alone.levels)[None]
    product, determinant = inner_products(alone, slope, u[:, -1], columns)
    scatter = np.exp(SCATTER[0] + 4.0 * SCATTER[1])
    variance = LEAST_STD**2 + scatter**2 * (slope[0, :, :2] ** 2).sum(axis=1)
    np.testing.assert_allclose(determinant, np.log(variance).sum(), rtol=1e-9)
    expected = (columns[0] / variance) @ columns[0].T
    np.testing.assert_allclose(product[0], expected, rtol=1e-3)
    assert np.linalg.eigvalsh(product[0])[0] > 0.0


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


BIAS = {"1B": 0.005, "2B": 0.005}


@pytest.mark.slow
def test_joint_holds_the_truth_and_survives_netcdf(model, tmp_path):
    made = problem_of(surface(0.003), levels(), LAWS["one power"], np.full(2, 0.005), np.zeros(2),
                      (200.0, 0.01))  # fmt: skip
    bias, tilt = (0.003, -0.002), (2e-4, -1e-4)
    theta = np.array([np.log(1.5e9), np.log(2.0e9), 0.6, *bias, *tilt, 100.0, 0.005, np.log(0.02)])
    f = np.exp(predict(made, ((theta - made.mean) / made.std)[None]).ln_frequency[0])
    found = joint(model, stick(f), GAUGE, [12e3, 18e3], BIAS, steps=60)
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
    high_only = joint(model, stick(f), GAUGE, [12e3], BIAS, least_force=10e3, steps=30)
    assert high_only.sizes["level"] == 6
    assert "all forces" in high_only["variation"].values


def test_a_further_mode_of_a_higher_order_joins_those_that_are_used(model):
    made = problems_of(model, stick(np.full(10, 500.0)), GAUGE, BIAS)["constant"]
    _, third, others = surfaces_of(model, tuple(BIAS))
    assert others == ("3B",)
    found = worth(made, made.mean, REFERENCE_FORCE, third, others)
    assert "mode 3B measured too" in found["option"].values


def test_no_frequency_no_posterior(model):
    given = stick(np.full(10, 500.0))
    one_mode = given.isel(level=np.flatnonzero(given["mode"].values == "1B"))
    for lacking in (given.isel(level=slice(0, 0)), one_mode):
        assert joint(model, lacking, GAUGE, [12e3], BIAS).attrs["law"] == ""
    assert joint(model, given, GAUGE, [12e3], BIAS, least_force=50e3).attrs["law"] == ""


def test_a_mode_that_was_not_measured_is_left_out(model):
    given = stick(np.full(10, 500.0))
    made = problems_of(model, given, GAUGE, {**BIAS, "3B": 0.005})["constant"]
    assert made.levels.modes == tuple(BIAS)


def test_modes_and_forces_that_are_not_there_are_named(model):
    given = stick(np.full(10, 500.0))
    with pytest.raises(ValueError, match="lacks modes 4B"):
        joint(model, given, GAUGE, [12e3], {**BIAS, "4B": 0.01})
    with pytest.raises(ValueError, match="no stick frequency at 50000 N or above"):
        problems_of(model, given, GAUGE, BIAS, least_force=50e3)
