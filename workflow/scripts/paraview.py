"""Mesh and mode shapes of a structure for ParaView -> modes.vtu."""

from _cli import run
from bladeroot import artifacts
from bladeroot.files import whole_file
from bladeroot.rom.external.bodies import load_bodies
from bladeroot.rom.external.description import read_description
from bladeroot.rom.external.full import full_joint_of
from bladeroot.rom.file import is_matrices, load_structure
from bladeroot.rom.full import full_joint
from bladeroot.rom.paraview import mode_shapes, points_and_cells


def main(structure, mesh, prestress, force, stiffness, output):
    import meshio

    nodes = artifacts.load(mesh)
    if is_matrices(structure):
        full = full_joint_of(load_bodies(read_description(structure), nodes), nodes)
    else:
        full = full_joint(load_structure(structure), nodes, artifacts.load(prestress))
    kn, kt = (float(k) for k in stiffness)
    points, cells, cell_data = points_and_cells(nodes)
    shapes = mode_shapes(full, nodes, float(force), kn, kt)
    drawn = meshio.Mesh(points, cells, point_data=shapes, cell_data=cell_data)
    with whole_file(output) as part:
        meshio.write(part, drawn, file_format="vtu")


if __name__ == "__main__":
    run(
        main,
        structure="structure file (YAML)",
        mesh="mesh.nc",
        prestress="optional: prestress.nc; not for a structure of kind matrices",
        force="axial force in N",
        stiffness="many: kn and kt of a flank in N/m",
        output="modes.vtu",
    )
