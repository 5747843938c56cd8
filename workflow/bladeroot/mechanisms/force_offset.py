"""A force gauge with a wrong zero."""

import numpy as np

from bladeroot.mechanisms.drift import share
from bladeroot.mechanisms.mechanism import Mechanism, Parameter, Records, StickEffect


def stick(records: Records, values: np.ndarray) -> StickEffect:
    """The true force is the read one plus an offset."""
    one = np.ones_like(records.force)
    return StickEffect({"force": values[0] * one}, {"force": one[:, None]})


def creeping(records: Records, values: np.ndarray) -> StickEffect:
    """An offset that was another at first: the zero creeps, fast and then ever slower."""
    offset, first, time = values
    begun = share(records)
    late = time / (time + begun)
    slopes = [1.0 + first * late, offset * late, offset * first * begun / (time + begun) ** 2]
    return StickEffect({"force": offset * slopes[0]}, {"force": np.column_stack(slopes)})


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
    form="constant",
).also(
    "creeping",
    Parameter(
        "first", "1", 0.0, 0.3, -1.0, 1.0,
        "of the offset, at first besides: a zero moves by tenths of its error as a gauge warms",
    ),
    Parameter("time", "1", 0.3, 0.7, 0.02, 3.0, "of the campaign: hours, as of a rig", log=True),
    stick=creeping,
    starts=((3000.0, -0.2, float(np.log(0.3))), (-2000.0, -0.2, float(np.log(0.3)))),
)  # fmt: skip
