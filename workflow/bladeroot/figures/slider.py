"""The model of 1 degree of freedom: its decay, FREEVIB on it and the closed form (3.7 to 3.9)."""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from bladeroot.figures.style import MEASURED, PUBLISHED, panels

_SHOWN = 0.08  # s of the decay: to the last slip and somewhat further


def slider(curves: xr.Dataset) -> Figure:
    """`curves` is `bladeroot.reproduction.slider_curves.slider_curves`."""
    drawn, axes = panels(3, 2, 8.4, 8.0)
    here = curves.isel(sample=slice(0, int(_SHOWN * curves.attrs["sampling_Hz"])))
    time = 1e3 * np.arange(here.sizes["sample"]) / curves.attrs["sampling_Hz"]
    for axis, name, label in zip(
        axes[0], ("velocity", "force"), ("velocity / m/s", "contact force / N"), strict=True
    ):
        axis.plot(time, here[name], color=MEASURED, linewidth=0.7)
        axis.set_xlabel("time / ms")
        axis.set_ylabel(label)
    axes[0, 0].set_title("direct integration (fig. 3.7)", loc="left")
    for sign in (-1.0, 1.0):
        axes[0, 1].axhline(sign * curves.attrs["slip_force_N"], color=PUBLISHED, linestyle=":")
    axes[0, 1].set_title("slip at the dotted lines", loc="left")
    critical = curves.attrs["critical_amplitude_m"]
    read, balanced = curves["amplitude"] / critical, curves["balanced_amplitude"] / critical
    for axis, name, label, stuck in zip(
        axes[1],
        ("frequency", "loss_factor"),
        ("frequency / Hz", "loss factor"),
        (curves.attrs["stick_frequency_Hz"], curves.attrs["loss_factor"]),
        strict=True,
    ):
        axis.plot(balanced, curves[f"balanced_{name}"], color=PUBLISHED, label="closed form (3.19)")
        axis.plot(read, curves[name], ".", color=MEASURED, markersize=4, label="FREEVIB")
        axis.axhline(stuck, color="#888888", linestyle=":", label="adhesion")
        axis.set_ylabel(label)
    axes[1, 0].set_title("FREEVIB on the decay (fig. 3.8)", loc="left")
    axes[1, 0].legend(loc="best")
    for axis, name in zip(axes[2], ("stiffness", "damping"), strict=True):
        axis.plot(balanced, curves[name], color=PUBLISHED)
        axis.set_ylabel(f"equivalent {name} over kt")
    axes[2, 0].set_title("first harmonic of the contact (fig. 3.9)", loc="left")
    for axis in axes[1:].ravel():
        axis.set_xscale("log")
        axis.set_xlabel("amplitude over the critical one")
        axis.axvline(1.0, color="#888888", linewidth=0.6)
    return drawn
