"""The first page: the answer at a glance, each stage's in a line, verdict, next, what is open."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from bladeroot.figures.chart import sure
from bladeroot.report.bad_records import rejected, unlike_repeats
from bladeroot.report.numbers import NONE, fixed, interval, listed, percent, significant, span
from bladeroot.report.page import Box, Cards, Link, Picture, Section, Table
from bladeroot.report.stiffness import DETERMINED
from bladeroot.report.verdict import (
    against,
    answer_of,
    causes_of,
    chance,
    compared_with,
    disagreement,
    in_short,
    next_of,
    plain,
    supposed,
    with_open,
)
from bladeroot.report.words import Words, words_of

_REFERENCE_FORCE = 12e3  # N, nearest to which kn and kt are shown
_MOST_TOLD = 5  # bad records that are told by name; the chapters have them all
_MOST_CARDS = 5  # modes that have a card of their own
FOREIGN_CHANGE = 0.05  # of a frequency, relative, that no error of a model of the specimen explains


def front_sections(
    facts: Mapping,
    stages: Mapping[str, xr.Dataset],
    joints: Sequence[xr.Dataset],
    amplitudes: Sequence[xr.Dataset],
    found: Sequence[xr.Dataset],
    verdicts: Sequence[Mapping],
    measured: Sequence[Picture],
    judged: Sequence[Picture],
    where: str,
) -> list[Section]:
    """The page's sections; measured, judged: the figure of all curves, and that of the verdict.

    facts: as for the report. stages: stick; with records, integrity; with a structure, stiffness
    and theory. joints, amplitudes: of the structures; found, verdicts: of each that is judged, the
    main one first. where: the way to the chapters.
    """
    stick, main = stages["stick"], found[0]
    named = [
        {**with_open(said), "structure": against(one, said)}
        for one, said in zip(found, verdicts, strict=True)
    ]
    told = in_short(main, named[0]) + disagreement(named)
    over = over_amplitude(stages["curves"]) if "curves" in stages else {}
    cards = [*_mode_cards(facts, stick, over), _verdict_card(main, named[0])]
    return [
        Section("", [Cards(cards)]),
        Section("What was measured", [*measured]),
        Section(
            "The answer of each stage",
            [_stages(facts, stages, joints, amplitudes, named[0], over, where)],
        ),
        Section("Verdict", [*told, *judged, *next_of(main, named[0])]),
        Section(
            "What is wrong with records, and what is open",
            [*_bad(stages), *undecided(facts, stages)],
        ),
    ]


def over_amplitude(curves: xr.Dataset) -> dict[str, tuple[str, str]]:
    """Frequency (Hz) and loss factor (%) of each mode over all amplitudes, where they are sure."""
    found = {}
    for mode in dict.fromkeys(curves["mode"].values.astype(str)):
        here = curves.isel(level=np.flatnonzero(curves["mode"].values == mode))
        frequency, loss = (sure(here, name) for name in ("frequency", "loss_factor"))
        found[mode] = (_range(frequency, 4), _range(100.0 * loss, 2))
    return found


def _mode_cards(
    facts: Mapping, stick: xr.Dataset, over: Mapping[str, tuple[str, str]]
) -> list[tuple[str, str, list[str]]]:
    """Frequency, damping and where they were measured, of each mode."""
    words, cards = words_of(stick), []
    modes, bad = facts["modes"], rejected(stick)
    for mode in modes[:_MOST_CARDS]:
        of_mode = (
            stick["record_mode"].values == mode if "record_mode" in stick else np.zeros(0, bool)
        )
        here = stick.isel(level=np.flatnonzero(stick["mode"].values == mode))
        if not here.sizes["level"]:
            frequency, loss = over.get(mode, (NONE, NONE))
            if frequency == NONE:
                used = of_mode & ~np.isin(stick["record"].values, [name for name, _ in bad])
                why = "its curves are hardly known" if used.any() else "no usable record"
                cards.append((f"mode {mode}", "no frequency", [why]))
            else:
                lines = [f"loss factor {loss} %", "over amplitude; no plateau is reached"]
                cards.append((f"mode {mode}", f"{frequency} Hz", lines))
            continue
        loss = _range(100.0 * here["loss_factor"].values, 2)
        loss = over.get(mode, (NONE, NONE))[1] if loss == NONE else loss
        where = words.load and f"{_range(words.factor * here['force'].values, 3)} {words.unit}"
        count = f"{here.sizes['level']} levels"
        if facts["entry"] == "records":
            records = int(np.nansum(here["records"].values))
            count = f"{records} record{'s' * (records != 1)}"
            if records < of_mode.sum():
                bare = int((of_mode & (stick["verdict"].values == "plateau not reached")).sum())
                out = int((of_mode & np.isin(stick["record"].values, [n for n, _ in bad])).sum())
                left = [f"{bare} without a plateau"] * bool(bare) + [f"{out} rejected"] * bool(out)
                count = ", ".join([f"{records} of {of_mode.sum()} records", *left])
        lines = [f"loss factor {loss} %", ", ".join(filter(None, [where, count]))]
        cards.append((f"mode {mode}", f"{_hertz(here)} Hz", [line for line in lines if line]))
    if len(modes) > _MOST_CARDS:
        cards.append(("more modes", str(len(modes) - _MOST_CARDS), ["in the table below"]))
    return cards


def _hertz(level: xr.Dataset) -> str:
    low, high = float(level["frequency"].min()), float(level["frequency"].max())
    digits = 1 if low > 100.0 else 3
    ends = dict.fromkeys(fixed(end, digits) for end in (low, high))
    return " to ".join(ends)


def _verdict_card(one: xr.Dataset, said: Mapping) -> tuple[str, str, list[str]]:
    causes = list(map(supposed, said["causes"]))
    return "verdict", answer_of(said), [*causes, f"compared with {compared_with(one, said)}"]


def _stages(
    facts: Mapping,
    stages: Mapping[str, xr.Dataset],
    joints: Sequence[xr.Dataset],
    amplitudes: Sequence[xr.Dataset],
    said: Mapping,
    over: Mapping[str, tuple[str, str]],
    where: str,
) -> Table:
    """Each stage's answer with its uncertainty, and the chapter that has the rest."""
    stick = stages["stick"]
    words = words_of(stick)
    rows = [*_of_records(facts, stages), *_of_stick(stick, words)]
    rows += [
        (Link(f"over amplitude, {mode}", "measurement"), f"{frequency} Hz, loss factor {loss} %",
         "no plateau is reached")
        for mode, (frequency, loss) in over.items()
        if mode not in stick["mode"].values
    ]  # fmt: skip
    if "score" in stages:
        hit, reached = (stages["score"].attrs[key] for key in ("within_3", "reached"))
        rows.append((Link("against the bench's truth", "stick"), f"{hit} of {reached} records",
                     "within three standard errors"))  # fmt: skip
    if "stiffness" in stages:
        rows += _of_stiffness(stages["stiffness"], joints, amplitudes)
        theory = [f"{k} {significant(float(stages['theory'][f'{k}_theory'].mean()) / 1e9, 3)}"
                  for k in ("kn", "kt")]  # fmt: skip
        rows.append((Link("contact theory", "theory"), f"{listed(theory)} GN/m",
                     "smooth, elastic; hardly grows with the force"))  # fmt: skip
    causes = listed([plain(cause["mechanism"]) for cause in causes_of(said)])
    odds = list(said["probabilities"].items())[:1]
    texts = [f"{plain(name).replace('+', ' and ')} ({chance(p)})" for name, p in odds]
    doubt = "; ".join(map(supposed, said["causes"])) or listed(texts) or NONE
    name = f"diagnosis{', ' + said['structure'] if said['structure'] else ''}"
    answer = answer_of(said) + (f": {causes}" if causes else "")
    rows.append((Link(name, "diagnosis"), answer, doubt))
    if "ledger" in stages:
        verdict = stages["ledger"]["verdict"].values
        rows.append((Link("the source, number by number", "comparison"),
                     f"{int((verdict == 'reproduced').sum())} of {verdict.size} rows reproduced",
                     f"{int((verdict == 'differs').sum())} differ"))  # fmt: skip
    led = [(Link(name, f"{where}{name.href}.html"), *cells) for name, *cells in rows]
    return Table("Each name leads to its chapter", ("stage", "answer", "uncertainty"), led)


def _of_records(facts: Mapping, stages: Mapping[str, xr.Dataset]) -> list[tuple[str, ...]]:
    stick = stages["stick"]
    name = Link("records", "measurement")
    if facts["entry"] != "records":
        return [(name, "none: the campaign begins at stick frequencies", NONE)]
    bad, count = len(rejected(stick)), stick.sizes["record"]
    unreached = int((stick["verdict"].values == "plateau not reached").sum())
    found = stages["integrity"].sizes["finding"]
    return [
        (name, f"{count - bad} of {count} are used",
         f"{unreached} of them without a plateau"),
        (Link("quality", "quality"), f"{found} finding{'s' * (found != 1)}",
         _agreement(stages["integrity"])),
    ]  # fmt: skip


def _agreement(judged: xr.Dataset) -> str:
    agrees = judged["pff_agrees"].values
    if not (agrees >= 0).any():
        return NONE
    return f"peak fitting agrees on {int((agrees == 1).sum())} of {int((agrees >= 0).sum())}"


def _of_stick(stick: xr.Dataset, words: Words) -> list[tuple[str, ...]]:
    rows = []
    grouped = "record_group" in stick and np.unique(stick["record_group"].values).size > 1
    for mode in dict.fromkeys(stick["mode"].values.astype(str)):
        level = stick.isel(level=np.flatnonzero(stick["mode"].values == mode)).sortby("force")
        where = f", {_range(words.factor * level['force'].values, 3)} {words.unit}" * bool(
            words.load
        )
        count = level.sizes["level"]
        groups = f", {count} group{'s' * (count != 1)}" if grouped else ""
        rows.append(
            (Link(f"stick frequency, {mode}", "stick"),
             f"{_hertz(level)} Hz{where}{groups}",
             f"± {_range(level['frequency_std'].values, 2)} Hz")
        )  # fmt: skip
        loss = 100.0 * level["loss_factor"].values
        if np.isfinite(loss).any():
            rows.append(
                (Link(f"loss factor, {mode}", "stick"), f"{_range(loss, 2)} %",
                 f"± {_range(100.0 * level['loss_factor_std'].values, 2)} %")
            )  # fmt: skip
        onset = level["onset_amplitude"].values
        if np.isfinite(onset).any():
            rows.append(
                (Link(f"end of the plateau, {mode}", "stick"),
                 f"{_range(1e6 * onset, 2)} µm",
                 f"± {_range(1e6 * level['onset_amplitude_std'].values, 2)} µm")
            )  # fmt: skip
    if not rows:
        rows.append((Link("stick frequency", "stick"), "none", NONE))
    return rows


def _of_stiffness(
    stiffness: xr.Dataset, joints: Sequence[xr.Dataset], amplitudes: Sequence[xr.Dataset]
) -> list[tuple[str, ...]]:
    rows = []
    for structure in stiffness["structure"].values.astype(str)[:1]:
        line = stiffness.sel(structure=structure)
        status = list(line["status"].values)
        found = sum(status.count(name) for name in DETERMINED)
        tried = found + status.count("no root")
        alone = Link(f"kn, kt force by force, {structure}", "stiffness")
        rows.append((alone, f"{found} of {tried} forces have a pair" if tried
                     else "no pair of frequencies to invert", _doubt(line)))  # fmt: skip
        for one, data, chapter in _together(structure, joints, amplitudes):
            here = one.isel(force=int(np.abs(one["force"].values - _REFERENCE_FORCE).argmin()))
            k = here["k_quantile"]
            known = {name: interval(k.sel(stiffness=name), 0.025, 3) for name in ("kn", "kt")}
            middle, ends = (listed([f"{n} {of[i]}" for n, of in known.items()]) for i in (0, 1))
            rows.append(
                (Link(f"kn, kt together, {structure}", chapter),
                 f"{middle} GN/m at {float(here['force']) / 1e3:.1f} kN, from {data}",
                 f"{ends} GN/m (95 %)")
            )  # fmt: skip
    return rows


def _together(
    structure: str, joints: Sequence[xr.Dataset], amplitudes: Sequence[xr.Dataset]
) -> list[tuple[xr.Dataset, str, str]]:
    """The inference from all forces at once, with the curves if they could be used."""
    curves = [one for one in amplitudes if one.attrs["law"] and one.attrs["converged"]]
    for several, data, chapter in (
        (curves, "frequencies and curves", "nonlinear"),
        ([one for one in joints if one.attrs["law"]], "frequencies", "stiffness"),
    ):
        mine = [one for one in several if one.attrs["structure"] == structure]
        if mine:
            return [(mine[0], data, chapter)]
    return []


def _doubt(line: xr.Dataset) -> str:
    """How well known roots are, or how far the model must move where there is none."""
    rooted = np.isin(line["status"].values, DETERMINED)
    if rooted.any():
        spread = [float(np.nanmedian(line[f"ln_{k}_std"].values[rooted])) for k in ("kn", "kt")]
        if max(spread) < 0.5:
            return f"± {percent(spread[0], 0)} and {percent(spread[1], 0)}"
        factors = [significant(float(np.exp(one)), 2) for one in spread]
        return f"a factor of {factors[0]} and {factors[1]} either way"
    missed = line["status"].values == "no root"
    if not missed.any():
        return NONE
    needed = np.abs(line["needed_bias"].isel(force=np.flatnonzero(missed)))
    text = f"the model must move by {percent(float(needed.max('mode').min()), 2)} or more"
    if float(needed.min("force").max()) > FOREIGN_CHANGE:
        text += ": this structure is not the specimen, or a mode is taken for another"
    return text


def _bad(stages: Mapping[str, xr.Dataset]) -> list:
    """Rejected records and those unlike their repeats."""
    bad = [(name, f"rejected: {why}") for name, why in rejected(stages["stick"])]
    if "integrity" in stages:
        bad += unlike_repeats(stages["integrity"])
    if not bad:
        return ["No record is rejected or unlike its repeats."] if "integrity" in stages else []
    more = [f"{len(bad) - _MOST_TOLD} more stand in the chapters."] if len(bad) > _MOST_TOLD else []
    return [Box("Records to look at", [*(f"{n}: {why}." for n, why in bad[:_MOST_TOLD]), *more])]


def undecided(facts: Mapping, stages: Mapping[str, xr.Dataset]) -> list[str]:
    """What the data and the model leave open, and what would settle it."""
    parts, stick = [], stages["stick"]
    status = stages["stiffness"]["status"].values if "stiffness" in stages else []
    if np.isin(status, ["root", "no root"]).any():
        parts.append(
            "Two frequencies fix two stiffnesses, so force by force nothing shows an error of the "
            "model; a third mode, or frequencies of the free beam, would."
        )
    if facts["entry"] == "stick frequencies":
        parts.append(
            "The stated errors of the stick frequencies cannot be checked without the records or "
            "repeats of a clamping."
        )
    unreached = int((stick["verdict"].values == "plateau not reached").sum())
    if unreached:
        parts.append(
            f"Records that do not reach their plateau: {unreached}. Smaller amplitudes would show "
            "it: a longer decay above the noise, or one that nothing disturbs."
        )
    return parts


def _range(values: np.ndarray, digits: int) -> str:
    """The least and the greatest known."""
    known = values[np.isfinite(values)]
    return span(float(known.min()), float(known.max()), digits) if known.size else NONE


def provenance_section(made: Mapping) -> Section:
    """made: version, environment, date, settings (by stage, JSON texts), sources (sha256 by path)
    and command, as `report/provenance.json` has them.
    """
    return Section(
        "Where this comes from",
        [
            f"bladeroot {made['version']}, {made['date']}; {made['environment']}. Again: "
            f"{made['command']}",
            Table("Settings of each stage", ("stage", "settings"),
                  list(made["settings"].items()), folded=True),
            Table(f"Source files ({len(made['sources'])})", ("file", "sha256"),
                  list(made["sources"].items()), folded=True),
        ],
    )  # fmt: skip
