"""A machine without space, right to write, language or home: one line, or the result."""

import os
import resource
import subprocess
import sys
from pathlib import Path

import pytest
from bladeroot import artifacts

ROOT = Path(__file__).resolve().parents[2]
TABLE = ROOT / "resources" / "campaigns" / "thesis" / "stick.csv"
NOWHERE = "/dev/null/nowhere"


def stage(folder, output, *, script="stick", limit=None, **environment):
    """Run a stage's script; its status and what it says."""
    more = {
        "stick": ["--sources", TABLE, "--campaign", "thesis", "--load",
                  '{"load":{"name":"axial force","unit":"N"}}', "--settings",
                  '{"table_error":"stated"}', "--output", output],
    }  # fmt: skip

    def before():
        if limit is not None:
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

    done = subprocess.run(
        [sys.executable, ROOT / "workflow/scripts" / f"{script}.py", *more.get(script, [output])],
        cwd=folder, env={**os.environ, **environment}, preexec_fn=before,
        capture_output=True, text=True, errors="replace", timeout=300,
    )  # fmt: skip
    return done.returncode, done.stderr


ASCII = {"LC_ALL": "C", "LANG": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0",
         "PYTHONIOENCODING": "ascii"}  # fmt: skip
HOMELESS = {name: NOWHERE for name in ("HOME", "XDG_CACHE_HOME", "XDG_CONFIG_HOME",
                                       "MPLCONFIGDIR", "NUMBA_CACHE_DIR")}  # fmt: skip
MACHINES = {
    "as it is": {},
    "ascii": ASCII,
    "another language": {"LC_ALL": "xx_XX.nothing"},
    "homeless": HOMELESS,
    "no temporary folder": {"TMPDIR": NOWHERE, "TEMP": NOWHERE, "TMP": NOWHERE},
    "no terminal": {"TERM": "", "COLUMNS": "0"},
}
QUICK = ("ascii",)
REST = [name for name in MACHINES if name not in ("ascii", "homeless")]


@pytest.mark.parametrize(
    "case",
    [pytest.param(name, marks=[pytest.mark.slow] * (name not in QUICK)) for name in MACHINES],
)
def test_the_same_result_on_an_odd_machine(case, tmp_path):
    status, said = stage(tmp_path, "a.nc", **MACHINES[case])
    assert (status, said) == (0, "")
    artifacts.load(tmp_path / "a.nc")
    if case == "ascii":
        assert stage(tmp_path, "b.nc")[0] == 0
        assert (tmp_path / "a.nc").read_bytes() == (tmp_path / "b.nc").read_bytes()


DRAWS = f"""
import sys
sys.path.insert(0, {str(ROOT / "workflow")!r})
import numpy as np
from bladeroot.figures.chart import Chart, Panel, Trace
from bladeroot.figures.still import still
from bladeroot.figures.style import svg
from bladeroot.files import save_text
x = np.geomspace(1, 10, 5)
chart = Chart("", [Panel("a", "amplitude / µm", "f / Hz", x_log=True)], [Trace(0, x, x, line="-")])
save_text(svg(still(chart)), sys.argv[1])
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    "case", ["ascii", "homeless", *(pytest.param(name, marks=pytest.mark.suite) for name in REST)]
)
def test_a_figure_on_an_odd_machine(case, tmp_path):
    (tmp_path / "draws.py").write_text(DRAWS, encoding="utf-8")
    script = str(tmp_path / "draws")
    status, said = stage(tmp_path, "a.svg", script=script, **MACHINES[case])
    assert status == 0, said
    assert "</svg>" in (tmp_path / "a.svg").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    "limit", [pytest.param(size, marks=[pytest.mark.slow] * (size != 20_000)) for size in
              (0, 100, 5000, 20_000)]
)  # fmt: skip
def test_no_space(limit, tmp_path):
    """A limit on a file's size in place of a full disk, at several places of the writing."""
    (tmp_path / "a.nc").write_text("before")
    status, said = stage(tmp_path, "a.nc", limit=limit, PYTHONDONTWRITEBYTECODE="1")
    assert status == 1
    assert "a.nc cannot be written" in said
    assert "Traceback" not in said
    assert (tmp_path / "a.nc").read_text() == "before"
    assert [path.name for path in tmp_path.iterdir()] == ["a.nc"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("output", "told"),
    [
        ("file/a.nc", "file/a.nc cannot be written"),
        ("/dev/null/a.nc", "/dev/null/a.nc cannot be written"),
        ("a" * 256, "file name too long"),
        ("folder", "folder cannot be written: is a directory"),
    ],
)
def test_no_place(output, told, tmp_path):
    (tmp_path / "file").touch()
    (tmp_path / "folder").mkdir()
    status, said = stage(tmp_path, output)
    assert (status, told in said, "Traceback" in said) == (1, True, False), said
