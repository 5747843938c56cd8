"""What a change makes Snakemake do again: exactly what depends on it. Read from its job table."""

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


def test_a_second_run_does_nothing(house):
    assert house.planned() == {}


def test_an_added_record_redoes_itself_and_what_aggregates_it(restored):
    sheet = restored.folder / SHEET
    last = sheet.read_text().splitlines()[-1].split(",")
    added = ["r900", "r900.nc", *last[2:]]
    sheet.write_text(sheet.read_text().rstrip() + "\n" + ",".join(added) + "\n")
    assert restored.planned() == {
        "bench": 1, "ringdown": 1, **AGGREGATES, **SEARCHES,
    }  # fmt: skip


def test_a_record_inserted_in_the_middle_moves_no_other(restored):
    sheet = restored.folder / SHEET
    lines = sheet.read_text().splitlines()
    added = ["r900", "r900.nc", *lines[1].split(",")[2:]]
    sheet.write_text("\n".join([*lines[:2], ",".join(added), *lines[2:]]) + "\n")
    planned = restored.planned()
    assert (planned["bench"], planned["ringdown"]) == (1, 1)


def test_an_excluded_record_redoes_its_batch_and_what_aggregates_it(restored):
    sheet = restored.folder / SHEET
    lines = sheet.read_text().splitlines()
    lines = [f"{lines[0]},exclude", f"{lines[1]},yes", *(f"{line}," for line in lines[2:])]
    sheet.write_text("\n".join(lines) + "\n")
    assert restored.planned() == {"bench": 1, "ringdown": 1, **AGGREGATES, **SEARCHES}


def test_a_search_setting_redoes_the_search_and_what_follows(restored):
    restored.edit("config/config.yaml", "1B: 0.5", "1B: 0.4")
    assert restored.planned() == {
        **SEARCHES, "stiffness": 1, "joint": 1, "amplitude": 1, "theory": 1,
        "report": 1, "diagnosis": 1, "verdict": 1,
    }  # fmt: skip


def test_another_estimator_redoes_the_decays_and_no_structure(restored):
    asked = restored.planned("--config", "decay={estimator: thesis}")
    assert asked["ringdown"] > 0
    assert asked["bench"] + asked["frequency_maps"] == 0
    restored.edit("config/config.yaml", "estimator: blocks", "estimator: thesis")
    assert restored.planned() == asked


def test_swapping_two_settings_is_noticed(restored):
    restored.edit("config/config.yaml", "{1B: 0.5, 2B: 0.6}", "{1B: 0.6, 2B: 0.5}")
    assert restored.planned()["search"] == 1


def test_a_new_force_redoes_the_maps_and_no_structure(restored):
    restored.edit("config/config.yaml", "[12, 16]", "[12, 14, 16]")
    planned = restored.planned()
    assert (planned["frequency_maps"], planned["search"]) == (1, 1)
    assert planned["ringdown"] + planned["reduced"] + planned["bench"] + planned["parametric"] == 0


@pytest.mark.parametrize(
    ("module", "first", "never"),
    [
        ("decay/freevib.py", "ringdown", ["bench", "reduced"]),
        ("stiffness/interpolation.py", "fe_forces", ["stick", "frequency_maps"]),
        ("rom/reduction.py", "reduced", ["mesh", "prestress"]),
        ("rom/greedy.py", "parametric", ["reduced", "ringdown"]),
        ("decay/cut.py", "ringdown", ["bench", "reduced"]),
        ("io/readers/netcdf.py", "ringdown", ["bench", "reduced"]),
    ],
)
def test_changed_library_code_redoes_its_stage(restored, module, first, never):
    path = restored.folder / "workflow" / "bladeroot" / module
    path.write_text(path.read_text() + "\n\n_changed = True\n")
    planned = restored.planned()
    assert planned[first] >= 1
    assert planned["report"] == 1
    assert all(planned[rule] == 0 for rule in never)


def test_a_comment_in_the_library_and_the_order_of_settings_redo_nothing(restored):
    path = restored.folder / "workflow" / "bladeroot" / "decay" / "freevib.py"
    path.write_text(path.read_text() + "\n# A remark.\n")
    restored.edit("config/config.yaml", "{1B: 0.5, 2B: 0.6}", "{2B: 0.6, 1B: 0.5}")
    assert restored.planned() == {}
