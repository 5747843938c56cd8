"""What a change makes Snakemake do again: exactly what depends on it. Read from its job table."""

import pytest

SHEET = "resources/campaigns/small/records.csv"
AGGREGATES = {"stick": 1, "fe_forces": 1, "stiffness": 1, "joint": 1, "amplitude": 1, "theory": 1,
              "score": 1, "figures": 1, "figures_records": 1, "figures_stick": 1,
              "figures_amplitude": 1, "curves": 1, "integrity": 1, "observations": 1,
              "diagnosis": 1, "verdict": 1, "figures_diagnosis": 1, "report": 1}  # fmt: skip
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


def test_a_search_setting_redoes_the_search_and_what_follows(restored):
    restored.edit("config/config.yaml", "1B: 0.5", "1B: 0.4")
    assert restored.planned() == {
        **SEARCHES, "stiffness": 1, "joint": 1, "amplitude": 1, "theory": 1, "figures": 1,
        "figures_amplitude": 1, "report": 1, "diagnosis": 1, "verdict": 1,
        "figures_diagnosis": 1,
    }  # fmt: skip


def test_another_estimator_and_a_new_force_redo_no_structure(restored):
    """The one redoes decays, the other maps; neither makes a record or a body anew."""
    restored.edit("config/config.yaml", "[12, 16]", "[12, 14, 16]")
    planned = restored.planned("--config", "decay={estimator: thesis}")
    assert planned["ringdown"] > 0
    assert (planned["frequency_maps"], planned["search"]) == (1, 1)
    assert planned["reduced"] + planned["bench"] + planned["parametric"] == 0


def test_changed_library_code_redoes_its_stages(restored):
    """What else a stage's code stands on: tests/unit/test_provenance.py."""
    for module in ("decay/freevib.py", "rom/greedy.py"):
        path = restored.folder / "workflow" / "bladeroot" / module
        path.write_text(path.read_text() + "\n\n_changed = True\n")
    planned = restored.planned()
    assert planned["ringdown"] >= 1
    assert planned["parametric"] == planned["report"] == 1
    assert planned["bench"] + planned["mesh"] + planned["reduced"] == 0


def test_a_second_run_a_comment_and_the_order_of_settings_redo_nothing(restored):
    path = restored.folder / "workflow" / "bladeroot" / "decay" / "freevib.py"
    path.write_text(path.read_text() + "\n# A remark.\n")
    restored.edit("config/config.yaml", "{1B: 0.5, 2B: 0.6}", "{2B: 0.6, 1B: 0.5}")
    assert restored.planned() == {}
