"""What a stage depends on besides its input files: its code and its settings, as short texts.

Snakemake notices a changed rule parameter but neither an edited module that a script imports
nor, dependably, a changed dictionary. So each rule carries two strings: the hash of the stage's
code and the canonical JSON of the settings that it reads.
"""

import ast
import hashlib
import json
import os
import platform
from contextlib import suppress
from functools import cache
from pathlib import Path

_LIBRARY = Path(__file__).parent
_PACKAGE = _LIBRARY.name
_IMPORTS = (ast.Import, ast.ImportFrom)
# What is known of sources, by the hash of their text: to parse a whole library takes seconds.
# Another Python or another version of this file sees them differently.
_READER = hashlib.sha256(platform.python_version().encode() + Path(__file__).read_bytes())
_KNOWN = _LIBRARY / "__pycache__" / f"sources-{_READER.hexdigest()[:8]}.json"


def canonical_json(settings: object) -> str:
    """JSON text that is the same for equal settings: sorted keys, no spaces, no NaN."""
    return json.dumps(settings, sort_keys=True, separators=(",", ":"), allow_nan=False)


def code_hash(script: str | Path) -> str:
    """Hash of a stage's script and of every library module that it imports, however deep.

    Syntax trees without docstrings are hashed: a comment, a docstring or a line break changes
    nothing, any real change does. Raises SyntaxError when a module cannot be parsed.
    """
    script = Path(script).resolve()
    known = _known()
    before = len(known)
    seen = {script}
    waiting = [script]
    while waiting:
        for imported in _library_imports(waiting.pop()) - seen:
            seen.add(imported)
            waiting.append(imported)
    digest = hashlib.sha256()
    for name, tree in sorted((_module_name(path), _source(path)["tree"]) for path in seen):
        digest.update(f"{name}\n{tree}\n".encode())
    if len(known) > before:
        _keep(known)
    return digest.hexdigest()[:16]


@cache
def _known() -> dict[str, dict]:
    """What earlier runs learnt of sources; nothing where that cannot be read."""
    with suppress(Exception):  # whatever is wrong with it, it only saves time
        known = json.loads(_KNOWN.read_text(encoding="utf-8"))
        if {"tree", "imports"} <= set.intersection(*map(set, known.values())):
            return known
    return {}


def _keep(known: dict[str, dict]) -> None:
    """Write it for later runs, whole or not at all; a library that cannot be written to goes on."""
    part = _KNOWN.with_name(f"{_KNOWN.name}.tmp.{os.getpid()}")
    with suppress(OSError):
        _KNOWN.parent.mkdir(exist_ok=True)
        try:
            part.write_text(json.dumps(known), encoding="utf-8")
            part.replace(_KNOWN)
        finally:
            part.unlink(missing_ok=True)


def _module_name(path: Path) -> str:
    if path.is_relative_to(_LIBRARY):
        return path.relative_to(_LIBRARY).as_posix()
    return path.name


@cache
def _source(path: Path) -> dict:
    """Hash of a file's syntax tree without docstrings, and what the file imports."""
    text = path.read_text(encoding="utf-8")
    key = hashlib.sha256(text.encode()).hexdigest()
    if key not in _known():
        tree = _bare_tree(text, path)
        _known()[key] = {
            "tree": hashlib.sha256(ast.dump(tree).encode()).hexdigest(),
            "imports": [_import(node) for node in ast.walk(tree) if isinstance(node, _IMPORTS)],
        }
    return _known()[key]


def _import(node: ast.Import | ast.ImportFrom) -> tuple[int, str | None, list[str]]:
    """Level, module (None for a plain import) and names of an import statement."""
    names = [alias.name for alias in node.names]
    if isinstance(node, ast.Import):
        return 0, None, names
    return node.level, node.module or "", names


def _bare_tree(text: str, path: Path) -> ast.Module:
    """Syntax tree without docstrings."""
    tree = ast.parse(text, filename=str(path))
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        if (
            isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef)
            and body
            and isinstance(body[0], ast.Expr)
            and isinstance(body[0].value, ast.Constant)
            and isinstance(body[0].value.value, str)
        ):
            node.body = body[1:]
    return tree


@cache
def _library_imports(path: Path) -> frozenset[Path]:
    """Files of the library that a file imports, anywhere in it (late imports, too).

    A sub-package that is imported as a whole counts with all its modules: it may be a registry
    that finds them by itself. So do files beside a script.
    """
    found = set()
    for level, module, imported in _source(path)["imports"]:
        names = whole = imported
        if module is not None:
            base = _absolute(level, module, path)
            whole = [f"{base}.{name}" for name in imported]
            names = [base, *whole]
        for name in names:
            found |= _files(name)
            beside = path.parent / f"{name}.py"
            if beside.is_file():
                found.add(beside)
        for name in whole:
            found |= _modules_of(name)
    return frozenset(found)


@cache
def _modules_of(name: str) -> set[Path]:
    """All modules of a sub-package of the library; none for a plain module."""
    parts = name.split(".")
    folder = _LIBRARY.joinpath(*parts[1:])
    if parts[0] != _PACKAGE or len(parts) < 2 or not (folder / "__init__.py").is_file():
        return set()
    return set(folder.glob("*.py"))


def _absolute(level: int, module: str, path: Path) -> str:
    if level == 0:
        return module
    folder = path.parents[level - 1].relative_to(_LIBRARY.parent)
    return ".".join([*folder.parts, *([module] if module else [])])


@cache
def _files(module: str) -> set[Path]:
    """The file of a dotted name and the `__init__` files that Python runs on the way to it."""
    parts = module.split(".")
    if parts[0] != _PACKAGE:
        return set()
    found = set()
    for depth in range(1, len(parts) + 1):
        stem = _LIBRARY.joinpath(*parts[1:depth])
        for candidate in (stem / "__init__.py", stem.with_suffix(".py")):
            if candidate.is_file():
                found.add(candidate)
    return found
