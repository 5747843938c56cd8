"""Nonlinear forces of the specimen on its stuck modes, without slip: the same in time and cycle.

Stretching pulls against bending, drag brakes the beam's middle line, flanks that lift off stop
pushing, and tangential springs soften. Each is absent where its size is zero.
"""

from typing import NamedTuple, no_type_check

import numpy as np
from numpy import ndarray

from bladeroot.bench.conditions import Conditions
from bladeroot.bench.modes import StuckModes
from bladeroot.compiled import njit


class ModalForces(NamedTuple):
    """What the nonlinear forces need: `active` says whether there are any."""

    active: bool
    stretching: float
    geometric: ndarray  # (mode, mode)
    drag: ndarray  # (point), each point's part of the braking coefficient
    line: ndarray  # (point, mode)
    closed: ndarray  # (pair), static force (N) that keeps a pair closed; empty if all stay so
    normal_kn: ndarray  # (pair)
    normal: ndarray  # (pair, mode)
    cubic: ndarray  # (slider), N/m^3; empty if linear
    tangential: ndarray  # (slider, mode)


def modal_forces(
    conditions: Conditions,
    modes: StuckModes,
    pressing: ndarray,
    laser_x: float,
    lowest: str = "1B",
) -> ModalForces:
    """Forces on the kept modes; sizes are those of `lowest` seen at `laser_x` (m), others follow.

    `pressing` is each pair's static normal force (N) at the nominal pressure.
    """
    first = modes.names.index(lowest)
    omega = modes.omega[first]
    seen = abs(np.interp(laser_x, modes.line_x, modes.line_shape[:, first]))
    stretching = 2 * conditions.hardening * (seen * omega) ** 2 / modes.geometric[first, first] ** 2
    width = np.gradient(modes.line_x)
    shape = modes.line_shape[:, first]
    # A cycle of c |v| v takes 8/3 c omega^2 q^3; a loss factor of one would take pi omega^2 q^2.
    braking = 3 * np.pi / 8 * conditions.drag * seen / np.sum(width * np.abs(shape) ** 3)
    opens = np.isfinite(conditions.preload)
    absent = no_forces(modes.omega.size)
    cubic = conditions.tangential_cubic
    solid = np.ascontiguousarray
    return ModalForces(
        active=bool(conditions.hardening or conditions.drag or opens or cubic),
        stretching=float(stretching),
        geometric=solid(modes.geometric),
        drag=braking * width if conditions.drag else absent.drag,
        line=solid(modes.line_shape),
        closed=conditions.preload * pressing if opens else absent.closed,
        normal_kn=solid(modes.normal_kn),
        normal=solid(modes.normal_shape),
        cubic=cubic * modes.slider_kt if cubic else absent.cubic,
        tangential=solid(modes.slider_shape),
    )


def no_forces(modes: int) -> ModalForces:
    """No nonlinear force on so many modes."""
    none, shape = np.zeros(0), np.zeros((0, modes))
    square = np.zeros((modes, modes))
    return ModalForces(False, 0.0, square, none, shape, none, none, shape, none, shape)


@njit(cache=True)
@no_type_check
def nonlinear_force(forces, r, v, out):
    """Write the nonlinear force on each mode at displacements r and speeds v into `out`."""
    modes = r.size
    out[:] = 0.0
    if forces.stretching != 0.0:
        pull = np.zeros(modes)
        stretch = 0.0
        for m in range(modes):
            for n in range(modes):
                pull[m] += forces.geometric[m, n] * r[n]
            stretch += r[m] * pull[m]
        for m in range(modes):
            out[m] -= 0.5 * forces.stretching * stretch * pull[m]
    for x in range(forces.drag.size):
        speed = 0.0
        for m in range(modes):
            speed += forces.line[x, m] * v[m]
        brake = forces.drag[x] * abs(speed) * speed
        for m in range(modes):
            out[m] -= forces.line[x, m] * brake
    for i in range(forces.closed.size):
        opening = 0.0
        for m in range(modes):
            opening += forces.normal[i, m] * r[m]
        # A closed pair's spring pushes back; past the static force the flanks part.
        missing = forces.normal_kn[i] * opening - forces.closed[i]
        if missing > 0.0:
            for m in range(modes):
                out[m] += forces.normal[i, m] * missing
    for j in range(forces.cubic.size):
        u = 0.0
        for m in range(modes):
            u += forces.tangential[j, m] * r[m]
        for m in range(modes):
            out[m] += forces.tangential[j, m] * forces.cubic[j] * u * u * u
