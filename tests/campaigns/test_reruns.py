"""How many jobs a change makes Snakemake do again; test_rerun_table.py has which, a case a line."""

import pytest

SHEET = "resources/campaigns/small/records.csv"
AGGREGATES = {"stick": 1, "fe_forces": 1, "stiffness": 1, "joint": 1, "amplitude": 1, "theory": 1,
              "score": 1, "curves": 1, "integrity": 1, "observations": 1, "diagnosis": 1,
              "verdict": 1, "report": 1}  # fmt: skip
SEARCHES = {"search": 1}


@pytest.fixture
def restored(house):
    """Put the house's sources back after a test, whatever it did to them."""
    kept = {
        path: path.read_bytes()
        for folder in ("workflow", "config", "resources")
        for path in (house.folder / folder).rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    yield house
    for path, content in kept.items():
        if path.read_bytes() != content:
            path.write_bytes(content)


def test_an_added_record_redoes_itself_and_what_aggregates_it(restored):
    """Wherever it stands in the sheet, it moves no other."""
    sheet = restored.folder / SHEET
    lines = sheet.read_text().splitlines()
    added = ["r900", "r900.nc", *lines[1].split(",")[2:]]
    sheet.write_text("\n".join([*lines[:2], ",".join(added), *lines[2:]]) + "\n")
    assert restored.planned() == {"bench": 1, "ringdown": 1, **AGGREGATES, **SEARCHES}


def test_another_estimator_and_a_new_force_redo_no_structure(restored):
    """The one redoes decays, the other maps; neither makes a record or a body anew."""
    restored.edit("config/config.yaml", "[12, 16]", "[12, 14, 16]")
    planned = restored.planned("--config", "decay={estimator: thesis}")
    assert planned["ringdown"] > 0
    assert (planned["frequency_maps"], planned["search"]) == (1, 1)
    assert planned["reduced"] + planned["bench"] + planned["parametric"] == 0
