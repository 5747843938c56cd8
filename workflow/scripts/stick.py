"""Stick frequencies, from the plateaus of all records or from a table -> stick.nc."""

from pathlib import Path

import pandas as pd
from _cli import run
from bladeroot import artifacts
from bladeroot.decay.stick import stick_from_records, stick_from_table


def main(sources, campaign, output):
    if Path(sources[0]).suffix == ".csv":
        stick = stick_from_table(pd.read_csv(sources[0], skipinitialspace=True))
    else:
        plateaus = [artifacts.load(plateau) for plateau in sources]
        stick = stick_from_records(plateaus)
        stick.attrs["simulated"] = max(plateau.attrs["simulated"] for plateau in plateaus)
    stick.attrs["campaign"] = campaign
    artifacts.save(stick, output)


if __name__ == "__main__":
    run(
        main,
        sources="many: the plateau of every record, or one stick.csv",
        campaign="the campaign's name",
        output="stick.nc",
    )
