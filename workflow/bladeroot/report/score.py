"""How well the stick frequencies of simulated records hit what the virtual bench knows."""

from collections.abc import Mapping

import numpy as np
import xarray as xr

_TEXTS = {
    "frequency": ("Hz", "stuck eigenfrequency of the bench"),
    "loss_factor": ("1", "loss factor of the bench, all stuck"),
    "onset_amplitude": ("m", "amplitude at the sensor at which the bench's first pair slips"),
    "kn": ("N/m", "normal stiffness of a flank in the bench"),
    "kt": ("N/m", "tangential stiffness of a flank in the bench"),
}


def score(stick: xr.Dataset, truths: Mapping[str, xr.Dataset]) -> xr.Dataset:
    """Each record's stick frequency beside the stuck eigenfrequency, in standard errors.

    stick: with dim `record`. truths: by record, from the bench. Records whose plateau was not
    reached have a deviation of NaN. Attributes: `reached`, `within_3`, the counts that matter.
    Raises ValueError when a record has no truth.
    """
    records = [str(record) for record in stick["record"].values]
    missing = [record for record in records if record not in truths]
    if missing:
        raise ValueError(f"no truth for record {', '.join(missing)}")
    truth = {name: np.array([float(truths[record][name]) for record in records]) for name in _TEXTS}
    reached = stick["plateau_reached"].values.astype(bool)
    deviation = np.where(
        reached,
        (stick["stick_frequency"].values - truth["frequency"])
        / stick["stick_frequency_std"].values,
        np.nan,
    )
    made = {
        f"true_{name}": ("record", truth[name], {"units": unit, "long_name": text})
        for name, (unit, text) in _TEXTS.items()
    }
    made["deviation"] = (
        "record",
        deviation,
        {"units": "1", "long_name": "stick frequency less truth, in its standard errors"},
    )
    made["force"] = (
        "record", stick["record_force"].values, {"units": "N", "long_name": "axial force as read"}
    )  # fmt: skip
    return xr.Dataset(made, {"record": records}).assign_attrs(
        reached=int(reached.sum()), within_3=int((np.abs(deviation[reached]) <= 3).sum())
    )
