"""kn and kt over all forces and structures, beside Table 5.2 -> stiffness.nc."""

import pandas as pd
from _cli import run
from bladeroot import artifacts
from bladeroot.contact.published import published_stiffness
from bladeroot.stiffness.summary import summarise


def main(searches, fe_forces, published, output):
    by_structure = {}
    for found in map(artifacts.load, searches):
        by_structure.setdefault(found.attrs["structure"], []).append(found)
    measured = artifacts.load(fe_forces)
    artifacts.save(
        summarise(
            by_structure, measured, published_stiffness(pd.read_csv(published).to_dict("list"))
        ),
        output,
        origin=measured,
    )


if __name__ == "__main__":
    run(
        main,
        searches="many: the searches of every structure and force",
        fe_forces="fe_forces.nc",
        published="Table 5.2 as printed (CSV)",
        output="stiffness.nc",
    )
