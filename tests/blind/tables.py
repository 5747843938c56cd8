"""The blind matrix as a page: confusion, what must be shown with its bounds, power curves."""

import pandas as pd
from cases import catalogue, outsiders
from score import share
from tuning import effect

# At least so often named, or the class given (single effects within their sizes).
WANTED = {name: 0.95 for name in catalogue()} | {
    name: 0.80
    for name in ("force-gain", "force-offset", "added-mass", "drift", "mode-beating",
                 "normal-load-variation")
}  # fmt: skip
NOT_ALONE = ("modulus-density", "rig-compliance")


def matrix_page(outcomes: pd.DataFrame, seed: dict, tier: str) -> str:
    """Markdown of all tables of a run; `seed` says where its cases come from."""
    of = ", ".join(f"{name} {value}" for name, value in seed.items())
    parts = [f"{len(outcomes)} cases, tier {tier}, {of}."]
    if outcomes["relative_size"].notna().any():
        parts.append(_power(outcomes))
    else:
        parts += [_claims(outcomes), _by_effect(outcomes), _confusion(outcomes)]
    spent = outcomes[["bench_s", "verdict_s"]].median()
    parts.append(
        f"Median wall time a case: bench {spent['bench_s']:.1f} s, "
        f"diagnosis {spent['verdict_s']:.1f} s."
    )
    return "\n\n".join(parts) + "\n"


def _row(name: str, hits: int, trials: int, wanted: str) -> str:
    part, low, high = share(hits, trials)
    return f"| {name} | {hits} of {trials} | {part:.1%} | {low:.1%} to {high:.1%} | {wanted} |"


def _claims(outcomes: pd.DataFrame) -> str:
    kind = outcomes["hidden"].map(_kind)
    null, outside, pair = (outcomes[kind == k] for k in ("null", "outside", "pair"))
    single = outcomes[kind == "single"]
    compared = outcomes[(outcomes["named"] > 0) & outcomes["parameter"].notna()]
    alone = single[single["hidden"].isin(NOT_ALONE)]
    split = alone[alone["split"].notna()]
    forces = single[
        (single["named"] > 0) & single["hidden"].map(_class).isin(("force-law", "level"))
    ]
    level = forces[forces["hidden"].map(_class) == "level"]
    laws = forces.drop(level.index)
    fitted, counted = "between_forces", "between_forces_without_bias"
    slip = single[(single["named"] > 0) & (single["hidden"] == "joint-slip")]
    rows = [
        ("wrong name, all cases", outcomes["wrong"], "at most 2 %"),
        ("name on a null", null["column"] != "nothing-missing", "at most 2 %"),
        ("wrong name, effect of no catalogue", outside["wrong"], "at most 5 %"),
        ("effect of no catalogue flagged", outside["column"] != "nothing-missing", "75 %"),
        ("level pair named without its splitter", alone["named"] > 0, "never"),
        ("level pair named with its splitter", split["split"] == 1, "always"),
        (
            "error between forces then halved, bias not spared",
            split["split_between_forces"] <= 0.5,
            "",
        ),
        ("error of kn, kt then halved", split["split_k"] <= 0.5, ""),
        ("pair: dominant one named", pair["dominant"], "95 %"),
        ("pair: both named", pair["named"] == 2, "60 %"),
        ("value of a named effect right", compared["parameter"] == 1, "90 %"),
        ("error between forces halved, force laws", laws[fitted] <= 0.5, "always"),
        ("the same, bias not spared, force laws", laws[counted] <= 0.5, ""),
        ("error between forces halved, level effects", level[fitted] <= 0.5, ""),
        ("the same, bias not spared, level effects", level[counted] <= 0.5, "always"),
        ("error of kn, kt halved, level effects", level["k_after"] <= 0.5 * level["k_before"], ""),
        ("kn, kt then right within 3 of their std", level["k_away"] <= 3.0, ""),
        ("damping curves' error less by 40 %, joint-slip", slip["damping_curves"] <= 0.6, "always"),
    ]
    head = "| | cases | share | 95 % bounds | wanted |\n|---|---|---|---|---|"
    lines = [_row(name, int(hits.sum()), len(hits), wanted) for name, hits, wanted in rows]
    return "\n".join([head, *lines])


def _by_effect(outcomes: pd.DataFrame) -> str:
    head = (
        "| effect | class | cases | named | named or class | 95 % bounds | wanted |\n"
        "|---|---|---|---|---|---|---|"
    )
    lines = []
    for name in catalogue():
        here = outcomes[outcomes["hidden"] == name]
        if here.empty:
            continue
        hits = int((here["classed"] > 0).sum())
        part, low, high = share(hits, len(here))
        wanted = "class" if name in NOT_ALONE else f"{WANTED[name]:.0%}"
        lines.append(
            f"| `{name}` | {effect(name).CLASS} | {len(here)} | {int((here['named'] > 0).sum())} |"
            f" {part:.0%} | {low:.0%} to {high:.0%} | {wanted} |"
        )
    return "\n".join([head, *lines])


def _confusion(outcomes: pd.DataFrame) -> str:
    counts = outcomes.groupby(["hidden", "column"]).size()
    head = "| hidden | verdicts (cases) |\n|---|---|"
    lines = []
    for name in sorted(outcomes["hidden"].unique()):
        said = counts[name].sort_values(ascending=False)
        lines.append(f"| {name} | {', '.join(f'{c} ({n})' for c, n in said.items())} |")
    return "\n".join([head, *lines])


def _power(outcomes: pd.DataFrame) -> str:
    sizes = sorted(outcomes["relative_size"].unique())
    head = "| effect (named or class) | " + " | ".join(f"{s:g} x bound" for s in sizes) + " |"
    lines = [head, "|---" * (len(sizes) + 1) + "|"]
    for name in catalogue():
        here = outcomes[outcomes["hidden"] == name]
        hit = here.assign(hit=here["classed"] > 0).groupby("relative_size")["hit"].mean()
        lines.append(f"| `{name}` | " + " | ".join(f"{hit.get(s, 0):.0%}" for s in sizes) + " |")
    return "\n".join(lines)


def _class(hidden: str) -> str:
    return effect(hidden).CLASS if hidden in catalogue() else ""


def _kind(hidden: str) -> str:
    if hidden == "nothing":
        return "null"
    if "+" in hidden:
        return "pair"
    return "outside" if hidden in outsiders() else "single"
