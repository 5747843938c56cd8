"""Frequencies of the prestressed beam against CalculiX, an independent finite-element program.

    python benchmarks/calculix.py             # the shipped mesh
    python benchmarks/calculix.py --small     # a coarse mesh, a few seconds

Needs `ccx` (Debian: calculix-ccx); without it the script says so and compares nothing. The free
beam of a structure file with its pad is solved at 0, 2 and 24 kN of dead load, and a slot that is
clamped at its far face, by both programs, on the same nodes, elements and nodal forces, so that a
difference is one of programs:

- C3D20: twenty nodes. Their shapes are a subspace of the library's 27: nodes on faces and in
  centres follow those on edges, A20 = T^T A27 T.
- C3D8I: eight nodes with incompatible modes, on the eighths of the elements. The library has no
  such element; `bricks.py` has, independently of both.

CalculiX takes stress and displacement of the static step into the frequency step (PERTURBATION):
besides K0 + F Kg it counts the elastic stiffness of the strained shape, which the thesis's (4.1)
leaves out. Both are printed: as the library has it, and with that term. "from 27 nodes" is how far
the element itself is from the library's, on the same mesh.
"""

import argparse
import json
import shutil
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import bricks
import ccx
import numpy as np
import scipy.sparse as sp
from bladeroot.fem import elasticity
from bladeroot.fem.geometry import Material, MeshDensity, Structure
from bladeroot.fem.linear import factor, lowest_eigenpairs
from bladeroot.fem.mesh import Mesh, base_nodes, body_mesh, build_mesh
from bladeroot.fem.modes import name_modes
from bladeroot.fem.prestress import flank_loads, materials_of, prestress, supports
from bladeroot.rom.file import load_structure
from bladeroot.rom.reduction import beam_model

FORCES = (0.0, 2.0e3, 24.0e3)
TARGET = 2e-4
MODES = 12
SLOT_MODES = 6
_SMALL = MeshDensity(width=1, thickness=1, span_size=0.07, root_size=0.02, jaw=1, base=1)
# Corners, then edges of a C3D20: places 0..2 along X, Y, Z among the 27 local nodes.
_SQUARE, _SIDES = ((0, 0), (2, 0), (2, 2), (0, 2)), ((1, 0), (2, 1), (1, 2), (0, 1))
_C3D20 = [
    *((i, j, k) for k in (0, 2) for i, j in _SQUARE),
    *((i, j, k) for k in (0, 2) for i, j in _SIDES),
    *((i, j, 1) for i, j in _SQUARE),
]


@dataclass(frozen=True)
class Problem:
    """The free beam in one kind of element, for CalculiX (`body`) and in matrices by dof.

    geometric: per newton. `strained(F)` is the elastic stiffness about the statically deformed
    beam. `nodal` gives the displacements of the library's nodes, by which modes are named; `shown`
    does so for CalculiX's own shapes.
    """

    body: ccx.Body
    stiffness: sp.csr_array
    mass: sp.csr_array
    geometric: sp.csr_array
    strained: Callable[[float], sp.csr_array]
    nodal: sp.csr_array
    shown: sp.csr_array


def twenty_nodes(mesh: Mesh, materials: Sequence[Material], loads: np.ndarray) -> Problem:
    """C3D20 on the elements' corners and edges."""
    follow, kept = serendipity(mesh)
    spread = elasticity.per_axis(follow)
    rule = elasticity.quadrature(mesh)
    held = supports(mesh.nodes[kept])
    stiffness = sp.csr_array(spread.T @ elasticity.stiffness(mesh, rule, materials) @ spread)
    loads = follow.T @ loads
    moves = (spread @ _static(stiffness, loads.ravel(), held)).reshape(-1, 3)
    stress = elasticity.stress(mesh, rule, materials, moves)
    geometric = follow.T @ elasticity.geometric_stiffness(mesh, rule, stress) @ follow
    slope = np.einsum("eai,eqaj->eqij", moves[mesh.elements], rule.gradients)
    own = [materials[part] for part in mesh.part]
    hooke = np.stack([bricks.isotropic(material) for material in own])

    def strained(force: float) -> sp.csr_array:
        local = bricks.strained(rule.gradients, rule.volumes, hooke, force * slope)
        dofs = (3 * mesh.elements[:, :, None] + np.arange(3)).reshape(-1, 81)
        return sp.csr_array(spread.T @ bricks.gather(local, dofs) @ spread)

    number = np.full(len(mesh.nodes), -1)
    number[kept] = np.arange(len(kept))
    elements = number[mesh.elements[:, [9 * i + 3 * j + k for i, j, k in _C3D20]]]
    mass = follow.T @ elasticity.mass(mesh, rule, materials) @ follow
    return Problem(
        ccx.Body("C3D20", mesh.nodes[kept], elements, own, loads, held),
        stiffness,
        elasticity.per_axis(sp.csr_array(mass)),
        elasticity.per_axis(sp.csr_array(geometric)),
        strained,
        spread,
        spread,
    )


def serendipity(mesh: Mesh) -> tuple[sp.csr_array, np.ndarray]:
    """T (27-node mesh's node, kept node), and the kept nodes, those on corners and edges."""
    places = [9 * i + 3 * j + k for i, j, k in _C3D20]
    kept = np.unique(mesh.elements[:, places])
    number = np.full(len(mesh.nodes), -1)
    number[kept] = np.arange(len(kept))
    follow = sp.lil_array((len(mesh.nodes), len(kept)))
    follow[kept, np.arange(len(kept))] = 1.0
    for place, at in enumerate(np.ndindex(3, 3, 3)):
        if at.count(1) < 2:
            continue
        around = [one for one in _C3D20 if all(a in (1, b) for a, b in zip(at, one, strict=True))]
        for i, j, k in around:
            middle = 0.5 if at.count(1) == 2 else 0.25
            columns = number[mesh.elements[:, 9 * i + 3 * j + k]]
            follow[mesh.elements[:, place], columns] = middle if 1 in (i, j, k) else -0.25
    return sp.csr_array(follow), kept


def eight_nodes(mesh: Mesh, materials: Sequence[Material], loads: np.ndarray) -> Problem:
    """C3D8I on the eighths of the elements."""
    corners = (bricks.CORNERS + 1) // 2
    eighths = [
        mesh.elements[:, [9 * (i + a) + 3 * (j + b) + k + c for a, b, c in corners]]
        for i, j, k in np.ndindex(2, 2, 2)
    ]
    elements = np.concatenate(eighths)
    own = [materials[part] for part in np.tile(mesh.part, 8)]
    made = bricks.bricks(mesh.nodes, elements, own)
    held = supports(mesh.nodes)
    stiffness = bricks.stiffness(made)
    right = np.zeros(stiffness.shape[0])
    right[: loads.size] = loads.ravel()
    moves = _static(stiffness, right, held).reshape(-1, 3)
    return Problem(
        ccx.Body("C3D8I", mesh.nodes, elements, own, loads, held),
        stiffness,
        bricks.mass(made),
        bricks.prestressed(made, moves)[0],
        lambda force: bricks.prestressed(made, force * moves)[1],
        sp.csr_array(sp.eye_array(loads.size, stiffness.shape[0])),
        sp.csr_array(sp.eye_array(loads.size)),
    )


def _static(stiffness: sp.csr_array, right: np.ndarray, held: np.ndarray) -> np.ndarray:
    free = np.setdiff1d(np.arange(len(right)), held)
    moves = np.zeros(len(right))
    moves[free] = factor(sp.csr_array(stiffness[free][:, free]))(right[free])
    return moves


Named = dict[str, float]


def named(beam: Mesh, weights: np.ndarray, stiffness, mass, nodal, force: float) -> Named:
    """Eigenvalues (rad^2/s^2) of the lowest modes, by name."""
    # below the unstable Rx, whose eigenvalue grows with the force
    shift = -((2 * np.pi * 1000.0) ** 2) * (1 + force / 1e4)
    values, shapes = lowest_eigenpairs(sp.csr_array(stiffness), mass, MODES, shift)
    return dict(zip(name_modes(beam.nodes, weights, values, nodal @ shapes), values, strict=True))


def compare(
    beam: Mesh, weights: np.ndarray, problem: Problem, whole: Named, force: float
) -> list[dict]:
    """A row a mode: frequencies (Hz) and relative differences; negative where it is unstable.

    `whole`: of the 27-node elements. Translations, and rotations without a force, have no row.
    """
    values, shapes = ccx.modes(problem.body, force, MODES)
    names = name_modes(beam.nodes, weights, values, problem.shown @ shapes)
    theirs = dict(zip(names, values, strict=True))
    about = (problem.mass, problem.nodal, force)
    pull = force * problem.geometric
    ours = named(beam, weights, problem.stiffness + pull, *about)
    term = named(beam, weights, problem.strained(force) + pull, *about)
    rows = []
    for mode, value in ours.items():
        if mode in "XYZ" or (force == 0 and mode.startswith("R")):
            continue
        if not all(mode in found for found in (theirs, term, whole)):
            raise RuntimeError(f"{problem.body.kind}, {force:g} N: mode {mode} is not everywhere")
        reference = _hertz(theirs[mode])
        rows.append(
            {
                "element": problem.body.kind,
                "force_N": force,
                "mode": mode,
                "calculix_Hz": reference,
                "ours_Hz": _hertz(value),
                "difference": _hertz(value) / reference - 1.0,
                "difference_strained": _hertz(term[mode]) / reference - 1.0,
                "from_27_nodes": reference / _hertz(whole[mode]) - 1.0,
            }
        )
    return rows


def measure_slot(structure: Structure) -> list[dict]:
    """Rows of a slot clamped at its base, a mode each, in their order."""
    mesh = build_mesh(structure)
    slot, _ = body_mesh(mesh, 1)
    rows = []
    for make in (twenty_nodes, eight_nodes):
        problem = make(slot, materials_of(structure, mesh, 1), np.zeros_like(slot.nodes))
        base = base_nodes(replace(slot, nodes=problem.body.nodes))
        at = (3 * base[:, None] + np.arange(3)).ravel()
        body = replace(problem.body, fixed=at)
        theirs = ccx.modes(body, 0.0, SLOT_MODES)[0]
        # dofs of the problem that move the clamped nodes: the body's nodes stand first among them
        free = np.setdiff1d(np.arange(problem.stiffness.shape[0]), at)
        inner = (sp.csr_array(part[free][:, free]) for part in (problem.stiffness, problem.mass))
        values = lowest_eigenpairs(*inner, SLOT_MODES, 0.0)[0]
        rows += [
            {
                "element": problem.body.kind,
                "mode": str(number),
                "calculix_Hz": _hertz(reference),
                "ours_Hz": _hertz(value),
                "difference": _hertz(value) / _hertz(reference) - 1.0,
            }
            for number, (reference, value) in enumerate(zip(theirs, values, strict=True), 1)
        ]
    return rows


def _hertz(value: float) -> float:
    return float(np.sign(value) * np.sqrt(abs(value)) / (2 * np.pi))


def measure(structure: Structure, forces: Sequence[float] = FORCES) -> list[dict]:
    """All rows of both kinds of element at each axial force (N)."""
    mesh = build_mesh(structure, with_pad=True)
    model = beam_model(structure, mesh, prestress(structure, mesh))
    beam, weights = model.mesh, model.mass.sum(axis=1)
    per_axis, one = elasticity.per_axis, sp.eye_array(model.stiffness.shape[0])
    whole = {
        force: named(
            beam,
            weights,
            model.stiffness + force * per_axis(model.geometric),
            per_axis(model.mass),
            one,
            force,
        )
        for force in forces
    }
    rows = []
    for make in (twenty_nodes, eight_nodes):
        problem = make(beam, materials_of(structure, mesh, 0), flank_loads(mesh))
        for force in forces:
            rows += compare(beam, weights, problem, whole[force], force)
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--small", action="store_true", help="a coarse mesh")
    parser.add_argument("--structure", default="dovetail-H", help="of resources/structures")
    parser.add_argument("--json", help="file for the numbers")
    chosen = parser.parse_args()
    if shutil.which("ccx") is None:
        print("skipped: CalculiX is not installed (no ccx on the path; Debian: calculix-ccx)")
        return
    folder = Path(__file__).parents[1] / "resources/structures"
    structure = load_structure(folder / f"{chosen.structure}.yaml")
    structure = replace(structure, density=_SMALL) if chosen.small else structure
    rows, of_slot = measure(structure), measure_slot(structure)
    print("element  force N  mode  CalculiX Hz    ours Hz  difference  strained  from 27 nodes")
    for row in rows:
        print(
            f"{row['element']:7}{row['force_N']:9.0f}  {row['mode']:4}{row['calculix_Hz']:13.4f}"
            f"{row['ours_Hz']:11.4f}{row['difference']:12.1e}{row['difference_strained']:10.1e}"
            f"{row['from_27_nodes']:15.1e}"
        )
    print("slot, clamped: mode  CalculiX Hz    ours Hz  difference")
    for row in of_slot:
        print(
            f"{row['element']:16}{row['mode']:4}{row['calculix_Hz']:13.3f}{row['ours_Hz']:11.3f}"
            f"{row['difference']:12.1e}"
        )
    for element in ("C3D20", "C3D8I"):
        every = [r for r in rows + of_slot if r["element"] == element]
        steady = [r for r in every if r["ours_Hz"] > 0]
        largest = max(abs(row["difference"]) for row in steady)
        verdict = "ok" if largest < TARGET else "FAILS"
        print(f"{element}: largest difference {largest:.1e} (target {TARGET:.0e}) {verdict}")
    if chosen.json:
        Path(chosen.json).write_text(json.dumps({"beam": rows, "slot": of_slot}, indent=1))


if __name__ == "__main__":
    main()
