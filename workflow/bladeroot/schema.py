"""Checking a YAML document against one of the project's JSON schemas (`schemas/`)."""

import math
import re
from functools import cache
from pathlib import Path
from typing import Any

import yaml

_SCHEMAS = Path(__file__).resolve().parent / "schemas"
# What a document of this project never reaches, and beyond which it is refused.
LARGEST_BYTES = 2_000_000  # the largest has 50 kB
DEEPEST_NESTING = 40  # of lists and keys in each other; the deepest node lies nine deep
MOST_NODES = 200_000  # with all that references (*name) stand for, which can double at each line
_LARGEST_WHOLE = 2**53  # up to which floats tell whole numbers apart
_EXPONENT = re.compile(r"[-+]?[\d.]+[eE][-+]?\d+")  # a number in YAML only with point and sign


def read_yaml(path: str | Path, schema: str) -> dict:
    """Read a YAML file and check it; one ValueError names the file, every fault a line.

    `schema` is a name of `schemas/`, without its ending.
    """
    document = parse_yaml(path)
    if document is None:
        raise ValueError(f"the file is empty; expected keys and values ({path})")
    check(document, schema, str(path))
    return document


def parse_yaml(path: str | Path) -> Any:
    """What a YAML file holds, unchecked; ValueError, one line, if there is none."""
    path = Path(path)
    try:
        if not path.is_file():
            raise ValueError(f"file not found: {path}")
        size = path.stat().st_size
        if size > LARGEST_BYTES:
            raise ValueError(f"expected a YAML text of {LARGEST_BYTES} bytes at most, got {size}")
        text = path.read_text(encoding="utf-8")
        _check_size(text)
        return yaml.load(text, Loader=_Loader)
    except OSError as error:
        raise ValueError(f"cannot be read: {error.strerror} ({path})") from error
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise ValueError(f"not a YAML text: {' '.join(str(error).split())} ({path})") from error
    except (ValueError, TypeError, RecursionError, OverflowError) as error:
        # a number of thousands of digits, a date that is none, a key that is a list
        told = " ".join(str(error).split())[:200]
        raise ValueError(told if str(path) in told else f"{told} ({path})") from error


# libyaml's parser is ten times as fast; both are safe ones.
class _Loader(getattr(yaml, "CSafeLoader", yaml.SafeLoader)):
    """Keys are texts, whatever they look like (a mode may be called 1 or on), and none twice."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict:
        """Raise ValueError for a key that stands twice."""
        first: dict[str, int] = {}
        for key, _ in node.value:
            if not isinstance(key, yaml.ScalarNode) or key.tag == "tag:yaml.org,2002:merge":
                continue
            key.tag = "tag:yaml.org,2002:str"
            if key.value in first:
                line = key.start_mark.line + 1
                before = first[key.value]
                raise ValueError(f"{key.value!r} in line {line} stands in line {before} already")
            first[key.value] = key.start_mark.line + 1
        return super().construct_mapping(node, deep)


def _check_size(text: str) -> None:
    """Raise ValueError for a document that is too deep, or too large with its references.

    By the parser's events, which need no memory for the document itself.
    """
    sizes: dict[str, int] = {}  # of what a name stands for
    open_names: list[tuple[str | None, int]] = []  # of the nodes around, with the count before them
    count = 0
    for event in yaml.parse(text, Loader=_Loader):
        if isinstance(event, yaml.AliasEvent):
            if any(name == event.anchor for name, _ in open_names):
                raise ValueError(f"*{event.anchor} stands within what it refers to")
            count += sizes.get(event.anchor, 1)
        elif isinstance(event, yaml.CollectionStartEvent):
            open_names.append((event.anchor, count))
            count += 1
        elif isinstance(event, yaml.CollectionEndEvent):
            name, before = open_names.pop()
            if name is not None:
                sizes[name] = count - before
        elif isinstance(event, yaml.ScalarEvent):
            count += 1
        if len(open_names) > DEEPEST_NESTING:
            raise ValueError(
                f"expected lists and keys nested {DEEPEST_NESTING} deep at most, got more"
            )
        if count > MOST_NODES:
            raise ValueError(
                f"expected {MOST_NODES} values at most, references (*name) with all that they "
                "stand for, got more"
            )


def check(document: object, schema: str, where: str) -> None:
    """Raise one ValueError with a line for every fault of a document."""
    import jsonschema  # late: most jobs check nothing

    validator = jsonschema.Draft202012Validator(_schema(schema))
    faults = sorted(validator.iter_errors(document), key=lambda fault: list(map(str, fault.path)))
    # of a node that may be one of several kinds, what misses the nearest of them
    lines = [_line(jsonschema.exceptions.best_match([fault]), where) for fault in faults]
    lines += [
        f"{place} must be a finite number of at most 15 digits ({where})"
        for place in _not_finite(document)
    ]
    if lines:
        raise ValueError("\n".join(lines))


@cache
def _schema(name: str) -> dict:
    text = (_SCHEMAS / f"{name}.schema.yaml").read_text(encoding="utf-8")
    return yaml.load(text, Loader=_Loader)


def _not_finite(node: object, place: str = "") -> list[str]:
    """Places of NaN, infinity and huge whole numbers, which a schema does not refuse."""
    if isinstance(node, float) and not math.isfinite(node):
        return [place]
    if isinstance(node, int) and abs(node) > _LARGEST_WHOLE:
        return [place]
    if isinstance(node, dict):
        parts = node.items()
    elif isinstance(node, list):
        parts = enumerate(node)
    else:
        return []
    return [bad for key, part in parts for bad in _not_finite(part, f"{place}.{key}".lstrip("."))]


def _line(fault: Any, where: str) -> str:
    place = ".".join(str(step) for step in fault.absolute_path) or "the file"
    hint = fault.schema.get("description") if isinstance(fault.schema, dict) else None
    message = fault.message if len(fault.message) < 200 else f"{fault.message[:200]}..."
    if fault.validator == "type" and _EXPONENT.fullmatch(str(fault.instance)):
        message = f"{fault.instance!r} is a text in YAML, a number is written as 1.0e+7"
    if fault.validator == "additionalProperties" and re.search(r"\('\d+' was", fault.message):
        message += "; a number with a decimal comma? it must be a point"
    expected = f"; expected: {hint}" if hint else ""
    return f"{place}: {message}{expected} ({where})"
