"""From samples to independent log-phasors: frames of whole cycles, gathered where they are weak.

A record is cut into frames of equal length; each is fitted by least squares with a cosine, a sine
and a constant (and the same for other modes), so that frames at the very ends are as good as
any other and need no filter. As frames of one length share their matrix, the whole record is one
matrix product. For white noise the frames are independent with a known standard error:
everything that follows (derivatives, plateau) is then ordinary weighted regression.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Complex, Float
from numpy import ndarray

# Powers of time within a frame up to which growth and chirp of the mode are allowed for.
TAYLOR = 4


@dataclass(frozen=True)
class Phasors:
    """Log-phasors of blocks: ln A + i phase at `time`, `std` for either part."""

    time: Float[ndarray, " block"]
    log: Complex[ndarray, " block"]
    std: Float[ndarray, " block"]


@dataclass(frozen=True)
class Stretch:
    """Frames of one length and one angular frequency (rad per sample), from a first sample on."""

    first: int
    length: int
    frames: int
    angle: float


@dataclass(frozen=True)
class Frames:
    """The mode's phasor in the middle of each frame.

    `own` and `image` are what a term t^k/k! of the relative phasor (k = 1 ... TAYLOR, t from the
    frame's middle in s) and its conjugate add to the fitted phasor. `others`: phasors of the other
    modes, NaN where a frame cannot tell them apart.
    """

    time: Float[ndarray, " frame"]
    phasor: Complex[ndarray, " frame"]
    std: Float[ndarray, " frame"]
    omega: Float[ndarray, " frame"]
    own: Complex[ndarray, "frame power"]
    image: Complex[ndarray, "frame power"]
    others: Complex[ndarray, "other frame"]


def fit_frames(
    velocity: Float[ndarray, " sample"],
    sampling_Hz: float,
    noise: float,
    stretches: Sequence[Stretch],
    others: Sequence[complex] = (),
    usable: Bool[ndarray, " sample"] | None = None,
) -> Frames:
    """Least-squares phasors of the frames; those with few usable samples are left out.

    The model in a frame is v = Re[z exp(i omega t)] + constant, and the same again for each other
    mode exp(other t), other in rad/s, that differs by most of a cycle in a frame. The standard
    error is that of white noise with rms `noise`.
    """
    parts = []
    for stretch in stretches:
        stop = stretch.first + stretch.frames * stretch.length
        pieces = velocity[stretch.first : stop].reshape(stretch.frames, stretch.length)
        local = np.arange(stretch.length) - 0.5 * (stretch.length - 1)
        time = local / sampling_Hz
        omega = stretch.angle * sampling_Hz
        columns, told = _columns(time, omega, others)
        powers = time[:, None] ** np.arange(1, TAYLOR + 1) / np.cumprod(np.arange(1, TAYLOR + 1.0))
        waves = np.concatenate([powers * columns[:, :1], powers * columns[:, 1:2]], axis=1)
        solver = _solver(columns)
        z = pieces @ solver.T
        spread = np.full(stretch.frames, 0.5 * (solver[:2] ** 2).sum())
        own, image = (np.tile(part, (stretch.frames, 1)) for part in _answers(solver @ waves))
        if usable is not None:
            good = usable[stretch.first : stop].reshape(pieces.shape)
            count = good.sum(axis=1)
            spread[count < max(0.4 * stretch.length, 2 * columns.shape[1])] = np.inf
            for k in np.flatnonzero((count < stretch.length) & np.isfinite(spread)):
                solver = _solver(columns[good[k]])
                z[k] = solver @ pieces[k, good[k]]
                # amplitude and phase are known unequally: the worse counts
                spread[k] = np.linalg.eigvalsh(solver[:2] @ solver[:2].T)[1]
                own[k], image[k] = _answers(solver @ waves[good[k]])
        middle = stretch.first + np.arange(stretch.frames) * stretch.length + local[-1]
        apart = np.full((stretch.frames, len(others)), np.nan, complex)
        apart[:, told] = z[:, 3::2] + 1j * z[:, 4::2]
        parts.append(
            (
                middle / sampling_Hz,
                z[:, 0] + 1j * z[:, 1],
                noise * np.sqrt(spread),
                np.full(stretch.frames, omega),
                own,
                image,
                apart,
            )
        )
    values = [np.concatenate(column) for column in zip(*parts, strict=True)]
    seen = np.isfinite(values[2])
    time, phasor, std, angular, own, image, apart = (column[seen] for column in values)
    return Frames(time, phasor, std, angular, own, image, apart.T)


def _answers(
    fitted: Float[ndarray, "column wave"],
) -> tuple[Complex[ndarray, " power"], Complex[ndarray, " power"]]:
    """What the phasor answers to powers of time on the carrier, and on its conjugate."""
    answer = fitted[0] + 1j * fitted[1]
    cos, sin = answer[:TAYLOR], answer[TAYLOR:]
    return 0.5 * (cos - 1j * sin), 0.5 * (cos + 1j * sin)


def _solver(columns: Float[ndarray, "sample column"]) -> Float[ndarray, "column sample"]:
    """Least squares as a matrix: a whisper of damping for what too few samples cannot tell."""
    gram = columns.T @ columns
    gram[np.diag_indices(gram.shape[0])] *= 1.0 + 1e-12
    return np.linalg.solve(gram, columns.T)


def _columns(
    time: Float[ndarray, " sample"], omega: float, others: Sequence[complex]
) -> tuple[Float[ndarray, "sample column"], list[int]]:
    """Cosine, minus sine, constant, and those of the other modes that a frame can tell apart."""
    columns = [np.cos(omega * time), -np.sin(omega * time), np.ones_like(time)]
    taken, told = [omega, 0.0], []
    length = time.size * (time[1] - time[0])
    for number, other in enumerate(others):
        if min(abs(other.imag - one) for one in taken) * length > 0.7 * 2.0 * np.pi:
            wave = np.exp(other * time)
            columns += [wave.real, -wave.imag]
            taken.append(other.imag)
            told.append(number)
    return np.stack(columns, axis=1), told


def refined(others: Sequence[complex], frames: Frames) -> list[complex]:
    """The other modes' rates (rad/s), from how their phasors advance from frame to frame."""
    step = np.diff(frames.time)
    near = step < 1.5 * step.min()
    better = []
    for other, phasor in zip(others, frames.others, strict=True):
        clear = np.abs(phasor) > 6.0 * frames.std
        pairs = near & clear[1:] & clear[:-1]
        if pairs.sum() >= 3:
            still = phasor * np.exp(-1j * other.imag * frames.time)
            before, after = still[:-1][pairs], still[1:][pairs]
            power = np.abs(before) ** 2
            advance = np.log(np.vdot(before, after) / power.sum())
            other = 1j * other.imag + advance * power.sum() / (power @ step[pairs])
        better.append(complex(other))
    return better


def corrected(
    frames: Frames,
    near: slice,
    rate: Complex[ndarray, " near"],
    change: Complex[ndarray, " near"],
) -> Complex[ndarray, " near"]:
    """The phasors of the frames in a range, without what growth and chirp within them add.

    rate, change: first and second derivative of the log-phasor in the middle of each frame.
    """
    phasor = frames.phasor[near]
    delta = rate - 1j * frames.omega[near]
    terms = np.stack(
        [
            delta,
            delta**2 + change,
            delta**3 + 3 * delta * change,
            delta**4 + 6 * delta**2 * change + 3 * change**2,
        ],
        axis=1,
    )
    own = (frames.own[near] * terms).sum(axis=1)
    image = (frames.image[near] * terms.conj()).sum(axis=1)
    share = 1.0 + own
    for _ in range(2):
        true = phasor / share
        share = 1.0 + own + image * true.conj() / true
    return phasor / share


def gather(
    time: Float[ndarray, " frame"],
    phasor: Complex[ndarray, " frame"],
    std: Float[ndarray, " frame"],
    guess: Complex[ndarray, " frame"],
    target: float = 0.1,
    worst: float = 0.3,
    most: int = 1500,
) -> tuple[Phasors, Complex[ndarray, " block"]]:
    """Log-phasors of blocks of frames, and what `guess` misses of them.

    guess: the log-phasor as far as it is known; its amplitude, not the noisy one, sets the
    errors. A block is one frame (or the frames over `most`), and grows where the mode is weak
    until its standard error is about `target`, but not beyond a drop of the envelope by 0.4. The
    blocks end where the mode is lost: where that is not enough for `worst`. Raises ValueError
    where it is lost from the start.
    """
    share = std * np.exp(-guess.real)
    fall = -np.gradient(guess.real) if share.size > 1 else np.zeros(1)
    length = np.minimum((share / target) ** 2, 0.4 / np.maximum(fall, 1e-12))
    length = np.maximum(np.ceil(length), np.ceil(time.size / most)).astype(int)
    longer = np.flatnonzero(length > 1)
    single = int(longer[0]) if longer.size else time.size
    edges = list(range(single + 1))
    lengths = length.tolist()
    while edges[-1] < time.size and edges[-1] + lengths[edges[-1]] <= time.size:
        edges.append(edges[-1] + lengths[edges[-1]])
    stop = edges[-1]
    if stop == 0:
        raise ValueError("expected a mode that stands out of the noise, got none from the start")
    starts = np.array(edges[:-1])
    weight = share[:stop] ** -2.0
    total = np.add.reduceat(weight, starts)
    relative = np.add.reduceat(weight * phasor[:stop] * np.exp(-guess[:stop]), starts) / total
    known = np.add.reduceat(weight * guess[:stop], starts) / total
    centre = np.add.reduceat(weight * time[:stop], starts) / total
    miss = np.log(np.maximum(np.abs(relative), 1e-300)) + 1j * np.unwrap(np.angle(relative))
    spread = total**-0.5
    lost = np.flatnonzero(spread > worst)
    keep = slice(0, int(lost[0]) if lost.size else None)
    return Phasors(centre[keep], (known + miss)[keep], spread[keep]), miss[keep]
