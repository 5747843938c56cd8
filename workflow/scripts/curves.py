"""Mean frequency and damping over amplitude for each mode and force -> curves.nc."""

from _cli import run
from bladeroot import artifacts
from bladeroot.decay.curves import mean_curves


def main(decays, stick, campaign, output):
    curves = mean_curves([artifacts.load(decay) for decay in decays], artifacts.load(stick))
    curves.attrs["campaign"] = campaign
    artifacts.save(curves, output)


if __name__ == "__main__":
    run(
        main,
        decays="many: curves over amplitude of every record",
        stick="stick.nc, which says what records are rejected",
        campaign="the campaign's name",
        output="curves.nc",
    )
