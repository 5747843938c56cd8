"""The table of faults, from what the tests reported.

    pytest -m "slow or not slow" --junitxml=faults.xml tests/hostile
    pytest -m "slow or not slow" --junitxml=reruns.xml tests/campaigns/test_rerun_table.py
    python tests/hostile/matrix.py faults.xml reruns.xml > tests/hostile/faults.md

A row a file of tests: what it says of itself, its cases, and how many passed, failed and were left
out. The kills are those of `kills.json`.
"""

import ast
import json
import re
import sys
from collections import Counter, defaultdict
from pathlib import Path
from xml.etree import ElementTree

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]


def rows(reports):
    """Class, and how many cases passed, failed and were left out, of each file of tests."""
    counts = defaultdict(Counter)
    for case in (case for one in reports for case in ElementTree.parse(one).iter("testcase")):
        ends = {part.tag for part in case}
        end = "failed" if ends & {"failure", "error"} else "left out" if ends else "passed"
        counts[case.get("classname")][end] += 1
    for name, found in sorted(counts.items()):
        source = (ROOT / f"{name.replace('.', '/')}.py").read_text(encoding="utf-8")
        yield ast.get_docstring(ast.parse(source)).splitlines()[0].rstrip("."), found


def table(reports):
    kills = json.loads((HERE / "kills.json").read_text(encoding="utf-8"))
    lines = [
        "# Faults",
        "",
        "Made by `matrix.py` from the tests' own reports; what they ask of each case stands at the",
        "head of each file here and in `tests/campaigns/`.",
        "",
        "| class | cases | passed | failed | left out |",
        "|---|---|---|---|---|",
    ]
    total = Counter()
    for told, found in rows(reports):
        total += found
        lines.append(_line(told, found))
    lines += [
        _line("all", total),
        "",
        _reruns(),
        "",
        f"Kills, {kills['date']}, seed {kills['seed']}: ",
        "",
    ]
    lines += ["| killed | kills | ended before |", "|---|---|---|"]
    lines += [
        f"| {one['class']} | {one['killed']} | {one['ended before']} |" for one in kills["kills"]
    ]
    bad = kills["chains not identical"]
    lines += [
        "",
        f"{kills['chains']} chains; {bad} did not end in the bytes of an undisturbed run.",
    ]
    return "\n".join(lines) + "\n"


def _reruns():
    """How many changes the table of reruns names."""
    table = (ROOT / "tests/campaigns/test_rerun_table.py").read_text(encoding="utf-8")
    alone, together = map(int, re.search(r"^COUNTED = \((\d+), (\d+)\)", table, re.M).groups())
    return (
        f"Reruns: {alone + together} single changes, {alone} in a run of their own and {together} "
        "that redo nothing, made in groups."
    )


def _line(told, found):
    ends = [found[end] for end in ("passed", "failed", "left out")]
    return f"| {told} | {sum(ends)} | {ends[0]} | {ends[1]} | {ends[2]} |"


if __name__ == "__main__":
    sys.stdout.write(table(sys.argv[1:]))
