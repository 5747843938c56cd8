"""CalculiX: an input deck of a loaded body, a run of it, and what it says of the modes."""

import subprocess
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from bladeroot.fem.geometry import Material


@dataclass(frozen=True)
class Body:
    """What CalculiX is told: SI units, nodes from 0 in its own order within an element.

    kind: its name of the element; loads: (node, 3) per newton; held: dofs fixed in the static step;
    fixed: dofs fixed always, of a body without a load.
    """

    kind: str
    nodes: np.ndarray
    elements: np.ndarray
    materials: list[Material]
    loads: np.ndarray
    held: np.ndarray
    fixed: np.ndarray = field(default_factory=lambda: np.empty(0, dtype=int))


def deck(body: Body, force: float, modes: int) -> str:
    """The static step at the supports (if there is a force), then frequencies without them."""
    lines = ["*NODE, NSET=ALL"]
    lines += [f"{k}, {x:.12e}, {y:.12e}, {z:.12e}" for k, (x, y, z) in enumerate(body.nodes, 1)]
    for m, material in enumerate(dict.fromkeys(body.materials)):
        lines.append(f"*ELEMENT, TYPE={body.kind}, ELSET=E{m}")
        for e, nodes in enumerate(body.elements):
            if body.materials[e] == material:
                row = [str(e + 1), *(str(node + 1) for node in nodes)]
                lines += [", ".join(row[:11]) + ("," if row[11:] else ""), ", ".join(row[11:])]
        lines += [f"*MATERIAL, NAME=M{m}", "*ELASTIC", f"{material.young}, {material.poisson}"]
        lines += ["*DENSITY", f"{material.density}", f"*SOLID SECTION, ELSET=E{m}, MATERIAL=M{m}"]
    if len(body.fixed):
        lines += ["*BOUNDARY", *_fixed(body.fixed)]
    if force:
        lines += ["*STEP", "*STATIC", "*BOUNDARY", *_fixed(body.held)]
        lines.append("*CLOAD")
        for node, axis in np.argwhere(body.loads):
            lines.append(f"{node + 1}, {axis + 1}, {force * body.loads[node, axis]:.12e}")
        lines += ["*END STEP", "*STEP, PERTURBATION", "*FREQUENCY", f"{modes}", "*BOUNDARY, OP=NEW"]
    else:
        lines += ["*STEP", "*FREQUENCY", f"{modes}"]
    lines += ["*NODE PRINT, NSET=ALL", "U", "*END STEP"]
    return "\n".join(line for line in lines if line) + "\n"


def _fixed(dofs: np.ndarray) -> list[str]:
    return [f"{dof // 3 + 1}, {dof % 3 + 1}, {dof % 3 + 1}" for dof in dofs]


def run(folder: Path, text: str) -> str:
    """Run a deck in a folder, as `beam`; what CalculiX said."""
    (folder / "beam.inp").write_text(text)
    done = subprocess.run(["ccx", "beam"], cwd=folder, capture_output=True, text=True)
    return done.stdout


def modes(body: Body, force: float, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Lowest eigenvalues (rad^2/s^2), ascending, and shapes (3 node, mode)."""
    with tempfile.TemporaryDirectory() as name:
        said = run(Path(name), deck(body, force, count))
        written = Path(name) / "beam.dat"
        lines = written.read_text().splitlines() if written.exists() else []
    heads = [k for k, line in enumerate(lines) if "E I G E N V A L U E   O U T P U T" in line]
    if not heads:
        raise RuntimeError(f"CalculiX gave no eigenvalues; it said: {said[-400:]}")
    rows = [line.split() for line in lines[heads[0] :]]
    values = np.array([float(row[1]) for row in rows if len(row) == 5 and row[0].isdigit()][:count])
    blocks = [k for k, line in enumerate(lines) if "displacements (vx,vy,vz) for set ALL" in line]
    shapes = [
        [line.split()[1:] for line in lines[k + 2 : k + 2 + len(body.nodes)]]
        for k in blocks[-len(values) :]
    ]
    moves = np.array(shapes, dtype=float).reshape(len(values), -1).T
    order = np.argsort(values)
    return values[order], moves[:, order]
