"""What a stage depends on besides its input files: its code and its settings, as short texts.

Snakemake notices a changed rule parameter but neither an edited module that a script imports
nor, dependably, a changed dictionary. So each rule carries two strings: the hash of the stage's
code and the canonical JSON of the settings that it reads. What the numbers stand on besides, the
versions of the numerical libraries, is `environment`.
"""

import ast
import hashlib
import json
import os
import platform
import re
from contextlib import suppress
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

_LIBRARY = Path(__file__).parent
_PACKAGE = _LIBRARY.name
_SCHEMAS = _LIBRARY / "schemas"
_IMPORTS = (ast.Import, ast.ImportFrom)
# What arithmetic depends on besides the library's own code.
NUMERICAL = ("numpy", "scipy", "numba", "llvmlite")
# A text that may be a file's path: with an ending.
_FILE = re.compile(r"[^\n\0]{1,255}\.\w{1,8}")
# Functions of `bladeroot.schema` that are given a schema's name.
_CHECKS = ("read_yaml", "check")
# What is known of sources, by the hash of their text: to parse a whole library takes seconds.
# Another Python or another version of this file sees them differently.
_READER = hashlib.sha256(platform.python_version().encode() + Path(__file__).read_bytes())
_KNOWN = _LIBRARY / "__pycache__" / f"sources-{_READER.hexdigest()[:8]}.json"


def canonical_json(settings: object) -> str:
    """JSON text that is the same for equal settings: sorted keys, no spaces, no NaN.

    Angle brackets are escaped: Snakemake's report holds parameters within a page's script.
    """
    text = json.dumps(settings, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return text.replace("<", "\\u003c").replace(">", "\\u003e")


@cache
def environment() -> str:
    """Versions of Python and of what computes, as `python 3.12.3, numpy 2.4.6, ...`."""
    parts = [f"python {platform.python_version()}"]
    for name in NUMERICAL:
        with suppress(PackageNotFoundError):
            parts.append(f"{name} {version(name)}")
    return ", ".join(parts)


def environment_hash(keep: str = "") -> str:
    """Short hash of the environment; of `keep`, an earlier one's text, where that is given.

    Results that were made in the environment `keep` then count as current.
    """
    return hashlib.sha256((keep or environment()).encode()).hexdigest()[:16]


def code_hash(*files: str | Path) -> str:
    """Hash of a stage's script and of every library module that it imports, however deep.

    Several files (a script and a user's mechanisms) are hashed together. Syntax trees without
    docstrings are hashed: a comment, a docstring or a line break changes nothing, any real change
    does. With a module count the files beside it that are no code (a page's template and style) and
    the schemas that it names; with a user's own the files that its texts name. Raises SyntaxError
    when a module cannot be parsed.
    """
    known = _known()
    before = len(known)
    seen = {Path(path).resolve() for path in files}
    waiting = list(seen)
    while waiting:
        for imported in _library_imports(waiting.pop()) - seen:
            seen.add(imported)
            waiting.append(imported)
    parts = [(_module_name(path), _source(path)["tree"]) for path in seen]
    data = set().union(*map(_read_by, seen))
    parts += [(_module_name(path), hashlib.sha256(path.read_bytes()).hexdigest()) for path in data]
    digest = hashlib.sha256()
    for name, content in sorted(parts):
        digest.update(f"{name}\n{content}\n".encode())
    if len(known) > before:
        _keep(known)
    return digest.hexdigest()[:16]


@cache
def _known() -> dict[str, dict]:
    """What earlier runs learnt of sources; nothing where that cannot be read."""
    with suppress(Exception):  # whatever is wrong with it, it only saves time
        known = json.loads(_KNOWN.read_text(encoding="utf-8"))
        if {"tree", "imports", "schemas", "files"} <= set.intersection(*map(set, known.values())):
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
        nodes = list(ast.walk(tree))
        _known()[key] = {
            "tree": hashlib.sha256(ast.dump(tree).encode()).hexdigest(),
            "imports": [_import(node) for node in nodes if isinstance(node, _IMPORTS)],
            "schemas": [name for node in nodes for name in _schema_names(node)],
            "files": _file_names(nodes),
        }
    return _known()[key]


def _import(node: ast.Import | ast.ImportFrom) -> tuple[int, str | None, list[str]]:
    """Level, module (None for a plain import) and names of an import statement."""
    names = [alias.name for alias in node.names]
    if isinstance(node, ast.Import):
        return 0, None, names
    return node.level, node.module or "", names


def _schema_names(node: ast.AST) -> list[str]:
    """Texts in a call of what checks a document, a schema's name among them."""
    if not isinstance(node, ast.Call):
        return []
    called = getattr(node.func, "id", getattr(node.func, "attr", None))
    if called not in _CHECKS:
        return []
    given = [*node.args, *(keyword.value for keyword in node.keywords)]
    return [
        one.value for one in given if isinstance(one, ast.Constant) and isinstance(one.value, str)
    ]


def _file_names(nodes: list[ast.AST]) -> list[str]:
    """Texts of a module that may name a file."""
    texts = {one.value for one in nodes if isinstance(one, ast.Constant)}
    return sorted(one for one in texts if isinstance(one, str) and _FILE.fullmatch(one))


@cache
def _read_by(path: Path) -> frozenset[Path]:
    """Files that are no code and that a module reads: its schemas, and those of its folder.

    Of a user's module those, beside it or elsewhere, whose names stand in it as texts.
    """
    named = [_SCHEMAS / f"{name}.schema.yaml" for name in _source(path)["schemas"]]
    ours = path.is_relative_to(_LIBRARY)
    named += [] if ours else [path.parent / name for name in _source(path)["files"]]
    read = {one for one in named if os.path.isfile(one)}
    if ours:
        read |= {
            beside
            for beside in path.parent.iterdir()
            if beside.suffix != ".py"
            and beside.is_file()
            # an editor's own files are read by nobody
            and not (beside.name.startswith(".") or beside.name.endswith("~"))
        }
    return frozenset(read)


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
    that finds them by itself. So do files beside a script or a user's file, and those that it
    finds by the environment's PYTHONPATH.
    """
    found = set()
    ours = path.is_relative_to(_LIBRARY)
    for level, module, imported in _source(path)["imports"]:
        names = whole = imported
        if module is not None:
            base = _absolute(level, module, path)
            whole = [f"{base}.{name}" for name in imported]
            names = [base, *whole]
        for name in names:
            found |= _files(name)
            if not ours:
                found |= _beside(path, name)
        for name in whole:
            found |= _modules_of(name)
    return frozenset(found)


def _beside(path: Path, name: str) -> set[Path]:
    """The files of a module that lies beside a file outside the library, or on PYTHONPATH."""
    if name.split(".")[0] == _PACKAGE:
        return set()
    elsewhere = os.environ.get("PYTHONPATH", "").split(os.pathsep)
    folders = [path.parent, *map(Path, filter(None, elsewhere))]
    stems = [folder.joinpath(*name.split(".")) for folder in folders]
    candidates = [one for stem in stems for one in (stem.with_suffix(".py"), stem / "__init__.py")]
    return {one.resolve() for one in candidates if one.is_file()}


@cache
def _modules_of(name: str) -> set[Path]:
    """All modules of a sub-package of the library; none for a plain module."""
    if "." not in name or f"{name}.__init__" not in _library():
        return set()
    return {file for one, file in _library().items() if one.rpartition(".")[0] == name}


def _absolute(level: int, module: str, path: Path) -> str:
    if level == 0:
        return module
    folder = path.parents[level - 1].relative_to(_LIBRARY.parent)
    return ".".join([*folder.parts, *([module] if module else [])])


@cache
def _library() -> dict[str, Path]:
    """The library's files by dotted name, `__init__` files by their own."""
    files = _LIBRARY.rglob("*.py")
    return {".".join(one.relative_to(_LIBRARY.parent).with_suffix("").parts): one for one in files}


@cache
def _files(module: str) -> set[Path]:
    """The file of a dotted name and the `__init__` files that Python runs on the way to it."""
    parts = module.split(".")
    if parts[0] != _PACKAGE:
        return set()
    ways = [".".join(parts[:depth]) for depth in range(1, len(parts) + 1)]
    candidates = [one for way in ways for one in (f"{way}.__init__", way)]
    return {_library()[one] for one in candidates if one in _library()}
