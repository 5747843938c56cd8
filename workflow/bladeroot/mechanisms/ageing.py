"""Contact stiffness that changes from clamping to clamping: flanks bed in, or wear."""

from collections.abc import Callable

import numpy as np

from bladeroot.mechanisms.mechanism import Mechanism, Parameter, Records, StickEffect

_EARLY = 10.0  # how much faster than in proportion bedding-in begins


def law(course: Callable[[np.ndarray], np.ndarray], stiffnesses: tuple[str, ...]):
    """The hook: `change` of ln k from first to last clamping, by a course of their number."""

    def stick(records: Records, values: np.ndarray) -> StickEffect:
        along = course(records.clamping) - 0.5
        changes, slopes = values[0] * along, along[:, None]
        return StickEffect(dict.fromkeys(stiffnesses, changes), dict.fromkeys(stiffnesses, slopes))

    return stick


def _linear(u: np.ndarray) -> np.ndarray:
    return u


def _fast_at_first(u: np.ndarray) -> np.ndarray:
    return np.log1p(_EARLY * u) / np.log1p(_EARLY)


MECHANISM = Mechanism(
    id="ageing",
    kind="time",
    sentence="the contact changes with every clamping: its surfaces bed in, or wear",
    parameters=(
        Parameter(
            "change", "1", 0.0, 0.3, -1.5, 1.5,
            "of ln k from the first to the last clamping: bedding-in adds tenths, wear takes them",
        ),
    ),
    splitter="the same clamping kept over hours beside many in a row",
    stick=law(_linear, ("ln_kn", "ln_kt")),
    over=("clamping",),
    form="kn and kt",
)  # fmt: skip
for _course, _names, _form in (
    (_linear, ("ln_kt",), "kt"),
    (_fast_at_first, ("ln_kn", "ln_kt"), "kn and kt, fast at first"),
    (_fast_at_first, ("ln_kt",), "kt, fast at first"),
):
    MECHANISM = MECHANISM.also(_form, stick=law(_course, _names))
