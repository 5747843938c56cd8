"""Figures 5.11 to 5.18 of the thesis, made with our structures."""

import pandas as pd
from _cli import run
from bladeroot import artifacts
from bladeroot.contact.published import published_stiffness
from bladeroot.figures import thesis_search as figures
from bladeroot.figures.style import svg


def main(searches, published, folder):
    table_5_2 = published_stiffness(pd.read_csv(published).to_dict("list"))
    found = [artifacts.load(search) for search in searches]
    drawn = {
        "solution_sets": figures.solution_sets(found[0], table_5_2),
        "thesis_search": figures.over_force(found, table_5_2),
    }
    for name, figure in drawn.items():
        artifacts.save_text(svg(figure), f"{folder}/{name}.svg")


if __name__ == "__main__":
    run(
        main,
        searches="many: the thesis's search with every structure, the main one first",
        published="Table 5.2 as printed (CSV)",
        folder="where the figures go",
    )
