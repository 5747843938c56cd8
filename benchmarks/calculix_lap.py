"""The lap joint by matrices that CalculiX itself assembles, beside the same by the library.

    python benchmarks/calculix_lap.py [--small]

Needs `ccx` (Debian: calculix-ccx); without it the script says so and compares nothing. CalculiX
meshes each half beam with C3D20 and writes its matrices (*FREQUENCY, SOLVER=MATRIXSTORAGE: .sti,
.mas, .dof); a structure file of kind `assembly` names them, with the contact pairs of the bolts'
patches that lie on corners and edges. The library's are of the same elements, by A20 = T^T A27 T.
Without load and bolts' mass, at three stiffnesses of all interfaces.
"""

import argparse
import shutil
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import ccx
import numpy as np
import yaml
from bladeroot.fem.lap_joint import half_beam, lap_joint_of
from bladeroot.rom.bodies import Assembly, Body, box_of, joint_of_bodies, reduce_bodies
from bladeroot.rom.external.assembly import assembly_of_matrices, export_assembly, read_assembly
from bladeroot.rom.joint import exact_modes
from bladeroot.rom.lap_joint import lap_joint_assembly
from bladeroot.schema import read_yaml
from bladeroot.shipped_files import structure_file
from calculix import serendipity, twenty_nodes

SMALL = {"span_element_mm": 60, "overlap_elements": 6, "width_elements": 1,
         "thickness_elements": 1}  # fmt: skip
STIFFNESS = (0.1, 1.0, 10.0)  # over the middle of the box


def by_library(data: dict) -> tuple[Assembly, list[ccx.Body]]:
    """The assembly on 20-node elements, and what CalculiX is told of its bodies."""
    whole, joint = lap_joint_assembly(data, "lap-joint.yaml"), lap_joint_of(data, "lap-joint.yaml")
    bodies, told, numbers = [], [], []
    for which, body in enumerate(whole.bodies):
        mesh = half_beam(joint, which).mesh
        made = twenty_nodes(mesh, [joint.material], np.zeros_like(mesh.nodes))
        _, kept = serendipity(mesh)
        numbers.append(np.full(len(mesh.nodes), -1))
        numbers[-1][kept] = np.arange(len(kept))
        dof = np.arange(3 * len(kept)).reshape(-1, 3)
        bodies.append(Body(body.name, made.mass, made.stiffness, None, mesh.nodes[kept], dof))
        told.append(made.body)
    interfaces = []
    for one in whole.interfaces:
        node = np.stack([numbers[b][n] for b, n in zip((0, 1), one.node.T, strict=True)], axis=1)
        there = (node >= 0).all(axis=1)
        interfaces.append(
            replace(one, body=one.body[there], node=node[there], normal=one.normal[there],
                    area=one.area[there])
        )  # fmt: skip
    display = np.array([(b, numbers[b][n]) for b, n in whole.display if numbers[b][n] >= 0])
    return replace(whole, bodies=tuple(bodies), interfaces=tuple(interfaces),
                   display=display), told  # fmt: skip


def by_calculix(own: Assembly, told: list[ccx.Body], data: dict, folder: Path) -> Assembly:
    """The same whose matrices CalculiX has written."""
    export_assembly(own, data, folder, "theirs")
    path = folder / "theirs.yaml"
    described = yaml.safe_load(path.read_text())
    for body, deck in zip(own.bodies, told, strict=True):
        inner = folder / body.name
        inner.mkdir()
        text = ccx.deck(deck, 0.0, 12).replace("*FREQUENCY", "*FREQUENCY, SOLVER=MATRIXSTORAGE")
        said = ccx.run(inner, text)
        if not (inner / "beam.sti").is_file():
            raise RuntimeError(f"CalculiX wrote no matrices; it said: {said[-400:]}")
        table = folder / described["bodies"][body.name]["nodes"]
        rows = [line.split(",")[:4] for line in table.read_text().splitlines()]
        table.write_text("\n".join(",".join(row) for row in rows) + "\n")
        described["bodies"][body.name] = {
            "nodes": described["bodies"][body.name]["nodes"],
            "mapping": f"{body.name}/beam.dof", "mass": f"{body.name}/beam.mas",
            "stiffness": f"{body.name}/beam.sti",
        }  # fmt: skip
    path.write_text(yaml.safe_dump(described, sort_keys=False))
    return assembly_of_matrices(read_assembly(path))


def frequencies(assembly: Assembly) -> np.ndarray:
    """Hz, (stiffness, mode)."""
    reduced = reduce_bodies(assembly)
    joint, middle = joint_of_bodies(reduced), np.log(box_of(reduced)).mean(axis=1)
    points = [np.append(middle + np.log(k), 0.0) for k in STIFFNESS]
    found = [exact_modes(joint, point, list(assembly.modes)).values for point in points]
    return np.sqrt(np.array(found)) / (2.0 * np.pi)


def main() -> None:
    asked = argparse.ArgumentParser(description=__doc__)
    asked.add_argument("--small", action="store_true", help="a coarse mesh")
    options = asked.parse_args()
    if shutil.which("ccx") is None:
        print("CalculiX (ccx) is not installed: nothing compared")
        return
    data = read_yaml(structure_file("lap-joint"), "assembly")
    data["bolts"]["mass_kg"] = 0.0
    if options.small:
        data["mesh"] = SMALL
    own, told = by_library(data)
    with TemporaryDirectory() as folder:
        theirs = by_calculix(own, told, data, Path(folder))
        ours, other = frequencies(own), frequencies(theirs)
    for one, body in zip(own.bodies, theirs.bodies, strict=True):
        print(f"{one.name}: {one.mass.shape[0]} dofs")
        for name in ("stiffness", "mass"):
            a, b = getattr(one, name), getattr(body, name)
            off = abs(a - b).max() / abs(a).max()
            print(f"  {name}: largest difference {off:.1e} of the largest entry")
    print("k over middle, mode, library Hz, CalculiX Hz, difference")
    for k, row, there in zip(STIFFNESS, ours, other, strict=True):
        for mode, a, b in zip(own.modes, row, there, strict=True):
            print(f"{k:g} {mode} {a:.4f} {b:.4f} {b / a - 1.0:+.1e}")
    print(f"largest difference {np.abs(other / ours - 1.0).max():.1e}")


if __name__ == "__main__":
    main()
