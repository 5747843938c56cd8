"""The tables for records without a plateau: frequency and damping over amplitude in numbers."""

import numpy as np
import xarray as xr

from bladeroot.report.numbers import NONE, fixed, significant, with_std
from bladeroot.report.page import Table
from bladeroot.report.words import Words, words_of
from bladeroot.terms import length

# Amplitudes that are shown: these in each decade of the quantity that was measured.
ROUND_AMPLITUDES = (1.0, 3.0)
SLOPES = ("frequency_per_decade", "frequency_per_decade_std", "loss_factor_per_decade",
          "loss_factor_per_decade_std")  # fmt: skip
# Unit of an amplitude in a table, how many are one in SI, and its power of the angular frequency.
UNITS = {"displacement": ("µm", 1e6, 0), "velocity": ("mm/s", 1e3, 1),
         "acceleration": ("m/s²", 1.0, 2)}  # fmt: skip


def over_amplitude(curves: xr.Dataset, stick: xr.Dataset) -> list[Table]:
    """Values at round amplitudes, and changes per decade, of levels with records without a plateau.

    curves: from `bladeroot.pooling.curves`; stick: which records have no plateau.
    """
    bare = stick.isel(record=stick["verdict"].values == "plateau not reached")
    of_record = ("record_mode", "record_force", "record_group", "sensor")
    without = set(zip(*(bare[name].values for name in of_record), strict=True))
    of_level = ("mode", "force", "group", "sensor")
    levels = [
        curves.isel(level=k)
        for k, own in enumerate(zip(*(curves[name].values for name in of_level), strict=True))
        if own in without
    ]
    words = words_of(curves)
    values = [row for level in levels for row in _values(level, words)]
    changes = [row for level in levels for row in _changes(level, words)]
    named = ("mode", words.header, "group", "sensor")
    tables = []
    if values:
        tables.append(Table(
            "Frequency and damping at round amplitudes, where records have no plateau: mean of the "
            "records with one standard error; the damping ratio is half of the loss factor. All "
            "amplitudes: bladeroot export",
            (*named, "amplitude", "displacement", "frequency / Hz", "loss factor / %",
             "damping ratio / %", "records"),
            values,
        ))  # fmt: skip
    if changes:
        tables.append(Table(
            "Change with amplitude and repeatability of the same: change of the frequency (of "
            "itself) and of the loss factor (in points) in a decade of amplitude, mean over all "
            "that the records reach; scatter: standard deviation between records at one "
            "amplitude, median",
            (*named, "from", "to", "change of frequency / %", "change of loss factor / %",
             "scatter of frequency", "scatter of loss factor"),
            changes,
        ))  # fmt: skip
    return tables


def stuck(here: xr.Dataset) -> str:
    """What a record without a plateau says of its stuck frequency, in words."""
    bound, low, high = (
        float(here[name]) for name in ("frequency_bound", "limit_low", "limit_high")
    )
    if not np.isfinite([low, high]).all():
        return f"beyond {fixed(bound, 2)}"
    side = "above" if low >= bound else "below" if high <= bound else "near"
    within = f"between {fixed(low, 2)} and {fixed(high, 2)}"
    return f"{side} {fixed(bound, 2)}; {within} at 95 %, if the law goes on"


def _values(level: xr.Dataset, words: Words) -> list[tuple[str, ...]]:
    known = np.isfinite(level["frequency"].values) & np.isfinite(level["loss_factor"].values)
    if not known.any():
        return []
    metres = level["amplitude"].values[known]
    unit, amplitude = _measured(level, known)
    powers = np.arange(np.floor(np.log10(amplitude[0])), np.ceil(np.log10(amplitude[-1])) + 1)
    asked = [one * 10.0**power for power in powers for one in ROUND_AMPLITUDES]
    asked = [one for one in asked if amplitude[0] <= one <= amplitude[-1]]
    rows = []
    for one in asked or [float(np.sqrt(amplitude[0] * amplitude[-1]))]:
        at = {
            name: float(np.interp(np.log(one), np.log(amplitude), level[name].values[known]))
            for name in ("frequency", "frequency_std", "loss_factor", "loss_factor_std", "records")
        }
        loss, loss_std = 100.0 * at["loss_factor"], 100.0 * at["loss_factor_std"]
        rows.append(
            (
                *_named(level, words),
                *_amplitude(one, unit, float(np.interp(np.log(one), np.log(amplitude), metres))),
                with_std(at["frequency"], at["frequency_std"], 2),
                with_std(loss, loss_std, 2),
                with_std(0.5 * loss, 0.5 * loss_std, 2),
                fixed(at["records"], 0),
            )
        )
    return rows


def _changes(level: xr.Dataset, words: Words) -> list[tuple[str, ...]]:
    known = np.isfinite(level["frequency"].values) & np.isfinite(level["loss_factor"].values)
    slope = {name: float(level[name]) for name in SLOPES}
    if not (known.any() and np.isfinite(list(slope.values())).all()):
        return []
    unit, amplitude = _measured(level, known)
    per_cent = 100.0 / float(np.median(level["frequency"].values[known]))
    cells = [
        with_std(
            per_cent * slope["frequency_per_decade"],
            per_cent * slope["frequency_per_decade_std"],
            2,
        ),
        with_std(
            100.0 * slope["loss_factor_per_decade"], 100.0 * slope["loss_factor_per_decade_std"], 2
        ),
    ]
    for name in ("frequency", "loss_factor"):
        both = (100.0 * level[f"{name}_scatter"] / level[name]).values[known]
        both = both[np.isfinite(both)]
        cells.append(significant(float(np.median(both)), 2, "%") if both.size else NONE)
    metres = level["amplitude"].values[known]
    ends = [_amplitude(amplitude[k], unit, metres[k])[0] for k in (0, -1)]
    return [(*_named(level, words), *ends, *cells)]


def _measured(level: xr.Dataset, known: np.ndarray) -> tuple[str, np.ndarray]:
    """Unit and values of the amplitudes in the quantity that was measured."""
    unit, factor, power = UNITS[str(level["quantity"].item())]
    omega = 2.0 * np.pi * level["frequency"].values[known]
    return unit, factor * omega**power * level["amplitude"].values[known]


def _amplitude(value: float, unit: str, metres: float) -> tuple[str, str]:
    """An amplitude as it was measured, and as a displacement beside it."""
    if unit == UNITS["displacement"][0]:
        return length(metres), NONE
    return significant(value, 2, unit), length(metres)


def _named(level: xr.Dataset, words: Words) -> tuple[str, ...]:
    group, sensor = (str(level[name].item()) or NONE for name in ("group", "sensor"))
    return str(level["mode"].item()), words.value(float(level["force"])), group, sensor
