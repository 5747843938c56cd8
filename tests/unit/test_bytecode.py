"""An edited source never runs as the old one, whatever its time says."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

READ = """\
import sys; sys.path[:0] = sys.argv[1:]
from bladeroot.bytecode import follow_content
follow_content()
import law; print(law.SIZE)
"""
LIBRARY = Path(__file__).resolve().parents[2] / "workflow"


def size(folder):
    kept = os.environ | {"PYTHONDONTWRITEBYTECODE": ""}
    asked = [sys.executable, "-c", READ, LIBRARY, folder]
    return subprocess.run(asked, env=kept, capture_output=True, text=True, check=True).stdout


@pytest.mark.parametrize("seconds", [0, 1e9, 4e9])
def test_bytecode_follows_the_source(tmp_path, seconds):
    for text in ("1", "2", "1"):
        (tmp_path / "law.py").write_text(f"SIZE = {text}\n")
        os.utime(tmp_path / "law.py", (seconds, seconds))
        assert size(tmp_path) == f"{text}\n"
    (kept,) = tmp_path.glob("__pycache__/law.*.pyc")
    before = kept.stat().st_mtime_ns
    os.utime(tmp_path / "law.py")  # another time, the same source: nothing is compiled again
    assert size(tmp_path) == "1\n"
    assert kept.stat().st_mtime_ns == before
