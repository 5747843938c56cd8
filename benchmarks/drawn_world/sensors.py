"""From motion to numbers: cable sway, filters, noise, mains, offset and the digitiser."""

from dataclasses import dataclass, field

import numpy as np
from scipy import signal

from .laws import log_uniform

OVERSAMPLING = 3  # of the motion, before an anti-alias filter
TAPS = 240  # of the linear-phase filter of a delta-sigma converter, at the higher rate


@dataclass
class Chain:
    """What lies between the motion of a point and the file. Sizes are relative to the peak."""

    quantity: str
    filter: str
    corner: float  # of the anti-alias filter, over the sampling frequency
    order: int
    ac_Hz: float  # high-pass of first order; 0: none
    white_db: float
    flicker_Hz: float  # where 1/f noise is as strong as the white
    mains: list[tuple[float, float, float]]  # Hz, size over the white noise, phase
    sway: list[tuple[float, float, float, float]]  # Hz, size, decay time s, phase
    offset: float
    drift: float
    drift_s: float
    bits: int
    range: float  # full scale over the peak
    features: set[str] = field(default_factory=set)


def draw_chain(rng, quantity: str, first_Hz: float) -> Chain:
    features = set()
    kind = str(rng.choice(["delta-sigma", "butterworth", "none"], p=[0.6, 0.32, 0.08]))
    mains, sway, ac, offset, drift = [], [], 0.0, 0.0, 0.0
    if rng.random() < 0.4:
        base = rng.choice([50.0, 60.0]) + rng.normal() * 0.02
        for multiple in rng.choice([1, 2, 3, 5], rng.integers(1, 4), replace=False):
            size = log_uniform(rng, 0.1, 5.0)
            mains.append((base * multiple, size, rng.uniform(0, 2 * np.pi)))
        features.add("mains")
    if rng.random() < 0.35:
        for _ in range(rng.integers(1, 4)):
            wave = first_Hz * log_uniform(rng, 0.005, 0.15), log_uniform(rng, 1e-5, 3e-3)
            sway.append((*wave, log_uniform(rng, 0.2, 5.0), rng.uniform(0, 2 * np.pi)))
        features.add("cable sway")
    if rng.random() < 0.4:
        ac = first_Hz * log_uniform(rng, 0.002, 0.05)
        features.add("AC")
    elif rng.random() < 0.6:
        offset, drift = rng.normal() * 0.01, rng.normal() * log_uniform(rng, 1e-4, 5e-3)
        features.add("offset")
    headroom = log_uniform(rng, 1.15, 8.0)
    if rng.random() < 0.03:
        headroom = rng.uniform(0.5, 0.9)
        features.add("clipped")
    return Chain(
        quantity, kind, rng.uniform(0.3, 0.42), int(rng.integers(4, 9)), ac,
        rng.uniform(50.0, 95.0), first_Hz * log_uniform(rng, 0.005, 0.5), mains, sway,
        offset, drift, log_uniform(rng, 0.3, 10.0), int(rng.choice([12, 14, 16, 16, 24, 24])),
        headroom, features,
    )  # fmt: skip


def filtered(chain: Chain, motion, sampling_Hz):
    """The motion, OVERSAMPLING times as dense, through the filters and thinned."""
    rate = OVERSAMPLING * sampling_Hz
    if chain.filter == "delta-sigma":
        taps = signal.firwin(2 * TAPS + 1, 0.455 * sampling_Hz, fs=rate, window=("kaiser", 9.0))
        motion = signal.fftconvolve(motion, taps, mode="same")
    elif chain.filter == "butterworth":
        sos = signal.butter(chain.order, chain.corner * sampling_Hz, fs=rate, output="sos")
        motion = signal.sosfilt(sos, motion)
    motion = motion[::OVERSAMPLING]
    if chain.ac_Hz:
        b, a = signal.butter(1, chain.ac_Hz, "high", fs=sampling_Hz)
        # what stood before the block began has long been forgotten
        motion = signal.lfilter(b, a, motion, zi=signal.lfilter_zi(b, a) * motion[0])[0]
    return motion


def gain(chain: Chain, frequency_Hz: float, sampling_Hz: float) -> float:
    """By how much the filters change the amplitude of a mode."""
    rate, found = OVERSAMPLING * sampling_Hz, 1.0
    if chain.filter == "delta-sigma":
        taps = signal.firwin(2 * TAPS + 1, 0.455 * sampling_Hz, fs=rate, window=("kaiser", 9.0))
        found = abs(signal.freqz(taps, worN=[frequency_Hz], fs=rate)[1][0])
    elif chain.filter == "butterworth":
        sos = signal.butter(chain.order, chain.corner * sampling_Hz, fs=rate, output="sos")
        found = abs(signal.freqz_sos(sos, worN=[frequency_Hz], fs=rate)[1][0])
    if chain.ac_Hz:
        found /= np.hypot(1.0, chain.ac_Hz / frequency_Hz)
    return float(found)


def flicker(rng, size: int, sampling_Hz: float, corner_Hz: float):
    """Noise of 1/f power, as strong as white noise of unit variance at the corner."""
    frequency = np.fft.rfftfreq(size, 1.0 / sampling_Hz)
    spectrum = np.fft.rfft(rng.standard_normal(size))
    spectrum[0] = 0.0
    spectrum[1:] *= np.sqrt(corner_Hz / frequency[1:])
    return np.fft.irfft(spectrum, size)


def measured(rng, chain: Chain, clean, sampling_Hz: float, release_s: float):
    """Samples as the file holds them, and the standard deviation of their white noise.

    Args:
        clean: what comes out of the filters, in the chain's quantity (SI).
        release_s: when the blow falls, since the first sample.
    """
    peak = float(np.max(np.abs(clean)))
    time = np.arange(clean.size) / sampling_Hz
    white = peak * 10.0 ** (-chain.white_db / 20.0)
    out = clean + white * rng.standard_normal(clean.size)
    out += white * flicker(rng, clean.size, sampling_Hz, chain.flicker_Hz)
    for frequency, size, phase in chain.mains:
        out += white * size * np.cos(2 * np.pi * frequency * time + phase)
    since = np.maximum(time - release_s, 0.0)
    for frequency, size, decay, phase in chain.sway:
        wave = np.sin(2 * np.pi * frequency * since + phase) - np.sin(phase) * np.exp(-since / 0.05)
        out += peak * size * np.exp(-since / decay) * wave
    out += peak * (chain.offset + chain.drift * np.exp(-since / chain.drift_s))
    full = peak * chain.range + abs(peak * chain.offset)
    step = full / 2 ** (chain.bits - 1)
    out = np.clip(np.round(out / step), -(2 ** (chain.bits - 1)), 2 ** (chain.bits - 1) - 1) * step
    return out, float(np.hypot(white, step / np.sqrt(12.0)))
