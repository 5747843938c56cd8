"""Mean frequency and damping over amplitude for each mode and force -> curves.nc."""

from _cli import run
from bladeroot import artifacts
from bladeroot.decay.curves import mean_curves


def main(batches, campaign, output):
    curves = mean_curves(*(artifacts.load_records(batches, one) for one in ("decay", "plateau")))
    curves.attrs["campaign"] = campaign
    artifacts.save(curves, output)


if __name__ == "__main__":
    run(
        main,
        batches="many: lists of the records in each batch",
        campaign="the campaign's name",
        output="curves.nc",
    )
