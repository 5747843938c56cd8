"""Figures of the records: cuts, spectra, curves over amplitude, and their maps over force."""

from pathlib import Path

from _cli import run
from bladeroot import artifacts
from bladeroot.decay.spectra import FADE_CYCLES, before_and_after
from bladeroot.figures import amplitude_force
from bladeroot.figures import decay as decay_figures
from bladeroot.figures import records as record_figures
from bladeroot.figures import spectra as spectrum_figures
from bladeroot.figures.style import svg


def main(batches, curves, folder):
    decays = artifacts.load_records(batches, "decay")
    found = {decay.attrs["record"]: decay for decay in decays}
    told, not_shown = record_figures.worth_showing(
        artifacts.load_records(batches, "records", without=("velocity", "time")), found
    )
    samples = Path(batches[0]).parents[1] / "records"
    shown = [
        artifacts.load(samples / f"{record.attrs['record']}.nc").assign_attrs(record.attrs)
        for record in told
    ]
    mean = artifacts.load(curves)
    spectra = [
        before_and_after(
            record["velocity"].values.astype(float),
            record.attrs["sampling_Hz"],
            found[record.attrs["record"]],
            record["usable"].values.astype(bool),
        ).assign_attrs(reason=record.attrs["reason"])
        for record in shown
        # a few cycles have no spectrum to speak of
        if record.sizes["time"] * record.attrs["expected_Hz"]
        > 2 * FADE_CYCLES * record.attrs["sampling_Hz"]
    ]
    drawn = {
        "cuts": record_figures.cuts(shown, not_shown),
        "spectra": spectrum_figures.spectra(spectra, not_shown),
        "backbones": decay_figures.backbones(list(found.values())),
        "waterfall": amplitude_force.waterfall(mean),
        "amplitude_force": amplitude_force.maps(mean),
    }
    for name, figure in drawn.items():
        artifacts.save_text(svg(figure), f"{folder}/{name}.svg")


if __name__ == "__main__":
    run(
        main,
        batches="many: lists of the records in each batch",
        curves="curves.nc",
        folder="where the figures go",
    )
