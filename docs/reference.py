"""Pages that are made from what stands elsewhere: code, schemas, and the clone's own documents.

A Sphinx extension; it writes `generated/*.md` before the pages are read, and turns links between
the clone's documents, which work there, into links between pages.
"""

import csv
import os
import re
from collections.abc import Iterator, Mapping
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules

import yaml
from bladeroot.bench import effects
from bladeroot.mechanisms.catalogue import catalogue
from bladeroot.quality import findings
from bladeroot.terms import DOVETAIL

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
GENERATED = HERE / "generated"
SCHEMAS = ROOT / "workflow" / "bladeroot" / "schemas"
# Documents of the clone outside docs/, and the page that each becomes.
PAGES = {
    "config/README.md": "generated/campaign.md",
    "resources/structures/README.md": "generated/structures.md",
    "benchmarks/README.md": "generated/benchmarks.md",
    "CONTRIBUTING.md": "generated/contributing.md",
    "CHANGELOG.md": "generated/changelog.md",
    "README.md": "index.md",
}
_LINK = re.compile(r"(\[[^\]]*\]\()([^)#:\s]+)(#[^)]*)?(\))")
# What a schema says of a value beside its type, and how it reads.
LIMITS = {
    "enum": "one of",
    "const": "always",
    "pattern": "text like",
    "minimum": "at least",
    "exclusiveMinimum": "above",
    "maximum": "at most",
    "exclusiveMaximum": "below",
    "minItems": "items at least",
    "maxItems": "items at most",
}


def setup(app) -> dict:
    """Sphinx's entry."""
    app.connect("builder-inited", lambda _: write(GENERATED))
    app.connect("source-read", _read)
    return {"version": "1", "parallel_read_safe": True}


def _read(_, name: str, source: list[str]) -> None:
    """Sphinx's hook: the text of a page before it is parsed."""
    if "generated/" not in name:
        source[0] = linked(source[0], HERE, Path(name).parent)


def linked(text: str, folder: Path, page: Path) -> str:
    """Links to documents of the clone as links to their pages; links to other files as bare text.

    folder: of the document that `text` is of. page: the page's folder, relative to docs/.
    """

    def link(found: re.Match) -> str:
        before, target, anchor, after = found.groups()
        place = (folder / target).resolve()
        if not place.is_relative_to(ROOT) or place.suffix in (".png", ".svg"):
            return found[0]
        here = place.relative_to(ROOT).as_posix()
        to = PAGES.get(here) or (here.removeprefix("docs/") if here.startswith("docs/") else "")
        if not to.endswith(".md"):
            return before[1:-2]
        return f"{before}{os.path.relpath(to, page or '.')}{anchor or ''}{after}"

    return _LINK.sub(link, text)


def write(folder: Path) -> None:
    """All pages, each only if its text has changed."""
    folder.mkdir(exist_ok=True)
    pages = {path.name.removesuffix(".schema.yaml"): path for path in SCHEMAS.glob("*.yaml")}
    texts = {f"schema-{name}.md": schema_page(path) for name, path in sorted(pages.items())}
    texts |= {
        "mechanisms.md": mechanism_page(),
        "findings.md": finding_page(),
        "effects.md": effect_page(),
        "variables.md": variable_page(),
    }
    for document, page in PAGES.items():
        if page.startswith("generated/"):
            path = ROOT / document
            texts[Path(page).name] = linked(
                path.read_text(encoding="utf-8"), path.parent, GENERATED.relative_to(HERE)
            )
    for name, text in texts.items():
        path = folder / name
        if not path.is_file() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")


def schema_page(path: Path) -> str:
    """Every key of a schema with its type, limits and meaning."""
    schema = yaml.safe_load(path.read_text(encoding="utf-8"))
    rows = [
        f"| `{key}` | {kind} | {text} |"
        for key, kind, text in keys(schema, schema.get("$defs", {}))
    ]
    title = schema["title"].replace("<", "\\<")
    head = f"# {title}\n\n`{schema['$id']}`. {schema.get('description', '')}\n\n"
    return head + "\n".join(["| key | value | meaning |", "|---|---|---|", *rows]) + "\n"


def keys(node: Mapping, defined: Mapping, before: str = "") -> Iterator[tuple[str, str, str]]:
    """Key, kind and meaning of all that a schema describes; what refers to itself counts once."""
    here = str(node.get("$ref", "")).rpartition("/")[2]
    node = _followed(node, defined)
    defined = {name: part for name, part in defined.items() if name != here}
    for name, part in node.get("properties", {}).items():
        yield from _key(part, defined, f"{before}{name}", name in node.get("required", []))
    for pattern, part in node.get("patternProperties", {}).items():
        yield from _key(part, defined, f"{before}<{pattern}>", False)
    more = node.get("additionalProperties")
    if isinstance(more, Mapping):
        yield from _key(more, defined, f"{before}<name>", False)
    if isinstance(node.get("items"), Mapping):
        yield from keys(node["items"], defined, before.removesuffix(".") + "[].")
    for choice in (*node.get("oneOf", []), *node.get("anyOf", [])):
        if isinstance(choice, Mapping):
            yield from keys(choice, defined, before)


def _key(part, defined: Mapping, name: str, required: bool) -> Iterator[tuple[str, str, str]]:
    given = part if isinstance(part, Mapping) else {}
    part = _followed(given, defined)
    kind = part.get("type", "")
    kind = " or ".join(kind) if isinstance(kind, list) else kind
    limits = [f"{text} {_shown(part[name_])}" for name_, text in LIMITS.items() if name_ in part]
    told = "; ".join(filter(None, (kind, "required" if required else "", *limits)))
    yield name, told.replace("|", "\\|"), str(part.get("description", "")).replace("|", "\\|")
    yield from keys(given, defined, f"{name}.")


def _shown(value) -> str:
    return ", ".join(map(str, value)) if isinstance(value, list) else f"`{value}`"


def _followed(node: Mapping, defined: Mapping) -> Mapping:
    name = str(node.get("$ref", "")).rpartition("/")[2]
    return {**defined.get(name, {}), **{k: v for k, v in node.items() if k != "$ref"}}


def mechanism_page() -> str:
    """Every mechanism of the catalogue: what it is, its forms, its parameters and its splitter."""
    parts = [
        "# Mechanisms\n\nThe catalogue of causes that a verdict can name, from "
        "`workflow/bladeroot/mechanisms/`. A mechanism is physics; `forms` are the laws that the "
        "literature has for it, and the evidence of a mechanism is the sum over them.\n"
    ]
    for one in catalogue():
        sentence, splitter = map(DOVETAIL.say, (one.sentence, one.splitter))
        parts.append(f"## {one.id}\n\n{sentence[:1].upper()}{sentence[1:]}.\n")
        forms = ", ".join(form.form for form in (one, *one.forms) if form.form)
        parts.append(f"- class: {one.kind}" + (f"\n- forms: {forms}" if forms else ""))
        parts.append(f"- what tells it from its siblings: {splitter}\n")
        if one.parameters:
            parts.append("| parameter | unit | prior | limits | source |\n|---|---|---|---|---|")
            parts += [
                f"| `{p.name}` | {p.unit} | {p.mean:g} ± {p.std:g}"
                f"{' (ln)' if p.log else ' (logit)' if p.bounded else ''} | {p.low:g} to {p.high:g}"
                f" | {p.source} |"
                for p in one.parameters
            ]
            parts.append("")
    return "\n".join(parts)


def finding_page() -> str:
    """Every check of a record: what it looks at, its statistic and threshold."""
    parts = [
        "# Checks of a record\n\nOne file each in `workflow/bladeroot/quality/findings/`; what "
        "they do to a record, and how often they are wrong, is in [findings](../findings.md).\n"
    ]
    for module in _modules(findings):
        parts.append(f"## {_id(module)}\n\n{module.__doc__.strip()}\n")
        parts.append(f"- statistic: {module.STATISTIC}\n- threshold: {module.THRESHOLD:g}\n")
    return "\n".join(parts)


def effect_page() -> str:
    """Every effect that the virtual bench can hide."""
    parts = [
        "# Effects of the virtual bench\n\nWhat the bench can hide in a simulated campaign, from "
        "`workflow/bladeroot/bench/effects/`; see [the blind laboratory](../blind.md).\n"
    ]
    for module in _modules(effects):
        parts.append(f"## {_id(module)}\n\n{module.__doc__.strip()}\n")
        parts.append(f"- class: {module.CLASS}\n- smallest size hidden: {module.BOUND:g} "
                     f"{module.UNIT}\n")  # fmt: skip
    return "\n".join(parts)


def variable_page() -> str:
    """Every variable of every artifact, as `list_variables.py` found them in finished results."""
    parts = [
        "# Variables\n\nWhat the NetCDF files of `results/` hold; units are SI. Attributes of each "
        "file say campaign, settings and versions.\n"
    ]
    last = ""
    with (HERE / "variables.csv").open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            if row["artifact"] != last:
                last = row["artifact"]
                parts.append(f"\n## {last.replace('<', chr(92) + '<')}\n")
                parts.append("| variable | dims | unit | meaning | source |\n|---|---|---|---|---|")
            cells = (row[key].replace("|", "\\|") for key in ("dims", "units", "meaning", "source"))
            parts.append(f"| `{row['variable']}` | {' | '.join(cells)} |")
    return "\n".join(parts) + "\n"


def _modules(package) -> Iterator:
    for found in iter_modules(package.__path__):
        yield import_module(f"{package.__name__}.{found.name}")


def _id(module) -> str:
    return module.__name__.rpartition(".")[2].replace("_", "-")
