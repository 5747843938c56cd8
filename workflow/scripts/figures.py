"""Figures that every campaign with a structure has, from the structure to contact theory."""

import pandas as pd
from _cli import run
from bladeroot import artifacts
from bladeroot.contact.published import published_stiffness
from bladeroot.figures import joint as joint_figures
from bladeroot.figures import stiffness as stiffness_figures
from bladeroot.figures import structure as structure_figures
from bladeroot.figures import theory as theory_figures
from bladeroot.figures.style import svg


def main(searches, stiffness, joints, theory, published, mesh, simulated, folder):
    marked = simulated == "1"
    table_5_2 = published_stiffness(pd.read_csv(published).to_dict("list"))
    identified, predicted = artifacts.load(stiffness), artifacts.load(theory)
    found = [artifacts.load(search) for search in searches]
    drawn = {
        "structure": structure_figures.side_view(artifacts.load(mesh)),
        "maps": stiffness_figures.maps(found, table_5_2, marked),
        "joint": joint_figures.joint(
            [artifacts.load(one) for one in joints], found, identified, marked
        ),
        "tractions": theory_figures.tractions(predicted),
        "against_normal_force": theory_figures.against_normal_force(predicted),
        "compared": theory_figures.compared(predicted, identified, marked),
    }
    for name, figure in drawn.items():
        artifacts.save_text(svg(figure), f"{folder}/{name}.svg")


if __name__ == "__main__":
    run(
        main,
        searches="many: searches of every structure and force",
        stiffness="stiffness.nc",
        joints="many: joint inferences with every structure",
        theory="theory.nc",
        published="Table 5.2 as printed (CSV)",
        mesh="mesh.nc of the main structure",
        simulated="1 when the records are simulated, else 0",
        folder="where the figures go",
    )
