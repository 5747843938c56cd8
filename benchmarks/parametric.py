"""The structure stage and the parametric model against plain ways of doing the same, in one run.

    python benchmarks/parametric.py            # map, reduction and the stage at 20k dof
    python benchmarks/parametric.py dofs       # cost and memory from 5k to 160k dof

CPU seconds of this process on one thread. Dense solutions and solves of single columns are timed
on a sample and scaled; the number timed is printed beside.
"""

import copy
import os
import resource
import subprocess
import sys
import time
from pathlib import Path

os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"

import numpy as np
import scipy.linalg
import scipy.sparse.linalg as spla
import yaml
from bladeroot.fem import elasticity
from bladeroot.fem.geometry import structure_from_mapping
from bladeroot.fem.mesh import build_mesh
from bladeroot.fem.prestress import prestress
from bladeroot.rom.chebyshev import at_force
from bladeroot.rom.joint import exact_modes, joint_of_reduced, stiffness_at
from bladeroot.rom.parametric import frequencies, ln_frequencies, surface_of
from bladeroot.rom.parametric_build import parametric_model
from bladeroot.rom.reduction import beam_basis, beam_model, contact_dofs, reduce_structure
from bladeroot.rom.ritz import frequency

ROOT = Path(__file__).resolve().parents[1]
MODES = ("1B", "2B")
FORCE = 12e3
KEYS = ("width_elements", "thickness_elements", "span_element_mm", "root_element_mm",
        "jaw_elements", "base_elements")  # fmt: skip
MESHES = {
    "5k": (2, 1, 40, 14, 1, 1),
    "10k": (3, 2, 30, 10, 2, 1),
    "20k": (5, 2, 24, 8, 3, 1),
    "40k": (5, 4, 13, 5, 4, 2),
    "80k": (5, 6, 8, 3.5, 6, 3),
    "160k": (5, 9, 4.5, 2.0, 9, 5),
}


class Clock:
    """CPU seconds since the last call."""

    def __init__(self):
        self.last = time.process_time()

    def __call__(self) -> float:
        now = time.process_time()
        passed, self.last = now - self.last, now
        return passed


def structure_at(size: str):
    data = yaml.safe_load((ROOT / "resources/structures/dovetail-H.yaml").read_text())
    data = copy.deepcopy(data) | {"mesh": dict(zip(KEYS, MESHES[size], strict=True))}
    return structure_from_mapping(data)


def stage(size: str):
    """Mesh to parametric model; prints the CPU seconds of every part."""
    structure, clock, parts = structure_at(size), Clock(), {}
    mesh = build_mesh(structure)
    parts["mesh"] = clock()
    loaded = prestress(structure, mesh)
    parts["prestress"] = clock()
    reduced = reduce_structure(structure, mesh, loaded)
    parts["reduction"] = clock()
    joint = joint_of_reduced(reduced)
    model = parametric_model(joint)
    parts["parametric"] = clock()
    text = ", ".join(f"{name} {seconds:.2f}" for name, seconds in parts.items())
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(
        f"stage {3 * mesh.sizes['node']:7d} dof, {mesh.sizes['pair']} pairs: "
        f"{sum(parts.values()):6.2f} s ({text}), peak {peak:.0f} MB, "
        f"error bound {float(model['error_bound'].max()):.1e}",
        flush=True,
    )
    return structure, mesh, loaded, joint, model


def compare_map(joint, model, dense: int = 4, random: int = 20) -> None:
    """A map of 200 x 200 points for both modes at one force against a dense eigh a point."""
    axis = np.linspace(*np.log([1e8, 1e12]), 200)
    grid = np.stack(np.meshgrid(axis, axis, [FORCE], indexing="ij"), axis=-1).reshape(-1, 3)
    clock = Clock()
    drawn = frequencies(at_force(surface_of(model), FORCE), grid)
    ours = clock()
    ln_frequencies(surface_of(model), grid)
    second = clock()
    chosen = np.random.default_rng(1).choice(len(grid), dense)
    for point in grid[chosen]:
        scipy.linalg.eigh(stiffness_at(joint, point), joint.mass)
    plain = clock() / dense * len(grid)
    for point in grid[chosen]:
        scipy.linalg.eigh(stiffness_at(joint, point), joint.mass, subset_by_index=[0, 11])
    few = clock() / dense * len(grid)
    low, high = model["box"].values
    points = np.random.default_rng(2).uniform(low, high, (random, 3))
    exact = [frequency(exact_modes(joint, point, MODES).values) for point in points]
    error = np.abs(frequencies(surface_of(model), points) / exact - 1.0).max()
    print(f"map 200 x 200, two modes, one force: {ours:.3f} s; with the gradient by "
          f"(ln kn, ln kt, F) {second:.2f} s")  # fmt: skip
    print(f"dense eigh of {len(joint.mass)} dof a point: {plain:.0f} s, all modes; {few:.0f} s, "
          f"lowest 12 ({dense} points timed)")  # fmt: skip
    print(f"ratio {plain / ours:.0f}, of the lowest 12 only {few / ours:.0f}; "
          f"map is {drawn.min():.0f} to {drawn.max():.0f} Hz")  # fmt: skip
    print(f"largest relative error at {random} random points: {error:.1e}")


def compare_reduction(structure, mesh, loaded, columns: int = 20) -> None:
    """Craig-Bampton's basis of the beam against a default factor and one solve a column."""
    model = beam_model(structure, mesh, loaded)
    clock = Clock()
    basis = beam_basis(model, mesh, structure.beam_modes)
    ours = clock()
    masters = contact_dofs(mesh.pair_node.values[:, 0])
    slaves = np.setdiff1d(np.arange(len(basis.columns)), masters)
    rows = model.stiffness[slaves]
    inner = rows[:, slaves].tocsc()
    clock()
    factor = spla.splu(inner)
    right = rows[:, masters].toarray()
    plain = clock()
    for column in right.T[:columns]:
        factor.solve(column)
    plain += clock() / columns * len(masters)
    mass = elasticity.per_axis(model.mass)[slaves][:, slaves].tocsc()
    clock()
    spla.eigsh(inner, structure.beam_modes, mass, sigma=0.0)
    plain += clock()
    print(f"reduction of the beam, {len(slaves)} slave dof, {len(masters)} masters: {ours:.2f} s; "
          f"default factor and a solve a column ({columns} timed), eigsh: {plain:.2f} s; "
          f"ratio {plain / ours:.1f}")  # fmt: skip


def main() -> None:
    if sys.argv[1:2] == ["dofs"]:
        for size in sys.argv[2:] or MESHES:
            # a process each, so that the peak of memory is its own
            subprocess.run([sys.executable, __file__, "one", size], check=False)
    elif sys.argv[1:2] == ["one"]:
        stage(sys.argv[2])
    else:
        structure, mesh, loaded, joint, model = stage("20k")
        compare_map(joint, model)
        compare_reduction(structure, mesh, loaded)


if __name__ == "__main__":
    main()
