"""Loss factors that wander through the campaign while the frequencies stay."""

from collections.abc import Callable

import numpy as np

from bladeroot.mechanisms.drift import (
    MOMENT,
    MOMENTS,
    TIME_CONSTANT,
    columns,
    linear,
    saturating,
    step,
)
from bladeroot.mechanisms.mechanism import Mechanism, Parameter, Records


def law(course: Callable):
    """The hook: `change` of all ln(loss factors) times a course over time of a drift."""

    def damping(records: Records, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return columns(course, records, values)

    return damping


MECHANISM = Mechanism(
    id="damping-drift",
    kind="time",
    sentence="the losses of all modes change through the campaign, the frequencies do not",
    parameters=(
        Parameter(
            "change", "1", 0.0, 0.2, -1.5, 1.5,
            "of ln(loss factors): a joint that wears or dries, a cable that loosens",
        ),
    ),
    splitter="the first forces again at the end; cables and supports looked over",
    damping=law(linear),
    over=("time",),
    form="linear",
).also("saturating", TIME_CONSTANT, damping=law(saturating)).also(
    "step", MOMENT, damping=law(step), starts=MOMENTS
)  # fmt: skip
