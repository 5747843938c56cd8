"""A checkout uses the library that it holds, whatever is installed."""

import ast
import subprocess
import sys

from house import ROOT

SCRIPTS = sorted((ROOT / "workflow" / "scripts").glob("[a-z]*.py"))


def test_plan_and_scripts_take_their_own_library(bare, tmp_path):
    another = tmp_path / "another" / "bladeroot"
    another.mkdir(parents=True)
    (another / "__init__.py").write_text("raise ImportError('the library of another checkout')\n")
    environment = {**bare.environment, "PYTHONPATH": str(another.parent)}
    script = bare.folder / "workflow" / "scripts" / "stick.py"
    for command in (bare.command("--dry-run"), [sys.executable, str(script), "--help"]):
        done = subprocess.run(
            command, cwd=bare.folder, env=environment, capture_output=True, text=True
        )
        assert done.returncode == 0, done.stderr


def test_scripts_settle_their_library_before_they_import_it():
    assert SCRIPTS
    for script in SCRIPTS:
        imported = [
            node.module if isinstance(node, ast.ImportFrom) else node.names[0].name
            for node in ast.walk(ast.parse(script.read_text()))
            if isinstance(node, ast.Import | ast.ImportFrom)
        ]
        library = [k for k, name in enumerate(imported) if name.split(".")[0] == "bladeroot"]
        assert imported.index("_cli") < min(library), script
