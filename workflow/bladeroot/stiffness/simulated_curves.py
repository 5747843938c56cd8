"""Simulated softening curves at all levels, and their slopes by stiffness, force and friction.

Under Coulomb friction of constant normal load a curve depends on amplitude over friction times
force alone, so that the slopes by these two are the slope along the curve.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.nonlinear.fast_loading import softening_curve
from bladeroot.nonlinear.system import System, system_of
from bladeroot.nonlinear.uneven import Uneven, uneven_sliders
from bladeroot.rom.joint import Joint
from bladeroot.stiffness.softening import Softening

# ln of each parameter of friction: mean, standard deviation and origin.
FRICTION = {
    "ln_friction": (np.log(0.3), 0.5, "dry steel on steel, 0.11 to 0.8 within two std"),
    "ln_keep": (np.log(0.01), 1.5, "next to nothing, as a punch leaves at its edges, to a fifth"),
    "ln_exponent": (np.log(0.5), 0.5, "elliptic pressure (6.4) and twice or half as steep"),
    "ln_spread": (np.log(0.3), 0.7, "waviness and roughness; even pressure to a factor of three"),
}
_STEP = 0.02  # of ln k and of the friction parameters, for slopes by differences


@dataclass(frozen=True)
class Bench:
    """The systems in which a level's curves are simulated.

    number: of the level. force: N. systems: at its ln kn, ln kt; with ln kn a step larger; ln kt.
    """

    number: int
    force: float
    amplitude: Float[ndarray, " amplitude"]
    systems: tuple[System, ...]


@dataclass(frozen=True)
class Simulated:
    """Falls, then rises, of all points, and their slopes.

    by_level: by (ln kn, ln kt, ln F) of each point's level. by_friction: by the parameters in the
    order of `FRICTION`.
    """

    value: Float[ndarray, " number"]
    by_level: Float[ndarray, "number 3"]
    by_friction: Float[ndarray, "number parameter"]


def levels_at(
    joint: Joint,
    softening: Softening,
    levels: list[tuple[str, float]],
    lasers: Mapping[str, float],
    z: Float[ndarray, "level 3"],
) -> list[Bench]:
    """The systems of the levels (mode, force) that have points, at z = (ln kn, ln kt, ln F)."""
    made = []
    for number in np.unique(softening.level):
        mode = levels[number][0]
        systems = tuple(
            level_system(joint, z[number] + step, mode, lasers[mode])
            for step in _STEP * np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
        )
        amplitude = softening.amplitude[softening.level == number]
        made.append(Bench(int(number), float(np.exp(z[number, 2])), amplitude, systems))
    return made


def level_system(joint: Joint, z: Float[ndarray, "3"], mode: str, laser_x: float) -> System:
    """The system of a mode at z = (ln kn, ln kt, ln F), the laser at a place along the beam (m).

    RuntimeError where there is none, as of curves that cannot be simulated.
    """
    try:
        return system_of(joint, np.array([*z[:2], np.exp(z[2])]), mode, laser_x)
    except ValueError as error:
        raise RuntimeError(str(error)) from None


def values(
    joint: Joint, at: list[Bench], friction: Float[ndarray, " parameter"]
) -> Float[ndarray, " number"]:
    """Falls of all points, then rises."""
    return _stacked([_curve(joint, one, one.systems[0], friction)[0] for one in at])


def simulate(joint: Joint, at: list[Bench], friction: Float[ndarray, " parameter"]) -> Simulated:
    """Curves with slopes; friction: parameters in the order of `FRICTION`."""
    parts: list[tuple] = []
    for one in at:
        value, along = _curve(joint, one, one.systems[0], friction)
        by_k = [_curve(joint, one, other, friction)[0] - value for other in one.systems[1:]]
        by_friction = [
            _curve(joint, one, one.systems[0], friction + step)[0] - value
            for step in _STEP * np.eye(len(friction))[1:]
        ]
        parts.append(
            (
                value,
                np.stack([*(k / _STEP for k in by_k), -along], axis=2),
                np.stack([-along, *(f / _STEP for f in by_friction)], axis=2),
            )
        )
    return Simulated(*(_stacked(list(part)) for part in zip(*parts, strict=True)))


def by_unevenness(
    joint: Joint, at: list[Bench], friction: Float[ndarray, " parameter"]
) -> Float[ndarray, "number pair"]:
    """Change of all points, falls then rises, where one pair's pressure is a standard deviation up.

    The flanks' mean pressure stays. Mirror images of a contact are uneven each by itself, so that
    their sum, which the mode feels, is so by the root of their number.
    """
    law = friction_of(friction)
    parts = []
    for one in at:
        system = one.systems[0]
        sliders = uneven_sliders(joint, system, one.force, law)
        value = softening_curve(system, sliders, one.amplitude)[0]
        slope = np.empty((*value.shape, system.pair.size))
        for contact in range(system.pair.size):
            preload = sliders.preload.copy()
            preload[contact] *= np.exp(_STEP)
            changed = softening_curve(system, replace(sliders, preload=preload), one.amplitude)[0]
            slope[..., contact] = (changed - value) / _STEP
        share = system.count * sliders.preload.sum(axis=1)
        slope -= slope.sum(axis=2, keepdims=True) * share / share.sum()
        part = np.zeros((*value.shape, system.image.size))
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
