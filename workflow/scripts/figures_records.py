"""Figures of the records: what was cut, and the curves over amplitude."""

from _cli import run
from bladeroot import artifacts
from bladeroot.figures import decay as decay_figures
from bladeroot.figures import records as record_figures
from bladeroot.figures.style import svg


def main(records, decays, cuts, backbones):
    shown = record_figures.representative([artifacts.load(record) for record in records])
    artifacts.save_text(svg(record_figures.cuts(shown)), cuts)
    curves = decay_figures.backbones([artifacts.load(decay) for decay in decays])
    artifacts.save_text(svg(curves), backbones)


if __name__ == "__main__":
    run(
        main,
        records="many: free decays",
        decays="many: curves over amplitude",
        cuts="figure of the cuts (SVG)",
        backbones="figure of frequency and damping over amplitude (SVG)",
    )
