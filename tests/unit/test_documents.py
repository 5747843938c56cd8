"""Documents: their links lead somewhere, and what the code has stands in them."""

import csv
import re
import subprocess
from importlib import import_module
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).resolve().parents[2]
LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")
SCHEMAS = ROOT / "workflow" / "bladeroot" / "schemas"


def documents():
    listed = subprocess.run(
        ["git", "ls-files", "-z", "*.md"], cwd=ROOT, capture_output=True, text=True, check=False
    ).stdout.split("\0")
    return [name for name in listed if name] or [p.name for p in ROOT.glob("*.md")]


def anchors(path):
    """The anchors of a document's headings."""
    heads = re.findall(r"^#+ (.*)$", path.read_text(encoding="utf-8"), re.M)
    return {re.sub(r"[^\w\- ]", "", head.lower()).strip().replace(" ", "-") for head in heads}


@pytest.mark.parametrize("name", documents())
def test_links_within_the_clone_lead_somewhere(name):
    path = ROOT / name
    for target in LINK.findall(path.read_text(encoding="utf-8")):
        place, _, anchor = target.partition("#")
        if ":" in target or place.startswith("generated/"):
            continue
        file = (path.parent / place).resolve() if place else path
        assert file.exists(), f"{name}: {target}"
        if anchor and file.suffix == ".md":
            assert anchor in anchors(file), f"{name}: {target}"


def test_every_artifact_of_a_rule_stands_in_its_page():
    page = (ROOT / "docs" / "artifacts.md").read_text(encoding="utf-8")
    rules = "".join(p.read_text() for p in (ROOT / "workflow" / "rules").glob("*.smk"))
    made = set(re.findall(r'"results/\{campaign\}/([a-z_]+\.nc)"', rules))
    made |= set(re.findall(r'"results/\{campaign\}/([a-z_]+)/\{structure\}\.nc"', rules))
    assert made
    assert [name for name in sorted(made) if name not in page] == []


@pytest.mark.parametrize("schema", ["config", "campaign"])
def test_every_key_is_explained(schema):
    page = (ROOT / "config" / "README.md").read_text(encoding="utf-8")
    keys = yaml.safe_load((SCHEMAS / f"{schema}.schema.yaml").read_text())["properties"]
    assert [key for key in keys if f"`{key}" not in page] == []


def test_nothing_of_the_library_is_without_a_page_of_the_site(tmp_path, monkeypatch):
    """The site's generated pages, against the files that they are made of."""
    monkeypatch.syspath_prepend(ROOT / "docs")
    import_module("reference").write(tmp_path)
    pages = {page.stem: page.read_text(encoding="utf-8") for page in tmp_path.glob("*.md")}
    index = (ROOT / "docs" / "index.md").read_text(encoding="utf-8")
    assert [name for name in pages if f"generated/{name}\n" not in index] == []
    library = ROOT / "workflow" / "bladeroot"
    for page, folder, mark in (
        ("findings", "quality/findings", "THRESHOLD ="),
        ("effects", "bench/effects", "CLASS ="),
        ("mechanisms", "mechanisms", "MECHANISM ="),
    ):
        files = [
            path for path in (library / folder).glob("*.py") if f"\n{mark}" in path.read_text()
        ]
        assert len(files) > 5
        names = [path.stem.replace("_", "-") for path in files]
        assert [name for name in names if f"\n## {name}\n" not in pages[page]] == []
    checks = (ROOT / "docs" / "findings.md").read_text(encoding="utf-8")
    heads = re.findall(r"^## (.+)$", pages["findings"], re.M)
    assert [name for name in heads if f"`{name}`" not in checks] == []
    for path in SCHEMAS.glob("*.schema.yaml"):
        page = pages[f"schema-{path.name.removesuffix('.schema.yaml')}"]
        cells = [f".{cell.replace('[]', '')}." for cell in re.findall(r"^\| `([^`]+)`", page, re.M)]
        names = keys(yaml.safe_load(path.read_text()))
        assert [n for n in names if not any(f".{n}." in cell for cell in cells)] == [], path.name
    with (ROOT / "docs" / "variables.csv").open(encoding="utf-8") as table:
        listed = {named_alike(row["artifact"]) for row in csv.DictReader(table)}
    rules = "".join(p.read_text() for p in (ROOT / "workflow" / "rules").glob("*.smk"))
    made = {named_alike(name) for name in re.findall(r'"results/([^"]+\.nc)"', rules)}
    assert {"<>/stick.nc", "<>/joint/<>.nc"} <= made & listed
    # what a default run does not make is explained without its variables
    document = named_alike((ROOT / "docs" / "artifacts.md").read_text(encoding="utf-8"))
    patterns = {"<>/<>/<>.nc", "structures/<>/<>/<>.nc"}  # of any rule's outputs
    left = made - listed - patterns
    assert [name for name in left if name.partition("/")[2] not in document] == []


def named_alike(path):
    """A path whose wildcards have no names."""
    return re.sub(r"[{<][^}>]*[}>]", "<>", path)


def keys(schema):
    """Names of all properties in a schema."""
    if isinstance(schema, list):
        return set().union(*map(keys, schema))
    if not isinstance(schema, dict):
        return set()
    own = schema.get("properties", {})
    return {*(own if isinstance(own, dict) else {}), *keys(list(schema.values()))}


def test_external_addresses_are_well_formed_and_safe():
    """Whether they answer is for `sphinx-build -b linkcheck`, which needs a network."""
    names = subprocess.run(["git", "ls-files", "-z", "*.md", "*.cff", "*.toml", "docs"],
                           cwd=ROOT, capture_output=True, text=True, check=False)  # fmt: skip
    texts = [ROOT / name for name in names.stdout.split("\0") if name and "." in name]
    texts = [path.read_text(encoding="utf-8") for path in texts if path.suffix != ".png"]
    found = {one for text in texts for one in re.findall(r"\w+://[^\s)>\"'`,]+", text)}
    odd = {
        one for one in found if not re.fullmatch(r"https://[\w-]+(\.[\w-]+)+(/[\w./#%-]*)?", one)
    }
    assert {one for one in odd if not one.startswith(("file://", "s3://"))} == set()
