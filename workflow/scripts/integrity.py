"""Findings of all records, and the second opinion on each -> integrity.nc."""

from _cli import run
from bladeroot import artifacts
from bladeroot.pooling.judgement import judgement


def main(batches, campaign, output):
    not_asked = ("velocity", "time", "overview_*", "widening*")
    records = artifacts.load_records(batches, "records", without=not_asked)
    decays = artifacts.load_records(batches, "decay", without=("block_*",))
    plateaus = artifacts.load_records(batches, "plateau", without=("onset_*", "limit_*"))
    judged = judgement(records, decays, plateaus)
    judged.attrs["campaign"] = campaign
    artifacts.save(judged, output)


if __name__ == "__main__":
    run(
        main,
        batches="many: lists of the records in each batch",
        campaign="the campaign's name",
        output="integrity.nc",
    )
