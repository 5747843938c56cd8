"""A force gauge with a wrong scale."""

import numpy as np

from bladeroot.mechanisms.mechanism import (
    REFERENCE_FORCE,
    Mechanism,
    Parameter,
    Records,
    StickEffect,
)

_EDGE = 0.05  # of ln F, over which a gauge changes its range


def constant(records: Records, values: np.ndarray) -> StickEffect:
    """The true force is the read one times 1 + gain."""
    return StickEffect({"force": values[0] * records.force}, {"force": records.force[:, None]})


def curved(records: Records, values: np.ndarray) -> StickEffect:
    """A gain that grows in proportion to the force; as stated at 12 kN."""
    square = records.force**2 / REFERENCE_FORCE
    return StickEffect({"force": values[0] * square}, {"force": square[:, None]})


def two_ranges(records: Records, values: np.ndarray) -> StickEffect:
    """A gain above the force at which the gauge changes its range."""
    gain, switch = values
    above = 0.5 * (1.0 + np.tanh(np.log(records.force / switch) / _EDGE))
    slope = -2.0 * above * (1.0 - above) / _EDGE / switch
    columns = np.stack([above, gain * slope], axis=1)
    return StickEffect(
        {"force": gain * above * records.force}, {"force": columns * records.force[:, None]}
    )


MECHANISM = Mechanism(
    id="force-gain",
    kind="force-law",
    sentence="the {load} is a constant part larger or smaller than the {gauge} says",
    parameters=(
        Parameter(
            "gain", "1", 0.0, 0.12, -0.5, 0.5,
            "a piston area or a strain gauge's section taken wrong, a seal's friction",
        ),
    ),
    splitter="{second_measure}",
    stick=constant,
    measured_by="load cell scale",
    form="constant",
).also("curved", stick=curved).also(
    "two ranges",
    Parameter("switch", "N", 8e3, 0.7, 500.0, 50e3, "of the gauge's range", log=True),
    stick=two_ranges,
    starts=tuple((0.05, float(np.log(f))) for f in (4e3, 7e3, 1.2e4, 1.8e4)),
)  # fmt: skip
