"""Findings of all records, and the second opinion on each -> integrity.nc."""

from _cli import run
from bladeroot import artifacts
from bladeroot.decay.judgement import judgement


def main(batches, campaign, output):
    records = artifacts.load_records(batches, "records", without=("velocity", "time"))
    others = (artifacts.load_records(batches, stage) for stage in ("decay", "plateau"))
    judged = judgement(records, *others)
    judged.attrs["campaign"] = campaign
    artifacts.save(judged, output)


if __name__ == "__main__":
    run(
        main,
        batches="many: lists of the records in each batch",
        campaign="the campaign's name",
        output="integrity.nc",
    )
