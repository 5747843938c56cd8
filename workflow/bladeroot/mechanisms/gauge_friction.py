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
    reached, by_width = hysteresis.turned_over(records, values[1])
    lag = np.where(records.sign < 0, 2.0 * reached - 1.0, 1.0)
    made = _effect(records, values, records.force * lag)
    slope = 2.0 * values[0] * records.force * by_width
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
    "turning over", hysteresis.WIDTH, stick=turning_over
)  # fmt: skip
