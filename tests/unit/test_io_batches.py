"""Batches of records: whole, small enough, and unmoved by what happens to others."""

import pytest
from bladeroot.io.batches import batches
from hypothesis import given, settings
from hypothesis import strategies as st

NAME = st.integers(0, 10**6).map("r{}".format)
NAMES = st.sets(NAME, max_size=80)


@settings(max_examples=30)
@given(NAMES, st.integers(1, 12))
def test_every_record_is_in_one_batch_of_at_most_that_many(names, most):
    made = batches(names, most)
    assert sorted(name for batch in made.values() for name in batch) == sorted(names)
    assert all(1 <= len(batch) <= most for batch in made.values())


@settings(max_examples=30)
@given(NAMES, st.integers(1, 12), st.data())
def test_a_new_record_changes_its_own_batch_alone(names, most, data):
    new = data.draw(NAME.filter(lambda n: n not in names))
    before, after = batches(names, most), batches(names | {new}, most)
    (home,) = (batch for batch, held in after.items() if new in held)
    for batch, held in before.items():
        if not home.startswith(batch):  # it neither took the record in nor was halved by it
            assert after[batch] == held


@settings(max_examples=30)
@given(NAMES)
def test_the_order_of_the_sheet_does_not_matter(names):
    assert batches(sorted(names), 7) == batches(sorted(names, reverse=True), 7)


def test_large_campaigns_make_batches_that_are_half_full():
    made = batches([f"r{k:05d}" for k in range(10_000)], 32)
    assert max(map(len, made.values())) <= 32
    assert 10_000 / len(made) > 16


@pytest.mark.parametrize(("names", "most"), [(["a", "a"], 4), (["a"], 0)])
def test_names_that_repeat_and_batches_of_nothing_are_refused(names, most):
    with pytest.raises(ValueError, match="must"):
        batches(names, most)
