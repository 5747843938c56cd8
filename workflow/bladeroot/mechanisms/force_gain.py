"""A force gauge with a wrong scale."""

import numpy as np

from bladeroot.mechanisms.mechanism import (
    REFERENCE_FORCE,
    Mechanism,
    Parameter,
    Records,
    StickEffect,
)

_SWITCH_WIDTH = 0.05  # of ln F, over which a gauge changes its range


def constant(records: Records, values: np.ndarray) -> StickEffect:
    """The true force is the read one times 1 + gain."""
    return StickEffect({"force": values[0] * records.force}, {"force": records.force[:, None]})


def curved(records: Records, values: np.ndarray) -> StickEffect:
    """A gain that runs as a power of the force; as stated at 12 kN."""
    gain, power = values
    ratio = records.force / REFERENCE_FORCE
    course = ratio**power * records.force
    columns = np.stack([course, gain * course * np.log(ratio)], axis=1)
    return StickEffect({"force": gain * course}, {"force": columns})


def two_ranges(records: Records, values: np.ndarray) -> StickEffect:
    """Another gain below the force at which the gauge changes its range; as stated at 12 kN."""
    gain, low, switch = values
    forces = np.append(records.force, REFERENCE_FORCE)
    above = 0.5 * (1.0 + np.tanh(np.log(forces / switch) / _SWITCH_WIDTH))
    course, steep = low + (1.0 - low) * above, -2.0 * above * (1.0 - above) / _SWITCH_WIDTH / switch
    slopes = np.stack([np.zeros(forces.size), 1.0 - above, (1.0 - low) * steep], axis=1)
    here, stated = course[:-1], course[-1]
    columns = gain * (slopes[:-1] - np.outer(here / stated, slopes[-1])) / stated
    columns[:, 0] = here / stated
    return StickEffect(
        {"force": gain * here / stated * records.force},
        {"force": columns * records.force[:, None]},
    )


MECHANISM = Mechanism(
    id="force-gain",
    kind="force-law",
    sentence="the {load} is a constant part larger or smaller than the {gauge} says",
    parameters=(
        Parameter(
            "gain", "1", 0.0, 0.12, -0.5, 0.5,
            "true over read, less 1, at 12 kN: a wrong piston area, a seal's friction",
        ),
    ),
    splitter="{second_measure}",
    stick=constant,
    measured_by="load cell scale",
    form="constant",
).also(
    "curved", Parameter("power", "1", 0.5, 0.5, -3.0, 3.0, "of the force"), stick=curved
).also(
    "two ranges",
    Parameter("low", "1", 0.7, 1.0, 0.02, 50.0, "gain of the low range over the high's", log=True),
    Parameter("switch", "N", 8e3, 0.7, 500.0, 50e3, "of the gauge's range", log=True),
    keep=1, stick=two_ranges,
    starts=tuple((0.05, float(np.log(0.7)), float(np.log(f))) for f in (4e3, 7e3, 1.2e4, 1.8e4)),
)  # fmt: skip
