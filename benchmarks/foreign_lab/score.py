"""What the verdicts are worth: answer classes by kind, effect and form; sizes; log score."""

import itertools
import math
from collections import Counter
from collections.abc import Iterable

NONE, OTHER = "none", "none-of-these"
# An answer without probabilities is taken at this word (a name is given for certain).
STATED = 0.95
LEAST_STATED = 0.02  # probability of a set that is kept with the results
OUTCOMES = (
    "right, certain",
    "part right, certain",
    "kin, certain",
    "wrong, certain",
    "ambiguous with truth",
    "ambiguous without truth",
    "unexplained",
    "insufficient",
    "nothing missing",
)


def probabilities(verdict: dict) -> dict[str, float]:
    """Posterior over sets of causes; from a verdict without one, its answer at `STATED`."""
    given = verdict.get("probabilities")
    if isinstance(given, dict) and given:
        return {str(key): float(value) for key, value in given.items()}
    answer, named = verdict["answer"], names(verdict)
    if answer == "nothing-missing":
        key = NONE
    elif answer == "named":
        key = "+".join(sorted(named))
    elif answer == "unexplained":
        key = OTHER
    else:
        members = [m for cause in verdict["causes"] for m in cause["credible_set"]]
        sets = sorted(set(members)) or [NONE]
        return {one: STATED / len(sets) for one in sets} | {OTHER: 1 - STATED}
    return {key: STATED, (OTHER if key != OTHER else NONE): 1 - STATED}


def names(verdict: dict) -> set[str]:
    """What is named for certain: causes alone in their credible set."""
    return {
        cause["mechanism"]
        for cause in verdict.get("causes", [])
        if cause.get("mechanism") and len(cause.get("credible_set", [None])) <= 1
    }


def possible(verdict: dict) -> set[str]:
    """All that is named or in a credible set."""
    inside = {m for cause in verdict.get("causes", []) for m in cause.get("credible_set", [])}
    return inside | names(verdict)


def outcome(truth: dict, verdict: dict) -> str:
    """One of `OUTCOMES`. A certain wrong name beside a right one counts as wrong."""
    effects = truth["effects"]
    hidden = {one["id"] for one in effects}
    kin = {name for one in effects for name in one["kin"]}
    answer, named = verdict["answer"], names(verdict)
    if answer == "named" or (answer == "unexplained" and named):
        if named - hidden - kin:
            return "wrong, certain"
        if named - hidden:
            return "kin, certain"
        if named:
            return "right, certain" if named == hidden else "part right, certain"
    if answer == "ambiguous" or (answer == "named" and not named):
        true = hidden | kin | ({OTHER} if any(one["outside"] for one in effects) else set())
        return f"ambiguous {'with' if (true or {NONE}) & possible(verdict) else 'without'} truth"
    if answer == "unexplained":
        return "unexplained"
    return "insufficient" if answer == "insufficient-data" else "nothing missing"


def log_score(truth: dict, verdict: dict) -> float:
    """ln of the probability given to the truth, no less than ln 0.001."""
    given = probabilities(verdict)
    return math.log(max(sum(p for key, p in given.items() if is_true(truth, key)), 1e-3))


def is_true(truth: dict, key: str) -> bool:
    """Whether a set of a verdict's probabilities is the truth.

    What no catalogue is known to have is `OTHER`, or a name that describes it fairly.
    """
    if truth["kind"] == "null":
        return key == NONE
    fair = {
        name
        for one in truth["effects"]
        if one["outside"]
        for name in (OTHER, one["id"], *one["kin"])
    }
    return key in fair or key == "+".join(sorted(one["id"] for one in truth["effects"]))


# Parameter of a named cause in a verdict: the measure of the truth that it should be.
SIZES = {
    ("force-gain", "gain"): "gain",
    ("force-offset", "offset"): "offset",
    ("added-mass", "mass"): "mass",
    ("load-dependent-stiffness", "exponent"): "slope",
    ("force-relaxation", "loss"): "size",
}


def sizes(truth: dict, verdict: dict) -> list[tuple[str, float]]:
    """(id, deviation in stated standard deviations) of right names whose size is comparable."""
    hidden = {one["id"]: one for one in truth["effects"]}
    found = []
    for cause in verdict.get("causes", []):
        one = hidden.get(cause["mechanism"])
        for parameter in cause.get("parameters", []) if one else []:
            measure = SIZES.get((cause["mechanism"], parameter["name"]))
            true = {"size": one["size"], **one["measures"]}
            if measure in true and parameter["std"]:
                off = parameter["value"] - true[measure]
                found.append((cause["mechanism"], off / parameter["std"]))
    return found


def stated_causes(truth: dict, verdict: dict) -> list[tuple[float, bool]]:
    """Probability of each cause that the verdict shows, and whether it, or its kin, was hidden."""
    fair = {name for one in truth["effects"] for name in (one["id"], *one["kin"])}
    shown = [c for c in verdict.get("causes", []) if verdict["answer"] != "nothing-missing"]
    return [
        (c["probability"], c["mechanism"] in fair)
        for c in shown
        if c.get("probability") is not None and c["class"] != "record"
    ]


def row(truth: dict, verdict: dict) -> dict:
    """What a case's verdict was worth, as kept with the results."""
    hidden = {one["id"] for one in truth["effects"]}
    inside = possible(verdict) | names(verdict)
    stated = probabilities(verdict)
    return {
        "seed": truth["seed"],
        "kind": truth["kind"],
        "hidden": [[one["id"], one["form"]] for one in truth["effects"]],
        "answer": verdict["answer"],
        "named": sorted(names(verdict)),
        "outcome": outcome(truth, verdict),
        "inside": sorted(hidden & inside),
        "choice": len(inside),
        "possible": sorted(verdict.get("possible", {})),
        "log_score": round(log_score(truth, verdict), 4),
        "stated": [
            [round(p, 3), is_true(truth, key)] for key, p in stated.items() if p >= LEAST_STATED
        ],
        "causes": [[round(p, 3), right] for p, right in stated_causes(truth, verdict)],
        "sizes": [[name, round(off, 2)] for name, off in sizes(truth, verdict)],
        "seconds": verdict.get("seconds", {}),
    }


def report(rows: Iterable[dict], brief: bool = False) -> str:
    """Tables in Markdown of `row`s: outcomes by kind, effect and form, log score, reliability.

    brief: without effects, wrong names, sizes and times.
    """
    rows = list(rows)
    kinds = _outcome_table("kind", rows, lambda r: [r["kind"]])
    lines = [
        kinds,
        _inside(rows),
        _log_scores(rows),
        _reliability("sets", [pair for one in rows for pair in one["stated"]]),
        _reliability("causes", [pair for one in rows for pair in one["causes"]]),
    ]
    if brief:
        return "\n\n".join(lines) + "\n"
    lines += [_outcome_table("effect", rows, _ids), _wrong(rows)]
    off = [deviation for one in rows for _, deviation in one["sizes"]]
    lines.append(
        f"sizes within 3 standard deviations: {sum(abs(v) <= 3 for v in off)} of {len(off)}"
    )
    spent = sorted(one["seconds"]["diagnosis"] for one in rows if one["seconds"])
    if spent:
        lines.append(f"CPU time of a verdict: median {spent[len(spent) // 2]:.1f} s, at most "
                     f"{spent[-1]:.1f} s")  # fmt: skip
    return "\n\n".join(lines) + "\n"


def loop_report(rows: Iterable[dict], brief: bool = False) -> str:
    """Of the loops that were not right at once: how they end, and what was asked for.

    brief: what was asked for only of those that do not end right.
    """
    open_ = [one for one in rows if not one["steps"][0]["outcome"].startswith("right")]
    ends = Counter(one["steps"][-1]["outcome"] for one in open_)
    lines = [f"| of {len(open_)} not right at once | |", "|---|---|"]
    lines += [f"| {end} | {count} |" for end, count in ends.most_common()]
    lines += ["", "| seed | hidden | asked for | end |", "|---|---|---|---|"]
    for one in open_:
        if brief and one["steps"][-1]["outcome"] == OUTCOMES[0]:
            continue
        hidden = ", ".join(f"{name} ({form})" for name, form in one["hidden"])
        asked = "; ".join(step["asked"] for step in one["steps"] if step["asked"])
        lines.append(f"| {one['seed']} | {hidden} | {asked} | {one['steps'][-1]['outcome']} |")
    return "\n".join(lines) + "\n"


def with_table(page: str, name: str, table: str) -> str:
    """A page with the table between its marks `<!-- name -->` and `<!-- end of name -->`."""
    first, last = f"<!-- {name} -->\n", f"<!-- end of {name} -->"
    before, _, rest = page.partition(first)
    _, found, after = rest.partition(last)
    if not found:
        raise ValueError(f"expected the marks {first.strip()} and {last}")
    return f"{before}{first}\n{table}\n{last}{after}"


def _ids(one: dict) -> list[str]:
    mark = "" if len(one["hidden"]) == 1 else " (of a pair)"
    return [name + mark for name, _ in one["hidden"]]


def _outcome_table(title: str, rows: list, keys_of) -> str:
    counts: dict[str, Counter] = {}
    for one in rows:
        for key in keys_of(one):
            counts.setdefault(key, Counter())[one["outcome"]] += 1
    used = [one for one in OUTCOMES if any(c[one] for c in counts.values())]
    lines = [f"| {title} | cases | " + " | ".join(used) + " |", "|---" * (len(used) + 2) + "|"]
    for key in sorted(counts):
        cells = [str(counts[key][one] or "") for one in used]
        lines.append(f"| {key} | {counts[key].total()} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def _inside(rows: list) -> str:
    """How often all that was hidden is named or in a credible set, and how large these are."""
    lines = [
        "| kind | all hidden inside | any | mean number of names inside | all in the 95 % set "
        "| its mean size |",
        "|---|---|---|---|---|---|",
    ]
    for kind in sorted({one["kind"] for one in rows}):
        mine = [one for one in rows if one["kind"] == kind]
        all_ = sum(len(one["inside"]) == len(one["hidden"]) for one in mine if one["hidden"])
        any_ = sum(bool(one["inside"]) for one in mine)
        true = [{name for name, _ in one["hidden"]} or {NONE} for one in mine]
        set_ = sum(t <= set(one["possible"]) for t, one in zip(true, mine, strict=True))
        mean, wide = (
            sum(sizes) / len(mine)
            for sizes in ((r["choice"] for r in mine), (len(r["possible"]) for r in mine))
        )
        shares = ["" if kind == "null" else f"{n} of {len(mine)}" for n in (all_, any_)]
        lines.append(
            f"| {kind} | {shares[0]} | {shares[1]} | {mean:.1f} | {set_} of {len(mine)} "
            f"| {wide:.1f} |"
        )
    return "\n".join(lines)


def _log_scores(rows: list) -> str:
    lines = ["| kind | cases | mean log score |", "|---|---|---|"]
    for kind in sorted({one["kind"] for one in rows}):
        mine = [one["log_score"] for one in rows if one["kind"] == kind]
        lines.append(f"| {kind} | {len(mine)} | {sum(mine) / len(mine):.2f} |")
    return "\n".join(lines)


def _reliability(what: str, pairs: list) -> str:
    """Of all that were given a probability in a range, as many should be true; with the standard
    deviation of the number that would be, were the probabilities right.
    """
    edges = (LEAST_STATED, 0.05, 0.2, 0.5, 0.8, 0.9, 0.97, 1.0001)
    lines = [f"| stated | {what} | mean stated | true | +- |", "|---|---|---|---|---|"]
    for low, high in itertools.pairwise(edges):
        mine = [(value, right) for value, right in pairs if low <= value < high]
        if mine:
            mean = sum(value for value, _ in mine) / len(mine)
            right = sum(right for _, right in mine) / len(mine)
            error = math.sqrt(sum(value * (1 - value) for value, _ in mine)) / len(mine)
            lines.append(
                f"| {low:g} to {min(high, 1):g} | {len(mine)} | {mean:.3f} | {right:.3f} "
                f"| {error:.3f} |"
            )
    return "\n".join(lines)


def _wrong(rows: list) -> str:
    lines = ["| seed | hidden | named for certain |", "|---|---|---|"]
    for one in rows:
        if one["outcome"] == "wrong, certain":
            hidden = ", ".join(f"{name} ({form})" for name, form in one["hidden"]) or "nothing"
            lines.append(f"| {one['seed']} | {hidden} | {', '.join(one['named'])} |")
    return "\n".join(lines)
