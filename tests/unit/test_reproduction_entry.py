"""Verdicts follow from numbers and tolerance; entries that cannot be compared are refused."""

import numpy as np
import pandas as pd
import pytest
from bladeroot.reproduction.entry import Entry, best, compare, printed_values, verdict

BASE = {"id": "x", "chapter": "2", "where": "Table 2.2", "what": "f"}


def judged(computed, **changes):
    entry = Entry(**BASE | {"printed": [100.0, 200.0], "computed": "q"} | changes)
    labels, printed = printed_values(entry, {})
    values = compare(entry, labels, printed, np.array(computed))
    return verdict(entry, values), values


@pytest.mark.parametrize(
    ("computed", "tolerance", "expected"),
    [
        ([101.0, 202.0], {"relative": 0.01}, "reproduced"),
        ([101.1, 202.0], {"relative": 0.01}, "differs"),
        ([101.1, 202.0], {"relative": 0.01, "absolute": 2.0}, "reproduced"),
        ([101.0, np.nan], {"relative": 0.01}, "reproduced"),  # not computed in this run
        ([np.nan, np.nan], {"relative": 0.01}, "differs"),
    ],
)
def test_verdict_by_tolerance(computed, tolerance, expected):
    assert judged(computed, tolerance=tolerance)[0] == expected


@pytest.mark.parametrize(
    ("computed", "ends", "expected"),
    [
        ([0.5], [None, 0.5], "reproduced"),
        ([0.6], [None, 0.5], "differs"),
        ([0.4], [0.5, None], "differs"),
        ([0.7, 0.4], [0.3, 0.8], "reproduced"),
        ([np.nan], [None, 1.0], "differs"),
        ([np.nan], [0.0, None], "differs"),
        ([np.inf], [0.0, None], "differs"),
    ],
)
def test_verdict_by_range(computed, ends, expected):
    assert judged(computed, printed=None, says="s", range=ends)[0] == expected


def test_an_erratum_explains_only_a_difference():
    tolerance = {"relative": 0.01}
    assert judged([100.0, 300.0], tolerance=tolerance, errata=["e"])[0] == "erratum"
    assert judged([100.0, 200.0], tolerance=tolerance, errata=["e"])[0] == "reproduced"


def test_what_is_not_computed_must_say_what_is_missing():
    with pytest.raises(ValueError, match=r"x: .*missing"):
        Entry(**BASE)
    with pytest.raises(ValueError, match=r"x: .*tolerance or range"):
        Entry(**BASE, computed="q", printed=1.0)
    with pytest.raises(ValueError, match="x: 2 values printed, 3 computed"):
        judged([1.0, 2.0, 3.0], tolerance={"absolute": 1.0})


def test_the_closest_variant_is_taken():
    candidates = {
        name: judged(computed, tolerance={"absolute": 1.0})[1]
        for name, computed in (
            ("far", [100.0, 250.0]), ("near", [100.5, 200.5]), ("nearer", [100.1, 200.1]),
            ("none", [np.nan, np.nan]),
        )
    }  # fmt: skip
    assert best(candidates) == "nearer"
    assert best({name: candidates[name] for name in ("far", "none")}) == "far"


def test_printed_values_of_a_table():
    table = pd.DataFrame({"mode": ["a", "b", "a"], "force": [1.0, 2.0, 3.5], "f": [4, 5, 6]})
    given = {"table": "t", "column": "f", "label": ["mode", "force"], "rows": "mode == 'a'"}
    entry = Entry(**BASE, printed=given, reason="r")
    labels, values = printed_values(entry, {"t": table})
    assert labels == ["a, 1", "a, 3.5"]
    assert list(values) == [4.0, 6.0]
