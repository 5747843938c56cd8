"""Loss factors that wander through the campaign while the frequencies stay."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from bladeroot.mechanisms.drift import MOMENTS, columns, linear, saturating, step
from bladeroot.mechanisms.mechanism import Mechanism, Parameter, Records


def law(course: Callable):
    """The hook: `change` of all ln(loss factors) times a course over time of a drift."""

    def damping(records: Records, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return columns(course, records, values)

    return damping


_CHANGE = Parameter(
    "change", "1", 0.0, 0.2, -1.5, 1.5,
    "of ln(loss factors): a joint that wears or dries, a cable that loosens",
)  # fmt: skip
MECHANISM = Mechanism(
    id="damping-drift",
    kind="time",
    sentence="the losses of all modes change through the campaign, the frequencies do not",
    parameters=(_CHANGE,),
    splitter="the first forces again at the end; cables and supports looked over",
    damping=law(linear),
    over=("time",),
    form="linear",
)
MECHANISM = replace(
    MECHANISM,
    forms=(
        replace(
            MECHANISM,
            parameters=(
                _CHANGE,
                Parameter("time_constant", "1", 0.3, 0.7, 0.02, 3.0, "of the campaign", log=True),
            ),
            damping=law(saturating),
            form="saturating",
        ),
        replace(
            MECHANISM,
            parameters=(
                _CHANGE,
                Parameter("moment", "1", 0.5, 1.5, 0.0, 1.0, "of the clampings", bounded=True),
            ),
            damping=law(step),
            starts=MOMENTS,
            form="step",
        ),
    ),
)
