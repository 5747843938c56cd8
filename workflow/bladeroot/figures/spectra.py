"""Spectra of free decays before and after the mode was separated from the rest."""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from bladeroot.figures.style import (
    MEASURED,
    PUBLISHED,
    note_simulated,
    panels,
    title_of_record,
)


def spectra(found: Sequence[xr.Dataset]) -> Figure | None:
    """One panel a record: the free decay, the mode that was followed, and what it leaves over.

    found: dims line, as from `bladeroot.decay.spectra.before_and_after`, with the attribute
    `reason`, as from `bladeroot.figures.records.worth_showing`.
    """
    if not found:
        return None
    drawn, axes = panels(len(found), 1, 7.2, 2.2 * len(found) + 0.4)
    for axis, record in zip(axes[:, 0], found, strict=True):
        frequency = record["frequency"].values
        for name, colour, label in (
            ("whole", "#b9c3cf", "free decay"),
            ("mode", MEASURED, "mode as followed"),
            ("rest", PUBLISHED, "left over"),
        ):
            axis.plot(
                frequency, 1e3 * record[name].values, color=colour, label=label,
                linewidth=2.2 if name == "whole" else 0.8,
            )  # fmt: skip
        for other in np.atleast_1d(record.attrs.get("other_modes_Hz", [])):
            axis.annotate(
                "", xy=(other, 0.88), xytext=(other, 1.0), xycoords=("data", "axes fraction"),
                arrowprops={"arrowstyle": "->", "color": "#777777"},
            )  # fmt: skip
        axis.set_yscale("log")
        # the axes end where the record itself does: a sensor's band may be narrower than its rate
        whole = 1e3 * record["whole"].values
        last = min(frequency[whole > 1e-6 * whole.max()][-1], 8.0 * record.attrs["expected_Hz"])
        shown = 1e3 * record[["whole", "rest"]].to_array().values[:, frequency <= last]
        axis.set_ylim(0.5 * shown[shown > 0.0].min(), 10.0 * whole.max())
        axis.set_xlim(0.0, last)
        axis.set_ylabel("amplitude / mm/s")
        span = ", {from_s:.2f} to {to_s:.2f} s".format_map(record.attrs)
        title_of_record(axis, record.attrs, span)
    handles, labels = axes[0, 0].get_legend_handles_labels()
    drawn.legend(handles, labels, loc="outside lower center", ncols=3)
    axes[-1, 0].set_xlabel("frequency / Hz (arrows: other modes, followed and taken off)")
    return note_simulated(drawn, any(bool(r.attrs.get("simulated")) for r in found))
