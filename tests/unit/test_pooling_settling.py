"""First cycles that differ from settled records are left out, slip that all records show is not."""

import numpy as np
import pytest
from bladeroot.pooling.curves import unsettled

LADDER = np.geomspace(1e-5, 1e-3, 81)


def records(rng, starts, scatter=0.02):
    """Loss factors of one law with a scatter of each record; NaN above its start."""
    law = 1e-3 * (1.0 + 0.5 * (LADDER / 1e-3))
    value = law * (1.0 + scatter * rng.standard_normal((len(starts), 1)))
    return np.where(starts[:, None] >= LADDER, value, np.nan)


STARTS = np.geomspace(2e-4, 1e-3, 12)


def test_settled_records_are_left_alone():
    doubted = 0
    for seed in range(50):
        value = records(np.random.default_rng(seed), STARTS)
        doubted += unsettled(LADDER, STARTS, value, 1e-3 * value).any(axis=1).sum()
    assert doubted <= 3  # 1 in 1000 records is expected


@pytest.mark.parametrize("cycles", [1, 4])
def test_first_cycles_unlike_all_others_are_left_out(cycles):
    value = records(np.random.default_rng(3), STARTS)
    own = np.flatnonzero(np.isfinite(value[2]))[-cycles:]
    value[2, own] *= 1.4
    found = unsettled(LADDER, STARTS, value, 1e-3 * value)
    assert set(np.flatnonzero(found[2])) == set(own)
    assert not np.delete(found, 2, axis=0).any()


def test_slip_that_begins_in_every_record_stays():
    value = records(np.random.default_rng(4), STARTS) * (1.0 + np.maximum(LADDER / 3e-4 - 1.0, 0.0))
    assert not unsettled(LADDER, STARTS, value, 1e-3 * value).any()


def test_a_record_that_is_another_decay_throughout_stays():
    value = records(np.random.default_rng(5), STARTS)
    value[2] *= 1.5
    assert not unsettled(LADDER, STARTS, value, 1e-3 * value)[2].any()


def test_too_few_settled_records_say_nothing():
    value = records(np.random.default_rng(6), STARTS[-4:])
    value[0, np.flatnonzero(np.isfinite(value[0]))[-2:]] *= 3.0
    assert not unsettled(LADDER, STARTS[-4:], value, 1e-3 * value).any()
