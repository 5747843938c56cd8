"""How a verdict compares with the sealed answer."""

from dataclasses import dataclass

from scipy.stats import beta
from tuning import effect

# Effects whose size is defined as the diagnosis' parameter is (docs/blind.md), and how close a
# value must come: relative, or in its own standard deviations.
COMPARABLE = (
    "geometric-hardening",
    "quadratic-drag",
    "load-dependent-stiffness",
    "incomplete-contact",
    "force-gain",
    "force-offset",
    "added-mass",
    "drift",
    "force-relaxation",
    "loading-hysteresis",
)
RELATIVE, DEVIATIONS = 0.30, 3.0
SECURE = ("named", "ambiguous")


@dataclass(frozen=True)
class Outcome:
    """What a verdict was worth.

    `column` is what it said, for the confusion matrix: a mechanism, `class:<class>`, or an answer
    without a name. `named` and `classed` count the hidden effects that were named, or given at
    least by their class; `wrong` says that something was named that is not there; `parameter` is
    1 or 0 where the value of a named effect can be compared, None where not.
    """

    column: str
    named: int
    classed: int
    wrong: bool
    dominant: bool
    parameter: int | None


def known_as(name: str) -> str:
    """What the catalogue calls a hidden effect."""
    return getattr(effect(name), "CAUSE", name)


def score(answer: dict, verdict: dict) -> Outcome:
    """Score a verdict (the content of verdict.json) against a sealed answer."""
    hidden = [known_as(name) for name, _ in answer["effects"]]
    classes = {known_as(name): effect(name).CLASS for name, _ in answer["effects"]}
    causes = verdict["causes"] if verdict["answer"] in SECURE else []
    sure, sets = [], []
    for cause in causes:
        choice = set(cause["credible_set"]) | {cause["mechanism"]}
        (sure if len(choice) == 1 else sets).append((cause, choice))
    names = {cause["mechanism"] for cause, _ in sure}
    # What the records would not show is not excluded, which is no statement that it is there.
    shown = [cause for cause, choice in sets if "none" not in choice or cause["probability"] > 0.5]
    given = {cause["class"] for cause in shown}
    offered = set().union(*(choice for _, choice in sets)) if sets else set()
    named = [name for name in hidden if name in names]
    classed = [
        name for name in hidden if name in names or name in offered or classes[name] in given
    ]
    wrong = not names <= set(hidden)
    if not sure and not shown:
        column = "nothing-missing" if sets else verdict["answer"]
    elif sure:
        column = "+".join(sorted(names))
    else:
        column = "+".join(sorted(f"class:{name}" for name in given))
    first = causes[0] if causes else None
    dominant = first is not None and (
        first["mechanism"] in hidden
        or bool(set(first["credible_set"]) & set(hidden))
        or (len(first["credible_set"]) > 1 and first["class"] in classes.values())
    )
    return Outcome(
        column=column,
        named=len(named),
        classed=len(classed),
        wrong=wrong,
        dominant=bool(dominant),
        parameter=_parameter(answer, [cause for cause, _ in sure]),
    )


def _parameter(answer: dict, causes: list[dict]) -> int | None:
    """Whether the value of the named effect is right; None where it cannot be compared."""
    sizes = dict(answer["effects"])
    for cause in causes:
        if cause["mechanism"] in sizes and cause["mechanism"] in COMPARABLE:
            size = sizes[cause["mechanism"]]
            value, std = values(cause)
            miss = abs(value - size)
            return int(miss <= RELATIVE * abs(size) or miss <= DEVIATIONS * std)
    return None


def values(cause: dict) -> tuple[float, float]:
    """The first parameter of a cause: value and standard deviation."""
    parameters = cause["parameters"]
    first = next(iter(parameters.values())) if isinstance(parameters, dict) else parameters[0]
    return float(first["value"]), float(first["std"])


def left_over(verdict: dict) -> dict[str, float]:
    """Held-out error after over before: between forces and of damping curves; NaN if absent."""
    gain = verdict.get("gain") or {}
    places = {
        "between_forces": gain.get("between_forces"),
        "between_forces_without_bias": gain.get("between_forces_without_bias"),
        "damping_curves": gain.get("within_records", {}).get("loss_factor"),
    }
    return {
        name: sides["after"] / sides["before"] if sides else float("nan")
        for name, sides in places.items()
    }


def share(successes: int, trials: int, confidence: float = 0.95) -> tuple[float, float, float]:
    """Share with its two-sided exact bounds (Clopper-Pearson); (nan, 0, 1) without trials."""
    if trials == 0:
        return float("nan"), 0.0, 1.0
    tail = (1 - confidence) / 2
    low = beta.ppf(tail, successes, trials - successes + 1) if successes else 0.0
    high = beta.ppf(1 - tail, successes + 1, trials - successes) if successes < trials else 1.0
    return successes / trials, float(low), float(high)
