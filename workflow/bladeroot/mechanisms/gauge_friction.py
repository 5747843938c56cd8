"""Friction between the gauge and the specimen: the true force lags behind the reading."""

import numpy as np

from bladeroot.mechanisms import loading_hysteresis as hysteresis
from bladeroot.mechanisms.mechanism import (
    REFERENCE_FORCE,
    Mechanism,
    Parameter,
    Records,
    StickEffect,
)


def proportional(records: Records, values: np.ndarray) -> StickEffect:
    """Less than the reading by a part of it when loading, more when unloading."""
    return _effect(records, values, records.force)


def constant(records: Records, values: np.ndarray) -> StickEffect:
    """By the same at all forces, as stated at 12 kN."""
    return _effect(records, values, np.full(records.force.size, REFERENCE_FORCE))


def turning_over(records: Records, values: np.ndarray) -> StickEffect:
    """In proportion; below the upper turning point it turns over as Dahl's friction does."""
    down, width = records.sign < 0, values[1]
    way = 1.0 - hysteresis.part(records)
    left = 2.0 * np.exp(-way / width)
    made = _effect(records, values, records.force * np.where(down, 1.0 - left, 1.0))
    slope = values[0] * records.sign * records.force * np.where(down, left * way / width**2, 0.0)
    return StickEffect(made.changes, {"force": np.column_stack([made.slopes["force"], slope])})


def _effect(records: Records, values: np.ndarray, lag: np.ndarray) -> StickEffect:
    change = -records.sign * lag
    return StickEffect({"force": values[0] * change}, {"force": change[:, None]})


MECHANISM = Mechanism(
    id="gauge-friction",
    kind="direction",
    sentence="friction in the loading line: the true {force} lags behind the {gauge}'s, "
    "up and down",
    parameters=(
        Parameter(
            "friction", "1", 0.0, 0.08, 0.0, 0.4, "over the force: seals of a cylinder 2 to 20 %"
        ),
    ),
    splitter="{second_measure}, up and down",
    stick=proportional,
    measured_by="load cell hysteresis",
    over=("sign", "force"),
    form="proportional",
).also("constant", stick=constant).also(
    "turning over",
    Parameter("width", "1", 0.2, 0.7, 0.01, 2.0, "part of the range of forces", log=True),
    stick=turning_over,
)  # fmt: skip
