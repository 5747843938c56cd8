import numpy as np
import pandas as pd
import pytest
from bladeroot.reproduction.cases import RIGID, Case, Mode
from bladeroot.reproduction.targets import targets_of
from structure_coarse import ROOT


@pytest.fixture(scope="module")
def tables():
    return {path.stem: pd.read_csv(path) for path in ROOT.glob("resources/thesis/table_*.csv")}


def test_numbers_of_each_table(tables):
    every = ("2.2", "4.1", "4.1 without pad", "4.2", "4.3", "4.3 as lateral", "4.4", "5.2")
    found = targets_of(tables, dict.fromkeys(every, 0.5))
    count = {name: sum(one.table == name for one in found) for name in every}
    assert list(count.values()) == [3, 6, 6, 6, 2, 2, 2, 12]
    assert len({(one.table, one.mode, one.case) for one in found}) == len(found)
    fixed = [one for one in found if one.table in ("4.3", "4.4")]
    assert [one.reference for one in fixed] == [519, 1171, 562, 1525]
    assert [one.case.kt for one in fixed] == [0, 0, RIGID, RIGID]


def test_the_joint_is_at_the_published_stiffness_of_all_nodes(tables):
    first, second, *_ = targets_of(tables, {"5.2": 0.5})
    assert first.case == second.case
    assert first.case.kn == pytest.approx(33 * 41428.6e3)
    assert (first.reference, second.reference) == pytest.approx((539.05, 1445.57), abs=0.01)


def test_tolerance_adds_rounding_to_the_model(tables):
    one = targets_of(tables, {"4.4": 0.4})[0]
    assert one.tolerance == pytest.approx(np.hypot(0.004 * 562, 1 / np.sqrt(12)))


def test_a_slope_is_of_squares_between_rest_and_force(tables):
    found = {one.mode: one for one in targets_of(tables, {"4.2": 1.0})}
    rest, pulled = Case(True), Case(True, 30e3)

    def mode(case, frequency):
        return Mode(case, (2 * np.pi * frequency) ** 2, np.zeros((1, 3)))

    modes = {
        (rest, "1Fy"): mode(rest, 476.8),
        (pulled, "1Fy"): mode(pulled, 596.6),
        (pulled, "Ry"): mode(pulled, 182.2),
    }
    for name in ("1Fy", "Ry"):
        assert found[name].value(modes) == pytest.approx(found[name].reference, rel=2e-3)
