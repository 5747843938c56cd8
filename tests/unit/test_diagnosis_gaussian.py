"""Fits with Gaussian errors: evidence, scales and hold-out against closed forms."""

import numpy as np
import pytest
from bladeroot.inference.gaussian import _ahead, _point, best_fit, fit
from bladeroot.inference.hold_out import asked_along, asked_for, hold_out
from bladeroot.inference.problem import Prior, Problem, State, with_known_errors
from scipy.stats import multivariate_normal

X = np.linspace(-1.0, 1.0, 12)
GROUP = np.repeat(np.arange(4), 3)
PRIOR = Prior(np.array([0.5, -0.2]), np.array([2.0, 1.0]))


def straight_line(data, scales):
    """A line whose groups share an error of unknown size; the noise is known."""
    design = np.stack([np.ones_like(X), X], axis=1)
    same = (GROUP[:, None] == GROUP).astype(float)

    def covariance(state, s):
        shared = np.exp(2.0 * s[0]) * same
        return shared + 0.01 * np.eye(X.size), lambda: [2.0 * shared]

    return Problem(data, lambda t: State(design @ t, design, {}), covariance, PRIOR, scales)


def drawn(seed, shared=0.3):
    rng = np.random.default_rng(seed)
    return 1.0 + 0.5 * X + shared * rng.standard_normal(4)[GROUP] + 0.1 * rng.standard_normal(12)


def test_evidence_of_a_linear_model_is_the_data_density():
    known = Prior(np.array([np.log(0.3)]), np.array([1e-4]))
    found = fit(straight_line(drawn(1), known))
    design = np.stack([np.ones_like(X), X], axis=1)
    same = GROUP[:, None] == GROUP
    whole = 0.09 * same + 0.01 * np.eye(12) + (design * PRIOR.std**2) @ design.T
    exact = multivariate_normal(design @ PRIOR.mean, whole).logpdf(drawn(1))
    assert found.log_evidence == pytest.approx(exact, abs=1e-3)


def test_a_group_left_out_is_predicted_as_by_a_fit_without_it():
    known = Prior(np.array([np.log(0.3)]), np.array([1e-4]))
    data = drawn(2)
    held = hold_out(fit(straight_line(data, known)), GROUP)
    design = np.stack([np.ones_like(X), X], axis=1)
    whole = 0.09 * (GROUP[:, None] == GROUP) + 0.01 * np.eye(12)
    whole = whole + (design * PRIOR.std**2) @ design.T
    mean = design @ PRIOR.mean
    out, rest = GROUP == 2, GROUP != 2
    gain = whole[np.ix_(out, rest)] @ np.linalg.inv(whole[np.ix_(rest, rest)])
    said = mean[out] + gain @ (data - mean)[rest]
    spread = whole[np.ix_(out, out)] - gain @ whole[np.ix_(rest, out)]
    assert held.error[out] == pytest.approx((data[out] - said), abs=1e-6)
    score = multivariate_normal(said, spread).logpdf(data[out])
    assert held.log_score[2] == pytest.approx(score, abs=1e-3)


def test_a_prediction_may_go_without_a_parameter_that_the_rest_of_the_data_taught():
    known = Prior(np.array([np.log(0.3)]), np.array([1e-4]))
    data = drawn(2)
    held = hold_out(fit(straight_line(data, known)), GROUP, slice(1, 2))
    design = np.stack([np.ones_like(X), X], axis=1)
    out, rest = GROUP == 2, GROUP != 2
    covariance = (0.09 * (GROUP[:, None] == GROUP) + 0.01 * np.eye(12))[np.ix_(rest, rest)]
    weighted = np.linalg.solve(covariance, design[rest])
    curve = weighted.T @ design[rest] + np.diag(1.0 / PRIOR.std**2)
    pull = weighted.T @ data[rest] + PRIOR.mean / PRIOR.std**2
    level, slope = np.linalg.solve(curve, pull)
    assert abs(slope - PRIOR.mean[1]) > 0.3
    assert held.error[out] == pytest.approx(data[out] - level - PRIOR.mean[1] * X[out], abs=1e-6)
    whole = hold_out(fit(straight_line(data, known)), GROUP)
    assert held.log_score == pytest.approx(whole.log_score)


def test_the_scale_is_that_of_most_marginal_likelihood():
    free = Prior(np.array([np.log(0.1)]), np.array([3.0]))
    found = fit(straight_line(drawn(3), free))
    design = np.stack([np.ones_like(X), X], axis=1)
    grid = np.linspace(-5.0, 2.0, 1401)

    def density(s):
        whole = np.exp(2.0 * s) * (GROUP[:, None] == GROUP) + 0.01 * np.eye(12)
        whole = whole + (design * PRIOR.std**2) @ design.T
        prior = -0.5 * ((s - np.log(0.1)) / 3.0) ** 2
        return multivariate_normal(design @ PRIOR.mean, whole).logpdf(drawn(3)) + prior

    best = grid[np.argmax([density(s) for s in grid])]
    assert found.scales[0] == pytest.approx(best, abs=0.05)


def test_of_several_starts_the_better_maximum_wins():
    """A mean with two maxima; the start beside the lower one must not decide."""

    def predict(t):
        mean = np.full(5, t[0] ** 2 - 0.5 * t[0])
        return State(mean, np.full((5, 1), 2.0 * t[0] - 0.5), {})

    def covariance(state, s):
        return 0.01 * np.eye(5), list

    none = Prior(np.zeros(0), np.zeros(0))
    problem = Problem(np.full(5, 1.5), predict, covariance, Prior(np.zeros(1), np.ones(1)), none)
    found = best_fit(problem, [np.array([3.0]), np.array([-3.0])])
    assert found.parameters[0] == pytest.approx(-1.0, abs=0.01)


def test_a_further_covariance_is_asked_for_where_the_misses_have_it():
    unit = np.equal.outer(GROUP, GROUP).astype(float)
    none = Prior(np.zeros(0), np.ones(0))
    design = np.stack([np.ones_like(X), X], axis=1)
    noise = np.random.default_rng(4).standard_normal((400, X.size))
    asked = []
    for shared in (0.0, 0.3):
        steps = np.random.default_rng(5).standard_normal((400, 4))[:, GROUP]
        for data in 0.1 * noise + shared * steps:
            problem = Problem(
                data,
                lambda t: State(design @ t, design, {}),
                lambda state, s: (0.01 * np.eye(X.size), list),
                PRIOR,
                none,
            )
            asked.append(asked_for(fit(problem), unit))
    without, beside = np.array(asked).reshape(2, -1)
    assert abs(without.mean()) < 0.25
    assert without.std() == pytest.approx(1.0, abs=0.25)
    assert np.median(beside) > 5.0


def test_further_parameters_are_asked_for_by_the_misfit_that_they_take_off():
    found = fit(straight_line(drawn(2), Prior(np.array([np.log(0.3)]), np.array([1e-4]))))
    slope = np.stack([X**2, np.tanh(9.0 * (X - 0.3))], axis=1)
    root = np.linalg.cholesky(found.precision).T
    best = np.linalg.lstsq(root @ slope, root @ found.residual, rcond=None)[0]
    before, after = (
        rest @ found.precision @ rest for rest in (found.residual, found.residual - slope @ best)
    )
    assert asked_along(found, slope) == pytest.approx(before - after, rel=1e-9)
    doubled = np.column_stack([slope, slope[:, 0]])
    assert asked_along(found, doubled) == pytest.approx(before - after, rel=1e-6)


def test_a_model_too_steep_for_its_rounding_has_no_evidence():
    """A misfit that rounding makes negative would count as boundless evidence."""
    steep = 1e9 * np.stack([np.ones_like(X), 1.0 + 1e-12 * X], axis=1)
    noise = np.full(X.size, 1e-4)
    made = Problem(
        1e3 * drawn(1), lambda t: State(steep @ t, steep, {}),
        lambda state, s: (np.diag(noise**2), list), Prior(np.zeros(2), np.full(2, 1e6)),
        Prior(np.zeros(0), np.zeros(0)),
    )  # fmt: skip
    assert fit(made).log_evidence < 0.0


def test_a_step_ends_somewhere_where_the_model_is_flat_and_steep_by_turns():
    """Without a bound the first step goes to where e^x is beyond all numbers."""

    def predict(t):
        with np.errstate(over="ignore"):
            mean = np.exp(t[0]) + np.exp(t[1])
            return State(np.full(5, mean), np.tile(np.exp(t), (5, 1)), {})

    none = Prior(np.zeros(0), np.zeros(0))
    prior = Prior(np.full(2, -12.0), np.full(2, 3.0))
    made = Problem(np.ones(5), predict, lambda state, s: (1e-8 * np.eye(5), list), prior, none)
    found = fit(made)
    assert np.exp(found.parameters).sum() == pytest.approx(1.0, abs=1e-3)
    assert np.isfinite(found.log_evidence)


@pytest.mark.parametrize("turning", [False, True])
def test_steps_that_lead_too_far_are_shortened(turning):
    """Newton's steps from there go ever farther off."""
    turns = (lambda *_: (np.zeros((5, 1)), np.zeros(1))) if turning else None

    def predict(t):
        slope = np.full((5, 1), 10.0 / (1.0 + t[0] ** 2))
        return State(np.full(5, 10.0 * np.arctan(t[0])), slope, {}, turns=turns)

    none = Prior(np.zeros(0), np.zeros(0))
    prior = Prior(np.zeros(1), np.array([4.0]))
    made = Problem(np.zeros(5), predict, lambda state, s: (1e-4 * np.eye(5), list), prior, none)
    for start in (2.0, 6.0, -30.0):
        assert fit(made, np.array([start])).parameters[0] == pytest.approx(0.0, abs=1e-4)


def test_scales_and_parameters_that_mean_the_same_are_found_together():
    """What scatters by an unknown size times an unknown slope: the data tell the product alone, so
    that neither may wander off as the other follows.
    """
    rng, group = np.random.default_rng(6), np.repeat(np.arange(8), 4)
    same = (group[:, None] == group).astype(float)
    data = 0.5 * rng.standard_normal(8)[group] + 0.1 * rng.standard_normal(32)

    def predict(t):
        spread = np.exp(2.0 * t)

        def turns(s, vector, matrix):
            turned = 2.0 * np.exp(2.0 * s[0]) * spread * same
            return (turned @ vector)[:, None], np.array([np.sum(turned * matrix)])

        return State(np.zeros(32), np.zeros((32, 1)), {"spread": spread}, turns=turns)

    def covariance(state, s):
        shared = np.exp(2.0 * s[0]) * state.facts["spread"] * same
        return shared + 0.01 * np.eye(32), lambda: [2.0 * shared]

    made = Problem(
        data, predict, covariance, Prior(np.zeros(1), np.ones(1)), Prior(np.zeros(1), np.ones(1))
    )
    ends = [fit(made, np.array([t]), np.array([s])) for t, s in ((3.0, -3.0), (-2.0, 2.0), (0, 0))]
    grid = np.linspace(-3.0, 1.0, 401)
    # of the sum, whose prior has twice the variance
    best = min(
        grid, key=lambda u: -multivariate_normal(
            np.zeros(32), np.exp(2.0 * u) * same + 0.01 * np.eye(32)).logpdf(data) + u**2 / 4.0
    )  # fmt: skip
    for end in ends:
        assert end.parameters[0] + end.scales[0] == pytest.approx(best, abs=0.05)
    assert np.ptp([end.log_evidence for end in ends]) < 0.05


@pytest.mark.parametrize("part", [0.5, 0.9])
def test_steps_of_a_geometric_series_go_on_to_its_end(part):
    """Three points that near the maximum, each by a part of what was left."""
    slope, best = np.eye(3)[:, :2], np.array([0.3, -0.2])
    prior = Prior(np.zeros(2), np.full(2, 1e6))
    problem = with_known_errors(
        slope @ best, lambda t: State(slope @ t, slope, {}), 1e-4 * np.eye(3), prior
    )
    away = np.array([0.1, 0.05])
    nearing = [_point(problem, best + part**k * away, np.zeros(0)) for k in range(3)]
    np.testing.assert_allclose(_ahead(*nearing).parameters, best, atol=1e-9)
    leaving = [_point(problem, best + k * away, np.zeros(0)) for k in (1.0, 1.9, 2.71)]
    assert _ahead(*leaving) is leaving[2]
