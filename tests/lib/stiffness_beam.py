"""A small joined beam in the form of an assembly, for the tests of the stiffness room.

A slender beam (bar along X, bending in Y and Z) has two contact nodes a flank, held to its end
sections by stiff links at a height that couples rotation into the flanks; each faces a slot node
on springs to the ground. Its bending resembles the real one: 1B even, 2B odd, moving in Z.
"""

from functools import cache

import numpy as np
import xarray as xr
from bladeroot.rom.joint import joint_of
from bladeroot.rom.parametric_build import parametric_model
from bladeroot.stiffness.map import frequency_map

LENGTH, NODES = 0.30, 11
MODULUS, DENSITY, WIDTH, DEPTH = 2.0e11, 7800.0, 26e-3, 10e-3
REACH = 20e-3  # height of the contact nodes over the axis; separates kn from kt
LINK, GROUND = 5e11, 8e10


def _element(bending, line_mass, length):
    """Euler-Bernoulli stiffness and mass of an element by (w, w', w, w')."""
    a = length
    stiffness = (
        bending
        / a**3
        * np.array(
            [
                [12, 6 * a, -12, 6 * a],
                [6 * a, 4 * a**2, -6 * a, 2 * a**2],
                [-12, -6 * a, 12, -6 * a],
                [6 * a, 2 * a**2, -6 * a, 4 * a**2],
            ]
        )
    )
    mass = (
        line_mass
        * a
        / 420
        * np.array(
            [
                [156, 22 * a, 54, -13 * a],
                [22 * a, 4 * a**2, 13 * a, -3 * a**2],
                [54, 13 * a, 156, -22 * a],
                [-13 * a, -3 * a**2, -22 * a, 4 * a**2],
            ]
        )
    )
    return stiffness, mass


def beam_assembly(axial_force=12e3):
    """An assembly Dataset of 103 dofs with eight pairs, two a flank of unequal weight."""
    pairs = 8
    beam = 5 * NODES  # u, v, w, v', w' a node
    size = beam + 6 * pairs
    mass, stiffness = np.zeros((size, size)), np.zeros((size, size))
    step = LENGTH / (NODES - 1)
    line_mass = DENSITY * WIDTH * DEPTH
    inertia = {1: DEPTH * WIDTH**3 / 12, 2: WIDTH * DEPTH**3 / 12}
    for e in range(NODES - 1):
        n = 5 * np.array([e, e + 1])
        pull = MODULUS * WIDTH * DEPTH / step * np.array([[1, -1], [-1, 1]])
        stiffness[np.ix_(n, n)] += pull
        mass[np.ix_(n, n)] += line_mass * step / 6 * np.array([[2, 1], [1, 2]])
        for axis in (1, 2):
            k, m = _element(MODULUS * inertia[axis], line_mass, step)
            dofs = np.array([n[0] + axis, n[0] + axis + 2, n[1] + axis, n[1] + axis + 2])
            stiffness[np.ix_(dofs, dofs)] += k
            mass[np.ix_(dofs, dofs)] += m
            ends = dofs[[0, 2]]
            stiffness[np.ix_(ends, ends)] += axial_force / step * np.array([[1, -1], [-1, 1]])
    flank = np.repeat(np.arange(4), 2)
    weight = np.tile([0.3, 0.7], 4)
    beam_dof = beam + 3 * np.arange(pairs)[:, None] + np.arange(3)
    slot_dof = beam_dof + 3 * pairs
    frame = np.zeros((pairs, 3, 3))
    for p in range(pairs):
        side, top = (-1, 1)[flank[p] // 2], (-1, 1)[flank[p] % 2]
        frame[p] = np.array([[side, 0, top], [0, np.sqrt(2), 0], [side, 0, -top]]) / np.sqrt(2)
        end = 5 * (0 if side < 0 else NODES - 1)
        follow = np.zeros((3, size))  # contact node less the end section it is linked to
        follow[np.arange(3), beam_dof[p]] = 1.0
        follow[np.arange(3), end + np.arange(3)] -= 1.0
        follow[0, end + 4] += top * REACH
        stiffness += weight[p] * LINK * follow.T @ follow
        for dofs, ground in ((beam_dof[p], 0.0), (slot_dof[p], weight[p] * GROUND)):
            mass[dofs, dofs] += 2e-3
            stiffness[dofs, dofs] += ground
    position = np.zeros((NODES, 3))
    position[:, 0] = np.linspace(-0.5, 0.5, NODES) * LENGTH
    shape = np.zeros((NODES, 3, size))
    for axis in range(3):
        shape[np.arange(NODES), axis, 5 * np.arange(NODES) + axis] = 1.0
    return xr.Dataset(
        {
            "mass": (("dof", "dof_"), mass),
            "stiffness": (("dof", "dof_"), stiffness),
            "beam_dof": (("pair", "axis"), beam_dof),
            "slot_dof": (("pair", "axis"), slot_dof),
            "frame": (("pair", "local", "axis"), frame),
            "weight": ("pair", weight),
            "flank": ("pair", flank),
            "display_position": (("display", "axis"), position),
            "display_shape": (("display", "axis", "dof"), shape),
        },
        attrs={"axial_force": float(axial_force), "structure": "beam"},
    )


def beam_joint(equal_nodes=False):
    """The beam at any force."""
    free, pulled = beam_assembly(0.0), beam_assembly(1e6)
    own = int(free["slot_dof"].min())
    rise = (pulled["stiffness"] - free["stiffness"]).values[:own, :own]
    return joint_of(free, rise / 1e6, equal_nodes)


def beam_map(axial_force=12e3, equal_nodes=False, modes=("1B", "2B")):
    """The map of the beam at one force."""
    return frequency_map(_model(equal_nodes, modes), beam_assembly(axial_force))


@cache
def _model(equal_nodes, modes=("1B", "2B")):
    return parametric_model(beam_joint(equal_nodes), modes)
