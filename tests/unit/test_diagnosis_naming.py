"""Sets of causes: what a law explains by its mean, causes made needless, forms, what is barred."""

from dataclasses import replace

import numpy as np
import pytest
from bladeroot.diagnosis import guards, naming
from bladeroot.diagnosis.channel import Channel
from bladeroot.diagnosis.families import Known, baseline
from bladeroot.diagnosis.naming import _Search, search
from bladeroot.diagnosis.plausibility import explained_by_law, law_misfit
from bladeroot.diagnosis.posterior import UNKNOWN, inclusion
from bladeroot.inference.gaussian import fit
from bladeroot.inference.problem import Prior, Problem, State
from bladeroot.mechanisms.mechanism import Mechanism, Parameter

SIZE = 12


def line(name, shape, low=-100.0, high=100.0):
    """A cause whose effect is a size times a shape, in standard deviations of the data."""

    def damping(records, values):
        return values[0] * shape, shape[:, None]

    size = Parameter("size", "1", 0.0, 30.0, low, high, "made up")
    return Mechanism(name, "force-law", name, (size,), "none", damping=damping)


def channel(data, candidates, trust=0.0, smooth=None):
    """Data of unit noise; each law is trusted to a part of its own effect, point by point.

    `smooth`, shape (k, SIZE): shapes of which the smooth competitor is any sum.
    """
    kernels = {"anything": [(smooth.T @ smooth, 20.0)]} if smooth is not None else {}

    def problem(mechanisms, extra):
        def predict(theta):
            parts = [one.damping(None, theta[k : k + 1]) for k, one in enumerate(mechanisms)]
            effects = np.array([mean for mean, _ in parts]).reshape(-1, SIZE)
            slope = np.hstack([np.zeros((SIZE, 0)), *(slope for _, slope in parts)])
            return State(effects.sum(axis=0), slope, {"effects": effects})

        def covariance(state, scales):
            parts = [
                np.exp(2.0 * s) * kernel for s, kernel in zip(scales, covariances, strict=True)
            ]
            crude = trust**2 * np.diag((state.facts["effects"] ** 2).sum(axis=0))
            return sum(parts) + crude, lambda: [2.0 * part for part in parts]

        covariances = [np.eye(SIZE), *(unit for unit, _ in extra)]
        prior = Prior(np.zeros(len(mechanisms)), np.full(len(mechanisms), 30.0))
        scales = Prior(
            np.log([1.0, *(size for _, size in extra)]), np.array([1e-3, *[1.0] * len(extra)])
        )
        return Problem(data, predict, covariance, prior, scales)

    return Channel("toy", problem, 0, tuple(candidates), lambda _: kernels, {})


def named(found):
    return {cause.mechanism.id for cause in found.causes}


@pytest.fixture
def shapes():
    return np.linalg.qr(np.random.default_rng(3).standard_normal((SIZE, 4)))[0].T


def test_a_cause_that_later_ones_make_needless_is_dropped(shapes):
    """One shape alone comes nearest to a sum of two others; with both in the model it is idle."""
    a, b, c, _ = shapes
    truth = 0.8 * a + 0.6 * b
    both = [line("a", a), line("b", b)]
    found = search(channel(40.0 * truth, [*both, line("c", 0.837 * truth + 0.547 * c)]), Known())
    assert max(found.steps[0].mechanisms, key=found.steps[0].mechanisms.get) == "c"
    assert named(found) == {"a", "b"}
    size = dict(
        zip([one.mechanism.id for one in found.causes], found.final.parameters, strict=True)
    )
    assert size == pytest.approx({"a": 32.0, "b": 24.0}, abs=0.5)


def test_as_a_model_of_noise_a_law_explains_nothing():
    """Its error would cover what the data scatter, its mean is none of it."""
    scatter = 20.0 * np.random.default_rng(4).choice([-1.0, 1.0], SIZE)
    even = line("even", np.ones(SIZE))
    loose = channel(scatter - scatter.mean(), [even], trust=1.0)
    without, with_it = (fit(loose.problem(chosen, ()), np.full(len(chosen), 20.0))
                        for chosen in ((), (even,)))  # fmt: skip
    assert with_it.log_evidence > without.log_evidence + 100.0
    assert explained_by_law(without, with_it) < 0.0
    assert named(search(loose, Known())) == set()


def test_a_law_of_the_right_course_explains_whatever_size_its_error_allows():
    """A crude law is fitted too large, as its error then covers more of what it misses."""
    course = np.linspace(0.5, 1.5, SIZE)
    bent = line("bent", course * (1.0 + 0.1 * np.cos(3.0 * np.arange(SIZE))))
    crude = channel(200.0 * course, [bent], trust=0.1)
    without, with_it = (fit(crude.problem(chosen, ()), np.full(len(chosen), 200.0))
                        for chosen in ((), (bent,)))  # fmt: skip

    def at(size):
        theta = np.array([size])
        return replace(with_it, parameters=theta, state=with_it.problem.predict(theta))

    whole = explained_by_law(without, with_it)
    assert whole > 1000.0
    assert explained_by_law(without, at(600.0)) > 0.9 * whole
    assert explained_by_law(without, at(-200.0)) < 0.0


def test_a_law_is_none_of_the_catalogue_by_its_own_error(shapes):
    """Half as likely as not at `guards.LAW_MISFIT` times the trust; never where there is no law."""
    some = channel(40.0 * shapes[0], [line("a", shapes[0])])
    made = fit(some.problem(some.candidates, ()), np.full(1, 40.0))
    at = [
        law_misfit(
            some, replace(made, scales=np.log([error]), scales_covariance=np.array([[0.16]]))
        )
        for error in (0.3, guards.LAW_MISFIT, 10.0)
    ]
    assert at == pytest.approx([0.0, 0.5, 1.0], abs=1e-3)
    assert law_misfit(replace(some, name="curve"), replace(made, scales=np.log([10.0]))) == 0.0
    assert law_misfit(some, replace(fit(some.problem((), ())), scales=np.log([10.0]))) == 0.0


def test_a_right_law_is_not_noise_where_its_error_took_what_the_rest_explains(shapes):
    """Beside the law's error it pays to leave a free parameter near its prior; without it, not."""
    a, _, c, _ = shapes
    free = np.column_stack([a, c])

    def problem(mechanisms):
        def predict(theta):
            size = theta[2:]
            effects = np.outer(size, a + 0.5 * c)
            slope = np.column_stack([free, *([a + 0.5 * c] * size.size)])
            return State(slope @ theta, slope, {"effects": effects})

        def covariance(state, scales):
            crude = np.diag((state.facts["effects"] ** 2).sum(axis=0))
            return np.exp(2.0 * scales[0]) * np.eye(SIZE) + crude, lambda: [2.0 * np.eye(SIZE)]

        std = np.array([10.0, 30.0, *[1e3] * mechanisms])
        scales = Prior(np.zeros(1), np.array([1e-3]))
        return Problem(200.0 * a, predict, covariance, Prior(np.zeros(std.size), std), scales)

    without, with_it = fit(problem(0)), fit(problem(1), np.array([0.0, 0.0, 200.0]))
    assert with_it.log_evidence > without.log_evidence + 50.0
    assert explained_by_law(without, with_it) > 50.0


def test_what_a_looser_law_explains_better_is_no_certain_name():
    """One law explains two points by its mean, another all of them as a model of noise."""
    scatter = 20.0 * np.tile([1.0, 1.0, -1.0, -1.0], SIZE // 4)
    two = line("two", (np.arange(SIZE) < 2).astype(float))
    loose = replace(line("loose", np.ones(SIZE)), starts=((30.0,),))
    alone = search(channel(scatter, [two], trust=0.2), Known())
    both = search(channel(scatter, [loose, two], trust=0.2), Known())
    assert both.alone["loose"].log_evidence > both.alone["two"].log_evidence
    assert [one.credible for one in alone.causes] == [("two",)]
    assert [one.credible for one in both.causes] == [("two", "loose")]


def test_a_crude_law_explains_by_its_mean(shapes):
    """What a law is wrong by does not count against it."""
    a, _, c, _ = shapes
    found = search(channel(40.0 * a + 5.0 * c, [line("a", a)], trust=0.5), Known())
    assert named(found) == {"a"}


def test_a_new_cause_must_leave_the_earlier_ones_possible(shapes):
    """With the second one the first would have to be larger than it can be."""
    a, b, *_ = shapes
    near = 0.9 * a + np.sqrt(1 - 0.81) * b
    data = 60.0 * a - 40.0 * near
    first = line("first", a, high=30.0)
    alone = search(channel(data, [first]), Known())
    found = search(channel(data, [first, line("second", near)]), Known())
    assert named(alone) == {"first"}
    assert named(found) == {"first"}


def test_two_causes_are_found_where_the_smooth_competitor_beats_each(shapes):
    """Neither alone leaves nothing smooth, both do."""
    a, b, c, _ = shapes
    both = [line("a", a), line("b", b)]
    made = channel(40.0 * a + 35.0 * b, [*both, line("c", c)], smooth=np.array([a, b]))
    found = search(made, Known())
    step = found.steps[0]
    assert step.smooth["anything"] > max(step.mechanisms.values()) + 4.0
    assert named(found) == {"a", "b"}
    assert all(cause.probability > 0.5 for cause in found.causes)
    assert found.unexplained == ""


def test_laws_that_miss_too_much_leave_sets_that_were_not_fitted(shapes, monkeypatch):
    """Of three such causes any may be none of the catalogue; which two are left is not tried."""
    a, b, c, _ = shapes
    monkeypatch.setattr(
        naming, "law_misfit", lambda _, fitted: 0.999 * (len(fitted.state.facts["effects"]) == 3)
    )
    laws = [line("a", a), line("b", b), line("c", c)]
    found = search(channel(60.0 * a + 40.0 * (b + c), laws, smooth=np.array([b + c])), Known())
    assert frozenset("bc") not in found.models
    assert inclusion(found.probabilities, UNKNOWN) > guards.CERTAIN


def test_what_only_the_smooth_competitor_explains_stays_unexplained(shapes):
    """A part has a law in the catalogue; it is not named for that."""
    a, b, c, unknown = shapes
    candidates = [line("a", a), line("b", b), line("c", c)]
    found = search(
        channel(40.0 * a + 35.0 * unknown, candidates, smooth=np.array([a, unknown])), Known()
    )
    assert (named(found), found.unexplained) == (set(), "anything")


def test_a_name_is_certain_by_the_family_not_by_the_form(shapes):
    """Two forms of one mechanism share the evidence; another as good makes it ambiguous."""
    a, b, *_ = shapes
    near = 0.999 * a + np.sqrt(1 - 0.999**2) * b
    alone = line("a", a)
    family = replace(alone, forms=(replace(line("a", near), form="near"),))
    for candidates, sure in (([family], True), ([alone, line("rival", near)], False)):
        found = search(channel(10.0 * a, candidates), Known())
        (cause,) = found.causes
        assert (cause.credible == ("a",)) is sure
        assert (cause.probability > guards.CERTAIN) is sure


def test_a_form_that_fits_best_where_it_cannot_be_does_not_take_the_name(shapes):
    a, b, *_ = shapes
    near = 0.98 * a + np.sqrt(1 - 0.98**2) * b
    family = replace(line("a", near), forms=(replace(line("a", a, high=5.0), form="exact"),))
    found = search(channel(20.0 * a, [family], trust=0.1), Known())
    (cause,) = found.causes
    assert (cause.mechanism.id, cause.mechanism.form) == ("a", "")
    assert cause.probability > guards.CERTAIN


def test_a_size_is_over_forms_and_over_the_sets_that_hold_it(shapes):
    """Forms as good as each other whose first parameters differ: their spread is in its error."""
    a, b, *_ = shapes
    family = replace(line("a", a), forms=(replace(line("a", 0.5 * a), form="half"),))
    found = search(channel(10.0 * a, [family]), Known())
    mean, std = found.sizes["a"]
    assert 10.0 < mean < 20.0
    assert std > 4.0
    alone = search(channel(10.0 * a, [line("a", a), line("b", b)]), Known())
    assert alone.sizes["a"] == pytest.approx((10.0, 1.0), rel=0.02)
    near = 0.8 * a + 0.6 * b
    found = search(channel(10.0 * a + 6.0 * near, [line("a", a), line("near", near)]), Known())
    mean, std = found.sizes["a"]
    assert found.alone["a"].size("a")[0] == pytest.approx(14.8, rel=0.02)
    assert 10.0 < mean < 14.8
    assert std > 1.2 * found.alone["a"].size("a")[1]


def test_a_cause_that_is_left_out_takes_its_test_along(shapes):
    a, b, *_ = shapes
    tested = replace(line("a", a), measured_by="scale")
    channel_ = channel(20.0 * a + 15.0 * b, [tested, line("b", b)])
    made = _Search(channel_, Known(splits={"scale": (20.0, 1.0)}))
    made.expand(baseline(channel_))
    made.expand(made.models[frozenset("a")])
    rest = made.without(made.models[frozenset("ab")], "a")
    assert rest.log_evidence == pytest.approx(made.models[frozenset("b")].log_evidence, abs=0.1)


def test_nothing_below_three_standard_deviations_is_named(shapes):
    """Evidence by a free scale is none where the size is not known from nothing."""
    a, *_ = shapes
    for size, names in ((2.5, set()), (9.0, {"a"})):
        assert named(search(channel(size * a, [line("a", a)]), Known())) == names


def test_what_is_barred_and_explains_best_is_told(shapes):
    a, b, *_ = shapes
    near = 0.8 * a + 0.6 * b
    both = [line("a", a), line("near", near)]
    found = search(channel(20.0 * a, both), Known(barred={"a": "too few records"}))
    assert found.insufficient == "a"
    assert "a" not in named(found)
    ruled_out = search(channel(20.0 * a, both), Known(ruled_out={"a": "so it says"}))
    assert ruled_out.insufficient == ""
    assert named(ruled_out) == {"near"}


def test_where_all_are_barred_the_leading_one_holds_its_probability(shapes):
    """And nothing leads where the data show nothing."""
    a, b, *_ = shapes
    both = [line("a", a), line("b", b)]
    why = dict.fromkeys("ab", "one load")
    found = search(channel(20.0 * a, both), Known(barred=why))
    assert (found.insufficient, named(found)) == ("a", set())
    assert inclusion(found.probabilities, "a") > guards.CERTAIN
    assert inclusion(found.probabilities, UNKNOWN) < 0.1
    assert search(channel(0.5 * a, both), Known(barred=why)).insufficient == ""


def test_what_only_an_impossible_size_explains_is_of_no_catalogue(shapes):
    """It does not make the next best law the cause."""
    a, b, *_ = shapes
    near = 0.8 * a + 0.6 * b
    found = search(channel(60.0 * a, [line("small", a, high=30.0), line("near", near)]), Known())
    assert inclusion(found.probabilities, UNKNOWN) > guards.CERTAIN
    assert named(found) <= {"near"}
    assert all(UNKNOWN in cause.credible for cause in found.causes)
