"""Stick frequencies, from the plateaus of all records or from a table -> stick.nc."""

import json
from pathlib import Path

from _cli import run
from bladeroot import artifacts
from bladeroot.io.load import load_facts, load_of
from bladeroot.io.stick_rows import stick_table
from bladeroot.pooling.stick import stick_from_records
from bladeroot.pooling.stick_table import stick_from_table


def main(sources, campaign, load, settings, output):
    if Path(sources[0]).suffix == ".csv":
        known = load_of(json.loads(load))
        table = stick_table(Path(sources[0]), known)
        stick = stick_from_table(table, json.loads(settings)["table_error"], load_facts(known))
    else:
        plateaus = artifacts.load_records(sources, "plateau")
        stick = stick_from_records(plateaus)
        stick.attrs["simulated"] = max(plateau.attrs["simulated"] for plateau in plateaus)
    stick.attrs["campaign"] = campaign
    artifacts.save(stick, output, settings=settings)


if __name__ == "__main__":
    run(
        main,
        sources="many: lists of the records in each batch, or one stick.csv",
        campaign="the campaign's name",
        load="keys `load` and `force` of campaign.yaml, which say what a stick.csv gives (JSON)",
        settings="section `stick` of the configuration (JSON)",
        output="stick.nc",
    )
