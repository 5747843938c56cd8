"""The verdict on a campaign in words: what is missing, why, what to do, what it does not say."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import xarray as xr

from bladeroot.report.next_measurement import next_sentence
from bladeroot.report.numbers import fixed, listed, percent, with_std
from bladeroot.report.page import Box, Table
from bladeroot.report.words import Judge, Words, judge_of, words_of
from bladeroot.terms import Terms, spelled

ANSWERS = {
    "nothing-missing": "nothing is missing",
    "named": "cause named",
    "ambiguous": "cause known up to a few",
    "unexplained": "something is missing, cause not in the catalogue",
    "insufficient-data": "too few data",
}
REFUSED = "not this specimen"
QUIET = "nothing shows to be missing, some causes would not show"
# Of a credible set, what is no mechanism.
NO_MECHANISM = {"none": "nothing at all", "none-of-these": "a cause outside the catalogue"}
_SURE_PROBABILITY = 0.9  # above which a cause acts, whatever acts beside it
# Difference of log evidence, 20 to 1, below which one explains about as well as the other.
NEAR_EVIDENCE = 3.0
_TOLD_PROBABILITY = 0.02  # least one of a set of causes that is told
CLASSES = {
    "amplitude": "an effect of the amplitude",
    "force-law": "a law of the load",
    "level": "the same at all loads",
    "time": "a change in time",
    "direction": "an effect of loading and unloading",
    "record": "a fault of records",
}
_UNITS = {
    "m/N": (1e9, "µm/kN"),
    "N": (1e-3, "kN"),
    "kg": (1e3, "g"),
    "m": (1e3, "mm"),
    "1": (1.0, ""),
}


def plain(name: str) -> str:
    """A mechanism's id, or what stands in its place, as words."""
    return NO_MECHANISM.get(name) or spelled(name)


@dataclass(frozen=True)
class Sentences:
    """A verdict in sentences, a list a subject."""

    head: str
    missing: Sequence[str]
    because: Sequence[str]
    odds: Sequence[str]
    gain: Sequence[str]
    next: Sequence[str]

    @property
    def box(self) -> Box:
        """All of it."""
        lines = [*self.missing, *self.because, *self.odds, *self.gain, *self.next]
        return Box(self.head, lines)


def sentences_of(one: xr.Dataset, said: Mapping, simulated: bool) -> Sentences:
    """What is missing, why, and what to do; one: the diagnosis's artifact, said: its verdict."""
    words, judge = words_of(one), judge_of(one)
    head = f"{judge.subject if judge.plural else against(one, said)}: {answer_of(said)}"
    return Sentences(
        f"Simulated campaign. {head}" if simulated else head,
        _missing(said, judge),
        _because(one, said),
        odds(said),
        _gain(said, words, judge),
        next_of(one, said),
    )


def next_of(one: xr.Dataset, said: Mapping) -> list[str]:
    """The next measurement: by what it is expected to bring, else by the cause or what lacks."""
    lacks = [text.partition(": ")[0] for text in lacks_of(one)]
    texts = [*(cause["splitter"] for cause in said["causes"]), *lacks]
    return next_sentence(one) or [f"Measure next: {text}." for text in texts[:1]]


def with_open(said: Mapping) -> dict:
    """The verdict with the causes that the records show; `open`: those that they would not show."""
    shown, quiet = ([c for c in said["causes"] if c["shown"] == side] for side in (True, False))
    return {**said, "causes": shown, "open": quiet}


def causes_of(said: Mapping) -> list[Mapping]:
    """The causes that an answer is of: where one is certain, those that are."""
    certain = [cause for cause in said["causes"] if len(cause["credible_set"]) == 1]
    return certain if said["answer"] == "named" else list(said["causes"])


def answer_of(said: Mapping) -> str:
    """The answer as words."""
    if said.get("refused"):
        return REFUSED
    quiet = said["answer"] in ("ambiguous", "nothing-missing")
    if quiet and said.get("open") and not said["causes"]:
        return QUIET
    return ANSWERS[said["answer"]]


def against(one: xr.Dataset, said: Mapping) -> str:
    """Name of what a verdict judges."""
    return str(said["structure"] or one.attrs["structure"])


def compared_with(one: xr.Dataset, said: Mapping) -> str:
    """The same, or linear modes."""
    return "linear modes" if judge_of(one).plural else against(one, said)


def in_short(one: xr.Dataset, said: Mapping) -> list[str]:
    """The verdict in short: what is missing, and why."""
    judge, words = judge_of(one), words_of(one)
    missing = _missing(said, judge)
    if not said["causes"]:
        if said["answer"] == "nothing-missing" or answer_of(said) == QUIET:
            return [*missing, *_open(said)]
        why = _because(one, said)[:1] or [f"{said['reason'].partition('. ')[0].rstrip('.')}."]
        return [*missing, *why]
    texts = [f"{supposed(cause)}, {_kind(cause)}" for cause in said["causes"]]
    what = {"insufficient-data": "Possible", "unexplained": "Besides"}.get(said["answer"], "Cause")
    gain = [g[0].lower() + g[1:].rstrip(".") for g in _gain(said, words, judge)]
    return [*missing, "; ".join([f"{what}: {'; '.join(texts)}", *gain]) + "."]


def of_level(said: Mapping) -> bool:
    """Whether a cause changes what is the same at all forces, which the model's bias takes up."""
    return any(cause["class"] == "level" for cause in said["causes"])


def between_forces(said: Mapping) -> Mapping:
    """Errors at forces left out; for a level without the model's bias, which would hide them."""
    key = "between_forces_without_bias" if of_level(said) else "between_forces"
    return said["gain"].get(key, {})


def _gain(said: Mapping, words: Words, judge: Judge) -> list[str]:
    """What the causes gain at loads left out."""
    gain = between_forces(said)
    if not gain:
        return []
    loads = f"{words.short or 'load'}s"
    constant = f", what is the same at all {loads} counted," if of_level(said) else ""
    better = "falls" if gain["after"] < gain["before"] else "does not fall"
    before, after = (percent(gain[side], 2) for side in ("before", "after"))
    change = f"{better}, from {before} to {after}" if before != after else f"stays at {before}"
    return [
        f"With {'it' if len(said['causes']) == 1 else 'them'} in the "
        f"{'model' if judge.plural else 'simulation'} the error at {loads} that the fit has not "
        f"seen{constant} {change} of the stick frequency."
    ]


def supposed(cause: Mapping) -> str:
    """A cause's names with its probability, and those that may act in its place, or beside it."""
    text = f"{plain(cause['mechanism'])} ({chance(cause['probability'])})"
    others = [plain(n) for n in cause["credible_set"] if n != cause["mechanism"]]
    beside = ", perhaps beside " if cause["probability"] > _SURE_PROBABILITY else " or "
    return text + beside * bool(others) + listed(others, "or")


def _kind(cause: Mapping) -> str:
    """The classes of a cause in words."""
    return listed([CLASSES[kind] for kind in cause["class"].split(" or ")], "or")


def chance(probability: float) -> str:
    """A probability in per cent, never as certain as it cannot be."""
    if probability > 0.99:
        return "more than 99 %"
    return f"{100 * probability:.0f} %" if probability >= 0.01 else "less than 1 %"


def odds(said: Mapping) -> list[str]:
    """The most probable sets of causes in a line."""
    sets = [(name, p) for name, p in said["probabilities"].items() if p >= _TOLD_PROBABILITY][:4]
    if not sets:
        return []
    every = [name.split("+") for name, _ in sets]
    texts = []
    for names, (_, p) in zip(every, sets, strict=True):
        larger = any(set(names) < set(other) for other in every)
        alone = larger * (" alone" if len(names) == 1 else " only")
        texts.append(f"{listed(list(map(plain, names)))}{alone} {chance(p)}")
    rest = sum(said["probabilities"].values()) - sum(p for _, p in sets)
    texts += [f"all other sets together {chance(rest)}"] if rest > _TOLD_PROBABILITY else []
    return [f"Probabilities: {'; '.join(texts)}."]


def disagreement(verdicts: Sequence[Mapping]) -> list[str]:
    """A line where another structure leads to another answer or cause than the main one."""

    def outcome(said: Mapping) -> tuple:
        return said["answer"], [cause["mechanism"] for cause in said["causes"]]

    others = [said for said in verdicts[1:] if outcome(said) != outcome(verdicts[0])]
    if not others:
        return []
    texts = []
    for said in others:
        names = listed([plain(cause["mechanism"]) for cause in causes_of(said)])
        texts.append(f"{said['structure']}: {answer_of(said)}{', ' + names if names else ''}")
    return [
        "Other structures lead elsewhere, so this is true of the one named above only: "
        f"{'; '.join(texts)}."
    ]


def _missing(said: Mapping, judge: Judge) -> list[str]:
    """What is missing, of each quantity the mode that misses most and how, and the other modes of
    which it goes the same way: a sentence, or where there are many a line each.
    """
    if said["answer"] == "nothing-missing" or answer_of(said) == QUIET:
        return [f"{judge.does('explains', 'explain')} all records within their scatter."]
    rows: dict[tuple[str, bool], list[Mapping]] = {}
    for row in sorted(said["shortfall"], key=lambda row: -abs(row["size"])):
        rows.setdefault((row["quantity"], row["size"] > 0.0), []).append(row)
    texts = []
    for (quantity, _), several in rows.items():
        others = listed([row["mode"] for row in several[1:]])
        also = f" (also in {others})" if others else ""
        texts.append(f"the {quantity} of mode {several[0]['mode']}{also}: {several[0]['trend']}")
    head = judge.does("does not explain", "do not explain")
    if len(texts) > 2:
        return [f"{head}:", *(f"\u2013 {text}" for text in texts)]
    if texts:
        return [f"{head} {'; nor '.join(texts)}."]
    if said["causes"] and all(cause["class"] == "record" for cause in said["causes"]):
        text = judge.does("misses", "miss")
        return [f"{text} nothing that these records show; the records are faulty."]
    return ["Whether something is missing cannot be said."]


def shortfall_table(said: Mapping) -> Table:
    """Everything that is missing, by mode."""
    rows = [
        (row["quantity"], row["mode"], row["trend"], "yes" if row["explained"] else "no")
        for row in said["shortfall"]
    ]
    return Table("What is missing", ("quantity", "mode", "how it runs", "explained"), rows)


def _because(one: xr.Dataset, said: Mapping) -> list[str]:
    """The cause, or the class with what would split it, or what stands against an answer."""
    if said["answer"] == "nothing-missing":
        return []
    lines = []
    for cause in said["causes"]:
        if _is_barred(one, cause):
            continue  # told below, with what it lacks
        if len(cause["credible_set"]) == 1:
            row = one.isel(candidate=one["candidate"].values == cause["mechanism"])
            sizes = listed([f"{plain(p['name'])} {size(p)}" for p in cause["parameters"][:1]])
            what = "Cause" if said["answer"] in ("named", "ambiguous") else "Besides"
            lines.append(
                f"{what}: {plain(cause['mechanism'])} ({_kind(cause)}), "
                f"{row['sentence'].values[0]}; {sizes}"
                + ("" if cause["plausible"] else ", beyond what is physically plausible")
                + "."
            )
        else:
            lines.append(
                f"Cause: {supposed(cause)}, {_kind(cause)}. To decide: {cause['splitter']}."
            )
    lines += [*_not_named(one, next_of(one, said)), *_open(said)]
    left = {row["quantity"] for row in said["shortfall"] if not row["explained"]}
    if said["causes"] and left and said["answer"] != "insufficient-data":
        lines.append(
            f"What remains of the {listed(sorted(left))}, no cause of the catalogue explains."
        )
    if said["answer"] == "unexplained":
        lines.append("No cause of the catalogue explains it.")
    if said["answer"] == "insufficient-data" and lacks_of(one):
        lines.append(f"The campaign lacks {'; '.join(lacks_of(one))}.")
    if said["causes"] and (silent := str(one.attrs.get("not_judged", ""))):
        lines.append(f"{silent[0].upper()}{silent[1:]}.")
    return lines


def _is_barred(one: xr.Dataset, cause: Mapping) -> bool:
    """Whether a cause may not be named, for the campaign lacks what would show it."""
    return cause["mechanism"] in one.attrs.get("insufficient_causes", "").split(";")


def _not_named(one: xr.Dataset, then: Sequence[str]) -> list[str]:
    """What explains most and may not be named, with what it lacks; what decides, unless it is
    what is to be measured next.
    """
    text = str(one.attrs.get("insufficient", ""))
    before, _, decide = text.rpartition("; to decide: ")
    text = before if any(decide in line for line in then) and before else text
    return [f"{text[0].upper()}{text[1:]}."] if text else []


def _open(said: Mapping) -> list[str]:
    """What is not excluded, for the records would hardly show it."""
    lines = []
    for cause in said.get("open", []):
        names = [plain(name) for name in cause["credible_set"] if name not in NO_MECHANISM]
        lines.append(
            f"Not excluded, for these records would hardly show it: {listed(names, 'or')}. To "
            f"decide on the first: {cause['splitter']}."
        )
    return lines


def lacks_of(one: xr.Dataset) -> list[str]:
    """What the campaign lacks, a phrase each."""
    return [text for text in str(one.attrs["lacks"]).split(";") if text]


def cautions(found: Sequence[xr.Dataset], verdicts: Sequence[Mapping]) -> list[str]:
    """What the verdicts do not allow to conclude."""
    texts, lacks = [], {}
    for one, said in zip(found, verdicts, strict=True):
        name = against(one, said)
        for cause in (cause for cause in said["causes"] if not _is_barred(one, cause)):
            rivals: dict[str, list[str]] = {}
            for rival, evidence, why in _barred_rivals(one, cause):
                rivals.setdefault(why, []).append(f"{plain(rival)} ({fixed(evidence, 1)})")
            texts += [
                f"Mind, with {name}: {listed(names)} would explain the records about as well as "
                f"{plain(cause['mechanism'])} ({fixed(cause['log_evidence'], 1)}), or better where "
                f"the log evidence in brackets is larger. Not judged, because: {why}. The cause "
                "above is as sure as that."
                for why, names in rivals.items()
            ]
        if said["causes"] and lacks_of(one) and one.attrs.get("kind") != "none":
            lacks.setdefault("; ".join(lacks_of(one)), []).append(name)
    words = words_of(found[0])
    loads = f"{words.short or 'load'}s"
    gauge = Terms(words.load).say("{gauge}")
    texts += [
        f"With {listed(names)} nothing is said on the {gauge}'s errors and on what is the same at "
        f"all {loads}. The campaign lacks {lack}."
        for lack, names in lacks.items()
    ]
    return texts


def _barred_rivals(one: xr.Dataset, cause: Mapping) -> list[tuple[str, float, str]]:
    """Mechanisms that are not judged and explain the same data about as well as a cause."""
    names, channels = (one[key].values.astype(str) for key in ("candidate", "channel"))
    own = channels[names == cause["mechanism"]]
    return [
        (str(name), float(evidence), str(why))
        for name, channel, kind, evidence, why in zip(
            names,
            channels,
            *(one[k].values for k in ("class", "log_evidence", "barred")),
            strict=True,
        )
        if name != cause["mechanism"]
        and channel in own
        and kind != "smooth"
        and why
        and evidence > cause["log_evidence"] - NEAR_EVIDENCE
    ]


def size(p: Mapping) -> str:
    """A parameter with its standard deviation, in handy units."""
    factor, unit = _UNITS.get(p["unit"], (1.0, p["unit"]))
    text = with_std(factor * p["value"], factor * p["std"], 2, unit)
    return text.replace(" ± ", "\u00a0±\u00a0")
