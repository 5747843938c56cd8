"""The sections on what was measured and which stick frequencies came of it."""

from collections import Counter
from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd
import xarray as xr

from bladeroot.loads import AXIAL_FORCE
from bladeroot.report.bad_records import rejected
from bladeroot.report.numbers import NONE, fixed, listed, significant, with_std
from bladeroot.report.over_amplitude import over_amplitude, stuck
from bladeroot.report.page import Picture, Section, Table
from bladeroot.report.words import gauge_sentence, words_of

FEW_CYCLES = "too few cycles are sharp enough"  # a verdict of `bladeroot.plateau.plateau`
VERDICTS = {
    "plateau": "with a stick plateau (constant frequency at small amplitude)",
    "plateau not reached": "without a plateau: the frequency changes as long as it can be followed",
    "rejected": "rejected",
}


def measurement_section(
    facts: Mapping,
    stick: xr.Dataset,
    drawn: Sequence[Picture] = (),
    curves: xr.Dataset | None = None,
) -> Section:
    """The specimen's campaign: gauge, modes, records, what was left out and why."""
    description = facts["description"]
    parts: list = [description["notes"]] if description.get("notes") else []
    parts += gauge_sentence(description)
    if facts["entry"] == "stick frequencies":
        parts.append(
            f"The campaign begins with {stick.sizes['level']} stick frequencies; there are no "
            "records to check them with."
        )
        return Section("What was measured", parts)
    verdicts = Counter(str(v).split(":")[0] for v in stick["verdict"].values)
    counts = [
        f"{verdicts[verdict]} {text}" for verdict, text in VERDICTS.items() if verdicts[verdict]
    ]
    parts.append(f"{stick.sizes['record']} records: {listed(counts)}.")
    parts.append(_record_table(stick, facts["modes"]))
    bad = rejected(stick)
    if bad:
        parts.append(Table("Rejected, and left out of all that follows", ("record", "why"), bad))
        if any(FEW_CYCLES in why for _, why in bad):
            parts.append(
                "Too few cycles are sharp enough where noise hides the phase of most of them. A "
                "larger amplitude at the release, a finer range of the sensor or a longer record "
                "helps; so does a record of its own for a mode that another outshines."
            )
    if curves is not None:
        parts += over_amplitude(curves, stick)
    if facts["excluded"]:
        parts.append(f"Excluded in records.csv: {listed(list(facts['excluded']))}.")
    return Section("What was measured", [*parts, *drawn])


def stick_section(
    stick: xr.Dataset,
    drawn: Sequence[Picture],
    score: xr.Dataset | None,
    fe_forces: xr.Dataset | None,
) -> Section:
    """Stick frequency, loss factor and onset for each mode and force.

    fe_forces: None without a structure, which would have forces of its own.
    """
    words = words_of(stick)
    of_joint = fe_forces is not None or words.load == AXIAL_FORCE
    rows = [
        (
            str(level["mode"].item()),
            words.value(float(level["force"])),
            str(level["group"].item() or NONE) if "group" in level else NONE,
            with_std(float(level["frequency"]), float(level["frequency_std"]), 2),
            significant(float(level["within_std"]), 2),
            significant(float(level["between_std"]), 2),
            with_std(100 * float(level["loss_factor"]), 100 * float(level["loss_factor_std"]), 3),
            with_std(
                1e6 * float(level["onset_amplitude"]), 1e6 * float(level["onset_amplitude_std"]), 2
            ),
            f"{int(level['records'])} / {int(level['holds'])}",
        )
        for level in (stick.isel(level=index) for index in range(stick.sizes["level"]))
    ]
    parts: list = [
        "The stick frequency is that of the plateau at small amplitude, where "
        + ("all contacts stick and the joint is linear" if of_joint else "it is constant")
        + ". Nothing is extrapolated: a record that never reaches its plateau "
        "gives a bound and no frequency.",
        *drawn,
    ]
    if rows:
        parts.append(Table(
            "Stick frequencies. Within: propagated standard error of the records (3.21); between: "
            f"standard deviation of the records{words.at_one}. {_counted(stick)} The onset is "
            "where "
            + ("the whole motion begins to slip" if of_joint else "the plateau ends")
            + ": other modes in the record add to it, so that it is a lower bound for the mode "
            "alone.",
            ("mode", words.header, "group", "frequency / Hz", "within / Hz", "between / Hz",
             "loss factor / %", "onset of slip / µm" if of_joint else "onset / µm",
             "records / clampings"),
            rows,
        ))  # fmt: skip
    if (stick["verdict"].values == "plateau not reached").any():
        parts.append(_bounds(stick, of_joint))
    parts += scatter_parts(stick)
    if score is not None:
        parts += _score_parts(stick, score)
    if fe_forces is not None:
        parts.append(_interpolated(fe_forces))
    return Section("Stick frequencies", parts)


def _counted(stick: xr.Dataset) -> str:
    """What the stated errors count."""
    attrs = stick["frequency_std"].attrs
    if "note" in attrs:
        return f"The stated error is {attrs['note']}."
    words = words_of(stick)
    text = "The stated error counts both, and the scatter between clampings: that of repeats"
    if words.load:
        text += (
            f" or, where no {words.short} is clamped twice, of the {words.short}s about a smooth "
            "law"
        )
    text += "."
    if "lower_bound" in attrs:
        text += f" In {attrs['lower_bound']} it is unknown, and the error a lower bound."
    return text


def scatter_parts(stick: xr.Dataset) -> list:
    """What repeats scatter, or what a table's rows scatter beside its printed errors."""
    if "scatter_ratio" in stick:
        known = np.isfinite(stick["scatter_ratio"].values).any()
        return [_printed_errors(stick)] if known else []
    rows, words = [], words_of(stick)
    for mode in np.unique(stick["mode"].values.astype(str)):
        here = stick.isel(level=int(np.argmax(stick["mode"].values == mode)))
        if not int(here["record_freedom"]) + int(here["hold_freedom"]):
            continue  # nothing is repeated
        rows.append(
            (
                str(mode),
                significant(float(here["between_record_std"]), 2),
                str(int(here["record_freedom"])),
                significant(float(here["between_hold_std"]), 2),
                str(int(here["hold_freedom"])),
                with_std(
                    float(here["mode_direction_difference"]),
                    float(here["mode_direction_difference_std"]),
                    3,
                ),
            )
        )
    if not rows:
        return []
    header = ("mode", "between records / Hz", "freedom", "between clampings / Hz", "freedom",
              "up less down / Hz")  # fmt: skip
    return [
        Table(
            "What repeats scatter beyond their own errors"
            + (f", from all {words.short}s of a mode" if words.load else "")
            + ": standard deviation between the records of a clamping and between clampings, with "
            "degrees of freedom"
            + (", and the difference between loading up and down" if words.load else ""),
            header,
            rows,
        )
    ]


def _printed_errors(stick: xr.Dataset) -> Table:
    rows = []
    for mode in stick["table_mode"].values:
        cells = [str(mode)]
        for name in ("scatter_ratio", "loss_factor_scatter_ratio"):
            low, middle, high = (float(v) for v in stick[name].sel(table_mode=mode))
            known = np.isfinite(middle)
            interval = f"({significant(low, 2)} to {significant(high, 2)})"
            cells.append(f"{significant(middle, 2)} {interval}" if known else NONE)
        rows.append(tuple(cells))
    return Table(
        "How many times the printed errors of the table its own rows scatter about a smooth law "
        "of the force (median of the rows, 95 % interval): the printed errors are those within a "
        "record and leave out all that differs between records, clampings and readings of force",
        ("mode", "stick frequency", "loss factor"),
        rows,
    )


def table_5_1(fe_forces: xr.Dataset, published: pd.DataFrame) -> list:
    """Table 5.1 beside ours, with the force error read in both ways."""
    rows = []
    for line in published.itertuples():
        if 1e3 * line.force_kN not in fe_forces["force"].values:
            continue
        here = fe_forces["frequency_std"].sel(force=1e3 * line.force_kN)
        cells = [f"{line.force_kN:g}"]
        for mode in ("1B", "2B"):
            of_mode = here.sel(mode=mode)
            cells += [
                fixed(getattr(line, f"frequency_delta_{mode}_Hz"), 2),
                fixed(float(of_mode.sel(force_error="reading")), 3),
                fixed(float(of_mode.sel(force_error="full-scale")), 2),
            ]
        rows.append(tuple(cells))
    header = ["force / kN"]
    for mode in ("1B", "2B"):
        header += [f"{mode} printed / Hz", f"{mode}, 1 % of reading", f"{mode}, 1 % of full scale"]
    return [
        "The thesis's errors at these forces (Table 5.1) need a force error of 1 % of the reading. "
        "The gauge's data sheet says 1 % of its full scale, 700 bar or 1253 N, which is several "
        "times more; it is what we go on with.",
        Table("Standard deviations of the interpolated frequencies, Hz", header, rows),
    ]


def _record_table(stick: xr.Dataset, modes: Sequence[str]) -> Table:
    names = ["record_mode", "record_force", "record_group", "sensor"]
    frame = pd.DataFrame(
        {name: stick[name].values if name in stick else ""
         for name in (*names, "hold", "plateau_reached")}
    )  # fmt: skip
    frame["record_mode"] = pd.Categorical(frame["record_mode"], modes)  # groups in their order
    words, rows = words_of(stick), []
    repeated = frame.duplicated([*names, "hold"]).any()  # else a clamping is a record
    for (mode, force, group, sensor), seen in frame.groupby(names, observed=True):
        rows.append(
            (
                mode,
                words.value(force),
                group or NONE,
                sensor or NONE,
                str(len(seen)),
                str(seen["hold"].nunique()) if repeated else NONE,
                str(int(seen["plateau_reached"].sum())),
            )
        )
    header = ("mode", words.header, "group", "sensor", "records", "clampings", "plateau reached")
    return Table(f"Records of each mode{' and ' + words.short if words.load else ''}", header, rows)


def _bounds(stick: xr.Dataset, of_joint: bool) -> Table:
    """What the records without a plateau say all the same."""
    rows, words = [], words_of(stick)
    for record in stick["record"].values[stick["verdict"].values == "plateau not reached"]:
        here = stick.sel(record=record)
        rows.append(
            (
                str(record),
                str(here["record_mode"].item()),
                words.value(float(here["record_force"])),
                stuck(here),
            )
        )
    return Table(
        "Records without a plateau: the frequency still changes at the smallest usable amplitude. "
        "It would end in the interval if it goes on below as it changes above, by a power of the "
        "amplitude (the square root or a higher one); a joint of another law can end outside",
        (
            "record",
            "mode",
            words.header,
            f"{'stuck frequency' if of_joint else 'frequency at smallest amplitudes'} / Hz",
        ),
        rows,
    )


def _score_parts(stick: xr.Dataset, score: xr.Dataset) -> list:
    reached, hit = score.attrs["reached"], score.attrs["within_3"]
    deviation = score["deviation"].values
    worst = np.nanmax(np.abs(deviation)) if reached else np.nan
    error = 1e6 * np.abs(stick["stick_frequency"] / score["true_frequency"] - 1)
    onset = stick["record_onset_amplitude"] / score["true_onset_amplitude"]
    return [
        "The records are simulated, so the answer is known: of "
        f"{reached} records whose plateau is reached, {hit} hit the bench's stuck eigenfrequency "
        f"within three of their standard errors (worst {significant(worst, 2)}); the median "
        f"error is {significant(float(error.median()), 2)} ppm. The onset of slip is found at "
        f"{significant(float(onset.median()), 2)} times the amplitude (median) at which the "
        "bench's first pair of nodes would slip in a pure mode."
    ]


def _interpolated(fe_forces: xr.Dataset) -> Table | str:
    if not np.isfinite(fe_forces["frequency"].values).any():
        forces = listed([f"{force / 1e3:g}" for force in fe_forces["force"].values])
        return (
            f"None of the simulation's forces ({forces} kN) lies between forces that were measured."
        )
    primary = fe_forces.attrs["primary_force_error"]
    modes = list(fe_forces["mode"].values)
    rows = []
    for force in fe_forces["force"].values:
        cells = [f"{force / 1e3:g}"]
        for mode in modes:
            here = fe_forces.sel(force=force, mode=mode)
            spread = here["frequency_std"].sel(force_error=primary)
            cells.append(with_std(float(here["frequency"]), float(spread), 2))
            low, high = float(here["lower_force"]), float(here["upper_force"])
            cells.append(f"{low / 1e3:.2f} to {high / 1e3:.2f}" if np.isfinite(low) else NONE)
        rows.append(tuple(cells))
    header = ["force / kN"]
    for mode in modes:
        header += [f"{mode} / Hz", f"{mode} interpolated from / kN"]
    return Table(
        f"At the simulation's forces; force error: {primary.replace('-', ' ')} of the gauge",
        header,
        rows,
    )
