"""A stage's code hash follows what it imports, and nothing else."""

import importlib.util
import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from bladeroot import provenance
from bladeroot.provenance import canonical_json, environment, environment_hash

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


def test_so_does_a_file_that_a_module_of_ones_own_names(copy):
    edit(copy / "stage.py", "TABLE = 'prior.txt'\n")
    for name in ("prior.txt", "notes.txt"):
        (copy / name).write_text("1")
    before = code_hash(copy)
    edit(copy / "notes.txt", "2")
    assert code_hash(copy) == before
    edit(copy / "prior.txt", "2")
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


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """A copy of the whole library with its scripts."""
    folder = tmp_path_factory.mktemp("whole")
    for name in ("bladeroot", "scripts"):
        shutil.copytree(
            LIBRARY.parent / name, folder / name, ignore=shutil.ignore_patterns("compiled", "*.pyc")
        )
    return folder


def hash_of(folder, *files):
    """Hash by the copy's own provenance, freshly loaded: it keeps what it has read."""
    path = folder / "bladeroot" / "provenance.py"
    spec = importlib.util.spec_from_file_location("copied_provenance", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.code_hash(*(folder / file for file in files))


# A registry's folder, a file in it, a script that uses it, and one that does not.
REGISTRIES = [
    ("mechanisms", "drift.py", "diagnosis", "theory"),
    ("io/readers", "wav.py", "ringdown", "theory"),
    ("quality/findings", "spike.py", "ringdown", "theory"),
    ("rom/external/readers", "calculix.py", "matrices_reduced", "theory"),
]


@pytest.mark.parametrize(("folder", "file", "script", "other"), REGISTRIES)
def test_a_registry_counts_by_its_files_content_and_names(whole, folder, file, script, other):
    scripts = [f"scripts/{name}.py" for name in (script, other)]
    before = [hash_of(whole, one) for one in scripts]
    path = whole / "bladeroot" / folder / file
    text = path.read_text()

    def changed():
        mine, others = (hash_of(whole, one) for one in scripts)
        assert others == before[1]
        return mine != before[0]

    path.write_text(text + "\n_MORE = 1\n")
    assert changed()
    path.unlink()
    assert changed()
    renamed = path.with_name("renamed.py")
    renamed.write_text(text)
    assert changed()
    path.write_text(text)
    assert changed()  # one more
    renamed.unlink()
    assert not changed()


@pytest.mark.parametrize(
    ("file", "script", "other"),
    [
        ("bladeroot/report/page.css", "report", "theory"),
        ("bladeroot/report/page.html.j2", "report", "theory"),
        ("bladeroot/report/page.js", "report", "theory"),
        ("bladeroot/schemas/structure.schema.yaml", "reduced", "theory"),
        ("bladeroot/schemas/bench.schema.yaml", "bench", "theory"),
    ],
)
def test_what_code_reads_beside_it_counts(whole, file, script, other):
    scripts = [f"scripts/{name}.py" for name in (script, other)]
    before = [hash_of(whole, one) for one in scripts]
    path = whole / file
    text = path.read_text()
    path.write_text(text + "\n")
    after = [hash_of(whole, one) for one in scripts]
    path.write_text(text)
    assert (after[0] != before[0], after[1] == before[1]) == (True, True)


def test_an_own_mechanism_counts_with_what_it_imports(whole, tmp_path, monkeypatch):
    own, beside, elsewhere = (
        tmp_path / name for name in ("own.py", "laws.py", "far/away/__init__.py")
    )
    elsewhere.parent.mkdir(parents=True)
    own.write_text("import laws\nfrom away import A\n")
    beside.write_text("A = 1\n")
    elsewhere.write_text("A = 1\n")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path / "far"))
    seen = {hash_of(whole, "scripts/diagnosis.py", own)}
    for path in (own, beside, elsewhere):
        path.write_text(path.read_text() + "B = 2\n")
        seen.add(hash_of(whole, "scripts/diagnosis.py", own))
    seen.add(hash_of(whole, "scripts/diagnosis.py"))
    assert len(seen) == 5


def test_the_environment_names_what_computes_and_can_be_kept(monkeypatch):
    text = environment()
    assert text.startswith("python ")
    assert all(f", {name} " in text for name in provenance.NUMERICAL)
    before = environment_hash()
    assert before == environment_hash(keep=text)
    monkeypatch.setattr(provenance, "environment", lambda: text.replace("numpy ", "numpy 9"))
    assert environment_hash() != before
    assert environment_hash(keep=text) == before


def test_settings_hold_no_tag_of_a_page():
    text = canonical_json({"title": "</script><script>alert(1)</script>"})
    assert not set("<>") & set(text)
    assert json.loads(text) == {"title": "</script><script>alert(1)</script>"}
