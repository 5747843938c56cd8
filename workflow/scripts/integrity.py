"""Findings of all records, and the second opinion on each -> integrity.nc."""

from _cli import run
from bladeroot import artifacts
from bladeroot.decay.judgement import judgement


def main(records, decays, plateaus, campaign, output):
    judged = judgement(
        *([artifacts.load(one) for one in many] for many in (records, decays, plateaus))
    )
    judged.attrs["campaign"] = campaign
    artifacts.save(judged, output)


if __name__ == "__main__":
    run(
        main,
        records="many: free decays with their findings",
        decays="many: curves over amplitude, in the same order",
        plateaus="many: plateaus, in the same order",
        campaign="the campaign's name",
        output="integrity.nc",
    )
