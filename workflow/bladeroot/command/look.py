"""What is in a raw file: channels, spectrum, the decay cut out, and its curve."""

from pathlib import Path

import click
import numpy as np

from bladeroot.io.channel import moving
from bladeroot.io.read import as_stated, channels, read, stated_unit
from bladeroot.io.units import RAW, normal_unit
from bladeroot.signal.recording import Recording
from bladeroot.signal.spectral_peaks import peaks, spectrum

SHOWN_LINES = 8  # spectral lines that are listed, the strongest


@click.command()
@click.argument("file", type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option(
    "--mode",
    "mode_Hz",
    type=float,
    help="About where the mode lies, Hz; by default the strongest line.",
)
@click.option(
    "--channel", help="Name or number of a channel; by default the first that shows motion."
)
@click.option(
    "--sampling",
    "sampling_Hz",
    type=float,
    help="Sampling frequency, Hz, if the file does not say.",
)
@click.option("--unit", help="Unit of the numbers, such as mm/s, if the file does not say.")
@click.option("--quantity", help="velocity, displacement or acceleration.")
@click.option("--sensitivity", help='Of the sensor, such as "100 mV/g".')
@click.option(
    "--picture",
    type=click.Path(path_type=Path),
    help="Where the picture goes; by default FILE.look.png.",
)
def command(file, mode_Hz, channel, sampling_Hz, unit, quantity, sensitivity, picture) -> None:
    """Show what is in FILE: channels, spectrum, the decay cut out and its curve."""
    found = channels(file)
    click.echo(f"{file}")
    for entry in found:
        click.echo(f"  channel {entry}")
    shown = next(iter(moving(found)), None)
    named = channel or (str(shown.number) if shown else None)
    if len(found) > 1 and not channel:
        click.echo(f"  looking at channel {shown}; --channel names another")
    given = {"unit": unit, "quantity": quantity, "sensitivity": sensitivity}
    given |= _assumed(file, named, given)
    record = read(file, channel=named, sampling_Hz=sampling_Hz, **given)
    duration = record.samples.size / record.sampling_Hz
    click.echo(f"  {record.quantity}, {record.sampling_Hz:g} Hz, {duration:.3g} s")
    frequency, level = spectrum(record.samples, record.sampling_Hz)
    lines = peaks(frequency, level)
    for line_Hz, decibel in lines[:SHOWN_LINES]:
        click.echo(f"  line at {line_Hz:9.5g} Hz, {decibel:6.1f} dB")
    if mode_Hz is None and not lines:
        raise ValueError(
            f"no line stands out of the spectrum; --mode can say where to look ({file})"
        )
    from bladeroot.public.decay import of_recording, starts

    mode_Hz = mode_Hz or lines[0][0]
    begin = starts(record, mode_Hz)
    if len(begin) > 1:
        times = ", ".join(f"{start:.3g}" for start in begin)
        click.echo(f"  {len(begin)} decays, from {times} s on; the deepest is shown")
    decay = of_recording(record, mode_Hz, file.stem)
    click.echo(repr(decay))
    place = picture or file.with_name(f"{file.name}.look.png")
    _draw(record, frequency, level, decay).savefig(place, dpi=110)
    click.echo(f"picture: {place}")


def _assumed(file: Path, channel: str | None, given: dict[str, str | None]) -> dict[str, str]:
    """What is taken for a unit or sensitivity that nobody states: frequencies need neither."""
    found = as_stated(file, channel)
    own = stated_unit(found, f"{file}, channel {found.name!r}") or given["unit"]
    made = {}
    if own is None:
        made["unit"] = "m/s"
        click.echo(
            "  the file states no unit: its numbers are taken for m/s; --unit says otherwise"
        )
    elif normal_unit(own) in RAW and not given["sensitivity"]:
        made["sensitivity"] = f"1 m/s/{normal_unit(own)}"
        click.echo(f"  taken for {made['sensitivity']}; --sensitivity says otherwise")
    return made


def _draw(record: Recording, frequency, level, decay):
    """The record with its cut, its spectrum, and frequency and loss factor over amplitude."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10.0, 6.5), layout="constrained")
    (whole, lines), (rate, loss) = figure.subplots(2, 2)
    time = np.arange(record.samples.size) / record.sampling_Hz
    whole.plot(time, record.samples, color="0.6", linewidth=0.5)
    attrs = decay.free_decay.attrs
    if decay.free_decay.sizes["time"]:
        whole.axvspan(attrs["start_s"], attrs["end_s"], alpha=0.2)
    whole.set(
        xlabel="time in s", ylabel=f"{record.quantity} (SI)", title="record and the decay cut out"
    )
    lines.plot(frequency, level, linewidth=0.7)
    lines.axvline(attrs["expected_Hz"], color="C3", linewidth=0.8)
    lines.set(
        xlabel="frequency in Hz",
        ylabel="level in dB",
        ylim=(-100, 5),
        title="its spectrum",
    )
    curve, scale = decay.curves, "log" if decay.curves.sizes["point"] else "linear"
    for axis, name, label in (
        (rate, "frequency", "frequency in Hz"),
        (loss, "loss_factor", "loss factor"),
    ):
        axis.errorbar(*(curve[k] for k in ("amplitude", name, f"{name}_std")), fmt=".")
        axis.set(xscale=scale, xlabel="displacement amplitude in m", ylabel=label)
    return figure
