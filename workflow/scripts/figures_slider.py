"""Figures 3.7 to 3.9 of the thesis: the model of 1 degree of freedom."""

from _cli import run
from bladeroot import artifacts
from bladeroot.figures.slider import slider
from bladeroot.figures.style import svg
from bladeroot.reproduction.slider_curves import slider_curves


def main(output):
    artifacts.save_text(svg(slider(slider_curves())), output)


if __name__ == "__main__":
    run(main, output="figure (SVG)")
