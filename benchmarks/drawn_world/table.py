"""The summary of many scored records."""

from collections import Counter

import numpy as np

from .verdicts import CLASSES, COUNTS

CURVES = ("right", "wrong, told", "wrong in silence")  # classes with a curve that is given


def given(rows):
    return [row for row in rows if row["class"] in CURVES]


def lines(rows: list[dict]) -> list[str]:
    """Text to print: classes, errors by part of the curve, faults by feature with seeds."""
    counts = [Counter(row[one] for row in rows) for one in COUNTS]
    out = [f"{len(rows)} pairs of mode and sensor in {len({r['seed'] for r in rows})} events"]
    out[0] += "; in brackets as read, and with the largest of a curve's points allowed for"
    for name in CLASSES:
        shares = [100 * one[name] / len(rows) for one in counts]
        text = f"  {name:22s} {counts[0][name]:5d}  {shares[0]:5.1f} %"
        out.append(f"{text}  ({shares[1]:.1f} %, {shares[2]:.1f} %)")
    out.append(
        "curves given, by quantity:" + " " * 9 + "within 3 stated | chi start middle end |"
        " median error | over bound"
    )
    for name, unit, factor in (("frequency", "ppm", 1e6), ("loss_factor", "%", 100.0)):
        some = [row[name] for row in given(rows)]
        if not some:
            continue
        weight = [row["points"] for row in given(rows)]
        within = 100 * np.average([one["within 3"] for one in some], weights=weight)
        chi = [
            np.median([one["chi"][part] for one in some if part in one["chi"]] or [np.nan])
            for part in ("start", "middle", "end")
        ]
        least = [one["over bound"] for one in some if "over bound" in one]
        middle = np.median([one["median relative"] for one in some]) * factor
        out.append(
            f"  {name:22s} {within:14.1f} % points | {chi[0]:9.2f} {chi[1]:6.2f} {chi[2]:5.2f} |"
            f" {middle:8.3g} {unit:3s} | {np.median(least or [np.nan]):6.2f} ({len(least)})"
        )
    out.append(
        f"CPU of both stages: median {np.median([row['cpu_s'] for row in rows]):.2f} s a record"
    )
    out += by_feature(rows) + by_finding(rows)
    return out


def summary(rows: list[dict], seeds: str, commit: str) -> dict:
    """The numbers that the README's table shows, of scored pairs."""
    counts = [Counter(row[one] for row in rows) for one in COUNTS]
    made = {"seeds": seeds, "commit": commit, "pairs": len(rows)}
    made["events"] = len({row["seed"] for row in rows})
    made["classes"] = {name: [100 * one[name] / len(rows) for one in counts] for name in CLASSES}
    weight = [row["points"] for row in given(rows)]
    for name in ("frequency", "loss_factor"):
        some = [row[name] for row in given(rows)]
        made[name] = {
            "within 3 stated": 100 * np.average([one["within 3"] for one in some], weights=weight),
            "median error": np.median([one["median relative"] for one in some]),
            "over bound": np.median([one["over bound"] for one in some if "over bound" in one]),
        }
    made["cpu_s"] = np.median([row["cpu_s"] for row in rows])
    return made


def markdown(made: dict) -> list[str]:
    """The README's table of a summary."""
    out = [
        f"Scored once at {made['commit']}, on seeds {made['seeds']}: {made['events']} events,",
        f"{made['pairs']} pairs of mode and sensor.", "",
        "| class | of pairs | as read | with the largest of a curve's points allowed for |",
        "|---|---|---|---|",
    ]  # fmt: skip
    for name, shares in made["classes"].items():
        out.append(f"| {name} | {' | '.join(f'{share:.1f} %' for share in shares)} |")
    out += ["", "| curves given | frequency | loss factor |", "|---|---|---|"]
    both = [made["frequency"], made["loss_factor"]]
    for text, name, form in (
        ("points within three stated errors", "within 3 stated", "{:.1f} %"),
        ("median error, relative", "median error", "{:.2g}"),
        ("error over the Cramer-Rao bound", "over bound", "{:.1f}"),
    ):
        out.append(f"| {text} | {' | '.join(form.format(one[name]) for one in both)} |")
    return [
        *out,
        "",
        f"CPU of a record, all stages, reading included: {made['cpu_s']:.2f} s in the median.",
    ]


def by_feature(rows) -> list[str]:
    """Shares of classes where a feature is there, and seeds to repeat them with."""
    out = [
        "by feature, in %:               pairs  right  told silent drop-right drop-other    silent:"
    ]
    names = sorted({f for row in rows for f in row["features"]})
    for name in names:
        some = [r for r in rows if name in r["features"]]
        count = Counter(row["class"] for row in some)
        other = len(some) - sum(count[c] for c in CURVES) - count["dropped though right"]
        shown = examples([r for r in some if r["class"] == "wrong in silence"])
        parts = [100 * count[c] / len(some) for c in (*CURVES, "dropped though right")]
        out.append(
            f"  {name:28s} {len(some):6d} {parts[0]:6.0f} {parts[1]:5.0f} {parts[2]:6.0f}"
            f" {parts[3]:10.0f} {100 * other / len(some):10.0f}    {shown}"
        )
    return out


def by_finding(rows) -> list[str]:
    """How often each finding is told, and beside what."""
    out = [
        "by finding, counted:            pairs  right  told drop-right drop-other    drop-right:"
    ]
    for name in sorted({f for row in rows for f in row["findings"]}):
        some = [row for row in rows if name in row["findings"]]
        count = Counter(row["class"] for row in some)
        right, told = count["right"], count["wrong, told"]
        dropped = count["dropped though right"]
        other = len(some) - right - told - dropped
        shown = examples([r for r in some if r["class"] == "dropped though right"])
        out.append(
            f"  {name:28s} {len(some):6d} {right:6d} {told:5d} {dropped:10d} {other:10d}    {shown}"
        )
    return out


def examples(rows, most: int = 4) -> str:
    return " ".join(f"{row['seed']}:m{row['mode']}s{row['sensor']}" for row in rows[:most])
