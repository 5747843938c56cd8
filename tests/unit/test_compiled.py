"""Compiled functions follow the code of other modules, and survive any fault of their cache."""

import os
import shutil
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from bladeroot import compiled
from forked import forked

LIBRARY = Path(compiled.__file__).parent


@pytest.fixture
def library(tmp_path_factory):
    """A small library of the same name, in which one compiled function calls another's."""
    folder = tmp_path_factory.mktemp("library")
    room = folder / "bladeroot" / "room"
    room.mkdir(parents=True)
    for name in ("compiled.py", "provenance.py"):
        shutil.copy(LIBRARY / name, folder / "bladeroot")
    for package in (room, room.parent):
        (package / "__init__.py").touch()
    (room / "scale.py").write_text("SCALE = 3.0\n")
    write_callee(folder, 2.0)
    (room / "caller.py").write_text(
        "from bladeroot.compiled import njit\nfrom bladeroot.room.callee import times\n"
        "from bladeroot.room.scale import SCALE\n\n\n"
        "@njit(cache=True)\ndef call(x):\n    return SCALE * times(x)\n"
    )
    return folder


def write_callee(library, factor):
    (library / "bladeroot" / "room" / "callee.py").write_text(
        "from bladeroot.compiled import njit\n\n\n"
        f"@njit(cache=True)\ndef times(x):\n    return {factor} * x\n"
    )


def run(library, **environment):
    """What the compiled function gives, and how often it was found in the cache."""

    def call():
        # Python itself keeps a source that was rewritten within a second and has the same length
        sys.dont_write_bytecode = True
        from bladeroot.room.caller import call

        print(call(1.0), sum(call.stats.cache_hits.values()))

    done = forked(call, library, {"PYTHONPATH": str(library), "HOME": str(library)} | environment)
    assert done.returncode == 0, done.stderr
    value, hits = done.stdout.split()
    return float(value), int(hits)


def test_an_edited_callee_or_constant_is_compiled_in(library):
    scale = library / "bladeroot" / "room" / "scale.py"
    assert run(library) == (6.0, 0)
    write_callee(library, 2.5)
    assert run(library) == (7.5, 0)
    write_callee(library, 2.0)
    scale.write_text("SCALE = 4.0\n")
    assert run(library) == (8.0, 0)
    scale.write_text("SCALE = 3.0\n")
    assert run(library) == (6.0, 1)  # what was compiled before is still there


def test_a_damaged_cache_is_made_again(library):
    assert run(library)[0] == 6.0
    for suffix, content in (("nbi", b""), ("nbc", b"no pickle")):
        for path in (library / "bladeroot" / "__pycache__" / "compiled").rglob(f"*.{suffix}"):
            path.write_bytes(content)
        assert run(library) == (6.0, 0)
    assert run(library) == (6.0, 1)


def test_of_processes_that_start_together_one_compiles(library):
    with ThreadPoolExecutor() as pool:
        found = sorted(pool.map(run, [library] * 3))
    assert found == [(6.0, 0), (6.0, 1), (6.0, 1)]


def test_where_nothing_can_be_written_it_compiles(library, tmp_path):
    """A file where the cache's folder would be, in all places."""
    copy = tmp_path / "copy"
    shutil.copytree(library, copy, ignore=shutil.ignore_patterns("__pycache__"))
    (copy / "bladeroot" / "__pycache__").touch()
    places = {"NUMBA_CACHE_DIR": "/dev/null/asked", "XDG_CACHE_HOME": "/dev/null/user"}
    assert run(copy, **places) == (6.0, 0)
    places["XDG_CACHE_HOME"] = str(tmp_path / "user")
    assert run(copy, **places) == (6.0, 0)
    assert run(copy, **places) == (6.0, 1)


def test_only_the_last_used_folders_of_a_module_are_kept(tmp_path):
    for k in range(7):
        for name in (f"room.caller-{k}", f"room.caller-more-{k}"):
            (tmp_path / name).mkdir()
            os.utime(tmp_path / name, (k, k))
    compiled._prune(tmp_path, "room.caller")
    kept = sorted(path.name for path in tmp_path.glob("room.caller-[0-9]"))
    assert kept == [f"room.caller-{k}" for k in range(7 - compiled._KEPT_FOLDERS, 7)]
    assert len(list(tmp_path.glob("room.caller-more-*"))) == 7


def test_all_compiled_functions_are_kept_so():
    """numba's own decorator would miss an edited callee."""
    using = [
        path.name
        for path in LIBRARY.rglob("*.py")
        if any(word in path.read_text() for word in ("import numba", "from numba"))
    ]
    assert using == ["compiled.py"]
