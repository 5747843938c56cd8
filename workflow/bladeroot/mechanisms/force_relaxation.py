"""Axial force that relaxes after a hold is set."""

import numpy as np

from bladeroot.mechanisms.mechanism import Mechanism, Parameter, Records, StickEffect


def stick(records: Records, values: np.ndarray) -> StickEffect:
    """F (1 - loss log10(1 + t/tau)) with the time t since the first record of the hold."""
    loss, tau = values
    decades = np.log10(1.0 + records.since / tau)
    slope = -records.since / (tau * (tau + records.since)) / np.log(10.0)
    force = records.force
    return StickEffect(
        {"force": -loss * decades * force},
        {"force": np.stack([-decades * force, -loss * slope * force], axis=1)},
    )


MECHANISM = Mechanism(
    id="force-relaxation",
    kind="time",
    sentence="after each setting the axial force relaxes, by oil leakage or creep of the seats",
    parameters=(
        Parameter(
            "loss", "1", 0.0, 0.01, 0.0, 0.2,
            "a decade of time: a hydraulic hold loses tenths of a per cent to some per cent",
        ),
        Parameter(
            "time_constant", "s", 60.0, 1.2, 1.0, 1e5,
            "from seconds (seats) to an hour (leakage)", log=True,
        ),
    ),
    splitter="the gauge's reading at each record; a hold kept for an hour",
    stick=stick,
    over=("since",),
)  # fmt: skip
