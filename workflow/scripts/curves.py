"""Mean frequency and damping over amplitude for each mode and force -> curves.nc."""

from _cli import run
from bladeroot import artifacts
from bladeroot.decay.curves import mean_curves
from bladeroot.decay.groups import group_differences


def main(decays, plateaus, campaign, output):
    read = [[artifacts.load(one) for one in many] for many in (decays, plateaus)]
    curves = mean_curves(*read)
    differences = group_differences(*read)
    if differences is not None:
        curves = curves.merge(differences)
    curves.attrs["campaign"] = campaign
    artifacts.save(curves, output)


if __name__ == "__main__":
    run(
        main,
        decays="many: curves over amplitude of every record",
        plateaus="many: plateaus of the same records, which say what is rejected",
        campaign="the campaign's name",
        output="curves.nc",
    )
