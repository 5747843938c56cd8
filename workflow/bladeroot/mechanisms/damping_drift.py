"""Loss factors that wander through the campaign while the frequencies stay."""

from functools import partial

from bladeroot.mechanisms.drift import (
    MOMENT,
    STEP_STARTS,
    TIME_CONSTANT,
    columns,
    linear,
    saturating,
    step,
)
from bladeroot.mechanisms.mechanism import Mechanism, Parameter

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
    splitter="the first {forces} again at the end; cables and supports looked over",
    damping=partial(columns, linear),
    over=("time",),
    form="linear",
).also("saturating", TIME_CONSTANT, damping=partial(columns, saturating)).also(
    "step", MOMENT, damping=partial(columns, step), starts=STEP_STARTS
)  # fmt: skip
