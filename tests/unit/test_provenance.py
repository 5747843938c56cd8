"""A stage's code hash follows what it imports, and nothing else."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from bladeroot.provenance import canonical_json

LIBRARY = Path(__file__).resolve().parents[2] / "workflow" / "bladeroot"


@pytest.fixture
def copy(tmp_path):
    """A small library of the same name with a script that imports part of it."""
    package = tmp_path / "bladeroot"
    (package / "room").mkdir(parents=True)
    shutil.copy(LIBRARY / "provenance.py", package)
    (package / "__init__.py").write_text('"""Package."""\n')
    (package / "room" / "__init__.py").write_text('"""Room."""\n')
    (package / "room" / "used.py").write_text(
        '"""Used."""\n\nfrom .deep import g\n\n\ndef f():\n    return g()\n'
    )
    (package / "room" / "deep.py").write_text("def g():\n    return 1\n")
    (package / "room" / "late.py").write_text("value = 3\n")
    (package / "room" / "unused.py").write_text("value = 4\n")
    (package / "registry").mkdir()
    (package / "registry" / "__init__.py").write_text('"""Found by themselves."""\n')
    (package / "registry" / "found.py").write_text("value = 5\n")
    (tmp_path / "_beside.py").write_text("value = 6\n")
    (tmp_path / "stage.py").write_text(
        "from _beside import value\nfrom bladeroot import registry\n"
        "from bladeroot.room import used\n\n\ndef main():\n    import bladeroot.room.late\n"
    )
    return tmp_path


def code_hash(folder):
    command = "from bladeroot.provenance import code_hash; print(code_hash('stage.py'))"
    run = subprocess.run(
        [sys.executable, "-c", command],
        cwd=folder,
        env={"PYTHONPATH": str(folder)},
        capture_output=True,
        text=True,
        check=True,
    )
    return run.stdout


def edit(path, text):
    path.write_text(path.read_text() + text)


@pytest.mark.parametrize("module", ["used", "deep", "late"])
def test_a_change_of_any_imported_module_changes_the_hash(copy, module):
    before = code_hash(copy)
    edit(copy / "bladeroot" / "room" / f"{module}.py", "\nconstant = 5\n")
    assert code_hash(copy) != before


@pytest.mark.parametrize("path", ["bladeroot/registry/found.py", "_beside.py"])
def test_so_does_a_change_of_what_is_found_by_itself_or_lies_beside(copy, path):
    before = code_hash(copy)
    edit(copy / path, "\nconstant = 5\n")
    assert code_hash(copy) != before


def test_a_change_of_the_script_changes_the_hash(copy):
    before = code_hash(copy)
    edit(copy / "stage.py", "\nmain()\n")
    assert code_hash(copy) != before


def test_comments_docstrings_and_other_modules_change_nothing(copy):
    before = code_hash(copy)
    edit(copy / "bladeroot" / "room" / "unused.py", "\nconstant = 5\n")
    edit(copy / "bladeroot" / "room" / "deep.py", "# a remark\n\n\n")
    used = copy / "bladeroot" / "room" / "used.py"
    used.write_text(used.read_text().replace("Used.", "Used by the stage, described at length."))
    assert code_hash(copy) == before


@pytest.mark.parametrize("damaged", ["no JSON", "null", "[1]", '{"a": {}}', '{"a": 3}'])
def test_what_earlier_runs_kept_changes_no_hash(copy, damaged):
    first, again = code_hash(copy), code_hash(copy)
    (kept,) = (copy / "bladeroot" / "__pycache__").glob("sources-*.json")
    whole = json.loads(kept.read_text())
    kept.write_text(damaged)
    assert first == again == code_hash(copy)
    assert json.loads(kept.read_text()) == whole


def test_equal_settings_give_equal_text():
    assert canonical_json({"b": 1, "a": [1.5, None]}) == canonical_json({"a": [1.5, None], "b": 1})
    assert canonical_json({"a": 1, "b": 2}) != canonical_json({"a": 2, "b": 1})


def test_settings_that_are_not_numbers_are_refused():
    with pytest.raises(ValueError, match="Out of range"):
        canonical_json({"a": float("nan")})
