"""Imports run one way, and the virtual bench shares no code with what infers."""

import ast
import importlib
import importlib.util
import tomllib
from functools import cache
from pathlib import Path

import pytest

LIBRARY = Path(__file__).resolve().parents[2] / "workflow" / "bladeroot"
# What each room may import besides itself and the plain files at the library's top.
ALLOWED = {
    "signal": set(),
    "io": {"signal"},
    "quality": {"signal"},
    "plateau": {"signal"},
    "decay": {"signal", "io", "quality", "plateau"},
    "pooling": {"plateau"},
    "fem": set(),
    "rom": {"fem"},
    "contact": set(),
    "nonlinear": {"contact", "rom"},
    "inference": set(),
    "stiffness": {"pooling", "rom", "nonlinear", "inference"},
    "mechanisms": {"contact", "rom"},
    "diagnosis": {"pooling", "rom", "stiffness", "mechanisms", "inference"},
    "bench": set(),
    "reproduction": {
        "signal",
        "quality",
        "decay",
        "plateau",
        "fem",
        "rom",
        "contact",
        "inference",
        "stiffness",
    },
    "figures": set(),
    "report": {"figures"},
    "command": {
        "artifacts",
        "statement",
        "runs",
        "io",
        "signal",
        "public",
        "report",
        "__version__",
    },
    "public": {
        "artifacts",
        "figures",
        "io",
        "signal",
        "decay",
        "pooling",
        "fem",
        "rom",
        "inference",
        "mechanisms",
        "diagnosis",
        "bench",
        "reproduction",
    },
}
# Plain files that a room may use: the bench stands alone but for the compiler, the others share
# what checks files, what artifacts say of the load, and words.
COMPILER = {"compiled"}
SHARED = {
    "schema", "checksum", "files", "hdf5_links", "loads", "shipped_files", "terms", "variables",
}  # fmt: skip


def imported_rooms(room):
    """First part below `bladeroot` of everything that a room's files import."""
    return rooms_used((LIBRARY / room).rglob("*.py")) - {room}


def rooms_used(files):
    return set().union(*map(rooms_of, files))


@cache
def rooms_of(path):
    found = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: write the whole name of an import"
            names = [node.module, *(f"{node.module}.{alias.name}" for alias in node.names)]
        elif isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        else:
            continue
        parts = [name.split(".") for name in names]
        found |= {part[1] for part in parts if part[0] == "bladeroot" and len(part) > 1}
    return found


def test_every_room_is_listed():
    rooms = {path.parent.name for path in LIBRARY.glob("*/__init__.py")}
    assert rooms == set(ALLOWED)


@pytest.mark.parametrize("room", ALLOWED)
def test_a_room_imports_only_what_it_may(room):
    shared = set() if room == "bench" else SHARED
    assert imported_rooms(room) <= ALLOWED[room] | shared | COMPILER


def test_the_analysis_of_samples_reads_no_file():
    readers = [path for path in (LIBRARY / "decay").glob("*.py") if "io" in rooms_of(path)]
    assert [path.name for path in readers] == ["from_file.py"]


def test_nothing_but_its_own_script_uses_the_bench():
    users = {room for room in ALLOWED if "bench" in imported_rooms(room)}
    assert users == {"public"}  # br.diagnose lets it make the raw files of a simulated campaign
    scripts = LIBRARY.parents[0] / "scripts"
    using = {path.name for path in scripts.glob("*.py") if "bladeroot.bench" in path.read_text()}
    assert using == {"bench.py"}


def test_no_inference_reads_the_truth():
    rules = LIBRARY.parents[0] / "rules"
    reading = {path.name for path in rules.glob("*.smk") if "truth" in path.read_text()}
    assert reading == {"bench.smk", "report.smk"}  # made by the bench, read by its score alone


def test_the_blind_laboratory_uses_the_bench_alone():
    """What makes and seals a case shares no code with what diagnoses it, files in between."""
    used = rooms_used((LIBRARY.parents[1] / "tests" / "blind").glob("*.py"))
    assert used - COMPILER == {"bench", "artifacts"}


def test_bench_and_inference_share_no_function():
    """No two functions of a dozen lines or more are the same code under other names."""
    own = long_functions((LIBRARY / "bench").rglob("*.py"))
    others = [path for path in LIBRARY.rglob("*.py") if "bench" not in path.parts]
    assert not own & long_functions(others)


def long_functions(files):
    """Bodies of functions, docstrings out, names of variables and functions taken away."""
    found = set()
    for path in files:
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.FunctionDef) and node.end_lineno - node.lineno > 12:
                body = node.body[1:] if ast.get_docstring(node) else node.body
                for part in (inner for one in body for inner in ast.walk(one)):
                    for field in ("id", "arg", "attr", "name"):
                        if hasattr(part, field):
                            setattr(part, field, "_")
                found.add("\n".join(ast.dump(one) for one in body))
    return found


def test_a_wheel_carries_every_file_of_the_library_that_is_no_code():
    said = tomllib.loads((LIBRARY.parents[1] / "pyproject.toml").read_text(encoding="utf-8"))
    packed = said["tool"]["setuptools"]["package-data"]["bladeroot"]
    carried = {path for pattern in packed for path in LIBRARY.glob(pattern)}
    files = {path for path in LIBRARY.rglob("*.*") if "__pycache__" not in path.parts}
    assert {path for path in files if path.suffix != ".py" and path.is_file()} <= carried


def test_benchmarks_import_only_what_is_there():
    lacking = []
    for path in (LIBRARY.parents[1] / "benchmarks").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("bladeroot"):
                room = importlib.import_module(node.module)
                for one in node.names:
                    module = f"{node.module}.{one.name}"
                    if not hasattr(room, one.name) and not importlib.util.find_spec(module):
                        lacking.append(f"{path.name}: {module}")
    assert lacking == []
