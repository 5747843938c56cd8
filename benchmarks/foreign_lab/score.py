"""What the verdicts are worth: answer classes by kind, effect and form; sizes; log score."""

import itertools
import math
from collections import Counter
from collections.abc import Iterable

NONE, OTHER = "none", "none-of-these"
# An answer without probabilities is taken at this word (a name is given for certain).
STATED = 0.95
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
        inside = possible(verdict)
        return f"ambiguous {'with' if hidden & inside else 'without'} truth"
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
    ("load-dependent-stiffness", "exponent"): "slope_kn",
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


def report(cases: Iterable[tuple[dict, dict]]) -> str:
    """Tables in Markdown: outcomes by kind and by effect and form, log score, reliability."""
    cases = list(cases)
    lines = [_outcome_table("kind", cases, lambda t: [t["kind"]])]
    lines.append(_outcome_table("effect", [c for c in cases if c[0]["effects"]], _ids))
    lines.append(_outcome_table("form", [c for c in cases if len(c[0]["effects"]) == 1], _forms))
    lines.append(_log_scores(cases) + "\n" + _reliability(cases))
    lines.append(_wrong(cases))
    off = [deviation for truth, verdict in cases for _, deviation in sizes(truth, verdict)]
    inside = sum(abs(value) <= 3 for value in off)
    lines.append(f"sizes within 3 standard deviations: {inside} of {len(off)}")
    return "\n\n".join(lines) + "\n"


def _ids(truth: dict) -> list[str]:
    mark = "" if len(truth["effects"]) == 1 else " (of a pair)"
    return [one["id"] + mark for one in truth["effects"]]


def _forms(truth: dict) -> list[str]:
    return [f"{one['id']}: {one['form']}" for one in truth["effects"]]


def _outcome_table(title: str, cases: list, keys_of) -> str:
    counts: dict[str, Counter] = {}
    for truth, verdict in cases:
        for key in keys_of(truth):
            counts.setdefault(key, Counter())[outcome(truth, verdict)] += 1
    used = [one for one in OUTCOMES if any(c[one] for c in counts.values())]
    rows = [f"| {title} | cases | " + " | ".join(used) + " |", "|---" * (len(used) + 2) + "|"]
    for key in sorted(counts):
        cells = [str(counts[key][one] or "") for one in used]
        rows.append(f"| {key} | {counts[key].total()} | " + " | ".join(cells) + " |")
    return "\n".join(rows)


def _log_scores(cases: list) -> str:
    rows = ["| kind | cases | mean log score | stated probabilities |", "|---|---|---|---|"]
    for kind in sorted({truth["kind"] for truth, _ in cases}):
        mine = [(t, v) for t, v in cases if t["kind"] == kind]
        mean = sum(log_score(t, v) for t, v in mine) / len(mine)
        stated = sum(bool(v.get("probabilities")) for _, v in mine)
        rows.append(f"| {kind} | {len(mine)} | {mean:.2f} | {stated} |")
    return "\n".join(rows)


def _reliability(cases: list) -> str:
    """Of all sets that were given a probability in a range, as many should be true."""
    edges = (0.0, 0.05, 0.2, 0.5, 0.8, 0.9, 0.97, 1.0001)
    rows = ["", "| stated | sets | mean stated | true |", "|---|---|---|---|"]
    pairs = [
        (value, is_true(truth, key))
        for truth, verdict in cases
        for key, value in probabilities(verdict).items()
    ]
    for low, high in itertools.pairwise(edges):
        mine = [(value, right) for value, right in pairs if low <= value < high]
        if mine:
            mean = sum(value for value, _ in mine) / len(mine)
            right = sum(right for _, right in mine) / len(mine)
            rows.append(f"| {low:g} to {min(high, 1):g} | {len(mine)} | {mean:.3f} | {right:.3f} |")
    return "\n".join(rows)


def _wrong(cases: list) -> str:
    rows = ["| seed | hidden | named for certain |", "|---|---|---|"]
    for truth, verdict in cases:
        if outcome(truth, verdict) == "wrong, certain":
            hidden = (
                ", ".join(f"{one['id']} ({one['form']})" for one in truth["effects"]) or "nothing"
            )
            rows.append(f"| {truth['seed']} | {hidden} | {', '.join(sorted(names(verdict)))} |")
    return "\n".join(rows)
