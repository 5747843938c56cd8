"""A beam with two hammer-head ends in two slots: drawn geometry, matrices, contact rows.

The heads' arms reach back from the end section to the flanks, so that a rotation of the end slides
along the flanks more than it presses on them.
"""

import itertools
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import scipy.io
import scipy.sparse as sp
import yaml

from foreign_lab.frame import Frame, Section, matrices

FLANKS = ("Xn-bottom", "Xn-top", "Xp-bottom", "Xp-top")
SHARES = (0.25, 0.5, 0.25)  # of a flank's area, along the width


@dataclass(frozen=True)
class Geometry:
    """Dimensions in m, SI; `elements` along the span, even."""

    length: float
    width: float
    depth: float
    reach: float  # half-height of the flanks
    back: float  # how far the flanks lie inside of the end sections
    jaw: float  # length of the slots' jaws
    modulus: float
    density: float
    elements: int


def draw_geometry(rng: np.random.Generator) -> Geometry:
    """A beam whose first two bending modes lie between 100 and 2000 Hz when clamped."""
    steel = rng.random() < 0.6
    modulus, density = (2.05e11, 7830.0) if steel else (7.1e10, 2720.0)
    depth = rng.uniform(9e-3, 18e-3)
    speed = np.sqrt(modulus / density / 12) * depth
    second = rng.uniform(700.0, 1800.0)
    length = np.sqrt(61.67 / (2 * np.pi) * speed / second)
    reach = rng.uniform(0.75, 1.2) * depth
    return Geometry(
        length,
        rng.uniform(1.7, 2.4) * depth,
        depth,
        reach,
        rng.uniform(0.25, 0.75) * reach,
        rng.uniform(1.0, 2.0) * depth,
        modulus,
        density,
        10,
    )


def as_it_is(rng: np.random.Generator, told: Geometry) -> Geometry:
    """The specimen behind an analyst's drawing: other dimensions, material and mesh."""
    off = dict(length=1e-3, width=2e-3, depth=3e-3, reach=2e-2, back=5e-2, jaw=0.1, modulus=4e-3)
    moved = {name: getattr(told, name) * (1 + std * rng.normal()) for name, std in off.items()}
    return replace(told, **moved, density=told.density * (1 + 2e-3 * rng.normal()), elements=18)


@dataclass(frozen=True)
class Bodies:
    """Frames of beam and slots and the contact pairs, beam nodes beside slot nodes."""

    beam: Frame
    slots: tuple[Frame, Frame]
    fixed: tuple[list[int], list[int]]
    axis_nodes: list[int]
    pairs: list[tuple[int, int, int, float]]  # flank, beam node, slot node, share


def build(g: Geometry) -> Bodies:
    """The three frames."""
    beam, slots, fixed, pairs = Frame(), (Frame(), Frame()), ([], []), []
    span = Section(g.width, g.depth, g.modulus, g.density)
    head = Section(g.width / 3, 1.4 * g.depth, g.modulus, g.density)
    steel = Section(g.width / 2, 2.5 * g.depth, 2.1e11, 7800.0)
    axis = [beam.node(x, 0.0, 0.0) for x in np.linspace(-0.5, 0.5, g.elements + 1) * g.length]
    for first, last in itertools.pairwise(axis):
        beam.member(first, last, span, 1.0)
    for end, side in enumerate((-1, 1)):
        slot = slots[end]
        for top in (0, 1):
            up, before = (-1, 1)[top], None
            for y, share in zip((-g.width / 3, 0.0, g.width / 3), SHARES, strict=True):
                place = (side * (g.length / 2 - g.back), y, up * g.reach)
                mine, other = beam.node(*place), slot.node(*place)
                beam.member(axis[-end], mine, head)
                middle = slot.node(place[0], y, up * (g.reach + g.jaw / 2))
                ground = slot.node(place[0], y, up * (g.reach + g.jaw))
                slot.member(other, middle, steel)
                slot.member(middle, ground, steel)
                if before is not None:
                    slot.member(before, middle, steel)
                before = middle
                fixed[end].append(ground)
                pairs.append((2 * end + top, mine, other, share))
    return Bodies(beam, slots, fixed, axis, pairs)


def normal_of(flank: int) -> np.ndarray:
    """Out of the beam: to mid-span and away from the middle plane."""
    return np.array([(1, -1)[flank // 2], 0.0, (-1, 1)[flank % 2]]) / np.sqrt(2)


@dataclass(frozen=True)
class Assembly:
    """K0, M, Kg per newton and the contact rows of unit flank stiffness (gap, slip)."""

    stiffness: np.ndarray
    mass: np.ndarray
    geometric: np.ndarray
    gap: np.ndarray
    slip: np.ndarray
    axis_x: np.ndarray
    axis_z: np.ndarray  # dofs in Z along the axis


def assemble(g: Geometry) -> Assembly:
    """All bodies in one, held dofs struck out."""
    bodies = build(g)
    frames = (bodies.beam, *bodies.slots)
    starts = np.cumsum([0, *(6 * len(one.nodes) for one in frames)])
    parts = [matrices(one) for one in frames]
    total = [np.zeros((starts[-1], starts[-1])) for _ in range(3)]
    for start, part in zip(starts[:-1], parts, strict=True):
        where = slice(start, start + len(part[0]))
        for whole, piece in zip(total, part, strict=True):
            whole[where, where] = piece
    held = [
        starts[1 + end] + 6 * node + np.arange(6) for end in (0, 1) for node in bodies.fixed[end]
    ]
    free = np.setdiff1d(np.arange(starts[-1]), np.concatenate(held))
    gap, slip = [], []
    for flank, mine, other, share in bodies.pairs:
        rows = np.zeros((3, starts[-1]))
        n = normal_of(flank)
        frame = np.stack([n, [0.0, 1.0, 0.0], np.cross(n, [0.0, 1.0, 0.0])]) * np.sqrt(share)
        rows[:, 6 * mine : 6 * mine + 3] = frame
        there = starts[1 + flank // 2] + 6 * other
        rows[:, there : there + 3] = -frame
        gap.append(rows[:1])
        slip.append(rows[1:])
    place = np.searchsorted(free, 6 * np.array(bodies.axis_nodes) + 2)
    x = np.array(bodies.beam.nodes)[bodies.axis_nodes, 0]
    cut = [matrix[np.ix_(free, free)] for matrix in total]
    return Assembly(*cut, np.vstack(gap)[:, free], np.vstack(slip)[:, free], x, place)


def export(g: Geometry, folder: Path, name: str) -> Path:
    """The analyst's model as files of kind `matrices` in a folder; its structure file."""
    bodies, inside = build(g), folder / name
    inside.mkdir(parents=True, exist_ok=True)
    files = {}
    for body, frame in zip(("beam", "Xn", "Xp"), (bodies.beam, *bodies.slots), strict=True):
        parts = dict(
            zip(("stiffness", "mass", "geometric_stiffness"), matrices(frame), strict=True)
        )
        if body != "beam":
            parts.pop("geometric_stiffness")
            held = "\n".join(str(node + 1) for node in bodies.fixed[body == "Xp"])
            (inside / f"{body}_fixed.csv").write_text(f"node\n{held}\n")
        for kind, matrix in parts.items():
            path = inside / f"{body}_{kind}.mtx"
            scipy.io.mmwrite(path, sp.coo_array(matrix), precision=17, symmetry="symmetric")
        dofs = [f"dof_{axis}" for axis in ("x", "y", "z", "rx", "ry", "rz")]
        lines = [",".join(["node", "x", "y", "z", *dofs])]
        for k, place in enumerate(frame.nodes):
            rows = [str(6 * k + axis + 1) for axis in range(6)]
            lines.append(",".join([str(k + 1), *(f"{v:.12g}" for v in place), *rows]))
        (inside / f"{body}_nodes.csv").write_text("\n".join(lines) + "\n")
        files[body] = {"nodes": f"{name}/{body}_nodes.csv"} | {
            kind: f"{name}/{body}_{kind}.mtx" for kind in parts
        }
        if body != "beam":
            files[body]["fixed"] = f"{name}/{body}_fixed.csv"
    area = g.width * g.reach
    rows = ["flank,beam_node,slot_node,area,nx,ny,nz"]
    for flank, mine, other, share in bodies.pairs:
        n = normal_of(flank)
        rows.append(
            f"{FLANKS[flank]},{mine + 1},{other + 1},{share * area:.9g},{n[0]:.12g},0,{n[2]:.12g}"
        )
    (inside / "contact.csv").write_text("\n".join(rows) + "\n")
    described = {
        "name": name,
        "kind": "matrices",
        "description": "Beam with hammer-head ends in two slots, beam elements.",
        "units": "m-N-kg",
        "beam": files["beam"],
        "slots": {"Xn": files["Xn"], "Xp": files["Xp"]},
        "contact": f"{name}/contact.csv",
        "display_nodes": [node + 1 for node in bodies.axis_nodes],
        "reduction": {"beam_modes": 30, "slot_modes": 10},
    }
    path = folder / f"{name}.yaml"
    path.write_text(yaml.safe_dump(described, sort_keys=False))
    return path
