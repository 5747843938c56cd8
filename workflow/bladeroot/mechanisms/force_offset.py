"""A force gauge with a wrong zero."""

import numpy as np

from bladeroot.mechanisms.mechanism import Mechanism, Parameter, Records, StickEffect


def stick(records: Records, values: np.ndarray) -> StickEffect:
    """The true force is the read one plus an offset."""
    one = np.ones_like(records.force)
    return StickEffect({"force": values[0] * one}, {"force": one[:, None]})


MECHANISM = Mechanism(
    id="force-offset",
    kind="level",
    sentence="the {load} differs from what the {gauge} says by the same amount at all {forces}",
    parameters=(
        Parameter(
            "offset", "N", 0.0, 2500.0, -10e3, 10e3,
            "a pressure gauge is good to 1 % of full scale, 1253 N; weight and seal friction add",
        ),
    ),
    splitter="{second_measure}; the frequency without any {load}",
    stick=stick,
    measured_by="load cell zero",
    starts=((3000.0,), (-1000.0,)),
)  # fmt: skip
