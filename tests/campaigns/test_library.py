"""A checkout uses the library that it holds; in every run of a house another is installed."""

import ast

from house import ROOT

SCRIPTS = sorted((ROOT / "workflow" / "scripts").glob("[a-z]*.py"))


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
