"""Mesh, prestress and Craig-Bampton reduction of beam and slots, once for all forces.

-> mesh.nc, prestress.nc, reduced.nc
"""

from _cli import run
from bladeroot import artifacts
from bladeroot.fem.mesh import build_mesh
from bladeroot.fem.prestress import prestress as static_stress
from bladeroot.rom.file import load_structure
from bladeroot.rom.reduction import reduce_structure


def main(structure, mesh, prestress, output):
    described = load_structure(structure)
    nodes = build_mesh(described)
    stress = static_stress(described, nodes)
    artifacts.save(nodes, mesh)
    artifacts.save(stress, prestress)
    artifacts.save(reduce_structure(described, nodes, stress), output)


if __name__ == "__main__":
    run(
        main,
        structure="structure file (YAML)",
        mesh="mesh.nc to write",
        prestress="prestress.nc to write",
        output="reduced.nc",
    )
