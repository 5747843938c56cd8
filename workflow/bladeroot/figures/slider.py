"""The model of 1 degree of freedom: its decay, FREEVIB on it and the closed form (3.7 to 3.9)."""

import numpy as np
import xarray as xr

from bladeroot.figures.chart import Chart, Panel, Trace
from bladeroot.figures.style import MEASURED, PUBLISHED

_SHOWN_S = 0.08  # of the decay: to the last slip and somewhat further
_LABEL = "amplitude over the critical one"


def slider(curves: xr.Dataset) -> Chart:
    """`curves` is `bladeroot.reproduction.slider_curves.slider_curves`."""
    here = curves.isel(sample=slice(0, int(_SHOWN_S * curves.attrs["sampling_Hz"])))
    time = 1e3 * np.arange(here.sizes["sample"]) / curves.attrs["sampling_Hz"]
    critical = curves.attrs["critical_amplitude_m"]
    read, balanced = (curves[n].values / critical for n in ("amplitude", "balanced_amplitude"))
    ends = np.array([balanced[0], balanced[-1]])
    panels = [
        Panel("direct integration (fig. 3.7)", "time / ms", "velocity / m/s"),
        Panel("contact force; slip at the dotted lines", "time / ms", "contact force / N"),
        Panel("FREEVIB on the decay (fig. 3.8)", _LABEL, "frequency / Hz", x_log=True),
        Panel("FREEVIB on the decay (fig. 3.8)", _LABEL, "loss factor", x_log=True),
        Panel("first harmonic of the contact (fig. 3.9)", _LABEL, "stiffness over kt", x_log=True),
        Panel("first harmonic of the contact (fig. 3.9)", _LABEL, "damping over kt", x_log=True),
    ]
    traces = [
        Trace(k, time, here[name].values, name, line="-", width=0.7)
        for k, name in enumerate(("velocity", "force"))
    ]
    traces += [
        Trace(1, time[[0, -1]], np.full(2, sign * curves.attrs["slip_force_N"]), "slip", PUBLISHED,
              ":")
        for sign in (-1.0, 1.0)
    ]  # fmt: skip
    for k, (name, stuck) in enumerate(
        (("frequency", "stick_frequency_Hz"), ("loss_factor", "loss_factor")), start=2
    ):
        traces += [
            Trace(k, balanced, curves[f"balanced_{name}"].values, "closed form (3.19)", PUBLISHED,
                  "-", kind="closed form (3.19)"),
            Trace(k, read, curves[name].values, "FREEVIB", MEASURED, marker="o", size=2.5,
                  kind="FREEVIB"),
            Trace(k, ends, np.full(2, curves.attrs[stuck]), "adhesion", "#888888", ":",
                  kind="adhesion"),
        ]  # fmt: skip
    traces += [
        Trace(k, balanced, curves[name].values, name, PUBLISHED, "-")
        for k, name in enumerate(("stiffness", "damping"), start=4)
    ]
    return Chart(
        "Figures 3.7 to 3.9: the model of one degree of freedom with a slider, released at a "
        "hundred critical amplitudes and integrated from event to event; frequency and loss factor "
        "that FREEVIB reads off that decay; stiffness and damping of the contact by its first "
        "harmonic. Below some ten critical amplitudes the decay crosses the hump of damping within "
        "a few cycles: there no single harmonic describes it, and FREEVIB has a point a cycle.",
        panels, traces,
    )  # fmt: skip
