"""The plateau of one record as a Dataset: what the pooling over records starts from."""

import xarray as xr

from bladeroot.decay.plateau import plateau

RECORD = {
    "stick_frequency": ("Hz", "frequency of the stick plateau", "eqs 3.11, 3.20"),
    "stick_frequency_std": ("Hz", "standard error of stick_frequency within the record", "App. F"),
    "loss_factor": ("1", "hysteretic loss factor of the stick plateau", "eqs 3.11, 3.20"),
    "loss_factor_std": ("1", "standard error of loss_factor within the record", "App. F"),
    "onset_amplitude": ("m", "displacement amplitude where sticking ends", "sec. 3.5"),
    "onset_amplitude_std": ("m", "standard error of onset_amplitude", ""),
    "onset_bound": ("m", "largest amplitude seen, where the record never leaves the plateau", ""),
    "frequency_bound": ("Hz", "frequency at the smallest amplitude, plateau not reached", ""),
    "plateau_reached": ("1", "1 where the record reaches its stick plateau", ""),
}


def record_plateau(decay: xr.Dataset) -> xr.Dataset:
    """Stick frequency, loss factor, onset and verdict of one decay, with its attributes.

    Variables are the scalars of `bladeroot.decay.plateau.plateau`; NaN where there is none.
    """
    found = plateau(decay)
    made = {
        name: ((), found[name], {"units": units, "long_name": text} | _source(source))
        for name, (units, text, source) in RECORD.items()
    }
    text = {"units": "", "long_name": "plateau, plateau not reached, or rejected and why"}
    return xr.Dataset(made | {"verdict": ((), found["verdict"], text)}, attrs=decay.attrs)


def _source(source: str) -> dict[str, str]:
    return {"source": source} if source else {}
