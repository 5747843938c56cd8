"""Probabilities of sets of causes: priors, temper, several kinds of data."""

import numpy as np
import pytest
from bladeroot.diagnosis import guards
from bladeroot.diagnosis.posterior import (
    NONE,
    UNKNOWN,
    Weighed,
    as_shown,
    conditional,
    credible,
    entropy,
    inclusion,
    labelled,
    probabilities,
    together,
    with_unspoken,
)
from hypothesis import given
from hypothesis import strategies as st

A, B, AB = frozenset("a"), frozenset("b"), frozenset("ab")
EMPTY = frozenset()
nats = st.floats(-20.0, 2000.0)


@given(nats, nats, nats, nats)
def test_they_sum_to_one_and_the_better_explained_of_one_size_is_more_probable(a, b, both, smooth):
    sets = probabilities(
        [Weighed(EMPTY, 0.0, smooth), Weighed(A, a), Weighed(B, b), Weighed(AB, both)]
    )
    assert sum(sets.values()) == pytest.approx(1.0)
    assert (sets[A] - sets[B]) * (a - b) >= 0.0


def test_without_evidence_the_prior_is_left():
    sets = probabilities([Weighed(EMPTY, 0.0, 0.0), Weighed(A, 0.0)])
    assert np.log(sets[EMPTY] / sets[A]) == pytest.approx(guards.PRIOR)
    assert np.log(sets[EMPTY] / sets[frozenset({UNKNOWN})]) == pytest.approx(guards.PRIOR_UNKNOWN)


def test_stated_groups_that_a_law_cannot_be_told_from_share_its_probability():
    sets = probabilities([Weighed(EMPTY, 0.0, -3.0, 20.0), Weighed(A, 20.0)])
    assert sets[A] == pytest.approx(sets[frozenset({UNKNOWN})], rel=1e-3)


def test_a_small_part_of_a_large_effect_makes_no_second_cause():
    """Three per cent of what is explained are much by themselves, and little beside it."""
    alone = probabilities([Weighed(EMPTY, 0.0), Weighed(B, 15.0)])
    beside = probabilities([Weighed(EMPTY, 0.0), Weighed(A, 500.0), Weighed(AB, 515.0)])
    assert inclusion(alone, "b") > guards.CERTAIN
    assert inclusion(beside, "b") < 0.1
    assert inclusion(beside, "a") > 0.999


def test_a_test_of_a_cause_asks_for_no_law():
    """The same nats of the data, beside so large an effect, may be the first law's error."""
    law = [Weighed(EMPTY, 0.0), Weighed(A, 300.0), Weighed(AB, 308.0)]
    tested = [Weighed(EMPTY, 0.0), Weighed(A, 300.0), Weighed(AB, 300.0)]
    assert inclusion(probabilities(law), "b") < 0.1
    assert inclusion(probabilities(tested, tests={"b": 8.0}), "b") > guards.CERTAIN


@pytest.mark.parametrize("misfit", [0.0, 0.3, 0.99])
def test_what_a_law_misses_by_more_than_laws_do_is_of_no_catalogue(misfit):
    """Of two causes either may be what is none; what the law explains is explained all the same."""
    sets = probabilities([Weighed(EMPTY, 0.0), Weighed(A, 60.0, misfit=misfit)])
    assert inclusion(sets, UNKNOWN) == pytest.approx(misfit, abs=1e-6)
    assert inclusion(sets, "a") == pytest.approx(1.0 - misfit, abs=1e-6)
    both = probabilities([Weighed(EMPTY, 0.0), Weighed(AB, 60.0, misfit=misfit)])
    assert both.get(A | {UNKNOWN}, 0.0) == pytest.approx(0.5 * misfit, abs=1e-6)


def test_cruder_laws_make_evidence_count_less():
    rows = [Weighed(EMPTY, 0.0), Weighed(A, 300.0), Weighed(B, 290.0)]
    fine, crude = (inclusion(probabilities(rows, trust=trust), "a") for trust in (0.05, 0.2))
    assert 0.5 < crude < fine


def test_few_clampings_make_evidence_count_less():
    rows = [Weighed(EMPTY, 0.0), Weighed(A, 8.0)]
    assert inclusion(probabilities(rows, replicates=False), "a") < inclusion(
        probabilities(rows), "a"
    )


def test_kinds_of_data_speak_of_different_causes():
    """Two of them together are rarer than by chance, by one factor for each beside the first."""
    sets = together([{EMPTY: 0.2, A: 0.8}, {EMPTY: 0.4, B: 0.5, frozenset({UNKNOWN}): 0.1}])
    named = labelled(sets)
    rarer = np.exp(-guards.FURTHER)
    assert named["a+b"] / named["a"] == pytest.approx(0.5 / 0.4 * rarer)
    assert named["a"] / named[NONE] == pytest.approx(0.8 / 0.2)
    assert named[f"a+{UNKNOWN}"] / named["a"] == pytest.approx(0.1 / 0.4 * rarer)
    assert sum(named.values()) == pytest.approx(1.0)
    assert list(named.values()) == sorted(named.values(), reverse=True)


def test_the_credible_set_is_of_the_fewest_sets_that_reach_its_part():
    sets = {EMPTY: 0.7, A: 0.15, AB: 0.11, B: 0.04}
    assert credible(sets) == pytest.approx({"none": 0.7, "a": 0.26, "b": 0.15})
    assert credible({A: 0.97, B: 0.03}) == {"a": 0.97}
    assert "none-of-these" in credible({EMPTY: 0.5, frozenset({UNKNOWN}): 0.5})


def test_causes_at_their_prior_count_as_nothing_however_many():
    prior = float(np.exp(-guards.PRIOR))
    weights = {EMPTY: 1.0} | {frozenset({f"level {k}"}): prior for k in range(8)}
    total = sum(weights.values())
    sets = {key: value / total for key, value in weights.items()}
    assert as_shown(sets) == {EMPTY: pytest.approx(1.0)}
    raised = {EMPTY: 0.5, A: 0.4, B: 0.06, AB: 0.04}
    assert as_shown(raised) == pytest.approx({EMPTY: 0.56, A: 0.44})


def test_a_rival_of_what_is_surely_there_does_not_count_as_nothing():
    assert EMPTY not in as_shown({A: 0.9, B: 0.08, AB: 0.02})


def test_what_the_data_cannot_speak_of_keeps_its_prior():
    sets = with_unspoken({EMPTY: 0.75, A: 0.25}, ["c"])
    assert sum(sets.values()) == pytest.approx(1.0)
    odds = inclusion(sets, "c") / (1.0 - inclusion(sets, "c"))
    assert odds == pytest.approx(np.exp(-guards.PRIOR))
    assert inclusion(sets, "a") == pytest.approx(0.25)


def test_what_acts_beside_causes_is_judged_as_if_these_were_there():
    sets = {EMPTY: 0.2, A: 0.3, B: 0.4, AB: 0.1}
    assert conditional(sets, "a") == pytest.approx({EMPTY: 0.75, B: 0.25})
    assert conditional(sets, "") == pytest.approx(sets)


def test_entropy_is_that_of_equal_odds_at_most():
    assert entropy({A: 1.0, B: 0.0}) == 0.0
    assert entropy({A: 0.5, B: 0.5}) == pytest.approx(np.log(2.0))
