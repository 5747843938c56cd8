"""A force gauge with a wrong scale."""

import numpy as np

from bladeroot.mechanisms.mechanism import Mechanism, Parameter, Records, StickEffect


def stick(records: Records, values: np.ndarray) -> StickEffect:
    """The true force is the read one times 1 + gain."""
    return StickEffect({"force": values[0] * records.force}, {"force": records.force[:, None]})


MECHANISM = Mechanism(
    id="force-gain",
    kind="force-law",
    sentence="the axial force is a constant part larger or smaller than the gauge says",
    parameters=(
        Parameter(
            "gain", "1", 0.0, 0.12, -0.5, 0.5,
            "a piston area or a strain gauge's section taken wrong, a seal's friction",
        ),
    ),
    splitter="a load cell in the line of force, or strain gauges on the beam",
    stick=stick,
    measured_by="load cell scale",
)  # fmt: skip
