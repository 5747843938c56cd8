"""Figures 3.7 to 3.9: a decay of the model of 1 degree of freedom, FREEVIB on it, and (3.19)."""

from functools import cache

import numpy as np
import xarray as xr

from bladeroot.contact.laws import closed_forms
from bladeroot.decay.freevib import freevib
from bladeroot.reproduction.one_dof import Slider, free_decay

SAMPLING = 51200.0  # Hz
START = 100.0  # times the critical amplitude
_DURATION = 0.33  # s


@cache
def slider_curves() -> xr.Dataset:
    """The decay (velocity and contact force over time), frequency and loss factor over amplitude.

    By FREEVIB on the decay, and by the first harmonic of the contact (3.19); that harmonic's
    stiffness and damping are over k_t. The noise is that of a good record: without any there is no
    error to weigh by.
    """
    model = Slider()
    velocity, force = free_decay(model, START * model.critical_amplitude, SAMPLING, _DURATION)
    noise = 1e-5 * velocity.max()
    seen = velocity + noise * np.random.default_rng(0).standard_normal(velocity.size)
    curve = freevib(seen, SAMPLING, 500.0, noise, tolerance=0.4)
    size = model.critical_amplitude * np.geomspace(0.1, START, 200)
    frequency, loss = closed_forms.one_dof(
        size, model.mass, model.spring, model.contact, model.slip_force
    )
    stiffness, damping = closed_forms.equivalent_stiffness(size, model.contact, model.slip_force)
    viscous = 2.0 * model.zeta * model.stick_frequency / frequency
    made = {
        "balanced_amplitude": ("ladder", size, "m", "amplitude of the first harmonic", "3.19"),
        "velocity": ("sample", velocity, "m/s", "velocity", "3.15"),
        "force": ("sample", force, "N", "contact force", "3.17"),
        "balanced_frequency": ("ladder", frequency, "Hz", "frequency by it", "3.19"),
        "balanced_loss_factor": ("ladder", loss + viscous, "1", "loss factor by it", "3.19"),
        "stiffness": ("ladder", stiffness / model.contact, "1", "equivalent stiffness", "3.19"),
        "damping": ("ladder", damping / model.contact, "1", "equivalent damping", "3.19"),
    }
    added = {
        name: (dim, value, {"units": unit, "long_name": text, "source": f"eq. {source}"})
        for name, (dim, value, unit, text, source) in made.items()
    }
    return curve.assign(added).assign_attrs(
        sampling_Hz=SAMPLING,
        critical_amplitude_m=model.critical_amplitude,
        slip_force_N=model.slip_force,
        stick_frequency_Hz=model.stick_frequency,
        loss_factor=2.0 * model.zeta,
    )
