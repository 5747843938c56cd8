"""Contact stiffness that changes over clampings or time: flanks bed in, creep, or give way."""

from collections.abc import Callable

import numpy as np

from bladeroot.mechanisms.drift import MOMENT, STEP_STARTS, columns, share, step
from bladeroot.mechanisms.mechanism import Mechanism, Parameter, Records, StickEffect

_EARLY_RATE = 10.0  # of a change that is fast at first, ln(1 + 10 u) with u from 0 to 1
_BOTH = ("ln_kn", "ln_kt")


def law(course: Callable, stiffnesses: tuple[str, ...]):
    """The hook: `change` of ln k from first to last clamping, by a course of their number."""

    def stick(records: Records, values: np.ndarray) -> StickEffect:
        change, slopes = columns(course, records, values)
        return StickEffect(dict.fromkeys(stiffnesses, change), dict.fromkeys(stiffnesses, slopes))

    return stick


def _linear(records: Records, _: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return records.clamping - 0.5, np.zeros((records.clamping.size, 1))


def _fast_at_first(records: Records, _: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    course = np.log1p(_EARLY_RATE * records.clamping) / np.log1p(_EARLY_RATE)
    return course - 0.5, np.zeros((course.size, 1))


def _logarithmic(records: Records, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """By decades of the time since the start and a rest before it, as asperities creep."""
    t, rest = share(records), values[1]
    gone, whole = np.log1p(t / rest), np.log1p(1.0 / rest)
    by_gone, by_whole = -t / (rest * (rest + t)), -1.0 / (rest * (rest + 1.0))
    slope = (by_gone - gone / whole * by_whole) / whole
    return gone / whole - 0.5, np.stack([np.zeros(t.size), slope], axis=1)


MECHANISM = Mechanism(
    id="ageing",
    kind="time",
    sentence="the contact changes from clamping to clamping or with time: its surfaces bed in, "
    "creep, wear, or give way at once",
    parameters=(
        Parameter(
            "change", "1", 0.0, 0.3, -1.5, 1.5,
            "of ln k from the first to the last clamping: bedding-in adds tenths, wear takes them",
        ),
    ),
    splitter="the same clamping kept over hours beside many in a row",
    stick=law(_linear, _BOTH),
    over=("clamping",),
    form="kn and kt",
)  # fmt: skip
for _course, _names, _form in (
    (_linear, ("ln_kt",), "kt"),
    (_fast_at_first, _BOTH, "kn and kt, fast at first"),
    (_fast_at_first, ("ln_kt",), "kt, fast at first"),
):
    MECHANISM = MECHANISM.also(_form, stick=law(_course, _names))
for _names, _form in ((_BOTH, "kn and kt, with time"), (("ln_kt",), "kt, with time")):
    MECHANISM = MECHANISM.also(
        _form,
        Parameter("rest", "1", 0.1, 1.5, 1e-3, 10.0, "of the campaign's time", log=True),
        stick=law(_logarithmic, _names),
        over=("time",),
    )
MECHANISM = MECHANISM.also(
    "kn and kt, at once",
    MOMENT,
    stick=law(step, _BOTH),
    starts=tuple((0.1, at) for _, at in STEP_STARTS),
)
