"""A checkout uses the library that it holds, whatever is installed."""

import ast
import subprocess
import sys

import pytest
from house import ROOT, copy_house

SCRIPTS = sorted((ROOT / "workflow" / "scripts").glob("[a-z]*.py"))


def test_plan_and_scripts_take_their_own_library(tmp_path):
    house = copy_house(tmp_path / "house")
    another = tmp_path / "another" / "bladeroot"
    another.mkdir(parents=True)
    (another / "__init__.py").write_text("raise ImportError('the library of another checkout')\n")
    environment = {**house.environment, "PYTHONPATH": str(another.parent)}
    script = house.folder / "workflow" / "scripts" / "stick.py"
    for command in (house.command("--dry-run"), [sys.executable, str(script), "--help"]):
        done = subprocess.run(
            command, cwd=house.folder, env=environment, capture_output=True, text=True
        )
        assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
def test_a_script_settles_its_library_before_it_imports_it(script):
    imported = [
        node.module if isinstance(node, ast.ImportFrom) else node.names[0].name
        for node in ast.walk(ast.parse(script.read_text()))
        if isinstance(node, ast.Import | ast.ImportFrom)
    ]
    library = [k for k, name in enumerate(imported) if name.split(".")[0] == "bladeroot"]
    assert imported.index("_cli") < min(library)
