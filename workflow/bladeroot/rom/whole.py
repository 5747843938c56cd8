"""A structure file to its reduced matrices, through all stages in between."""

from collections.abc import Mapping
from pathlib import Path

import xarray as xr

from bladeroot.fem.mesh import build_mesh
from bladeroot.fem.prestress import prestress
from bladeroot.rom.bodies import (
    Assembly,
    box_of,
    joint_of_bodies,
    reduce_bodies,
    telling_of_floating,
)
from bladeroot.rom.external.assembly import assembly_of_matrices, read_assembly
from bladeroot.rom.external.bodies import load_bodies
from bladeroot.rom.external.description import read_description
from bladeroot.rom.external.mesh import external_mesh
from bladeroot.rom.external.reduction import reduce_matrices
from bladeroot.rom.file import ASSEMBLY, LAP_JOINT, is_matrices, kind_of, load_structure
from bladeroot.rom.joint import joint_of_reduced
from bladeroot.rom.lap_joint import lap_joint_assembly
from bladeroot.rom.parametric_build import TOLERANCE as DOVETAIL_TOLERANCE
from bladeroot.rom.parametric_build import parametric_model
from bladeroot.rom.reduction import reduce_structure
from bladeroot.schema import read_yaml

# Bound of a frequency's relative error in an assembly's parametric model: five hundred times below
# the usual error of a finite-element model. Its eigenproblems are half the size of those that the
# dovetail's bound, 1e-7, needs. The thesis's own search has it, too: its frequencies are printed to
# 0.1 Hz.
TOLERANCE = 1e-5
# Loads that an assembly serves whose stiffness no load changes, in any unit.
ANY_LOAD = (-1e9, 1e9)


def reduced_structure(path: str | Path) -> xr.Dataset:
    """Craig-Bampton reduction (4.3-4.12) of a built-in structure or of matrices made elsewhere.

    Takes some ten seconds. Raises ValueError for what is wrong in the file, a line a fault.
    """
    if kind_of(path) in (ASSEMBLY, LAP_JOINT):
        return reduce_bodies(assembly(path))
    if is_matrices(path):
        described = read_description(path)
        return reduce_matrices(described, external_mesh(described))
    structure = load_structure(path)
    nodes = build_mesh(structure)
    return reduce_structure(structure, nodes, prestress(structure, nodes))


def check_matrices(path: str | Path) -> None:
    """Read the matrices that a structure's file names, if any, as its first stage does.

    Raises ValueError with a line a fault. What only a factorisation or the modes show comes later.
    """
    kind = kind_of(path)
    if kind == ASSEMBLY:
        assembly(path)
    elif kind == "matrices":
        described = read_description(path)
        load_bodies(described, external_mesh(described))


def assembly(path: str | Path) -> Assembly:
    """Bodies and interfaces of a file of kind `assembly` or `lap-joint`."""
    if kind_of(path) == LAP_JOINT:
        return lap_joint_assembly(read_yaml(path, "assembly"), str(path))
    return assembly_of_matrices(read_assembly(path))


def parametric_structure(
    reduced: xr.Dataset, asked: Mapping, equal_nodes: bool = False
) -> xr.Dataset:
    """Frequencies over contact stiffness and load of what `reduced_structure` gives.

    asked: section `parametric` of the configuration; an assembly brings its own modes and ranges of
    stiffness. equal_nodes: the same spring at each node of a dovetail's flank, as in the thesis.
    """
    force = tuple(1e3 * end for end in asked["force_kN"])
    if reduced.attrs.get("kind") != "assembly":
        joint = joint_of_reduced(reduced, equal_nodes=equal_nodes)
        stiffness = tuple(1e9 * k for k in asked["stiffness_GN_per_m"])
        tolerance = TOLERANCE if equal_nodes else DOVETAIL_TOLERANCE
        return parametric_model(joint, asked["modes"], stiffness, force, tolerance)
    usual = force if reduced["geometric_stiffness"].values.any() else ANY_LOAD
    loads = reduced.attrs.get("load_range", usual)
    modes = reduced["mode"].values.astype(str).tolist()
    with telling_of_floating(reduced):
        model = parametric_model(
            joint_of_bodies(reduced), modes, box_of(reduced), tuple(map(float, loads)), TOLERANCE,
            sums=False,
        )  # fmt: skip
    return model.assign_attrs(kind="assembly")
