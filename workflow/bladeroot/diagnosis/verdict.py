"""The answer in the words of `verdict.json`."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import xarray as xr

from bladeroot.diagnosis.causes import places
from bladeroot.diagnosis.curve_model import stretched
from bladeroot.diagnosis.diagnose import Diagnosis
from bladeroot.diagnosis.gain import gains
from bladeroot.diagnosis.guards import CERTAIN, STRAINED
from bladeroot.diagnosis.naming import Cause, Found
from bladeroot.diagnosis.plausibility import by_effect, changes, plausible, sizes
from bladeroot.diagnosis.posterior import (
    NONE,
    UNKNOWN,
    Sets,
    as_shown,
    credible,
    inclusion,
    labelled,
    together,
)
from bladeroot.diagnosis.shortfall import of_curves, of_records
from bladeroot.diagnosis.sufficiency import FEW

SCHEMA = "bladeroot-verdict-1"
# Along what a shortfall is told, by what its cause is a law of.
_AXES = {"sign": "direction", "since": "time in a clamping", "clamping": "time"}


def verdict(made: Diagnosis, every: Diagnosis | None = None) -> dict:
    """As `workflow/bladeroot/schemas/verdict.schema.yaml` has it.

    every: the same with the records below the force of full contact, if such were left out; the
    reason then says what they would change.
    """
    sets = probabilities(made)
    causes = _causes(made, sets)
    sets = sets if made.found or causes else {}  # where no data were judged
    answer = _answer(made, causes)
    reason = _reason(made, answer) + (_below(made, every) if every else "")
    return {
        "schema": SCHEMA,
        "campaign": str(made.seen.attrs.get("campaign", "")),
        "structure": made.simulated.structure,
        "answer": answer,
        "probabilities": labelled(sets),
        "possible": {name: round(value, 9) for name, value in credible(sets).items()},
        "causes": causes,
        "shortfall": _shortfall(made),
        "gain": gains(made),
        "records": records_of(made.seen),
        "reason": made.terms.say(reason),
    }


def _causes(made: Diagnosis, sets: Sets) -> list[dict]:
    """Causes of all channels, what explains most first; record faults by how many records."""
    rows = []
    for found in made.found:
        rows += [(cause.gain, _cause(made, found, cause, sets)) for cause in found.causes]
        if found.open:
            supposed, cause = _as_if(found)
            rows.append((cause.gain, _cause(made, supposed, cause, sets)))
    for one in made.faulty:
        if one.named:
            rows.append((one.log_odds, _fault(one)))
    rows = [row for _, row in sorted(rows, key=lambda pair: -pair[0])]
    return [row | {"splitter": made.terms.say(row["splitter"])} for row in rows]


def _cause(made: Diagnosis, found: Found, cause: Cause, sets: Sets) -> dict:
    mechanism, number = cause.mechanism, [one is cause for one in found.causes].index(True)
    place = places([one.mechanism for one in found.causes], found.channel.base)[number]
    by_id = {one.id: one for one in found.channel.candidates}
    own = sizes(mechanism, found.final, place)
    own[0] = found.sizes.get(mechanism.id, own[0])
    doubt = made.simulated.doubt(mechanism) if found.channel.name == "stick" else 0.0
    if doubt:
        moved = doubt * by_effect(mechanism, found.final, place, number)
        own = [
            (value, float(np.hypot(std, more)))
            for (value, std), more in zip(own, moved, strict=True)
        ]
    kinds = sorted({by_id[name].kind for name in cause.credible if name in by_id})
    chance = inclusion(sets, mechanism.id)
    return {
        "mechanism": mechanism.id,
        "form": mechanism.form,
        "probability": round(chance, 9),
        "shown": NONE not in cause.credible or chance > 0.5,
        "class": " or ".join(kinds),
        "credible_set": list(cause.credible),
        "parameters": [
            {"name": p.name, "value": value, "std": std, "unit": p.unit}
            for p, (value, std) in zip(mechanism.parameters, own, strict=True)
        ],
        "sizes": changes(found, number, place),
        "plausible": plausible(mechanism, found.final, place),
        "splitter": mechanism.splitter,
        "log_evidence": cause.gain,
    }


def _as_if(found: Found) -> tuple[Found, Cause]:
    """The most probable mechanism of an open question, with all that may stand in its place."""
    name = next(one for one in found.open if one in found.beside)
    model, chance = found.beside[name], inclusion(found.probabilities, name)
    choice = (name, *(one for one in found.open if one != name))
    gain = found.steps[-1].mechanisms[name]
    causes = tuple(Cause(one, gain, choice, chance) for one in model.causes)
    cause = next(one for one in causes if one.mechanism.id == name)
    return replace(found, final=model.fit, causes=causes), cause


def _fault(one) -> dict:
    count, total = int(one.records.sum()), one.records.size
    share = count / total
    return {
        "mechanism": one.mechanism.id,
        "form": "",
        "probability": one.probability,
        "shown": True,
        "class": "record",
        "credible_set": [one.mechanism.id],
        "parameters": [
            {"name": "share", "value": share, "std": float(np.sqrt(share * (1 - share) / total)),
             "unit": "1"}
        ],
        "sizes": [],
        "plausible": True,
        "splitter": one.mechanism.splitter,
        "log_evidence": one.log_odds,
    }  # fmt: skip


def probabilities(made: Diagnosis) -> Sets:
    """Of sets of causes, over all kinds of data; what may not be named has its share."""
    faults = [
        {frozenset(): 1.0 - one.probability, frozenset({one.mechanism.id}): one.probability}
        for one in made.faulty
    ]
    return together([together(one.probabilities for one in made.found), *faults], further=0.0)


def _answer(made: Diagnosis, causes: list[dict]) -> str:
    """The answer; faults of records alone do not name what the simulation lacks besides them."""
    others = [one for one in causes if one["class"] != "record"]
    if any(certain(one) for one in others):
        return "named"
    if any(found.insufficient for found in made.found) or not (made.found or causes):
        return "insufficient-data"
    if any(NONE not in one["credible_set"] for one in others):
        return "ambiguous"
    if any(found.unexplained for found in made.found if not found.open):
        return "unexplained"
    if not all(found.quiet for found in made.found):
        return "ambiguous"
    if any(not one.startswith(FEW) for one in made.lacks) and len(others) == len(causes):
        return "insufficient-data"
    return "named" if len(causes) > len(others) else "nothing-missing"


def certain(cause: dict) -> bool:
    """Whether a cause is named for certain."""
    return len(cause["credible_set"]) == 1


def _shortfall(made: Diagnosis) -> list[dict]:
    """What the baseline misses in each channel that misses anything, in words."""
    rows = []
    for found in made.found:
        explained = not found.unexplained and not found.insufficient
        if explained and not found.causes:
            continue
        if found.channel.name == "curve":
            new = of_curves(made.curves, found.baseline)
        else:
            step = found.steps[0]
            axis = max(step.smooth, key=step.smooth.get, default="force")
            if found.causes and found.causes[0].mechanism.over:
                over = found.causes[0].mechanism.over[0]
                axis = _AXES.get(over, over)
            data = made.data if found.channel.name == "stick" else made.damping.stick
            new = of_records(found.channel.name, data, found.baseline, axis)
        rows += [
            row | {"trend": made.terms.say(row["trend"]), "explained": explained} for row in new
        ]
    return rows


def records_of(seen: xr.Dataset) -> dict[str, list[str]]:
    """Findings by record."""
    findings = seen["findings"].values.astype(str)
    names = seen["record"].values.astype(str)
    return {n: f.split(";") for n, f in zip(names, findings, strict=True) if f}


def _below(made: Diagnosis, every: Diagnosis) -> str:
    """What the records at lower forces add."""
    causes = _causes(every, probabilities(every))
    named = [f"{' or '.join(one['credible_set'])} ({one['probability']:.2f})" for one in causes]
    named += [f"something smooth in {one.unexplained}" for one in every.found if one.unexplained]
    said = ", ".join([_answer(every, causes), *named])
    return f". With the records below {made.settings.least_force / 1e3:g} kN: {said}"


def insufficient(made: Diagnosis, named: Callable[[str], str] = str) -> list[str]:
    """What explains most and may yet not be named, why, and what would decide.

    named: how a mechanism is called, by its id.
    """
    lines = []
    for found in made.found:
        if name := found.insufficient:
            chance = min(100.0 * inclusion(found.probabilities, name), 99.0)
            others = [one for one in found.open if one not in (name, NONE, UNKNOWN)]
            where = "beside it" if chance > 90.0 else "beside it or instead"
            instead = f"; {' or '.join(map(named, others))} may act {where}" if others else ""
            lines.append(
                f"{named(name)} explains the {found.channel.name} data best (it acts with a "
                f"probability of {chance:.0f} %, alone or beside others) and is not named, for "
                f"{found.known.barred[name]}{instead}; to decide: "
                f"{found.alone[name].causes[0].splitter}"
            )
    return lines


def _out_of_line(made: Diagnosis) -> list[str]:
    """Clampings and records that the records' own check finds unlike their repeats."""
    findings = made.seen["findings"].values.astype(str)
    apart = np.array(["unlike-repeats" in text.split(";") for text in findings], dtype=bool)
    if not apart.any():
        return []
    holds = made.seen["hold"].values.astype(str)
    names = [n for n in dict.fromkeys(holds[apart]) if n]
    places = f" of the clampings {', '.join(names)}" if names else ""
    records = ", ".join(made.seen["record"].values.astype(str)[apart])
    return [f"unlike their repeats are the records {records}{places}: a wrong label, or {{force}}?"]


def _open_question(found: Found) -> str:
    """What may be missing where no cause is named and none is excluded."""
    names = [one for one in found.open if one not in (NONE, UNKNOWN)]
    seen = as_shown(found.rest).get(frozenset(), 0.0)
    beside = " beside " + " and ".join(one.mechanism.id for one in found.causes)
    beside = beside if found.causes else ""
    text = (
        f"the {found.channel.name} data show nothing missing{beside} (probability "
        f"{100.0 * seen:.0f} %) and would hardly show"
        if seen >= CERTAIN
        else f"the {found.channel.name} data do not tell which is missing{beside}:"
    )
    first = next(one for one in names if one in found.alone)
    decide = found.alone[first].causes[0].splitter
    return f"{text} {' or '.join(names)}; to decide on {first}: {decide}"


def _reason(made: Diagnosis, answer: str) -> str:
    """Two or three sentences that an engineer can act on."""
    faults = [
        f"{one.mechanism.id}: {int(one.records.sum())} of {one.records.size} records"
        for one in made.faulty
        if one.named
    ]
    if answer == "insufficient-data":
        lacks = [f"the campaign lacks {'; '.join(made.lacks)}"] if made.lacks else []
        if made.seen.sizes["record"] and not (made.seen["verdict"] == "usable").any():
            lacks.insert(0, f"no record can be used, of {made.seen.sizes['record']}")
        judged = [made.not_judged] if made.not_judged else []
        said = insufficient(made)
        open_ = [found for found in made.found if found.open and not found.quiet]
        asked = [_open_question(found) for found in open_ if not found.insufficient]
        return ". ".join([*said, *lacks, *asked, *faults, *_out_of_line(made), *judged])
    lines = [*_out_of_line(made), *insufficient(made)]
    if answer == "nothing-missing":
        whole = "all records" if len(lines) == 0 else "the other records"
        lines.append(f"{{it_explains}} {whole} within their scatter")
    for found in made.found:
        for cause in found.causes:
            lines.append(
                f"{cause.mechanism.id}: {cause.mechanism.sentence} (log evidence {cause.gain:.1f} "
                "over {without_it})"
            )
            if len(cause.credible) > 1:
                lines.append(
                    f"as likely as not another of {', '.join(cause.credible)} stands in its place"
                    if cause.probability < 0.5
                    else f"with a probability of {100 * cause.probability:.0f} %, else of "
                    f"{', '.join(cause.credible[1:])}"
                )
                lines.append(f"to decide: {cause.mechanism.splitter}")
        if found.open and not found.insufficient:
            lines.append(_open_question(found))
        elif not (found.quiet or found.causes or found.unexplained or found.insufficient):
            chance = 100.0 * inclusion(found.probabilities, UNKNOWN)
            lines.append(
                f"the {found.channel.name} data may hold ({chance:.0f} %) what no mechanism of the "
                "catalogue explains"
            )
        if found.unexplained:
            lines.append(
                f"the {found.channel.name} data hold something smooth in "
                f"{found.unexplained.replace('force', '{force}')} that no mechanism of the "
                "catalogue explains"
            )
        times = stretched(found.final) if found.channel.name == "curve" else 0.0
        if times > STRAINED:
            lines.append(
                f"the curves lie {times:.2g} times as far off as their errors say: another law may "
                "act on them, or modes that ring beside"
            )
    lines += faults
    lines += [text for text in (made.left_out, made.not_judged) if text]
    if made.data.jumped:
        holds = ", ".join(made.data.jumped)
        lines.append(f"a stick frequency jumps within {holds}: counted as two clampings")
    if made.lacks:
        lacks = "; ".join(made.lacks)
        lines.append(f"no statement on {{gauge}} and level effects: it lacks {lacks}")
    return ". ".join(lines)
