"""The sections on what was measured and which stick frequencies came of it."""

from collections import Counter
from collections.abc import Mapping

import numpy as np
import pandas as pd
import xarray as xr

from bladeroot.report.bad_records import rejected
from bladeroot.report.numbers import NONE, fixed, listed, significant, with_std
from bladeroot.report.page import Picture, Section, Table

FEW_CYCLES = "too few cycles are sharp enough"  # a verdict of `bladeroot.decay.plateau`
VERDICTS = {
    "plateau": "with a stick plateau (constant frequency at small amplitude)",
    "plateau, but the frequency creeps on it": "with a stick plateau on which the frequency creeps "
    "in time (by what the standard error holds)",
    "plateau not reached": "bending down to their smallest amplitude",
    "rejected": "rejected",
}
PICTURES = {
    "cuts": "Raw records and the free decay that was cut out by itself: for each mode at the "
    "lowest and the highest force, then a few that are rejected (one for each kind of fault) and "
    "those of which most is masked, with the reason. Dashed: release, or start of the decay, and "
    "its end.",
    "spectra": "Amplitude spectra of the same free decays before and after the mode was separated, "
    "all three of the longest stretch that is not masked and where the mode was followed (its "
    "times after the start of the cut in the title; the whole decay where none was). What is left "
    "over should hold the other modes and the noise, and nothing of the mode: where it stands "
    "above the free decay the separation failed.",
    "backbones": "Natural frequency and loss factor against displacement amplitude (FREEVIB, "
    "3.11), a curve for each usable record (at most 100 a mode, evenly over the forces), coloured "
    "by force (by hold or record where there is one force "
    "only); bands are one standard error, and points are drawn where it is below 0.1 % of the "
    "frequency and 20 % of the loss factor.",
    "waterfall": "Mean curve of all records at each force, over the base line of its force; the "
    "base lines are evenly spaced, the bar at the right is the curves' scale. Softening: how far "
    "the frequency lies below its value at the smallest amplitudes. The records' own levels are "
    "taken off before the mean and their mean is put back. Bands: plus and minus one standard "
    "error of the change with amplitude, of one record alone where the line is thin; ±: standard "
    "deviation between the records, levels included (median over amplitude).",
    "amplitude_force": "Natural frequency and loss factor over amplitude and axial force: "
    "interpolated linearly between the forces that were measured (triangles). Blank where one of "
    "the two forces beside has no record of that amplitude, or where the standard error of the "
    "change with amplitude exceeds 0.1 % of the frequency or 20 % of the loss factor. At each "
    "force it is the mean of the records; how far they lie apart is beside the curves above.",
}


def measurement_section(facts: Mapping, stick: xr.Dataset, figures: Mapping[str, str]) -> Section:
    """The specimen's campaign: gauge, modes, records, what was left out and why."""
    description = facts["description"]
    parts: list = [description.get("notes", ""), _gauge_sentence(description["force"])]
    parts = [part for part in parts if part]
    if facts["entry"] == "stick frequencies":
        parts.append(
            f"The campaign enters at the stick-frequency stage with {_levels(stick)}; there are no "
            "records to check them with."
        )
        return Section("What was measured", parts)
    verdicts = Counter(str(v).split(":")[0] for v in stick["verdict"].values)
    counts = [
        f"{verdicts[verdict]} {text}" for verdict, text in VERDICTS.items() if verdicts[verdict]
    ]
    parts.append(f"{stick.sizes['record']} records: {listed(counts)}.")
    parts.append(_record_table(stick))
    bad = rejected(stick)
    if bad:
        parts.append(Table("Rejected, and left out of all that follows", ("record", "why"), bad))
        if any(FEW_CYCLES in why for _, why in bad):
            parts.append(
                "Too few cycles are sharp enough where noise hides the phase of most of them. A "
                "larger amplitude at the release, a finer range of the sensor or a longer record "
                "helps; so does a record of its own for a mode that another outshines."
            )
    if (stick["verdict"].values == "plateau not reached").any():
        parts.append(_bounds(stick))
    if facts["excluded"]:
        parts.append(f"Excluded in records.csv: {listed(list(facts['excluded']))}.")
    drawn = ["cuts", "spectra"]
    if len(bad) < stick.sizes["record"]:
        drawn += ["backbones", "waterfall"]
        if _several_forces(stick):
            drawn.append("amplitude_force")
        else:
            parts.append("Every mode was measured at one axial force: there is no map over force.")
    parts += [Picture(figures[name], PICTURES[name]) for name in drawn]
    return Section("What was measured", parts)


def stick_section(
    stick: xr.Dataset, figure: str, score: xr.Dataset | None, fe_forces: xr.Dataset | None
) -> Section:
    """Stick frequency, loss factor and onset for each mode and force.

    fe_forces: None without a structure, which would have forces of its own.
    """
    rows = [
        (
            str(level["mode"].item()),
            fixed(float(level["force"]) / 1e3, 2),
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
        "The stick frequency is that of the plateau at small amplitude, where all flanks stick and "
        "the joint is linear. Nothing is extrapolated: a record that never reaches its plateau "
        "gives a bound and no frequency.",
        Picture(
            figure,
            "Stick frequency and loss factor against axial force"
            + (
                ""
                if fe_forces is None
                else ", and their linear interpolation to the simulation's forces with the force "
                "error included (5.13, 5.14)"
            )
            + ".",
        ),
    ]
    if rows:
        parts.append(Table(
            "Stick frequencies. Within: propagated standard error of the records (3.21); between: "
            f"standard deviation of the records at one force. {_counted(stick)} "
            "The onset is where the whole motion begins to slip: other modes in the record add to "
            "it, so that it is a lower bound for the mode alone.",
            ("mode", "force / kN", "frequency / Hz", "within / Hz", "between / Hz",
             "loss factor / %", "onset of slip / µm", "records / holds"),
            rows,
        ))  # fmt: skip
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
    text = (
        "The stated error counts both, and the scatter between clampings: that of repeats or, "
        "where no force is clamped twice, of the forces about a smooth law."
    )
    if "lower_bound" in attrs:
        text += f" In {attrs['lower_bound']} it is unknown, and the error a lower bound."
    return text


def scatter_parts(stick: xr.Dataset) -> list:
    """What repeats scatter, or what a table's rows scatter beside its printed errors."""
    if "scatter_ratio" in stick:
        known = np.isfinite(stick["scatter_ratio"].values).any()
        return [_printed_errors(stick)] if known else []
    rows = []
    for mode in dict.fromkeys(stick["mode"].values):
        here = stick.isel(level=int(np.flatnonzero(stick["mode"].values == mode)[0]))
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
    header = ("mode", "between records / Hz", "freedom", "between holds / Hz", "freedom",
              "up less down / Hz")  # fmt: skip
    return [
        Table(
            "What repeats scatter beyond their own errors, told from all forces of a mode: "
            "standard deviation between the records of a hold and between holds, with degrees of "
            "freedom, and the difference between loading up and down",
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
        "record and leave out all that differs between records, holds and readings of the force",
        ("mode", "stick frequency", "loss factor"),
        rows,
    )


def _several_forces(stick: xr.Dataset) -> bool:
    """Whether any mode has records at two forces or more that were not rejected."""
    kept = ~np.char.startswith(stick["verdict"].values.astype(str), "rejected")
    levels = set(
        zip(stick["record_mode"].values[kept], stick["record_force"].values[kept], strict=True)
    )
    return len(levels) > len({mode for mode, _ in levels})


def _interval(low: float, high: float) -> str:
    return f"{fixed(low, 2)} to {fixed(high, 2)}" if np.isfinite([low, high]).all() else NONE


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


def _gauge_sentence(gauge: Mapping) -> str:
    if gauge["gauge"] == "pressure":
        what = (
            f"from the actuator's pressure on {gauge['piston_area_cm2']:g} cm², full scale "
            f"{gauge['full_scale_bar']:g} bar"
        )
    else:
        what = f"from strain gauges, full scale {gauge['full_scale_microstrain']:g} microstrain"
    return (
        f"The axial force is read {what}, accurate to {gauge['accuracy_percent']:g} % of the "
        f"{gauge['accuracy_of'].replace('-', ' ')}."
    )


def _levels(stick: xr.Dataset) -> str:
    texts = []
    for mode in dict.fromkeys(stick["mode"].values):
        force = stick["force"].values[stick["mode"].values == mode] / 1e3
        texts.append(
            f"{len(force)} forces in mode {mode} ({force.min():.1f} to {force.max():.1f} kN)"
        )
    return listed(texts)


def _record_table(stick: xr.Dataset) -> Table:
    frame = pd.DataFrame(
        {
            name: stick[name].values
            for name in ("record_mode", "record_force", "hold", "plateau_reached")
        }
    )
    rows = []
    for (mode, force), group in frame.groupby(["record_mode", "record_force"]):
        rows.append(
            (
                mode,
                fixed(force / 1e3, 2),
                str(len(group)),
                str(group["hold"].nunique()),
                str(int(group["plateau_reached"].sum())),
            )
        )
    header = ("mode", "force / kN", "records", "holds", "plateau reached")
    return Table("Records of each mode and force", header, rows)


def _bounds(stick: xr.Dataset) -> Table:
    """What the records that still bend at their smallest amplitude tell all the same."""
    rows = []
    for record in stick["record"].values[stick["verdict"].values == "plateau not reached"]:
        here = stick.sel(record=record)
        rows.append(
            (
                str(record),
                str(here["record_mode"].item()),
                fixed(float(here["record_force"]) / 1e3, 2),
                fixed(float(here["frequency_bound"]), 2),
                _interval(float(here["limit_low"]), float(here["limit_high"])),
            )
        )
    return Table(
        "Plateau not reached: the frequency at the smallest usable amplitude, where the record "
        "still bends; the stick frequency lies beyond it. Limit: where those powers of the "
        "amplitude, from the square root upwards, that describe the record would have it end; "
        "slip that saturates at large amplitudes can end outside",
        ("record", "mode", "force / kN", "frequency / Hz", "limit at zero amplitude / Hz"),
        rows,
    )


def _score_parts(stick: xr.Dataset, score: xr.Dataset) -> list:
    reached, hit = score.attrs["reached"], score.attrs["within_3"]
    deviation = score["deviation"].values
    worst = np.nanmax(np.abs(deviation)) if reached else np.nan
    error = 1e6 * np.abs(stick["stick_frequency"] / score["true_frequency"] - 1)
    return [
        "The records are simulated, so the answer is known: of "
        f"{reached} records whose plateau is reached, {hit} hit the bench's stuck eigenfrequency "
        f"within three of their stated standard errors (worst {significant(worst, 2)}); the median "
        f"error is {significant(float(error.median()), 2)} ppm. "
        f"{stick.sizes['record'] - reached} records are reported as not reached or rejected. That "
        "is the error within a record; between clampings the joint itself differs, as the table "
        f"shows. The onset of slip is found at {_onset_ratios(stick, score)} times the amplitude "
        "at which the bench's first pair of nodes would slip in a pure mode; what is left of the "
        "other mode in a record slips along with it."
    ]


def _onset_ratios(stick: xr.Dataset, score: xr.Dataset) -> str:
    """Median of found over true onset, mode by mode."""
    ratio = stick["record_onset_amplitude"] / score["true_onset_amplitude"]
    texts = []
    for mode in dict.fromkeys(stick["record_mode"].values):
        of_mode = ratio.values[stick["record_mode"].values == mode]
        texts.append(f"{significant(float(np.nanmedian(of_mode)), 2)} ({mode})")
    return listed(texts)


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
