"""A crack that grows with every clamping and run: frequencies fall, each mode's by its own part."""

from collections.abc import Callable

import numpy as np

from bladeroot.mechanisms.mechanism import Mechanism, Parameter, Records, StickEffect

_LN_ACCELERATION = 3.0  # ln of the crack's growth at the end over that at first


def law(course: Callable[[np.ndarray], np.ndarray]):
    """The hook: a fall of ln f over the number of clampings; other modes' by their own ratios."""

    def stick(records: Records, values: np.ndarray) -> StickEffect:
        along = course(records.clamping) - 0.5
        ratios = np.append(1.0, values[1:])
        own = np.eye(ratios.size)[np.minimum(records.mode, ratios.size - 1)]
        slopes = values[0] * along[:, None] * own
        slopes[:, 0] = (own @ ratios) * along
        return StickEffect({"ln_f": -values[0] * slopes[:, 0]}, {"ln_f": -slopes})

    return stick


def _steady(u: np.ndarray) -> np.ndarray:
    return u


def _faster(u: np.ndarray) -> np.ndarray:
    return np.expm1(_LN_ACCELERATION * u) / np.expm1(_LN_ACCELERATION)


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
        Parameter(
            "ratio", "1", 1.0, 0.5, 0.02, 50.0,
            "another mode's fall over the first's, as the square of their bending at the crack",
            log=True, ratio=True,
        ),
    ),
    splitter="the {beam} alone, free-free, before and after; dye or ultrasound at its notches",
    stick=law(_steady),
    over=("clamping",),
    form="steady",
    starts=((2e-3, 0.0), (2e-3, -0.5), (2e-3, 0.5)),
).also("ever faster", stick=law(_faster))  # fmt: skip
