"""Matrices that CalculiX itself writes go through, and keep its frequencies (needs `ccx`)."""

import shutil
import subprocess
from typing import NamedTuple

import numpy as np
import pytest
import scipy.linalg
import yaml
from bladeroot.fem.mesh import FLANKS, Mesh, base_nodes, body_mesh, build_mesh
from bladeroot.fem.prestress import materials_of, supports
from bladeroot.rom.external.checks import external_checks
from bladeroot.rom.external.description import BODIES, read_description
from bladeroot.rom.external.mesh import external_mesh
from bladeroot.rom.external.reduction import reduce_matrices
from bladeroot.rom.paraview import VTK_NODES
from structure_coarse import coarse_structure

pytestmark = pytest.mark.skipif(shutil.which("ccx") is None, reason="needs CalculiX (ccx)")

FORCE = 12e3
STORE = "*FREQUENCY, SOLVER=MATRIXSTORAGE"


class Bricks(NamedTuple):
    nodes: np.ndarray
    elements: np.ndarray
    part: np.ndarray


@pytest.fixture(scope="module")
def bricks():
    """Each body of the coarse dovetail in 20-node bricks: mesh, materials, kept nodes, contact."""
    structure = coarse_structure()
    mesh = build_mesh(structure)
    found = []
    for which in range(3):
        body, first = body_mesh(mesh, which)
        elements = body.elements[:, VTK_NODES[:20] @ [9, 3, 1]]
        kept, numbered = np.unique(elements, return_inverse=True)
        made = Bricks(body.nodes[kept], numbered.reshape(-1, 20), body.part)
        side = mesh.pair_node.values[:, min(which, 1)] - first
        found.append((made, materials_of(structure, mesh, which), kept, side))
    return mesh, found


def as_mesh(made):
    """The nodes alone: what supports and base are found by."""
    return Mesh(made.nodes, np.zeros((1, 27), dtype=np.int64), np.zeros(1, dtype=np.int64))


def geometry(made, materials):
    lines = ["*NODE, NSET=ALL"]
    lines += [f"{k}, {x:.12e}, {y:.12e}, {z:.12e}" for k, (x, y, z) in enumerate(made.nodes, 1)]
    for part, material in enumerate(materials):
        lines.append(f"*ELEMENT, TYPE=C3D20, ELSET=E{part}")
        for e in np.flatnonzero(made.part == part):
            row = [str(e + 1), *(str(node + 1) for node in made.elements[e])]
            lines += [", ".join(row[:11]) + ",", ", ".join(row[11:])]
        lines += [f"*MATERIAL, NAME=M{part}", "*ELASTIC", f"{material.young}, {material.poisson}"]
        lines += ["*DENSITY", f"{material.density}"]
        lines.append(f"*SOLID SECTION, ELSET=E{part}, MATERIAL=M{part}")
    return lines


def run(folder, name, lines):
    (folder / f"{name}.inp").write_text("\n".join(lines) + "\n")
    subprocess.run(["ccx", name], cwd=folder, capture_output=True, check=True)


def loaded(made, mesh, contact, procedure, force):
    """A static step under dead pressure on the flanks, then the free beam about that state."""
    lines = ["*STEP", "*STATIC", "*BOUNDARY"]
    lines += [f"{d // 3 + 1}, {d % 3 + 1}, {d % 3 + 1}" for d in supports(as_mesh(made).nodes)]
    lines.append("*CLOAD")
    for flank, frame in enumerate(mesh.flank_frame.values):
        nodes = contact[flank]
        # consistent with a uniform pressure on one 8-node face: edges 1/3, corners -1/12
        centre = made.nodes[nodes].mean(axis=0)
        far = np.linalg.norm(made.nodes[nodes] - centre, axis=1)
        share = np.where(np.argsort(np.argsort(far)) < 4, 1 / 3, -1 / 12)
        for node, part in zip(nodes, share, strict=True):
            push = -force * part * frame[0] / (2 * abs(frame[0, 0]))
            lines += [f"{node + 1}, {axis + 1}, {push[axis]:.12e}" for axis in (0, 2)]
    step = ["*END STEP", "*STEP, PERTURBATION", procedure, "12", "*BOUNDARY, OP=NEW"]
    return [*lines, *step, "*END STEP"]


@pytest.fixture(scope="module")
def exported(bricks, tmp_path_factory):
    folder = tmp_path_factory.mktemp("ccx")
    mesh, bodies = bricks
    listed, rows = {}, []
    for body, (made, materials, kept, side) in zip(BODIES, bodies, strict=True):
        head = geometry(made, materials)
        if body == "beam":
            number = {int(node): k for k, node in enumerate(kept)}
            pairs = mesh.pair_flank.values
            contact = [
                np.array([number[int(n)] for n in side[pairs == flank] if int(n) in number])
                for flank in range(4)
            ]
            run(folder, "loaded", [*head, *loaded(made, mesh, contact, STORE, FORCE)])
            run(folder, "modes", [*head, *loaded(made, mesh, contact, "*FREQUENCY", FORCE)])
            held = []
        else:
            held = ["*BOUNDARY", *(f"{node + 1}, 1, 3" for node in base_nodes(as_mesh(made)))]
        run(folder, body, [*head, *held, "*STEP", STORE, "12", "*END STEP"])
        table = ["node,x,y,z"]
        table += [f"{k},{x!r},{y!r},{z!r}" for k, (x, y, z) in enumerate(made.nodes.tolist(), 1)]
        (folder / f"{body}.csv").write_text("\n".join(table) + "\n")
        listed[body] = {
            "nodes": f"{body}.csv",
            "mapping": f"{body}.dof",
            "mass": f"{body}.mas",
            "stiffness": f"{body}.sti",
        }
    del listed["beam"]["stiffness"]
    listed["beam"]["stiffness_at"] = [
        {"force_N": 0, "stiffness": "beam.sti"},
        {"force_N": FORCE, "stiffness": "loaded.sti"},
    ]
    for k, flank in enumerate(mesh.pair_flank.values):
        numbers = []
        for _, _, kept, side in (bodies[0], bodies[1 + flank // 2]):
            place = int(np.searchsorted(kept, side[k]))
            numbers.append(place + 1 if place < len(kept) and kept[place] == side[k] else 0)
        if all(numbers):
            normal = ",".join(map(repr, mesh.flank_frame.values[flank, 0].tolist()))
            rows.append(f"{FLANKS[flank]},{numbers[0]},{numbers[1]},1.0,{normal}")
    header = "flank,beam_node,slot_node,area,nx,ny,nz"
    (folder / "contact.csv").write_text("\n".join([header, *rows]) + "\n")
    beam = bodies[0][0].nodes
    edge = beam[(abs(beam[:, 2] - 0.005) < 1e-9) & (abs(beam[:, 0]) < 0.141), 1].max()
    shown = np.flatnonzero(
        (abs(beam[:, 2] - 0.005) < 1e-9)
        & (abs(beam[:, 1] - edge) < 1e-9)
        & (abs(beam[:, 0]) < 0.141)
    )
    description = {
        "name": "ccx",
        "kind": "matrices",
        "description": "Written by CalculiX.",
        "units": "m-N-kg",
        "beam": listed["beam"],
        "slots": {side: listed[side] for side in BODIES[1:]},
        "contact": "contact.csv",
        "display_nodes": (shown + 1).tolist(),
        "reduction": {"beam_modes": 30, "slot_modes": 4},
    }
    (folder / "ccx.yaml").write_text(yaml.safe_dump(description))
    return folder


def test_what_must_hold_holds(exported):
    description = read_description(exported / "ccx.yaml")
    checks = external_checks(description, external_mesh(description))
    assert checks.within.all()


def test_the_loaded_beam_keeps_calculix_own_frequencies(exported):
    description = read_description(exported / "ccx.yaml")
    reduced = reduce_matrices(description, external_mesh(description))
    stiffness = reduced.beam_stiffness + FORCE * reduced.beam_geometric_stiffness
    values = scipy.linalg.eigh(stiffness, reduced.beam_mass, eigvals_only=True)
    ours = np.sqrt(values[values > (2 * np.pi * 300) ** 2][:4]) / (2 * np.pi)
    lines = (exported / "modes.dat").read_text().splitlines()
    rows = [line.split() for line in lines]
    theirs = [float(row[3]) for row in rows if len(row) == 5 and row[0].isdigit()]
    theirs = [frequency for frequency in theirs if frequency > 300][:4]
    np.testing.assert_allclose(ours, theirs, rtol=5e-4)
