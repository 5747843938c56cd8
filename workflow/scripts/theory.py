"""Contact theory beside the identified and the published stiffness -> theory.nc."""

import pandas as pd
from _cli import run
from bladeroot import artifacts
from bladeroot.contact.theory import theory
from bladeroot.reproduction.published import published_stiffness


def main(stiffness, parameters, published, output):
    identified = artifacts.load(stiffness)
    values = pd.read_csv(parameters, index_col="name")["value"].to_dict()
    printed = [published_stiffness(pd.read_csv(table).to_dict("list")) for table in published]
    compared = theory(values, identified["force"].values, identified, *printed)
    artifacts.save(compared, output, origin=identified)


if __name__ == "__main__":
    run(
        main,
        stiffness="stiffness.nc",
        parameters="parameters of the contact (CSV)",
        published="any: Table 5.2 as printed (CSV), of a campaign that states it",
        output="theory.nc",
    )
