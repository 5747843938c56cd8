"""Contact theory beside the identified and the published stiffness -> theory.nc."""

import pandas as pd
from _cli import run
from bladeroot import artifacts
from bladeroot.contact.published import published_stiffness
from bladeroot.contact.theory import theory


def main(stiffness, parameters, published, output):
    identified = artifacts.load(stiffness)
    values = pd.read_csv(parameters, index_col="name")["value"].to_dict()
    compared = theory(
        values,
        identified["force"].values,
        stiffness=identified,
        published=published_stiffness(pd.read_csv(published).to_dict("list")),
    )
    artifacts.save(compared, output, origin=identified)


if __name__ == "__main__":
    run(
        main,
        stiffness="stiffness.nc",
        parameters="parameters of the contact (CSV)",
        published="Table 5.2 as printed (CSV)",
        output="theory.nc",
    )
