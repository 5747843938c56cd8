"""Simulated softening curves at all levels, and their slopes by stiffness, force and friction.

Under Coulomb friction of constant normal load a curve depends on amplitude over friction times
force alone, so that the slopes by these two are the slope along the curve.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.nonlinear.fast_loading import softening_curve, softening_curves
from bladeroot.nonlinear.system import Place, System
from bladeroot.nonlinear.uneven import Uneven, uneven_sliders
from bladeroot.rom.joint import Joint
from bladeroot.stiffness.softening import Softening

# Steps for slopes by differences. Each slip of a friction point is a kink in a curve; a step as
# short as one slip would give the kink's slope, not the curve's.
_SLOPE_STEP = 0.1  # of ln k and of the friction's parameters: across several points' slips
_PRESSURE_STEP = 0.02  # of one pair's ln pressure; few parts of one pair slip


@dataclass(frozen=True)
class Bench:
    """The systems in which a level's curves are simulated.

    number: of the level. force: N. systems: at its ln kn and ln kt, then with ln kn, and with ln
    kt, a step larger.
    """

    number: int
    force: float
    amplitude: Float[ndarray, " amplitude"]
    systems: tuple[System, ...]


def levels_at(
    joint: Joint,
    softening: Softening,
    levels: list[tuple[str, float]],
    lasers: Mapping[str, float],
    z: Float[ndarray, "level 3"],
) -> list[Bench]:
    """The systems of the levels (mode, force) that have points, at z = (ln kn, ln kt, ln F)."""
    numbers = np.unique(softening.level)
    steps = _SLOPE_STEP * np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    wanted = [(levels[number][0], z[number] + step) for number in numbers for step in steps]
    systems = level_systems(joint, wanted, lasers)
    made = []
    for k, number in enumerate(numbers):
        own = tuple(_simulated(one) for one in systems[len(steps) * k : len(steps) * (k + 1)])
        amplitude = softening.amplitude[softening.level == number]
        made.append(Bench(int(number), float(np.exp(z[number, 2])), amplitude, own))
    return made


def _simulated(system: System | str) -> System:
    if isinstance(system, str):
        raise RuntimeError(system)
    return system


def level_systems(
    joint: Joint,
    wanted: Sequence[tuple[str, Float[ndarray, "3"]]],
    lasers: Mapping[str, float],
) -> list[System | str]:
    """The system of each mode at its place z = (ln kn, ln kt, ln F), or why there is none.

    The modes of one place share its factors and its lowest modes.
    """
    found: dict[int, System | str] = {}
    orders: dict[bytes, list[int]] = {}
    for order, (_, z) in enumerate(wanted):
        orders.setdefault(z.tobytes(), []).append(order)
    for same in orders.values():
        z = wanted[same[0]][1]
        place = Place(joint, np.array([*z[:2], np.exp(z[2])]))
        for order in same:
            mode = wanted[order][0]
            try:
                found[order] = place.system(mode, lasers[mode])
            except ValueError as error:
                found[order] = str(error)
    return [found[order] for order in range(len(wanted))]


def along(
    joint: Joint, at: list[Bench], friction: Float[ndarray, " parameter"]
) -> tuple[Float[ndarray, " number"], Float[ndarray, " number"]]:
    """Falls of all points, then rises, and their slopes by ln amplitude."""
    parts = [_curve(joint, one, one.systems[0], friction) for one in at]
    value, slope = zip(*parts, strict=True)
    return _stacked(list(value)), _stacked(list(slope))


def by_friction(
    joint: Joint,
    at: list[Bench],
    friction: Float[ndarray, " parameter"],
    value: Float[ndarray, " number"],
    slope: Float[ndarray, " number"],
) -> Float[ndarray, "number parameter"]:
    """Slopes by the parameters in the order of `FRICTION`; value and slope: from `along`."""
    steps = friction + _SLOPE_STEP * np.eye(len(friction))[1:]
    parts = []
    for one in at:
        system = one.systems[0]
        moved = [uneven_sliders(joint, system, one.force, friction_of(step)) for step in steps]
        parts.append(softening_curves(system, moved, one.amplitude)[0])
    changed = [
        (_stacked(list(curves)) - value) / _SLOPE_STEP for curves in zip(*parts, strict=True)
    ]
    return np.stack([-slope, *changed], axis=1)


def by_level(
    joint: Joint,
    at: list[Bench],
    friction: Float[ndarray, " parameter"],
    value: Float[ndarray, " number"],
    slope: Float[ndarray, " number"],
) -> Float[ndarray, "number 3"]:
    """Slopes by (ln kn, ln kt, ln F) of each point's level; value and slope: from `along`."""
    changed = [
        _stacked([_curve(joint, one, one.systems[k], friction)[0] for one in at]) for k in (1, 2)
    ]
    return np.stack([*((one - value) / _SLOPE_STEP for one in changed), -slope], axis=1)


def by_unevenness(
    joint: Joint, at: list[Bench], friction: Float[ndarray, " parameter"]
) -> Float[ndarray, "number pair"]:
    """Change of all points, falls then rises, by one standard deviation of each pair's pressure.

    The flanks' mean pressure is kept. Mirror images of a contact vary independently, so that their
    mean, which the mode feels, varies less by the root of their number.
    """
    law = friction_of(friction)
    parts = []
    for one in at:
        system = one.systems[0]
        sliders = uneven_sliders(joint, system, one.force, law)
        up = 1.0 + np.expm1(_PRESSURE_STEP) * np.eye(system.pair.size)[:, :, None]
        pressed = [replace(sliders, preload=sliders.preload * higher) for higher in up]
        value, *changed = softening_curves(system, [sliders, *pressed], one.amplitude)[0]
        slope = np.stack([(curve - value) / _PRESSURE_STEP for curve in changed], axis=-1)
        share = system.count * sliders.preload.sum(axis=1)
        slope -= slope.sum(axis=2, keepdims=True) * share / share.sum()
        part = np.zeros((*slope.shape[:2], system.image.size))
        part[..., system.pair] = law.spread * slope / np.sqrt(system.count)
        parts.append(part)
    return _stacked(parts)


def friction_of(parameters: Float[ndarray, " parameter"]) -> Uneven:
    """The friction law of the logarithms of its parameters."""
    return Uneven(*np.exp(parameters))


def _curve(joint: Joint, one: Bench, system: System, friction: ndarray) -> tuple[ndarray, ndarray]:
    sliders = uneven_sliders(joint, system, one.force, friction_of(friction))
    return softening_curve(system, sliders, one.amplitude)


def _stacked(parts: list[ndarray]) -> ndarray:
    """Falls of all levels, then rises, from parts whose first axis is fall and rise."""
    return np.concatenate([part[kind] for kind in (0, 1) for part in parts])
