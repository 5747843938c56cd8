"""Stick frequencies over the axial force -> figures/stick.svg."""

from _cli import run
from bladeroot import artifacts
from bladeroot.figures.stick import over_force
from bladeroot.figures.style import svg


def main(stick, fe_forces, simulated, output):
    interpolated = [artifacts.load(one) for one in fe_forces]
    drawn = over_force(artifacts.load(stick), *(interpolated or [None]), simulated == "1")
    artifacts.save_text(svg(drawn), output)


if __name__ == "__main__":
    run(
        main,
        stick="stick.nc",
        fe_forces="any: fe_forces.nc, where there is a structure",
        simulated="1 when the records are simulated, else 0",
        output="stick.svg",
    )
