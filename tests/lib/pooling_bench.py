"""Curves of groups of events, each seen by several sensors."""

import numpy as np
import xarray as xr


def curve(group, event, sensor="", loss=1.0, shift=0.0, low=1e-5, high=1e-3):
    amplitude = np.geomspace(high, low, 200)
    frequency = 20.0 * (1.0 + shift) + 0.01 * np.log(amplitude)
    damping = loss * (0.02 + 3.0 * amplitude)
    values = {"amplitude": amplitude, "frequency": frequency, "loss_factor": damping}
    values |= {"frequency_std": 0 * amplitude + 1e-4, "loss_factor_std": 1e-3 * damping}
    facts = {"mode": "m2", "group": group, "event": event, "sensor": sensor, "load": 0.0,
             "record": f"{event}{sensor}", "load_name": "", "load_unit": ""}  # fmt: skip
    return xr.Dataset({name: ("point", value) for name, value in values.items()}, attrs=facts)


def drawn(sizes, seed=0, scatter=0.01, sensors=("a", "b"), **how):
    rng = np.random.default_rng(seed)
    return [
        curve(f"floor {g}", f"e{g}{k}", sensor, size * own, low=1e-5 * (1 + k), **how)
        for g, size in enumerate(sizes)
        for k in range(3)
        for own in [np.exp(scatter * rng.standard_normal())]
        for sensor in sensors
    ]
