"""Documents: their links lead somewhere, and what the code has stands in them."""

import re
import subprocess
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
