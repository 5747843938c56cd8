"""The thesis's own search with each structure -> thesis_search/<structure>.nc."""

import json

import numpy as np
import pandas as pd
from _cli import run
from bladeroot import artifacts
from bladeroot.reproduction.published import published_stiffness
from bladeroot.reproduction.thesis_search import thesis_search


def main(parametrics, fe_forces, tables, settings, outputs):
    measured = artifacts.load(fe_forces)
    table_5_1, table_5_2 = (pd.read_csv(table) for table in tables)
    percent = json.loads(settings)["fe_bias_percent"]
    columns = [f"frequency_delta_{mode}_Hz" for mode in ("1B", "2B")]
    for model, output in zip(parametrics, outputs, strict=True):
        found = thesis_search(
            artifacts.load(model),
            measured,
            published_stiffness(table_5_2.to_dict("list")),
            table_5_1[columns].to_numpy(float),
            np.array([percent["1B"], percent["2B"]]) / 100,
        )
        artifacts.save(found, output, origin=measured, settings=settings)


if __name__ == "__main__":
    run(
        main,
        parametrics="many: parametric models with equal nodal springs, one a structure",
        fe_forces="fe_forces.nc",
        tables="many: Tables 5.1 and 5.2 as printed (CSV)",
        settings="section `search` of the configuration (JSON)",
        outputs="many: files to write, in the same order",
    )
