"""Frequencies that wander with time through the campaign, for a reason that nobody measured."""

from collections.abc import Callable

import numpy as np

from bladeroot.mechanisms.mechanism import Mechanism, Parameter, Records, StickEffect

# Where a fit of a step begins: change, and coordinate of the moment, every twentieth of the
# clampings; a step shows no slope to records that are away from it.
STEP_STARTS = tuple((1e-3, float(np.log(k / (20 - k)))) for k in range(1, 20))
HALF_WAVES = (1, 2, 3, 4)  # in a campaign, of any slow course
_STEP_WIDTH = 0.015  # of the clampings, over which a step is smeared, so that a fit finds its place


def columns(course: Callable, records: Records, values: np.ndarray) -> tuple[np.ndarray, ...]:
    """The first parameter times a course, and derivatives by all parameters of the law."""
    along, slopes = course(records, values)
    by_values = values[0] * slopes
    by_values[:, 0] = along
    return values[0] * along, by_values


def law(course: Callable):
    """The hook: frequencies by the modulus, all alike but for a part of what the load holds.

    With all stiffness but the load's larger by 1 + 2c, omega^2 is 1 + 2c times that at the load
    over 1 + 2c.
    """

    def stick(records: Records, values: np.ndarray) -> StickEffect:
        change, slopes = columns(course, records, np.delete(values, 1))
        slopes, load = np.insert(slopes, 1, 0.0, axis=1), -2.0 * records.force
        by_load = values[1] * slopes
        by_load[:, 1] = change
        return StickEffect(
            {"ln_f": change, "force": load * values[1] * change},
            {"ln_f": slopes, "force": load[:, None] * by_load},
        )

    return stick


def linear(records: Records, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """In proportion to time; none half-way through."""
    course = share(records) - 0.5
    return course, np.zeros((course.size, 1))


def saturating(records: Records, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """An exponential approach, as a rig that warms up; from first to last record one."""
    t, tau = share(records), values[1]
    near, whole = np.exp(-t / tau), -np.expm1(-1.0 / tau)
    by_near, by_whole = near * t / tau**2, -np.exp(-1.0 / tau) / tau**2
    course = (1.0 - near) / whole
    slope = -by_near / whole - course * by_whole / whole
    return course - 0.5, np.stack([np.zeros(t.size), slope], axis=1)


def step(records: Records, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """At once, after a part of the campaign's clampings: a pause has none."""
    course = 0.5 * np.tanh((records.clamping - values[1]) / _STEP_WIDTH)
    slope = -(0.5 - 2.0 * course**2) / _STEP_WIDTH
    return course, np.stack([np.zeros(course.size), slope], axis=1)


def periodic(records: Records, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A sine of half the change, so many cycles a campaign, as by day and night."""
    t = share(records)
    angle = 2.0 * np.pi * values[1] * t + values[2]
    slope = 0.5 * np.cos(angle)
    return 0.5 * np.sin(angle), np.stack([np.zeros(t.size), 2.0 * np.pi * t * slope, slope], axis=1)


def wandering(records: Records, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Any slow course, as the weather's: a line and waves of one half to two a campaign."""
    t = share(records)
    basis = np.column_stack([t - 0.5, *(np.cos(np.pi * k * t) for k in HALF_WAVES)])
    return basis @ values[1:], np.column_stack([np.zeros(t.size), basis])


def share(records: Records) -> np.ndarray:
    """Part of the campaign's time."""
    return records.time / records.span if records.span > 0.0 else 0.0 * records.time


HELD = Parameter(
    "held", "1", 0.7, 0.7, -1.0, 3.0,
    "of what the load holds: 1 of a modulus alone, 0 of a clock, any with what strains the load",
)  # fmt: skip
TIME_CONSTANT = Parameter(
    "time_constant", "1", 0.3, 0.7, 0.02, 3.0,
    "of the campaign: hours, as a rig of some 100 kg", log=True,
)  # fmt: skip
MOMENT = Parameter(
    "moment", "1", 0.5, 1.5, 0.0, 1.0, "of the campaign's clampings", bounded=True
)  # fmt: skip
MECHANISM = Mechanism(
    id="drift",
    kind="time",
    sentence="the frequencies drift through the campaign, as with the temperature of the {rig}",
    parameters=(
        Parameter(
            "change", "1", 0.0, 0.005, -0.03, 0.03,
            "of frequencies: steel's modulus falls by 2.4e-4 a kelvin, 10 K make 0.12 %",
        ),
        HELD,
    ),
    splitter="a thermometer on {beam_and_rig}; the first {forces} again at the end",
    stick=law(linear),
    over=("time",),
    moves_load=False,
    form="linear",
).also(
    "saturating", TIME_CONSTANT, stick=law(saturating), starts=((1e-3, 1.0, float(np.log(0.1))),),
).also(
    "step", MOMENT, stick=law(step), over=("clamping",),
    starts=tuple((change, 1.0, at) for change, at in STEP_STARTS),
).also(
    "wandering",
    Parameter("change", "1", 2e-3, 1.0, 1e-7, 0.03, "of frequencies, as a size", log=True),
    HELD,
    *(
        Parameter(
            f"part_{k}", "1", 0.0, 1.0 if k == 0 else 0.7 / k, -10.0, 10.0,
            "of a line, then of waves: slow ones are the larger",
        )
        for k in (0, *HALF_WAVES)
    ),
    keep=0,
    stick=law(wandering),
    starts=((float(np.log(2e-3)), 1.0, 0.5, 0.2, 0.0, 0.0, 0.0),
            (float(np.log(2e-3)), 1.0, -0.5, -0.2, 0.0, 0.0, 0.0)),
).also(
    "periodic",
    Parameter("cycles", "1", 1.5, 0.7, 0.3, 20.0, "a campaign of days", log=True),
    Parameter("phase", "1", 0.0, 2.0, -20.0, 20.0, "at the first record, rad"),
    stick=law(periodic),
    starts=tuple(
        (1e-3, 1.0, float(np.log(n)), phase)
        for n in (0.7, 1.0, 1.5, 2.0, 3.0, 4.5)
        for phase in (0.0, 1.57)
    ),
)  # fmt: skip
