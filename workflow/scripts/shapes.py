"""The first mode shapes of the free beam, as numbers and drawn -> shapes.nc, modes.svg."""

from _cli import run
from bladeroot import artifacts
from bladeroot.fem.shapes import beam_shapes
from bladeroot.figures.shapes import mode_shapes
from bladeroot.figures.style import svg
from bladeroot.files import save_text
from bladeroot.rom.file import load_structure


def main(structure, mesh, output, drawing):
    solid = artifacts.load(mesh)
    shapes = beam_shapes(load_structure(structure), solid)
    artifacts.save(shapes, output)
    save_text(svg(mode_shapes(solid, shapes)), drawing)


if __name__ == "__main__":
    run(
        main,
        structure="structure file (YAML)",
        mesh="mesh.nc",
        output="shapes.nc",
        drawing="modes.svg",
    )
