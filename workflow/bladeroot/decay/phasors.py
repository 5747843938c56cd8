"""From samples to independent log-phasors, one every whole number of cycles.

Each block of cycles is fitted by least squares with a cosine, a sine and a constant on the
carrier, so blocks at the very ends are as good as any other and need no filter. For white noise
the blocks are independent, with a known standard error: everything that follows (derivatives,
plateau) is then ordinary weighted regression.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float, Int
from numpy import ndarray


@dataclass(frozen=True)
class Phasors:
    """Log-phasors of blocks: ln A + i phase at `time`, `std` for either part."""

    time: Float[ndarray, " block"]
    log: Complex[ndarray, " block"]
    std: Float[ndarray, " block"]


def block_edges(
    log_carrier: Complex[ndarray, " sample"],
    sampling_Hz: float,
    noise: float,
    target: float = 0.1,
    most: int = 3000,
    largest_drop: float = 0.4,
) -> Int[ndarray, " edge"]:
    """First samples of blocks of whole carrier cycles (and one past the last).

    A block is one cycle (or the record's cycles over `most`), and grows where the mode is weak
    until its log-phasor's standard error is about `target`, but never beyond a drop of the
    envelope by `largest_drop`.
    """
    phase = log_carrier.imag
    cycles = np.floor((phase - phase[0]) / (2.0 * np.pi))
    starts = np.flatnonzero(np.diff(np.maximum.accumulate(cycles), prepend=-1.0) > 0)
    if starts.size < 2:
        return starts
    at = starts[:-1]
    samples_a_cycle = np.diff(starts)
    envelope = np.exp(log_carrier.real[at])
    rate = np.abs(np.gradient(log_carrier.real[starts]))[:-1] + 1e-12
    share = noise / np.maximum(noise, envelope)  # 1 where the mode has drowned
    wanted = 2.0 * (share / target) ** 2 / samples_a_cycle
    length = np.minimum(wanted, np.maximum(largest_drop / rate, 1.0))
    length = np.maximum(np.ceil(length), np.ceil(starts.size / most)).astype(int)
    edges = [0]
    while edges[-1] + length[min(edges[-1], length.size - 1)] < starts.size:
        edges.append(edges[-1] + int(length[min(edges[-1], length.size - 1)]))
    return starts[np.array(edges)]


def block_phasors(
    velocity: Float[ndarray, " sample"],
    sampling_Hz: float,
    log_carrier: Complex[ndarray, " sample"],
    edges: Int[ndarray, " edge"],
    noise: float,
    others: Sequence[Complex[ndarray, " sample"]] = (),
) -> Phasors:
    """Least-squares log-phasor of each block on the carrier exp(log_carrier).

    The model in a block is v = Re[z exp(log_carrier)] + constant, and the same again for the
    carriers of other modes, which must differ by a cycle or more in a block. The standard error
    is that of white noise with rms `noise`.
    """
    at, stop = edges[:-1], edges[-1]
    block = np.repeat(np.arange(at.size), np.diff(edges))
    level = log_carrier.real[at]
    carrier = np.exp(log_carrier[:stop] - level[block])
    columns = [carrier.real, -carrier.imag, np.ones(stop)]
    for other in others:
        wave = np.exp(other[:stop] - other.real[at][block])
        columns += [wave.real, -wave.imag]

    def total(values: Float[ndarray, " sample"]) -> Float[ndarray, " block"]:
        return np.add.reduceat(values, at)

    gram = np.empty((at.size, len(columns), len(columns)))
    right = np.empty((at.size, len(columns), 1))
    for i, column in enumerate(columns):
        right[:, i, 0] = total(column * velocity[:stop])
        for j in range(i + 1):
            gram[:, i, j] = gram[:, j, i] = total(column * columns[j])
    # a whisper of damping, for a carrier that has died away in a block
    gram += 1e-12 * np.trace(gram, axis1=1, axis2=2)[:, None, None] * np.eye(len(columns))
    inverse = np.linalg.inv(gram)
    value = (inverse @ right)[:, :, 0]
    z = value[:, 0] + 1j * value[:, 1]
    std = noise * np.sqrt(0.5 * (inverse[:, 0, 0] + inverse[:, 1, 1]))
    weight = np.abs(carrier) ** 2
    centre = total(weight * np.arange(stop)) / total(weight)
    floor = np.minimum(np.floor(centre).astype(int), log_carrier.size - 2)
    part = centre - floor
    log_at = log_carrier[floor] * (1.0 - part) + log_carrier[floor + 1] * part
    with np.errstate(divide="ignore"):
        log_z = np.log(np.maximum(np.abs(z), 1e-300)) + 1j * np.unwrap(np.angle(z))
    return Phasors(
        time=centre / sampling_Hz,
        log=log_at - level + log_z,
        std=std / np.maximum(_calm(np.abs(z)), 1e-300),
    )


def _calm(size: Float[ndarray, " block"], reach: int = 7) -> Float[ndarray, " block"]:
    """Running median: a block that noise makes large must not count as more certain for it."""
    padded = np.pad(size, min(reach, size.size - 1), mode="reflect")
    width = padded.size - size.size + 1
    return np.median(np.lib.stride_tricks.sliding_window_view(padded, width), axis=1)
