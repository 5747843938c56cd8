"""Figures of the nonlinear joint of a campaign with records."""

from _cli import run
from bladeroot import artifacts
from bladeroot.figures import nonlinear
from bladeroot.figures.style import svg


def main(amplitudes, simulated, folder):
    found, marked = [artifacts.load(path) for path in amplitudes], simulated == "1"
    drawn = {
        "amplitude_curves": nonlinear.curves(found, marked),
        "amplitude_stiffness": nonlinear.stiffness(found, marked),
        "slip": nonlinear.slip(found, marked),
    }
    for name, figure in drawn.items():
        artifacts.save_text(svg(figure), f"{folder}/{name}.svg")


if __name__ == "__main__":
    run(
        main,
        amplitudes="many: inferences with amplitude, of every structure",
        simulated="1 when the records are simulated, else 0",
        folder="where the figures go",
    )
