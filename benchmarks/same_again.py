"""Records of one's own, changed as records differ: each must give its own curve again.

    python benchmarks/same_again.py CAMPAIGN [CAMPAIGN ...] [--only hum,noise]

A measured record has no truth, but its curve must not hang on where the record begins, on its
sampling frequency, a hum or a tone, a knock, or a few wrong samples. Told are, for each change,
curves that are lost and points that lie beyond three errors (of both curves) and beyond 500 ppm in
frequency or 10 % in loss factor of the curve as it was. Some seconds a record. Noise that is added
is new: three errors are passed by chance, too.
"""

import argparse
import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
import xarray as xr
from bladeroot.decay.from_file import recorded
from bladeroot.decay.record import analyse
from bladeroot.io.campaign import load_campaign
from bladeroot.io.facts import record_facts
from bladeroot.signal.recording import Recording
from scipy import signal

TOLERANCE = {"frequency": 5e-4, "loss_factor": 0.1}
ERRORS = 3.0
HUM_HZ = 50.02
CUTTING, ESTIMATION = {"end": "noise"}, {"damping": "hysteretic"}
Change = Callable[[np.ndarray, float, float, np.random.Generator], tuple[np.ndarray, float]]


def hum(x, rate, mode_Hz, rng):
    """Mains of 1 % of the peak, and their third and fifth harmonic."""
    time = np.arange(x.size) / rate
    waves = (np.sin(2 * np.pi * HUM_HZ * k * time + k) / k for k in (1, 3, 5))
    return x + 0.01 * np.abs(x).max() * sum(waves), rate


def noise(x, rate, mode_Hz, rng):
    """White noise of 0.2 % of the peak."""
    return x + 0.002 * np.abs(x).max() * rng.standard_normal(x.size), rate


def pink_noise(x, rate, mode_Hz, rng):
    """1/f noise of 1 % of the peak."""
    spectrum = np.fft.rfft(rng.standard_normal(x.size))
    spectrum[1:] /= np.sqrt(np.arange(1, spectrum.size))
    spectrum[0] = 0.0
    made = np.fft.irfft(spectrum, x.size)
    return x + 0.01 * np.abs(x).max() * made / made.std(), rate


def sway(x, rate, mode_Hz, rng):
    """A cable that sways by 30 % of the peak at a fiftieth of the mode's frequency."""
    time = np.arange(x.size) / rate
    return x + 0.3 * np.abs(x).max() * np.sin(2 * np.pi * 0.02 * mode_Hz * time + 1.0), rate


def offset(x, rate, mode_Hz, rng):
    """An offset of three times the peak."""
    return x + 3.0 * np.abs(x).max(), rate


def half_rate(x, rate, mode_Hz, rng):
    """Every second sample, filtered, where ten a cycle are left."""
    if rate < 20.0 * mode_Hz:
        return x, rate
    return signal.decimate(x, 2, ftype="fir"), 0.5 * rate


def twice_the_rate(x, rate, mode_Hz, rng):
    """Twice as many samples."""
    return signal.resample_poly(x - x.mean(), 2, 1), 2.0 * rate


def late(x, rate, mode_Hz, rng):
    """From twenty cycles after the first loud sample on."""
    first = int(np.argmax(np.abs(x) > 0.3 * np.abs(x).max()))
    return x[first + int(20.0 * rate / mode_Hz) :], rate


def short(x, rate, mode_Hz, rng):
    """The first 30 %."""
    return x[: int(0.3 * x.size)], rate


def twelve_bits(x, rate, mode_Hz, rng):
    """In steps of a 2048th of the peak."""
    step = np.abs(x).max() / 2048.0
    return np.round(x / step) * step, rate


def wrong_samples(x, rate, mode_Hz, rng):
    """Three single samples off by the peak."""
    made = x.copy()
    made[rng.integers(x.size // 10, x.size // 2, 3)] += np.abs(x).max()
    return made, rate


def another_mode(x, rate, mode_Hz, rng):
    """A mode of half again the frequency and a loss factor of 0.5 %, as loud as the record."""
    time, at_Hz = np.arange(x.size) / rate, 1.5 * mode_Hz
    wave = np.sin(2 * np.pi * at_Hz * time) * np.exp(-np.pi * at_Hz * 0.005 * time)
    return x + np.abs(x).max() * wave, rate


def tone(x, rate, mode_Hz, rng):
    """A steady line of 0.3 % of the peak, 4 % above the mode."""
    time = np.arange(x.size) / rate
    return x + 0.003 * np.abs(x).max() * np.sin(2 * np.pi * 1.04 * mode_Hz * time), rate


def knock(x, rate, mode_Hz, rng):
    """Noise of 1 % of the peak in 2 % of the record, from a quarter of it on."""
    made, count = x.copy(), x.size // 50
    made[x.size // 4 :][:count] += 0.01 * np.abs(x).max() * rng.standard_normal(count)
    return made, rate


def dropout(x, rate, mode_Hz, rng):
    """Three cycles in which one value is held, 60 cycles after the first loud sample."""
    made, first = x.copy(), int(np.argmax(np.abs(x) > 0.3 * np.abs(x).max()))
    first = min(first + int(60.0 * rate / mode_Hz), x.size - 1)
    made[first : first + int(3.0 * rate / mode_Hz)] = x[first]
    return made, rate


def drift(x, rate, mode_Hz, rng):
    """A sensor that warms up: the peak once more, falling over a seventh of the record."""
    return x + np.abs(x).max() * np.exp(-np.arange(x.size) / (0.15 * x.size)), rate


def padded(x, rate, mode_Hz, rng):
    """Zeros behind the record, 30 % of its length."""
    return np.concatenate([x, np.zeros(int(0.3 * x.size))]), rate


CHANGES: dict[str, Change] = {
    one.__name__: one
    for one in (
        hum, noise, pink_noise, sway, offset, half_rate, twice_the_rate, late, short, twelve_bits,
        wrong_samples, another_mode, tone, knock, dropout, drift, padded,
    )
}  # fmt: skip


@dataclass
class Row:
    """Of one change: curves, those that are lost, and the worst of those that differ."""

    curves: int = 0
    lost: list[str] = field(default_factory=list)
    off: list[tuple[float, float, str]] = field(default_factory=list)


def compared(before: xr.Dataset, after: xr.Dataset) -> tuple[float, float]:
    """Share of the common points that lie beyond both limits, and the largest miss in errors."""
    level = np.log(before["amplitude"].values)
    order = np.argsort(after["amplitude"].values)
    at = np.log(after["amplitude"].values[order])
    common = (level >= at[0]) & (level <= at[-1])
    share, worst = 0.0, 0.0
    for name, tolerance in TOLERANCE.items():
        value, error = (
            np.interp(level[common], at, after[one].values[order]) for one in (name, f"{name}_std")
        )
        was = before[name].values[common]
        miss = np.abs(value - was) / np.hypot(error, before[f"{name}_std"].values[common])
        far = (miss > ERRORS) & (np.abs(value / was - 1.0) > tolerance)
        if far.any():
            share, worst = max(share, float(far.mean())), max(worst, float(miss[far].max()))
    return share, worst


def curves(recording: Recording, known: dict) -> xr.Dataset:
    """Of a record as the workflow makes them."""
    return analyse(recording, known, CUTTING, ESTIMATION)[1]


def records(folder: Path) -> Iterator[tuple[str, Recording, dict]]:
    """Of a campaign: name, recording, and what the sheet says."""
    campaign = load_campaign(folder)
    for row in campaign.records:
        known = record_facts(campaign, row)
        yield row["record"], recorded(campaign.folder / row["file"], known), known


def tried(folders: list[Path], names: list[str]) -> dict[str, Row]:
    """All records of campaigns under changes by name."""
    rows = {name: Row() for name in names}
    for folder in folders:
        for record, recording, known in records(folder):
            before = curves(recording, known)
            if not before.sizes["point"]:
                continue
            for number, name in enumerate(names):
                rng = np.random.default_rng(number)
                x, rate = CHANGES[name](
                    recording.samples, recording.sampling_Hz, known["expected_Hz"], rng
                )
                none = np.zeros(0, int)
                changed = replace(recording, samples=x, sampling_Hz=rate, lost=none, over=none)
                after = curves(changed, known)
                rows[name].curves += 1
                if not after.sizes["point"]:
                    rows[name].lost.append(f"{record}: {after.attrs['reason'][:90]}")
                    continue
                share, worst = compared(before, after)
                if share:
                    rows[name].off.append((worst, share, record))
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("campaigns", type=Path, nargs="+", help="folders with campaign.yaml")
    parser.add_argument("--only", default=",".join(CHANGES), help="changes, by commas")
    chosen = parser.parse_args()
    for name, row in tried(chosen.campaigns, chosen.only.split(",")).items():
        print(f"{name}: {row.curves} curves, {len(row.lost)} lost, {len(row.off)} differ")
        print(*(f"    lost: {text}" for text in row.lost), sep="\n", end="\n" * bool(row.lost))
        for worst, share, record in sorted(row.off, reverse=True)[:5]:
            print(f"    {record}: {share:.0%} of its points, up to {worst:.1f} stated errors")


if __name__ == "__main__":
    main()
