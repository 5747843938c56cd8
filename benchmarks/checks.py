"""What each check of a record does to the curve: records of the drawn world, with and without it.

    python benchmarks/checks.py --events 100 --seed 430000 --rows rows.json     # ten minutes
    python benchmarks/checks.py --page rows.json --commit abc1234 --json checks.json
                                                          # the table in docs/findings.md
    python benchmarks/checks.py --small

Every pair of mode and sensor of an event (`drawn_world/`) is analysed; where a check drops it,
masks samples or takes something off, it is analysed again without that check, and both curves are
held against the truth. A curve is right where no point lies outside both the tolerance (500 ppm,
10 %) and what the largest of its points may miss by (`drawn_world/verdicts.py`).

false drop: without the check the curve is right. false mask: so it is, and what is masked is lost;
paying: it is wrong without the check, and right, less wrong or dropped with it. A warning is false
where the curve is right all the same, and of use where curves with it are wrong more often than
curves without it: that is its lift.
"""

import argparse
import json
import tempfile
from collections import Counter
from pathlib import Path

import numpy as np
from bladeroot.quality import integrity
from drawn_world import campaign, draw
from drawn_world.product import analysed
from drawn_world.verdicts import errors, largest_of, wrong_points
from foreign_lab.score import with_table

HARD = ("drop", "mask", "subtract")
PAGE = Path(__file__).resolve().parents[1] / "docs" / "findings.md"
SMALL_EVENTS = 3


def wrong_share(event, entry: dict, curves: dict) -> float | None:
    """Part of a curve's points that are wrong; None without a curve."""
    if not curves:
        return None
    found = errors(event, entry["mode"], entry["sensor"], curves)
    return float(wrong_points(found, largest_of(2 * curves["time"].size)).mean())


def without(name: str, entry: dict):
    """The analysis with one check left out."""
    known = integrity.checks()
    integrity.checks = lambda: {one: module for one, module in known.items() if one != name}
    try:
        return analysed(entry)
    finally:
        integrity.checks = lambda: known


def rows_of(seed: int) -> list[dict]:
    """What each pair of an event shows with all checks, and without each that changed something."""
    event, rows = draw(seed), []
    with tempfile.TemporaryDirectory() as folder:
        for entry in campaign(event, Path(folder)):
            answer = analysed(entry)
            judged = answer.judged
            told = {}
            if not answer.crash:
                ids, done = (judged[f"finding_{x}"].values for x in ("id", "consequence"))
                told = {str(name): str(what) for name, what in zip(ids, done, strict=True)}
            row = {"seed": seed, "mode": entry["mode"] + 1, "sensor": entry["sensor"] + 1}
            row |= {"told": told, "wrong": wrong_share(event, entry, answer.curves), "without": {}}
            row["differs"] = "peak-fitting-differs" in answer.findings
            for name in integrity.checks():
                if told.get(name) in HARD:
                    loose = without(name, entry)
                    share = wrong_share(event, entry, loose.curves)
                    row["without"][name] = {"wrong": share}
            rows.append(row)
    return rows


def summary(rows: list[dict], commit: str) -> dict:
    """What the table shows, a line a check; rates are of all pairs."""
    seeds = sorted({row["seed"] for row in rows})
    given = [row for row in rows if row["wrong"] is not None]
    names = [*integrity.checks(), *sorted({n for row in rows for n in row["told"]})]
    made = {}
    for name in dict.fromkeys(names):
        done = Counter(row["told"][name] for row in rows if name in row["told"])
        here = [(row["wrong"], row["without"][name]["wrong"]) for row in rows
                if name in row["without"]]  # fmt: skip
        warned = [row["wrong"] > 0 for row in given if row["told"].get(name) == "warn"]
        others = [row["wrong"] > 0 for row in given if name not in row["told"]]
        made[name] = {
            **{what: done[what] for what in ("warn", *HARD)},
            "false drop": sum(a is None and b == 0 for a, b in here),
            "false mask": sum(a is not None and b == 0 for a, b in here),
            "pays": sum(b is not None and b > 0 and (a is None or a < b) for a, b in here),
            "harms": sum(a is not None and (b is None or a > b) for a, b in here),
            "false warning": sum(not wrong for wrong in warned),
            "lift": float(np.mean(warned) / np.mean(others)) if warned and any(others) else None,
        }
    return {
        "seeds": f"{seeds[0]} to {seeds[-1]}", "commit": commit, "events": len(seeds),
        "pairs": len(rows), "wrong": sum(row["wrong"] > 0 for row in given),
        "no curve": len(rows) - len(given),
        "dropped though right": sum(
            row["wrong"] is None and any(one["wrong"] == 0 for one in row["without"].values())
            for row in rows
        ),
        "false alarm of peak fitting": sum(row["differs"] and row["wrong"] == 0 for row in given),
        "peak fitting differs": sum(row["differs"] for row in given),
        "checks": made,
    }  # fmt: skip


def table(made: dict) -> list[str]:
    """The page's lines."""
    pairs, lost = made["pairs"], made["dropped though right"]
    out = [
        f"Seeds {made['seeds']} at {made['commit']}: {made['events']} events, {pairs} pairs of",
        f"mode and sensor, of which {made['no curve']} have no curve and {made['wrong']} one that",
        f"is wrong somewhere. Dropped though right by any check: {lost}, "
        f"{100.0 * lost / pairs:.1f} % (asked: 2 %, and 1 % by each). Peak fitting differs in",
        f"{made['peak fitting differs']}, of which {made['false alarm of peak fitting']} curves",
        "are right.", "",
        "| finding | drops (false) | masks (false) | taken off (false) | pays | harms "
        "| warnings (false) | lift |",
        "|---|---|---|---|---|---|---|---|",
    ]  # fmt: skip
    for name, one in made["checks"].items():
        false = {"drop": one["false drop"]}
        false |= {what: one["false mask"] if one[what] else 0 for what in ("mask", "subtract")}
        cells = [f"{one[what]} ({false[what]})" if one[what] else "" for what in HARD]
        cells += [str(one[what] or "") for what in ("pays", "harms")]
        cells += [f"{one['warn']} ({one['false warning']})" if one["warn"] else ""]
        cells += ["" if one["lift"] is None else f"{one['lift']:.1f}"]
        out.append(f"| {name} | {' | '.join(cells)} |")
    return out


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--events", type=int, default=100)
    parser.add_argument("--seed", type=int, default=430000)
    parser.add_argument("--small", action="store_true", help=f"{SMALL_EVENTS} events")
    parser.add_argument("--rows", type=Path, help="where the rows go")
    parser.add_argument("--page", type=Path, nargs="*", default=[], help="rows of earlier runs")
    parser.add_argument("--commit", default="", help="what was measured")
    parser.add_argument("--json", type=Path, help="where the table's numbers go")
    asked = parser.parse_args()
    rows = [row for path in asked.page for row in json.loads(path.read_text())]
    if not rows:
        for seed in range(asked.seed, asked.seed + (SMALL_EVENTS if asked.small else asked.events)):
            rows += rows_of(seed)
            if asked.rows:
                asked.rows.write_text(json.dumps(rows))
    made = summary(rows, asked.commit)
    lines = table(made)
    print(*lines, sep="\n")
    if asked.json:
        asked.json.write_text(json.dumps(made, indent=1) + "\n")
    if asked.page:
        PAGE.write_text(with_table(PAGE.read_text(encoding="utf-8"), "checks", "\n".join(lines)))


if __name__ == "__main__":
    np.seterr(all="ignore")
    main()
