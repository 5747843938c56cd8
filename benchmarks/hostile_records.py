"""Arrays as a hostile user gives them to `br.ringdown`: what fails, warns or is wrong.

    python benchmarks/hostile_records.py --records 400 --seed 1
    python benchmarks/hostile_records.py --show 17              # one record
    python benchmarks/hostile_records.py --small                # some seconds

Record i has the seed SEED + i. Frequencies span four decades, 2.5 to 40 samples a cycle, 20 to
20,000 cycles; other modes lie 1 to 50 % away, and the caller names half of them. What is drawn was
chosen by somebody who had not read the library; nothing is shared with the other worlds.
"""

import argparse
import warnings
from collections import Counter
from dataclasses import dataclass, field

import bladeroot as br
import numpy as np
from scipy.signal import lfilter

MOST_SAMPLES, LEAST_SAMPLES = 100_000, 70
# Beyond both in a tenth of the middle half of a curve it is wrong.
TOLERANCE, STATED, PART = {"frequency": 0.005, "loss_factor": 0.5}, 6.0, 0.1
CLASSES = (
    "right", "wrong, told", "wrong in silence", "rejected", "refused", "warns", "fails",
)  # fmt: skip


@dataclass
class Record:
    """What the caller gives, the truth at each sample, and what it is made of."""

    samples: np.ndarray
    sampling_Hz: float
    mode_Hz: float
    other_modes_Hz: list[float]
    truth: dict[str, np.ndarray]
    made_of: list[str] = field(default_factory=list)


def tone(rate, count, first, frequency_Hz, loss, phase):
    """A decaying wave of unit size from a sample on."""
    time = np.maximum(np.arange(count) - first, 0) / rate
    wave = np.exp(-np.pi * frequency_Hz * loss * time)
    return np.where(
        np.arange(count) >= first, wave * np.cos(2 * np.pi * frequency_Hz * time + phase), 0.0
    )


def course(law, size, change, frequency_Hz, loss, time):
    """Amplitude over the first, frequency and loss factor at times after the release."""
    fall = np.exp(-np.pi * frequency_Hz * loss * time)
    if law == "power":  # losses grow with the amplitude
        kept = fall / (1.0 + size)
        amplitude = kept / (1.0 - size * kept)
        return amplitude, frequency_Hz * (1.0 - change * amplitude), loss * (1.0 + size * amplitude)
    if law == "dry":  # they grow as it falls
        amplitude = np.maximum((1.0 + size) * fall - size, 1e-9)
        lost = np.where(amplitude > 1e-8, loss * (1.0 + size / amplitude), np.nan)
        return amplitude, np.full(time.size, frequency_Hz), lost
    return fall, np.full(time.size, frequency_Hz), np.full(time.size, loss)


def faded(rng, rate, count, frequency_Hz, loss):
    """A mode whose drive, off its resonance, fades: its phasor."""
    time, decline = np.arange(count) / rate, np.pi * frequency_Hz * loss
    end, fade = rng.uniform(0.05, 0.3) * count / rate, rng.uniform(0.01, 0.3) / decline
    off = 2j * np.pi * rng.uniform(-2.0, 2.0) * frequency_Hz * loss
    drive = np.exp(off * time) * np.where(time < end, 1.0, np.exp(-(time - end) / fade))
    moved = lfilter([1.0 / rate], [1.0, -np.exp(-decline / rate)], drive)
    moved = moved + np.exp(-decline * time) / (decline + off)
    return moved / np.abs(moved[0])


def draw(seed: int) -> Record:
    """The record of a seed."""
    rng = np.random.default_rng([seed, 77])
    own_Hz = 10.0 ** rng.uniform(0.5, 4.0)
    a_cycle = [rng.uniform(2.5, 3.2), rng.uniform(3.2, 8.0), rng.uniform(8.0, 40.0)][
        rng.integers(3)
    ]
    rate, cycles = own_Hz * a_cycle, 20.0 * 1000.0 ** rng.uniform()
    count = int(np.clip(cycles * a_cycle, LEAST_SAMPLES, MOST_SAMPLES))
    nepers = 10.0 ** rng.uniform(-0.3, 1.2)
    loss = float(np.clip(nepers / (np.pi * count / a_cycle), 1e-5, 0.08))
    start = str(rng.choice(["at once", "at once", "quiet", "blow", "fading drive"]))
    law = str(rng.choice(["plain", "plain", "power", "dry"]))
    first = int(rng.uniform(0.02, 0.3) * count) if start in ("quiet", "blow") else 0
    own, made_of = np.arange(count), [f"{own_Hz:.4g} Hz", f"loss {loss:.2g}", start]
    if start == "fading drive":
        z = faded(rng, rate, count, own_Hz, loss)
        x = (z * np.exp(2j * np.pi * own_Hz / rate * own)).real
        truth = {"frequency": np.full(count, own_Hz), "loss_factor": np.full(count, loss)}
    else:
        size = 10.0 ** (rng.uniform(-3.0, -0.5) if law == "dry" else rng.uniform(-1.0, 1.0))
        time = np.maximum(own - first, 0) / rate
        amplitude, frequency, lost = course(law, size, rng.uniform(0, 0.01), own_Hz, loss, time)
        phase = 2 * np.pi * np.cumsum(np.where(own >= first, frequency, 0.0)) / rate
        x = np.where(own >= first, amplitude * np.cos(phase + rng.uniform(0, 6.3)), 0.0)
        truth = {"frequency": frequency, "loss_factor": lost}
        made_of.append(law)
    if start == "blow":
        width = int(max(3, rng.uniform(0.1, 0.5) * a_cycle))
        pulse = np.sin(np.pi * np.arange(width) / width) * rng.uniform(0.1, 1.0)
        x[first : first + width] += pulse[: count - first]
    others = beside(rng, x, rate, first, own_Hz, loss, made_of)
    x = spoilt(rng, x, rate, made_of)
    return Record(x, rate, own_Hz * (1 + rng.uniform(-0.01, 0.01)), others, truth, made_of)


def beside(rng, x, rate, first, own_Hz, loss, made_of):
    """Other modes, one with a harmonic near ours, and hum, in place; those that are named (Hz)."""
    named, count, top = [], x.size, float(np.abs(x).max())
    for _ in range(int(rng.choice([0, 0, 1, 1, 2]))):
        away = rng.uniform(0.01, 0.06) if rng.random() < 0.6 else rng.uniform(0.1, 0.5)
        line = own_Hz * (1.0 + rng.choice([-1, 1]) * away)
        if line > 0.49 * rate:
            continue
        size, lost = 10.0 ** rng.uniform(-2.5, 0.2), min(loss * 10.0 ** rng.uniform(-0.5, 0.5), 0.1)
        x += top * size * tone(rate, count, first, line, lost, rng.uniform(0, 6.3))
        known = rng.random() < 0.5
        named += [line * (1.0 + rng.uniform(-0.002, 0.002))] if known else []
        made_of.append(f"mode x{line / own_Hz:.3f}, {size:.2g}{' named' if known else ''}")
    if rng.random() < 0.2:
        order = int(rng.integers(2, 4))
        line, size = own_Hz / order * (1 + rng.uniform(-0.05, 0.05)), 10.0 ** rng.uniform(-1, 1)
        part, phase = 10.0 ** rng.uniform(-3.0, -0.7), rng.uniform(0, 6.3)
        lost = loss * 10.0 ** rng.uniform(-0.5, 0.5)
        x += top * size * tone(rate, count, first, line, lost, phase)
        x += top * size * part * tone(rate, count, first, order * line, lost, order * phase)
        named += [line] if rng.random() < 0.5 else []
        made_of.append(f"harmonic {order} x {line:.4g} Hz, {size * part:.2g}")
    if rng.random() < 0.2:
        for hum in (50.0, 100.0, 150.0):
            if hum < 0.5 * rate:
                phase = 2 * np.pi * hum / rate * np.arange(count) + rng.uniform(0, 6.3)
                x += top * 10.0 ** rng.uniform(-4, -1) * np.cos(phase)
        made_of.append("hum")
    return named


def spoilt(rng, x, rate, made_of):
    """The samples with noise, and mostly with a fault; m/s."""
    count, top = x.size, float(np.abs(x).max())
    noise = 10.0 ** rng.uniform(-5.0, -1.5)
    x = x + top * noise * rng.normal(size=count)
    top, fault = (
        float(np.abs(x).max()),
        str(rng.choice(["", "", "8 bits", "clipped", "zeros", "held"])),
    )
    first = int(rng.uniform(0.1, 0.9) * count)
    gap = slice(first, first + int(rng.uniform(0.001, 0.05) * count) + 1)
    if fault == "8 bits":
        x = np.round(x / top * 127) * top / 127
    elif fault == "clipped":
        x = np.clip(x, -top * rng.uniform(0.2, 0.9), top * rng.uniform(0.2, 0.9))
    elif fault == "zeros":
        x[gap] = 0.0
    elif fault == "held":
        x[gap] = x[first]
    if rng.random() < 0.15:
        x = x + top * rng.uniform(-3.0, 3.0)
        made_of.append("offset")
    made_of += [f"noise {noise:.1g}", *([fault] if fault else [])]
    return x * 10.0 ** rng.choice([-3.0, -3.0, -3.0, -9.0, -12.0, 0.0]) / top


def judged(record: Record) -> tuple[str, str]:
    """One of CLASSES, and what is behind it."""
    given = {"sampling_Hz": record.sampling_Hz, "quantity": "velocity"}
    given |= {"mode_Hz": record.mode_Hz, "other_modes_Hz": record.other_modes_Hz}
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        try:
            found = br.ringdown(record.samples, **given)
            repr(found)
        except ValueError as error:
            return "refused", str(error)
        except Exception as error:  # this is what is looked for
            return "fails", repr(error)
    if warned:
        return "warns", str(warned[0].message)
    if found.verdict != "usable":
        return "rejected", found.verdict
    curves, count = found.curves, found.curves.sizes["point"]
    time = curves["time"].values + found.free_decay.attrs["start_s"]
    middle, wrong = slice(count // 4, max(3 * count // 4, count // 4 + 1)), []
    for name, most in TOLERANCE.items():
        true = np.interp(
            time, np.arange(record.samples.size) / record.sampling_Hz, record.truth[name]
        )
        value, std = curves[name].values, curves[f"{name}_std"].values
        if not (np.isfinite(value).all() and (std > 0.0).all()):
            return "fails", f"{name} is no number, or has no error"
        off = (np.abs(value / true - 1.0) > most) & (np.abs(value - true) > STATED * std)
        wrong += [name] if off[middle].mean() > PART else []
    if not wrong:
        return "right", ""
    told = "; ".join(found.findings)
    return ("wrong, told" if told else "wrong in silence"), f"{' and '.join(wrong)}: {told}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--records", type=int, default=400)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--small", action="store_true", help="20 records")
    parser.add_argument("--show", type=int, nargs="*", default=[], help="only these seeds")
    chosen = parser.parse_args()
    last = chosen.seed + (20 if chosen.small else chosen.records)
    count = Counter()
    for seed in chosen.show or range(chosen.seed, last):
        record = draw(seed)
        name, why = judged(record)
        count[name] += 1
        if chosen.show or name in CLASSES[1:3] + CLASSES[5:]:
            print(f"{seed} {name}: {why[:200]} | {', '.join(record.made_of)}")
    print(", ".join(f"{name} {count[name]}" for name in CLASSES))


if __name__ == "__main__":
    np.seterr(divide="warn", invalid="warn")
    main()
