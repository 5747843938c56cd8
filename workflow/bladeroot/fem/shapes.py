"""The first mode shapes of the free beam, by name, for the eye."""

import numpy as np
import xarray as xr

from bladeroot.fem import elasticity
from bladeroot.fem.geometry import Structure
from bladeroot.fem.mesh import body_mesh
from bladeroot.fem.modes import name_modes
from bladeroot.fem.prestress import materials_of
from bladeroot.fem.symmetry import reflections, symmetric_eigenpairs

_MODES = 12  # the free beam's six rigid motions among them
# Below every eigenvalue of the free beam.
_SHIFT = -((2 * np.pi * 1000.0) ** 2)


def beam_shapes(structure: Structure, mesh: xr.Dataset) -> xr.Dataset:
    """Elastic modes 7 to 12 of the free beam without a load: `shapes.nc`.

    Shapes have the largest displacement 1. A mode without clear parity is called "?", as it is.
    """
    beam, _ = body_mesh(mesh, 0)
    materials = materials_of(structure, mesh, 0)
    rule = elasticity.quadrature(beam)
    mass = elasticity.mass(beam, rule, materials)
    matrices = elasticity.stiffness(beam, rule, materials), elasticity.per_axis(mass)
    mirrors = reflections(beam.nodes, *matrices)
    values, shapes = symmetric_eigenpairs(*matrices, _MODES, _SHIFT, mirrors)
    names = name_modes(beam.nodes, mass.sum(axis=1), values, shapes)
    moves = shapes.T.reshape(_MODES, -1, 3)[6:]
    moves = moves / np.linalg.norm(moves, axis=2).max(axis=1)[:, None, None]
    return xr.Dataset(
        {
            "frequency": (
                "mode",
                np.sqrt(values[6:]) / (2 * np.pi),
                {"units": "Hz", "long_name": "natural frequency of the free beam"},
            ),
            "shape": (
                ("mode", "beam_node", "axis"),
                moves,
                {"units": "1", "long_name": "displacement, largest one 1"},
            ),
        },
        coords={"mode": names[6:], "axis": list("XYZ")},
        attrs={"structure": structure.name, "with_pad": mesh.attrs["with_pad"]},
    )
