"""Nodes of each body of a model made elsewhere, and the rows of its matrices that are theirs."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray

from bladeroot.rom.external.description import BODIES, Description
from bladeroot.rom.external.equations import Equations, equations_of
from bladeroot.rom.external.tables import Table, floats, read_table, whole_numbers

_AXES = ("X", "Y", "Z")


@dataclass(frozen=True)
class BodyNodes:
    """Nodes of one body (numbers in its table, m), and the rows of its matrices: their nodes, axes.

    Axes are 0 to 2 for displacements along X, Y, Z and 3 to 5 for rotations.
    """

    ids: Int[ndarray, " node"]
    position: Float[ndarray, "node 3"]
    row: Int[ndarray, " equation"]
    node: Int[ndarray, " equation"]
    axis: Int[ndarray, " equation"]
    fixed: ndarray

    def moves_freely(self, node: int) -> bool:
        """Whether a node has displacements along X, Y and Z that are not fixed."""
        return {0, 1, 2} <= set(self.axis[(self.node == node) & ~self.fixed].tolist())

    def places(self) -> dict[int, int]:
        """Place of each node by its number."""
        return {int(node): k for k, node in enumerate(self.ids)}


def body_nodes(description: Description) -> list[BodyNodes]:
    """Beam, slot Xn and slot Xp. ValueError, one line with file and row, for a wrong table."""
    models = {name: node_table(description, name) for name in description.models}
    return [_body(description, models, name) for name in BODIES]


def node_table(description: Description, name: str) -> tuple[Table, Equations, ndarray]:
    """Node table, equations and which equations are fixed, of one set of matrices."""
    model: dict[str, Any] = description.models[name]
    columns = ("node", "x", "y", "z", *(("body",) if name == "whole" else ()))
    optional = ("dof_x", "dof_y", "dof_z", "dof_rx", "dof_ry", "dof_rz")
    nodes = read_table(description.folder / model["nodes"], columns, optional)
    mapping = description.folder / model["mapping"] if "mapping" in model else None
    equations = equations_of(nodes, mapping)
    fixed = np.zeros(len(equations.node), dtype=bool)
    if "fixed" in model:
        fixed = _fixed(description.folder / model["fixed"], nodes, equations)
    return nodes, equations, fixed


def _fixed(path: Path, nodes: Table, equations: Equations) -> ndarray:
    """Equations of the fixed nodes: those of the axis in the row, or all."""
    table = read_table(path, ("node",), ("axis",))
    place = {int(node): k for k, node in enumerate(whole_numbers(nodes, "node"))}
    fixed = np.zeros(len(equations.node), dtype=bool)
    axes = table.columns.get("axis", [""] * len(table.lines))
    for k, node in enumerate(whole_numbers(table, "node")):
        if int(node) not in place:
            raise ValueError(f"node {node} is not in {nodes.path} ({table.where(k)})")
        if axes[k] not in ("", *_AXES):
            raise ValueError(f"axis must be X, Y, Z or empty, got {axes[k]!r} ({table.where(k)})")
        mine = equations.node == place[int(node)]
        fixed |= mine & (equations.axis == _AXES.index(axes[k])) if axes[k] else mine
    return fixed


def _body(description: Description, models: dict, name: str) -> BodyNodes:
    source, mirrored = description.model_of(name)
    nodes, equations, fixed = models[source]
    mine = np.ones(len(nodes.lines), dtype=bool)
    if source == "whole":
        bodies = np.array(nodes.columns["body"])
        unknown = np.flatnonzero(~np.isin(bodies, BODIES))
        if len(unknown):
            raise ValueError(
                f"body must be one of {', '.join(BODIES)}, got {str(bodies[unknown[0]])!r} "
                f"({nodes.where(int(unknown[0]))})"
            )
        mine = bodies == name
        if not mine.any():
            raise ValueError(f"expected nodes of body {name}, got none ({nodes.path})")
    position = description.length * np.column_stack([floats(nodes, axis) for axis in "xyz"])
    if mirrored:
        position = position * [-1.0, 1.0, 1.0]
    row = np.flatnonzero(mine[equations.node])
    place = np.cumsum(mine) - 1
    return BodyNodes(
        whole_numbers(nodes, "node")[mine],
        position[mine],
        row,
        place[equations.node[row]],
        equations.axis[row],
        fixed[row],
    )
