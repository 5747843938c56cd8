"""The plateau of one record as a Dataset: what the pooling over records starts from."""

import numpy as np
import xarray as xr

from bladeroot.plateau.plateau import plateau
from bladeroot.variables import dataset, names

RECORD = names("plateau/record")
OTHERS = "other modes ring in the record and add to the slip: a lower bound for this mode alone"


def record_plateau(decay: xr.Dataset) -> xr.Dataset:
    """Stick frequency, loss factor, onset and verdict of one decay, with its attributes.

    Variables are the scalars of `bladeroot.plateau.plateau.plateau`; NaN where there is none.
    """
    found = plateau(decay)
    made = dataset("plateau/record", {name: found[name] for name in RECORD})
    if decay.attrs.get("damping") == "viscous":
        made["loss_factor"].attrs["long_name"] = "twice the damping ratio of the stick plateau"
    if np.size(decay.attrs.get("other_modes_Hz", ())):
        made["onset_amplitude"].attrs["note"] = OTHERS
    verdict = dataset("plateau/verdict", {"verdict": found["verdict"]})
    return made.assign(verdict).assign_attrs(decay.attrs)
