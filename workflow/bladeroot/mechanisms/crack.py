"""A crack that grows with every clamping and run: frequencies fall, each mode's by its own part."""

from collections.abc import Callable

import numpy as np

from bladeroot.mechanisms.drift import share
from bladeroot.mechanisms.mechanism import Mechanism, Parameter, Records, StickEffect

_FASTER = 3.0  # ln of how much faster it grows at the end than at first


def law(course: Callable, own: int = 0):
    """The hook: a fall of ln f by a course; other modes' by their own ratios.

    course: of records and its own so many parameters, with its derivatives by them.
    """

    def stick(records: Records, values: np.ndarray) -> StickEffect:
        along, by_own = course(records, values[1 : own + 1])
        ratios = np.append(1.0, values[own + 1 :])
        number = np.minimum(records.mode, ratios.size - 1)
        share = ratios[number]
        by_ratio = values[0] * along[:, None] * np.eye(ratios.size)[number, 1:]
        by_course = values[0] * share[:, None] * by_own
        slopes = np.column_stack([share * along, by_course, by_ratio])
        return StickEffect({"ln_f": -values[0] * share * along}, {"ln_f": -slopes})

    return stick


def _steady(records: Records, _: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return records.clamping - 0.5, np.empty((records.clamping.size, 0))


def _faster(records: Records, _: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    course = np.expm1(_FASTER * records.clamping) / np.expm1(_FASTER)
    return course - 0.5, np.empty((course.size, 0))


def _power(records: Records, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A power of time: of a rig that shakes it all day long."""
    t = share(records)
    course = t ** values[0]
    return course - 0.5, (course * np.log(np.maximum(t, 1e-12)))[:, None]


_RATIO = Parameter(
    "ratio", "1", 1.0, 0.5, 0.02, 50.0,
    "another mode's fall over the first's, as the square of their bending at the crack",
    log=True, ratio=True,
)  # fmt: skip
MECHANISM = Mechanism(
    id="crack",
    kind="time",
    sentence="a crack grows in {beam_and_rig}: frequencies fall with every clamping, none rises",
    parameters=(
        Parameter(
            "fall", "1", 0.0, 0.005, 0.0, 0.1,
            "of ln f of the first mode: a crack through a tenth of the depth takes some 0.3 %, its "
            "square's part",
        ),
        _RATIO,
    ),
    splitter="the {beam} alone, free-free, before and after; dye or ultrasound at its notches",
    stick=law(_steady),
    over=("clamping",),
    form="steady",
    starts=((2e-3, 0.0), (2e-3, -0.5), (2e-3, 0.5)),
).also("ever faster", stick=law(_faster)).also(
    "with time",
    Parameter("order", "1", 1.5, 0.5, 0.3, 6.0, "power of time", log=True),
    _RATIO,
    keep=1,
    stick=law(_power, 1),
    over=("time",),
    starts=((2e-3, 0.4, 0.0), (2e-3, 0.4, -0.5), (2e-3, 0.4, 0.5)),
)  # fmt: skip
