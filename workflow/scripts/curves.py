"""Mean frequency and damping over amplitude for each mode and force -> curves.nc."""

from _cli import run
from bladeroot import artifacts
from bladeroot.pooling.curves import mean_curves
from bladeroot.pooling.groups import group_differences


def main(batches, campaign, output):
    decays = artifacts.load_records(batches, "decay", without=("pff_*",))
    plateaus = artifacts.load_records(batches, "plateau", without=("onset_*", "limit_*"))
    curves = mean_curves(decays, plateaus)
    rejected = [str(one["verdict"].values).startswith("rejected") for one in plateaus]
    differences = group_differences(decays, rejected)
    if differences is not None:
        curves = curves.merge(differences)
    curves.attrs["campaign"] = campaign
    artifacts.save(curves, output)


if __name__ == "__main__":
    run(
        main,
        batches="many: lists of the records in each batch",
        campaign="the campaign's name",
        output="curves.nc",
    )
