"""Checking a YAML document against one of the project's JSON schemas (workflow/schemas/)."""

import math
from functools import cache
from pathlib import Path
from typing import Any

import jsonschema
import yaml

_SCHEMAS = Path(__file__).resolve().parents[1] / "schemas"
# The compiled loader, where PyYAML has it, is some ten times as fast.
_LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


def read_yaml(path: str | Path, schema: str) -> dict:
    """Read a YAML file and check it; one ValueError names the file, every fault a line.

    `schema` is a name in workflow/schemas/, without its ending.
    """
    document = parse_yaml(path)
    if document is None:
        raise ValueError(f"the file is empty; expected keys and values ({path})")
    check(document, schema, str(path))
    return document


def parse_yaml(path: str | Path) -> Any:
    """What a YAML file holds, unchecked; ValueError, one line, if there is none."""
    path = Path(path)
    if not path.is_file():
        raise ValueError(f"file not found: {path}")
    try:
        return yaml.load(path.read_text(encoding="utf-8"), _LOADER)
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise ValueError(f"not a YAML text: {' '.join(str(error).split())} ({path})") from error


def check(document: object, schema: str, where: str) -> None:
    """Raise one ValueError with a line for every fault of a document."""
    faults = sorted(
        _validator(schema).iter_errors(document), key=lambda fault: list(map(str, fault.path))
    )
    lines = [_line(fault, where) for fault in faults]
    lines += [f"{place} must be a finite number ({where})" for place in _not_finite(document)]
    if lines:
        raise ValueError("\n".join(lines))


@cache
def _validator(schema: str) -> jsonschema.Draft202012Validator:
    text = (_SCHEMAS / f"{schema}.schema.yaml").read_text(encoding="utf-8")
    return jsonschema.Draft202012Validator(yaml.load(text, _LOADER))


def _not_finite(node: object, place: str = "") -> list[str]:
    """Places of NaN and infinity, which YAML can write and a schema cannot refuse."""
    if isinstance(node, float) and not math.isfinite(node):
        return [place]
    if isinstance(node, dict):
        parts = node.items()
    elif isinstance(node, list):
        parts = enumerate(node)
    else:
        return []
    return [bad for key, part in parts for bad in _not_finite(part, f"{place}.{key}".lstrip("."))]


def _line(fault: jsonschema.ValidationError, where: str) -> str:
    place = ".".join(str(step) for step in fault.absolute_path) or "the file"
    hint = fault.schema.get("description") if isinstance(fault.schema, dict) else None
    message = fault.message if len(fault.message) < 200 else f"{fault.message[:200]}..."
    expected = f"; expected: {hint}" if hint else ""
    return f"{place}: {message}{expected} ({where})"
