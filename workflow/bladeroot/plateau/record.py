"""The plateau of one record as a Dataset: what the pooling over records starts from."""

import numpy as np
import xarray as xr

from bladeroot.plateau.plateau import plateau

LIMIT = "not reached, by tenable laws no steeper there than the square root of the amplitude"
RECORD = {
    "stick_frequency": ("Hz", "frequency of the stick plateau", "eqs 3.11, 3.20"),
    "stick_frequency_std": ("Hz", "standard error of stick_frequency within the record", "App. F"),
    "loss_factor": ("1", "hysteretic loss factor of the stick plateau", "eqs 3.11, 3.20"),
    "loss_factor_std": ("1", "standard error of loss_factor within the record", "App. F"),
    "onset_amplitude": ("m", "displacement amplitude where sticking ends", "sec. 3.5"),
    "onset_amplitude_std": ("m", "standard error of onset_amplitude: half its 68 % interval", ""),
    "onset_low": ("m", "lower end of the 95 % interval of onset_amplitude", ""),
    "onset_high": ("m", "upper end of the 95 % interval of onset_amplitude", ""),
    "onset_time": ("s", "time since the start of the cut when sticking begins", ""),
    "creep": ("Hz", "change of the frequency in time on the plateau, where it shows", ""),
    "plateau_low_amplitude": ("m", "smallest amplitude of the constant stretch", ""),
    "plateau_high_amplitude": ("m", "largest amplitude of the constant stretch", ""),
    "plateau_weight": ("1", "weight of the laws with a plateau", ""),
    "onset_bound": ("m", "largest amplitude seen, where the record never leaves the plateau", ""),
    "frequency_bound": ("Hz", "frequency at the smallest amplitude, plateau not reached", ""),
    "frequency_bound_std": ("Hz", "standard error of frequency_bound", ""),
    "limit_low": ("Hz", f"least limit at zero amplitude, {LIMIT}", ""),
    "limit_high": ("Hz", f"greatest limit at zero amplitude, {LIMIT}", ""),
    "plateau_reached": ("1", "1 where the record reaches its stick plateau", ""),
}
OTHERS = "other modes ring in the record and add to the slip: a lower bound for this mode alone"


def record_plateau(decay: xr.Dataset) -> xr.Dataset:
    """Stick frequency, loss factor, onset and verdict of one decay, with its attributes.

    Variables are the scalars of `bladeroot.plateau.plateau.plateau`; NaN where there is none.
    """
    found = plateau(decay)
    made = {
        name: ((), found[name], {"units": units, "long_name": text} | _source(source))
        for name, (units, text, source) in RECORD.items()
    }
    if decay.attrs.get("damping") == "viscous":
        made["loss_factor"][2]["long_name"] = "twice the damping ratio of the stick plateau"
    if np.size(decay.attrs.get("other_modes_Hz", ())):
        made["onset_amplitude"][2]["note"] = OTHERS
    text = {
        "units": "",
        "long_name": "plateau (creeping or not), plateau not reached, or rejected and why",
    }
    return xr.Dataset(made | {"verdict": ((), found["verdict"], text)}, attrs=decay.attrs)


def _source(source: str) -> dict[str, str]:
    return {"source": source} if source else {}
