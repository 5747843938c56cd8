"""A modulus that wanders through the campaign, as with the temperature of the rig."""

from dataclasses import replace

import numpy as np

from bladeroot.mechanisms.mechanism import Mechanism, Parameter, Records
from bladeroot.structure.ritz import Ritz
from bladeroot.structure.sensitivity import Change, scaled

_EDGE = 0.01  # of the campaign, over which a step is smeared, so that a fit finds its time


def structure(ritz: Ritz, values: np.ndarray) -> tuple[Change, list[Change]]:
    """Twice the change in the modulus of beam and slots; the axial force's stiffness stays."""
    parts = [scaled(ritz, part) for part in ("beam_stiffness", "slot_stiffness")]
    stiffness = 2.0 * (parts[0].stiffness + parts[1].stiffness)
    none = parts[0].mass
    nothing = [Change(np.zeros_like(stiffness), none)] * (values.size - 1)
    return Change(values[0] * stiffness, none), [Change(stiffness, none), *nothing]


def linear(records: Records, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """In proportion to time; none half-way through."""
    course = _share(records) - 0.5
    return course, np.zeros((course.size, 1))


def saturating(records: Records, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """An exponential approach, as a rig that warms up; from first to last record one."""
    t, tau = _share(records), values[1]
    near, whole = np.exp(-t / tau), -np.expm1(-1.0 / tau)
    by_near, by_whole = near * t / tau**2, -np.exp(-1.0 / tau) / tau**2
    course = (1.0 - near) / whole
    slope = -by_near / whole - course * by_whole / whole
    return course - 0.5, np.stack([np.zeros(t.size), slope], axis=1)


def step(records: Records, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """At once, at a part of the campaign's time."""
    course = 0.5 * np.tanh((_share(records) - values[1]) / _EDGE)
    slope = -(0.5 - 2.0 * course**2) / _EDGE
    return course, np.stack([np.zeros(course.size), slope], axis=1)


def periodic(records: Records, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A sine of half the change, so many cycles a campaign, as by day and night."""
    t = _share(records)
    angle = 2.0 * np.pi * values[1] * t + values[2]
    slope = 0.5 * np.cos(angle)
    return 0.5 * np.sin(angle), np.stack([np.zeros(t.size), 2.0 * np.pi * t * slope, slope], axis=1)


def _share(records: Records) -> np.ndarray:
    """Part of the campaign's time."""
    return records.time / records.span if records.span > 0.0 else 0.0 * records.time


_CHANGE = Parameter(
    "change", "1", 0.0, 0.005, -0.03, 0.03,
    "of frequencies: steel's modulus falls by 2.4e-4 a kelvin, 10 K make 0.12 %",
)  # fmt: skip
MECHANISM = Mechanism(
    id="drift",
    kind="time",
    sentence="the modulus drifts through the campaign, as with the temperature of the rig",
    parameters=(_CHANGE,),
    splitter="a thermometer on beam and rig; the first forces again at the end",
    structure=structure,
    course=linear,
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
                Parameter(
                    "time_constant", "1", 0.3, 0.7, 0.02, 3.0,
                    "of the campaign: hours, as a rig of some 100 kg", log=True,
                ),
            ),
            course=saturating,
            starts=((1e-3, float(np.log(0.1))),),
            form="saturating",
        ),
        replace(
            MECHANISM,
            parameters=(
                _CHANGE,
                Parameter(
                    "moment", "1", 0.5, 1.5, 0.0, 1.0, "of the campaign's time", bounded=True
                ),
            ),
            course=step,
            starts=tuple((1e-3, x) for x in (-2.2, -1.4, -0.85, -0.4, 0.4, 0.85, 1.4, 2.2)),
            form="step",
        ),
        replace(
            MECHANISM,
            parameters=(
                _CHANGE,
                Parameter("cycles", "1", 1.5, 0.7, 0.3, 20.0, "a campaign of days", log=True),
                Parameter("phase", "1", 0.0, 2.0, -20.0, 20.0, "at the first record, rad"),
            ),
            course=periodic,
            starts=tuple(
                (1e-3, float(np.log(n)), phase)
                for n in (0.7, 1.0, 1.5, 2.0, 3.0, 4.5)
                for phase in (0.0, 1.57)
            ),
            form="periodic",
        ),
    ),
)  # fmt: skip
