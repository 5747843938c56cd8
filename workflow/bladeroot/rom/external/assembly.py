"""Matrices of any bodies with any interfaces: a structure file of kind `assembly`, in and out."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse as sp
import yaml
from jaxtyping import Float, Int
from numpy import ndarray

from bladeroot.rom.bodies import Assembly, Body, Interface
from bladeroot.rom.external.bodies import model_matrices, of_each
from bladeroot.rom.external.description import (
    UNITS,
    Description,
    check_loads,
    matrix_files_of,
    missing,
)
from bladeroot.rom.external.equations import Equations
from bladeroot.rom.external.export import write_matrix, write_table
from bladeroot.rom.external.nodes import node_table
from bladeroot.rom.external.tables import Table, floats, read_table, whole_numbers
from bladeroot.schema import read_yaml

_SIDES = ("first", "second")
_AXES = ("x", "y", "z")
# kg/m3 of the box around a body's nodes: no solid is heavier, no model of a structure lighter.
# Another unit of length or mass changes it by a thousand at least.
DENSITY = (1e-3, 3e4)
# A body's mass over that with all its entries positive: 0.7 of quadratic bricks, 1e-16 of a free
# body's stiffness.
_LEAST_INERTIA = 1e-6


def read_assembly(path: str | Path) -> Description:
    """Read and check the file and that all files of matrices exist that it names.

    Raises ValueError with a line a fault.
    """
    path = Path(path)
    data = read_yaml(path, "assembly")
    description = Description(path, data, *UNITS[data["units"]])
    faults = []
    for name, body in data["bodies"].items():
        check_loads(body, f"{path}, bodies.{name}", unloaded=True)
        faults += missing(description, body)
    for name in data["display_nodes"]:
        if name not in data["bodies"]:
            faults.append(f"display_nodes: {name} is not among bodies ({path})")
    low, high = data.get("load_range", (0.0, 1.0))
    if not low < high:
        faults.append(f"load_range must be [least, largest], got [{low:g}, {high:g}] ({path})")
    if faults:
        raise ValueError("\n".join(faults))
    return description


def files_of(description: Description) -> list[Path]:
    """All files that it names."""
    data = description.data
    tables = [body[key] for body in data["bodies"].values() for key in ("nodes", "mapping", "fixed")
              if key in body]  # fmt: skip
    shapes = [one["shape"] for one in data["modes"].values() if "shape" in one]
    named = [
        description.folder / name for name in dict.fromkeys([*tables, data["contact"], *shapes])
    ]
    return [*named, *matrix_files_of(description)]


@dataclass(frozen=True)
class Tables:
    """What the tables say: by body its node table with equations and fixed ones, and positions."""

    nodes: dict[str, tuple[Table, Equations, ndarray]]
    positions: dict[str, Float[ndarray, "node 3"]]
    display: Int[ndarray, "point 2"]
    modes: dict[str, Mapping[str, Any]]
    interfaces: tuple[Interface, ...]


def assembly_tables(description: Description) -> Tables:
    """All tables that a description names, read and checked; the matrices come later.

    Raises ValueError, one line that names file and row, for what is wrong in them.
    """
    data = description.data
    nodes = {name: node_table(description, name) for name in data["bodies"]}
    positions = {
        name: description.length * np.column_stack([floats(table, axis) for axis in _AXES])
        for name, (table, _, _) in nodes.items()
    }
    places = {
        name: {int(node): k for k, node in enumerate(whole_numbers(table, "node"))}
        for name, (table, _, _) in nodes.items()
    }
    order = list(nodes)
    shown = [(name, node) for name, nodes in data["display_nodes"].items() for node in nodes]
    display = np.array(
        [(order.index(name), _node(places, name, n, description.path)) for name, n in shown]
    )
    modes = {
        name: {"shape": _shape(description, one["shape"], order, places, display)}
        if "shape" in one
        else one
        for name, one in data["modes"].items()
    }
    interfaces = _interfaces(description, order, places, list(positions.values()))
    return Tables(nodes, positions, display, modes, interfaces)


def assembly_of_matrices(description: Description) -> Assembly:
    """Bodies, interfaces and modes from the files that a description names.

    Raises ValueError, a line a fault that names file and row, for what is wrong in them.
    """
    data, read = description.data, assembly_tables(description)
    bodies = tuple(of_each(data["bodies"], lambda name: _body(description, name, read)))
    of_load = data.get("load_range")
    kept = data["reduction"]["modes"]
    return Assembly(data["name"], bodies, read.interfaces, read.display, read.modes, kept, of_load)


def interface_of(name: str, one: Mapping[str, Any], where: str, *pairs: ndarray) -> Interface:
    """An interface as its file, `where`, describes it. ValueError for a range that is none."""
    if "tied" in one:
        return Interface(name, *pairs, None, None)
    ends = []
    for kind in ("kn", "kt"):
        given = one[f"{kind}_N_per_m"]
        known = not isinstance(given, list)
        if not known and not given[0] < given[1]:
            told = "[{:g}, {:g}]".format(*given)
            raise ValueError(
                f"interfaces.{name}.{kind}_N_per_m must be [low, high], got {told} ({where})"
            )
        ends.append(float(given) if known else (float(given[0]), float(given[1])))
    return Interface(name, *pairs, *ends, float(one.get("preload_share", 1.0)))


def export_assembly(assembly: Assembly, data: Mapping[str, Any], folder: Path, name: str) -> None:
    """Write `<name>.yaml` and a folder `<name>` of Matrix Market files and tables, in m, N and kg.

    data: interfaces, modes, description and reduction, as in the file that it was made of.
    """
    inner = folder / name
    inner.mkdir(parents=True, exist_ok=True)
    listed = {}
    for body in assembly.bodies:
        files = {"nodes": f"{body.name}_nodes.csv"}
        header = ("node", *_AXES, *(f"dof_{axis}" for axis in _AXES))
        rows = zip(body.nodes.tolist(), (body.dof + 1).tolist(), strict=True)
        write_table(
            inner / files["nodes"], header,
            ((k, *map(repr, x), *(row or "" for row in dof)) for k, (x, dof) in enumerate(rows, 1)),
        )  # fmt: skip
        matrices = {"mass": body.mass, "stiffness": body.stiffness}
        if body.geometric is not None:
            matrices["geometric_stiffness"] = body.geometric
        for kind, matrix in matrices.items():
            files[kind] = f"{body.name}_{kind}.mtx"
            write_matrix(inner / files[kind], matrix, f"{name} {body.name} {kind}")
        listed[body.name] = {key: f"{name}/{file}" for key, file in files.items()}
    called = [body.name for body in assembly.bodies]
    rows = [
        (one.name, called[b[0]], n[0] + 1, called[b[1]], n[1] + 1, repr(area), *map(repr, normal))
        for one in assembly.interfaces
        for b, n, area, normal in zip(
            one.body.tolist(),
            one.node.tolist(),
            one.area.tolist(),
            one.normal.tolist(),
            strict=True,
        )
    ]
    header = ("interface", "first_body", "first_node", "second_body", "second_node", "area",
              "nx", "ny", "nz")  # fmt: skip
    write_table(inner / "contact.csv", header, rows)
    shown = {called[b]: (assembly.display[assembly.display[:, 0] == b, 1] + 1).tolist()
             for b in np.unique(assembly.display[:, 0])}  # fmt: skip
    description = {
        "name": name, "kind": "assembly", "description": f"{data['description']} (its matrices)",
        "units": "m-N-kg", "bodies": listed, "contact": f"{name}/contact.csv",
        "display_nodes": shown, "interfaces": dict(data["interfaces"]),
        "modes": dict(data["modes"]), "reduction": dict(data["reduction"]),
    }  # fmt: skip
    if assembly.load_range:
        description["load_range"] = list(assembly.load_range)
    text = yaml.safe_dump(description, sort_keys=False, allow_unicode=True)
    (folder / f"{name}.yaml").write_text(text, encoding="utf-8")


def _body(description: Description, name: str, read: Tables) -> Body:
    """A body without its held rows."""
    _, equations, fixed = read.nodes[name]
    mass, stiffness, geometric = model_matrices(description, name)
    if mass.shape[0] != len(equations.node):
        model = description.models[name]
        raise ValueError(
            f"expected {len(equations.node)} rows, as {model.get('mapping', model['nodes'])} says, "
            f"got {mass.shape[0]} ({description.folder / model['mass']})"
        )
    _check_density(description, name, mass, equations, read.positions[name])
    free = np.flatnonzero(~fixed)
    row = np.full(len(fixed), -1)
    row[free] = np.arange(len(free))
    dof = np.full((len(read.positions[name]), 3), -1)
    moves = equations.axis < 3
    dof[equations.node[moves], equations.axis[moves]] = row[moves]

    def kept(matrix: sp.csr_array | None) -> sp.csr_array | None:
        return None if matrix is None else sp.csr_array(matrix[free][:, free])

    return Body(name, kept(mass), kept(stiffness), kept(geometric), read.positions[name], dof)


def _check_density(
    description: Description, name: str, mass: sp.csr_array, equations: Equations, nodes: ndarray
) -> None:
    """A wrong unit shows in the density, where the nodes span a volume.

    So does a stiffness in the mass's place, unless its rows are all free: then it is as light as
    rounding has it.
    """
    along = (equations.axis == 0).astype(float)
    weight, volume = float(along @ (mass @ along)), float(np.prod(np.ptp(nodes, axis=0)))
    inert = weight > _LEAST_INERTIA * float(along @ (abs(mass) @ along))
    if volume > 0.0 and not (inert and DENSITY[0] <= weight / volume <= DENSITY[1]):
        raise ValueError(
            f"body {name} weighs {weight:.3g} kg in a box of {volume:.3g} m3, "
            f"{weight / volume:.2g} kg/m3: units are not {description.data['units']}, "
            f"rows not of these nodes, or mass and stiffness exchanged ({description.path})"
        )


def _node(places: Mapping[str, dict], body: str, node: int, where: object) -> int:
    if node not in places[body]:
        raise ValueError(f"node {node} is not among those of body {body} ({where})")
    return places[body][node]


def _nodes(
    table: Table, side: str, order: list[str], places: Mapping[str, dict]
) -> Int[ndarray, "row 2"]:
    """Number of the body and of its node, by row."""
    prefix = f"{side}_" if side else ""
    found = []
    for k, node in enumerate(whole_numbers(table, f"{prefix}node")):
        body = table.columns[f"{prefix}body"][k]
        if body not in order:
            known = ", ".join(order)
            raise ValueError(f"body must be one of {known}, got {body!r} ({table.where(k)})")
        found.append((order.index(body), _node(places, body, int(node), table.where(k))))
    return np.array(found)


def _interfaces(
    description: Description, order: list[str], places: Mapping[str, dict], nodes: list
) -> tuple[Interface, ...]:
    """From the table of contact pairs."""
    data = description.data
    columns = ("interface", *(f"{side}_{what}" for side in _SIDES for what in ("body", "node")),
               "area", "nx", "ny", "nz")  # fmt: skip
    table = read_table(description.folder / data["contact"], columns)
    names = np.array(table.columns["interface"])
    for k, name in enumerate(names):
        if name not in data["interfaces"]:
            known = ", ".join(data["interfaces"])
            raise ValueError(
                f"interface must be one of {known}, got {str(name)!r} ({table.where(k)})"
            )
    sides = np.stack([_nodes(table, side, order, places) for side in _SIDES], axis=1)
    pairs = [tuple(map(tuple, np.sort(pair, axis=0).tolist())) for pair in sides]
    for k, (one, other) in enumerate(pairs):
        if one == other:
            raise ValueError(f"a pair must have two nodes, got one twice ({table.where(k)})")
    if len(first := dict(zip(pairs[::-1], range(len(pairs))[::-1], strict=True))) < len(pairs):
        again = next(k for k, pair in enumerate(pairs) if first[pair] != k)
        raise ValueError(f"the same pair stands in the table twice ({table.where(again)})")
    area = floats(table, "area")
    normal = np.column_stack([floats(table, name) for name in ("nx", "ny", "nz")])
    wrong = np.flatnonzero(~((area > 0.0) & (np.linalg.norm(normal, axis=1) > 0.0)))
    if len(wrong):
        where = table.where(int(wrong[0]))
        raise ValueError(f"expected a positive area and a normal that does not vanish ({where})")
    position = np.array([[nodes[b][n] for b, n in pair] for pair in sides])
    gap = np.linalg.norm(position[:, 0] - position[:, 1], axis=1)
    tolerance = 1e-3 * data.get("contact_tolerance_mm", 1e-3)
    if not gap.max() <= tolerance:
        worst = int(np.argmax(gap))
        raise ValueError(
            f"expected contact nodes that coincide within {1e3 * tolerance:g} mm, got "
            f"{1e3 * gap[worst]:.4g} mm ({table.where(worst)})"
        )
    made = []
    for name, one in data["interfaces"].items():
        mine = names == name
        if not mine.any():
            raise ValueError(f"interface {name} has no contact pairs ({table.path})")
        pairs = (sides[mine, :, 0], sides[mine, :, 1], normal[mine], area[mine])
        made.append(interface_of(name, one, str(description.path), *pairs))
    return tuple(made)


def _shape(
    description: Description, file: str, order: list[str], places: Mapping[str, dict],
    display: Int[ndarray, "point 2"],
) -> Float[ndarray, "point 3"]:  # fmt: skip
    """A given or measured shape at the display points; NaN where the table has nothing."""
    table = read_table(description.folder / file, ("body", "node"), _AXES)
    axes = [axis for axis in _AXES if axis in table.columns]
    if not axes:
        raise ValueError(f"expected a column x, y or z ({table.path})")
    moved = {axis: floats(table, axis) for axis in axes}
    shape = np.full((len(display), 3), np.nan)
    for k, (body, node) in enumerate(_nodes(table, "", order, places)):
        at = np.flatnonzero((display == [body, node]).all(axis=1))
        if not len(at):
            raise ValueError(f"the node must be one of display_nodes ({table.where(k)})")
        for axis in axes:
            shape[at[0], _AXES.index(axis)] = moved[axis][k]
    if np.count_nonzero(np.nan_to_num(shape)) < 2:
        raise ValueError(f"expected a shape that moves at two places or more ({table.path})")
    return shape
