"""Two campaigns, or two runs of one, side by side: settings, records, numbers, verdict."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import product

import numpy as np
import xarray as xr

from bladeroot.figures.chart import sure
from bladeroot.report.numbers import NONE, fixed, interval, listed, percent, significant, with_std
from bladeroot.report.page import Section, Table, render
from bladeroot.report.verdict import answer_of, chance, plain, size, with_open
from bladeroot.report.words import Words, words_of
from bladeroot.terms import length

_SAME_LOAD = 1e-3  # relative: the same load, read twice


@dataclass(frozen=True)
class Side:
    """A campaign's results: what it is called here, and its artifacts.

    made: `report/provenance.json`. joints: joint inferences by structure. curves: mean curves over
    amplitude, of a campaign with records.
    """

    label: str
    made: Mapping
    stick: xr.Dataset
    verdict: Mapping
    joints: Mapping[str, xr.Dataset] = field(default_factory=dict)
    curves: xr.Dataset | None = None


def compared(a: Side, b: Side) -> list[Section]:
    """What differs between them; what is the same is counted."""
    return [
        Section("Verdict", [_verdicts(a, b)]),
        Section("Numbers", [*_levels(a, b), *_over_amplitude(a, b), *_stiffness(a, b)]),
        Section("Records", _records(a, b)),
        Section(
            "Settings and sources",
            [
                *_differing("settings", "Settings that differ", a, b),
                *_differing("sources", "Source files that differ (sha256)", a, b, shown=12),
            ],
        ),
    ]


def page(a: Side, b: Side) -> str:
    """The same as a page."""
    simulated = [one.label for one in (a, b) if one.stick.attrs.get("simulated")]
    note = f"; simulated: {listed(simulated)}" if simulated else ""
    title = f"{a.label} beside {b.label}"
    version = f"bladeroot {b.made['version']}, {b.made['date']}"
    return render(title, f"What differs{note}", len(simulated) == 2, compared(a, b), version)


def text(sections: Sequence[Section]) -> Iterator[str]:
    """Sections of sentences and tables as lines."""
    for section in sections:
        yield f"{section.title}"
        for part in section.parts:
            if isinstance(part, Table):
                yield f"  {part.caption}"
                lines = [part.header, *part.rows]
                widths = [max(len(row[k]) for row in lines) for k in range(len(part.header))]
                for row in lines:
                    cells = [cell.ljust(width) for cell, width in zip(row, widths, strict=True)]
                    yield f"    {'  '.join(cells)}".rstrip()
            else:
                yield f"  {part}"


def _verdicts(a: Side, b: Side) -> Table:
    rows = [("judged", *(str(one.verdict["structure"] or NONE) for one in (a, b))),
            ("answer", *(answer_of(with_open(one.verdict)) for one in (a, b)))]  # fmt: skip
    causes = [{c["mechanism"]: c for c in with_open(s.verdict)["causes"]} for s in (a, b)]
    for name in dict.fromkeys([*causes[0], *causes[1]]):
        cells = [
            f"{chance(of[name]['probability'])}, {size(of[name]['parameters'][0])}"
            if name in of
            else "not named"
            for of in causes
        ]
        rows.append((plain(name), *cells))
    missing = [
        {(r["quantity"], r["mode"]): r["trend"] for r in one.verdict["shortfall"]} for one in (a, b)
    ]
    for key in dict.fromkeys([*missing[0], *missing[1]]):
        rows.append((f"missing: {key[0]}, {key[1]}", *(of.get(key, "nothing") for of in missing)))
    return Table("What each says", ("", a.label, b.label), rows)


def _levels(a: Side, b: Side) -> list:
    """Stick frequency and loss factor of the modes, loads and groups that both have."""
    words, rows = words_of(a.stick), []
    for one, other in _both(a.stick, b.stick):
        pair = [(float(s["frequency"]), float(s["frequency_std"])) for s in (one, other)]
        change = pair[1][0] - pair[0][0]
        z = change / np.hypot(pair[0][1], pair[1][1]) if change else 0.0
        rows.append(
            (str(one["mode"].item()), words.value(float(one["force"])),
             str(one["group"].item() or NONE) if "group" in one else NONE,
             *(with_std(value, std, 2) for value, std in pair),
             f"{1e6 * change / pair[0][0]:+z.0f} ppm ({significant(abs(z), 2)} std)",
             *(percent(float(s["loss_factor"]), 3) for s in (one, other)))
        )  # fmt: skip
    if not rows:
        return ["No stick frequency of a mode, load and group is in both."]
    same = sum(row[5].startswith("+0 ppm (0 ") for row in rows)
    header = ("mode", words.header, "group", f"{a.label} / Hz", f"{b.label} / Hz", "change",
              f"loss factor, {a.label}", f"loss factor, {b.label}")  # fmt: skip
    caption = f"Stick frequencies that both have: {len(rows)}, of which {same} are the same"
    return [Table(caption, header, rows)]


def _over_amplitude(a: Side, b: Side) -> list[Table]:
    """Frequency and loss factor of what both have, at the least, middle and largest amplitude that
    is sure in both: all there is of a mode that reaches no plateau.
    """
    if a.curves is None or b.curves is None:
        return []
    pairs, words = _both(a.curves, b.curves), words_of(a.curves)
    rows = [row for pair in pairs for row in _at_amplitudes(*pair, words)]
    header = ("mode", words.header, "curve", "amplitude", f"{a.label} / Hz", f"{b.label} / Hz",
              f"loss factor, {a.label}", f"loss factor, {b.label}")  # fmt: skip
    caption = "Frequency and loss factor over amplitude, with one standard error"
    return [Table(caption, header, rows)] if rows else []


def _at_amplitudes(one: xr.Dataset, other: xr.Dataset, words: Words) -> list[tuple[str, ...]]:
    """A row an amplitude; the grid of amplitudes of the one is read in the other."""
    names = ("frequency", "loss_factor")
    there = other.interp(amplitude=one["amplitude"].values)[
        [f"{name}{end}" for name in names for end in ("", "_std", "_change_std")]
    ]
    seen = np.isfinite(sum(sure(side, name) for side in (one, there) for name in names))
    known = np.flatnonzero(seen)
    curve = [str(one[name].item()) for name in ("group", "sensor") if name in one.coords]
    return [
        (
            str(one["mode"].item()),
            words.value(float(one["force"])),
            ", ".join(filter(None, curve)) or NONE,
            length(float(one["amplitude"][k])),
            *(
                with_std(scale * float(side[name][k]), scale * float(side[f"{name}_std"][k]), 2, u)
                for name, scale, u in (("frequency", 1.0, ""), ("loss_factor", 100.0, "%"))
                for side in (one, there)
            ),
        )
        for k in (dict.fromkeys(known[[0, known.size // 2, -1]]) if known.size else ())
    ]


def _both(one: xr.Dataset, other: xr.Dataset) -> list[tuple[xr.Dataset, xr.Dataset]]:
    """Levels of the same mode, load, group and sensor."""
    levels = [[of.isel(level=k) for k in range(of.sizes["level"])] for of in (one, other)]
    # of stick frequencies the sensor is a record's
    names = [k for k in ("mode", "group", "sensor")
             if all(k in of and of[k].dims == ("level",) for of in (one, other))]  # fmt: skip
    return [
        (a, b)
        for a, b in product(*levels)
        if all(a[k].item() == b[k].item() for k in names)
        and np.isclose(a["force"], b["force"], rtol=_SAME_LOAD)
    ]


def _stiffness(a: Side, b: Side) -> list[Table]:
    rows = []
    for structure in [name for name in a.joints if name in b.joints]:
        for name in ("kn", "kt"):
            cells = []
            for side in (a, b):
                one = side.joints[structure]["reference_quantile"].sel(stiffness=name)
                middle, ends = interval(one, 0.025, 3)
                cells.append(f"{middle} ({ends})")
            rows.append((structure, name, *cells))
    caption = "Contact stiffness from all forces together, GN/m (95 %)"
    return [Table(caption, ("structure", "", a.label, b.label), rows)] if rows else []


def _records(a: Side, b: Side) -> list:
    """Which records only one has, and which are judged or read otherwise."""
    said = [
        dict(zip(s.stick["record"].values.astype(str), s.stick["verdict"].values, strict=True))
        for s in (a, b)
    ]
    if not said[0] and not said[1]:
        return ["Neither has records."]
    both = [name for name in said[0] if name in said[1]]
    parts: list = [
        f"{len(both)} records are in both; {len(said[0]) - len(both)} only in {a.label}, "
        f"{len(said[1]) - len(both)} only in {b.label}."
    ]
    rows = []
    for name in both:
        one, other = (s.stick["stick_frequency"].sel(record=name).item() for s in (a, b))
        if said[0][name] == said[1][name] and np.isclose(one, other, rtol=1e-9, equal_nan=True):
            continue
        verdicts = (str(of[name]) for of in said)
        rows.append((name, *verdicts, fixed(one, 3), fixed(other, 3)))
    header = ("record", a.label, b.label, f"{a.label} / Hz", f"{b.label} / Hz")
    caption = "Records that are judged or read otherwise"
    alike = ["They are read alike."] if both else []
    return [*parts, *([Table(caption, header, rows)] if rows else alike)]


def _differing(key: str, caption: str, a: Side, b: Side, shown: int | None = None) -> list:
    """Entries of the provenance that are not the same in both."""
    one, other = a.made[key], b.made[key]
    names = [name for name in dict.fromkeys([*one, *other]) if one.get(name) != other.get(name)]
    if not names:
        return [f"No {key} differ."]
    cells = [tuple(of.get(name, NONE)[:shown] for of in (one, other)) for name in names]
    rows = [(name, *pair) for name, pair in zip(names, cells, strict=True)]
    return [Table(caption, ("", a.label, b.label), rows)]
