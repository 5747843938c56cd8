"""The small campaign's verdict and report as they were agreed: fields, numbers within tolerances.

Where a change is meant, `pytest tests/campaigns/test_golden.py --golden` writes `golden.json` anew.
"""

import json
import re
from pathlib import Path

import pytest

GOLDEN = Path(__file__).parent / "golden.json"
# Sentences, what sums up all else, what moves with every prior, and what is the form's own: two
# forms of the slip explain these records alike, and which leads hangs on a wave of 1e-4 in them
# that another processor's finite elements make.
NOT_AGREED = {"reason", "trend", "splitter", "next", "log_evidence", "probabilities", "possible",
              "checksum", "form", "parameters", "after"}  # fmt: skip
# A number may move by so much of its own error, or of itself where it has none; and an error.
PART_OF_STD, PART, OF_ERRORS = 1.5, 0.05, 0.3


def fields(said):
    """A verdict without its sentences."""
    if isinstance(said, dict):
        return {name: fields(value) for name, value in said.items() if name not in NOT_AGREED}
    return [fields(one) for one in said] if isinstance(said, list) else said


def page_of(text):
    """A page's headings, its number of figures, and each table's head and number of rows."""
    text = re.sub(r"<(style|script|svg).*?</\1>", "", text, flags=re.DOTALL)

    def cells(tag, inside):
        found = re.findall(rf"<{tag}\b[^>]*>(.*?)</{tag}>", inside, flags=re.DOTALL)
        return [re.sub(r"<[^>]+>|\s+", " ", one).strip() for one in found]

    tables = re.findall(r"<table.*?</table>", text, flags=re.DOTALL)
    return {
        "headings": cells("h2", text),
        "figures": text.count("<figure"),
        "tables": [f"{one.count('<tr')} rows: {', '.join(cells('th', one))}" for one in tables],
    }


def expected_of(value):
    """The agreed value, with its tolerance where it is a number."""
    if isinstance(value, dict):
        std = value.get("std")
        near = {"std": {"rel": OF_ERRORS}}
        near["value"] = {"abs": PART_OF_STD * std} if std else {"rel": PART}
        return {
            name: pytest.approx(one, **near[name]) if name in near else expected_of(one)
            for name, one in value.items()
        }
    if isinstance(value, list):
        return [expected_of(one) for one in value]
    return pytest.approx(value, rel=PART) if isinstance(value, float) else value


def test_verdict_and_report_are_the_agreed_ones(house, request):
    folder = house.folder / "results" / "small"
    chapters = sorted((folder / "report").glob("*.html"))
    found = {
        "verdict": fields(json.loads((folder / "diagnosis" / "verdict.json").read_text())),
        "report": {path.stem: page_of(path.read_text()) for path in chapters},
    }
    if request.config.getoption("--golden"):
        GOLDEN.write_text(json.dumps(found, indent=1, ensure_ascii=False) + "\n")
    agreed = json.loads(GOLDEN.read_text())
    assert found["verdict"] == expected_of(agreed["verdict"])
    assert found["report"] == agreed["report"]
