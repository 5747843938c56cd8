"""Ring-downs as they are measured, drawn: what the product makes of every mode and sensor.

    python benchmarks/real_like.py --events 60 --seed 1000 --json found.json
    python benchmarks/real_like.py --small                     # some seconds
    python benchmarks/real_like.py --show 1003                 # one event, a line for every pair
    python benchmarks/real_like.py --rows a.json b.json --commit abc1234 --json real_like.json
    python benchmarks/real_like.py --page real_like.json       # that summary into README.md

Event i of a run has the seed SEED + i. Seeds below 100000 are for tuning; those from 100000 on are
for scoring only, once, and nothing may be set by looking at them (README.md says which are used).
"""

import argparse
import json
import tempfile
from pathlib import Path

import numpy as np
from drawn_world import campaign, draw
from drawn_world.bound import bounds
from drawn_world.product import analysed, judged_together, unchecked
from drawn_world.table import lines, markdown, summary
from drawn_world.verdicts import score
from foreign_lab.score import with_table

PAGE = Path(__file__).with_name("README.md")
SMALL_EVENTS = 4


def scored(seed: int, bound: bool = True) -> list[dict]:
    """All pairs of mode and sensor of one event."""
    event, rows = draw(seed), []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        entries = campaign(event, folder)
        answers = [analysed(entry) for entry in entries]
        judged_together(answers)
        for entry, answer in zip(entries, answers, strict=True):
            mode, sensor = entry["mode"], entry["sensor"]
            loose = unchecked(answer) if not answer.curves and not answer.crash else {}
            least = bounds(event, mode, sensor) if bound and answer.curves else None
            rows.append(score(event, mode, sensor, answer, loose, least))
    return rows


def shown(row: dict) -> str:
    """One record in a line."""
    text = f"{row['seed']} m{row['mode']} s{row['sensor']} {row['class']:20s}"
    for name, factor, unit in (("frequency", 1e6, "ppm"), ("loss_factor", 100.0, "%")):
        if name in row:
            one = row[name]
            text += (
                f" | {factor * one['median relative']:.3g}"
                f" (worst {factor * one['worst relative']:.3g})"
                f" {unit}, worst {one['worst stated']:.3g} stated"
            )
    return f"{text} | {' '.join(row.get('wrong where', []))} | {' '.join(row['findings'])}"


def paged(made: dict) -> str:
    """README.md with the tables of a summary."""
    return with_table(PAGE.read_text(), "real_like", "\n".join(markdown(made)) + "\n")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--events", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1000)
    parser.add_argument("--small", action="store_true", help=f"{SMALL_EVENTS} events, no bound")
    parser.add_argument(
        "--show", type=int, nargs="*", default=[], help="only these seeds, a line a pair"
    )
    parser.add_argument("--json", type=Path)
    parser.add_argument("--rows", type=Path, nargs="*", default=[], help="JSON of earlier runs")
    parser.add_argument("--commit", default="", help="what was scored")
    parser.add_argument("--page", type=Path, help="summary that goes into README.md")
    chosen = parser.parse_args()
    if chosen.page:
        PAGE.write_text(paged(json.loads(chosen.page.read_text())))
        return
    if chosen.rows:
        rows = [row for path in chosen.rows for row in json.loads(path.read_text())]
        seeds = sorted({row["seed"] for row in rows})
        made = summary(rows, f"{seeds[0]} to {seeds[-1]}", chosen.commit)
        print(*markdown(made), sep="\n")
        if chosen.json:
            chosen.json.write_text(json.dumps(made, indent=1, default=float) + "\n")
        return
    count = SMALL_EVENTS if chosen.small else chosen.events
    seeds = chosen.show or range(chosen.seed, chosen.seed + count)
    rows = []
    for seed in seeds:
        own = scored(seed, bound=not chosen.small)
        rows += own
        if chosen.show:
            print(*map(shown, own), sep="\n")
    print(f"seeds {seeds[0]} to {seeds[-1]}")
    print(*lines(rows), sep="\n")
    if chosen.json:
        chosen.json.write_text(json.dumps(rows, indent=1, default=float))


if __name__ == "__main__":
    np.seterr(all="ignore")
    main()
