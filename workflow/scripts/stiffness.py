"""kn and kt over all forces and structures, beside published ones -> stiffness.nc."""

import pandas as pd
from _cli import run
from bladeroot import artifacts
from bladeroot.reproduction.published import published_stiffness
from bladeroot.stiffness.summary import summarise


def main(searches, fe_forces, published, output):
    by_structure = {}
    for found in map(artifacts.load, searches):
        by_structure.setdefault(found.attrs["structure"], []).append(found)
    measured = artifacts.load(fe_forces)
    printed = [published_stiffness(pd.read_csv(table).to_dict("list")) for table in published]
    artifacts.save(summarise(by_structure, measured, *printed), output, origin=measured)


if __name__ == "__main__":
    run(
        main,
        searches="many: the searches of every structure and force",
        fe_forces="fe_forces.nc",
        published="any: Table 5.2 as printed (CSV), of a campaign that states it",
        output="stiffness.nc",
    )
