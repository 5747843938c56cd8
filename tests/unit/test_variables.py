"""The registry of output variables: a row a variable, and nothing written without one."""

import csv
from collections import Counter

import pytest
from bladeroot import variables

TABLES = sorted(variables._LIBRARY.glob("*/variables.csv"))


@pytest.mark.parametrize("path", TABLES, ids=lambda path: path.parent.name)
def test_every_variable_has_one_row_with_a_meaning(path):
    with path.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    twice = [key for key, n in Counter((r["table"], r["variable"]) for r in rows).items() if n > 1]
    assert not twice
    assert all(row["long_name"] and None not in row.values() for row in rows)


def test_a_dataset_has_dims_and_attributes_of_its_rows():
    made = variables.dataset("stiffness/search", {"gain": [[1.0, 2.0]], "mode": ["1B", "2B"]})
    assert made["gain"].dims == ("stiffness", "mode")
    assert made["gain"].attrs["units"] == "1/Hz"
    assert made["mode"].attrs["long_name"] == "name of the mode"


def test_what_has_no_row_is_named():
    with pytest.raises(KeyError, match="no row for kx in table stiffness/search"):
        variables.dataset("stiffness/search", {"kx": 1.0})
