"""A user's own mechanisms that end the program, never end, or are none: a footnote, not the end."""

import re

import pytest
from answers import answer, in_time
from bladeroot.mechanisms import own_files
from bladeroot.mechanisms.catalogue import catalogue, usable_catalogue
from bladeroot.report.diagnosis import _not_tried
from xarray import Dataset

GOOD = """import numpy as np
from bladeroot.mechanisms.mechanism import Mechanism, Parameter, StickEffect

SIZE = Parameter("size", "1", 0.1, 0.05, -1.0, 1.0, "made up")


def stick(records, values):
    {body}
    return StickEffect(
        changes={{"ln_f": values[0] * np.ones(records.force.size)}},
        slopes={{"ln_f": np.ones((records.force.size, 1))}},
    )


MECHANISM = Mechanism("{id}", "level", "a law", (SIZE,), "none", stick=stick)
"""
SOURCES = {
    "ends": ("import sys\nsys.exit()", "ends the program|SystemExit"),
    "ends with a text": ("raise SystemExit('bye')", "ends the program|SystemExit"),
    "ends at once": ("import os\nos._exit(0)", "ends the program"),
    "ends well": ("import os\nos._exit(3)", "ends the program"),
    "kills itself": ("import os\nos.kill(os.getpid(), 9)", "SIGKILL"),
    "aborts": ("import faulthandler, os\nfaulthandler.disable()\nos.abort()", "SIGABRT"),
    "crashes": (
        "import ctypes, faulthandler\nfaulthandler.disable()\nctypes.string_at(0)",
        "SIGSEGV",
    ),
    "never ends": ("while True:\n    pass", "does not end"),
    "sleeps": ("import time\ntime.sleep(1e6)", "does not end"),
    "never ends in C": ("sum(range(10**15))", "does not end"),
    "never ends, catching all": (
        "while True:\n    try:\n        while True:\n            pass\n"
        "    except BaseException:\n        pass",
        "does not end",
    ),
    "waits for input": ("input()", "EOFError|OSError|does not end"),
    "raises": ("1 / 0", "ZeroDivisionError"),
    "imports what is not there": ("import nothing_of_that_name", "ModuleNotFoundError"),
    "imports itself": ("import own", "ModuleNotFoundError"),
    "recursion": ("def f():\n    f()\n\n\nf()", "RecursionError"),
    "nothing": ("", "expected MECHANISM"),
    "another thing": ("MECHANISM = 'drift'", "expected MECHANISM"),
    "law ends": (GOOD.format(body="raise SystemExit", id="own"), "ends the program|SystemExit"),
    "law never ends": (GOOD.format(body="while True:\n        pass", id="own"), "does not end"),
    "law raises": (GOOD.format(body="raise KeyError('a')", id="own"), "hook stick: KeyError"),
    "law returns nothing": (GOOD.format(body="return None", id="own"), "hook stick"),
}


@pytest.mark.parametrize("case", SOURCES)
def test_a_failing_file_leaves_the_others(case, tmp_path, monkeypatch):
    monkeypatch.setattr(
        own_files, "PATIENCE_S", 0.5 if "does not end" in SOURCES[case][1] else 20.0
    )
    source, told = SOURCES[case]
    (tmp_path / "own.py").write_text(source)
    (tmp_path / "zz.py").write_text(GOOD.format(body="pass", id="wire"))
    with in_time():
        found, faults = usable_catalogue(tmp_path)
    assert len(faults) == 1
    assert "own.py" in faults[0]
    assert re.search(told, faults[0]), faults[0]
    assert {one.id for one in found} == {*(one.id for one in catalogue()), "wire"}
    note = _not_tried(Dataset(attrs={"mechanisms_not_tried": "; ".join(faults)}))
    assert "own.py" in note[0]


def test_no_failing_file_no_footnote(tmp_path):
    (tmp_path / "zz.py").write_text(GOOD.format(body="pass", id="wire"))
    assert usable_catalogue(tmp_path)[1] == ()
    assert _not_tried(Dataset(attrs={"mechanisms_not_tried": ""})) == []
    assert _not_tried(Dataset()) == []


NO_PYTHON = {
    "unclosed": b"(",
    "zero byte": b"a = 1\0",
    "another encoding": b"a = '\xff'",
    "deep": b"a = " + b"(" * 100_000,
    "deeper": b"a = " + b"-" * 200_000 + b"1",
    "text": b"this is no Python",
}


@pytest.mark.parametrize("case", NO_PYTHON)
def test_what_is_no_python(case, tmp_path):
    (tmp_path / "own.py").write_bytes(NO_PYTHON[case])
    assert answer(lambda: usable_catalogue(tmp_path), "own.py")
