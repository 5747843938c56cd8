"""From samples to independent log-phasors: frames of whole cycles, gathered where they are weak.

A record is cut into frames of equal length; each is fitted by least squares with a cosine, a sine
and a constant, so that frames at the very ends are as good as any other and need no filter. As
frames of one length share their matrix, the whole record is one matrix product. For white noise the
frames are independent with a known standard error: everything that follows (derivatives, plateau)
is then ordinary weighted regression.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Complex, Float, Int
from numpy import ndarray

# Growth and chirp of the mode within a frame are allowed for up to this power of time.
TAYLOR_ORDER = 4
# Standard error of a block's ln A and phase.
WANTED_STD = 0.1  # frames are joined into a block until about this is reached
WORST_STD = 0.3  # the blocks end before the first one that is worse
_NO_PHASOR = -100.0  # ln of a phasor of zero: small enough to count as lost, without overflow


@dataclass(frozen=True)
class Phasors:
    """Log-phasors of blocks: ln A + i phase at `time`, `std` for either part."""

    time: Float[ndarray, " block"]
    log: Complex[ndarray, " block"]
    std: Float[ndarray, " block"]

    @property
    def rows(self) -> Float[ndarray, "2 block"]:
        """Log-amplitude and phase as rows, as splines take them."""
        return np.stack([self.log.real, self.log.imag])

    def first(self, count: int) -> "Phasors":
        """So many blocks from the start."""
        return Phasors(self.time[:count], self.log[:count], self.std[:count])


@dataclass(frozen=True)
class FrameGrid:
    """Frames of one length and one angular frequency (rad per sample), from a first sample on."""

    first: int
    length: int
    frames: int
    angle: float


@dataclass(frozen=True)
class Frames:
    """The mode's phasor in the middle of each frame.

    `own` and `image` are what a term t^k/k! of the relative phasor and its conjugate add to the
    fitted phasor (k = 1 ... `TAYLOR_ORDER`, t in s from the frame's middle).
    """

    time: Float[ndarray, " frame"]
    phasor: Complex[ndarray, " frame"]
    std: Float[ndarray, " frame"]
    omega: Float[ndarray, " frame"]
    own: Complex[ndarray, "frame power"]
    image: Complex[ndarray, "frame power"]


def fit_frames(
    velocity: Float[ndarray, " sample"],
    sampling_Hz: float,
    noise: float,
    grids: Sequence[FrameGrid],
    usable: Bool[ndarray, " sample"] | None = None,
) -> Frames:
    """Least-squares phasors of the frames; those with few usable samples are left out.

    The model in a frame is v = Re[z exp(i omega t)] + constant. The standard error is that of
    white noise with rms `noise`.
    """
    total = sum(grid.frames for grid in grids)
    time, std, omega = np.empty((3, total))
    phasor, (own, image) = np.empty(total, complex), np.empty((2, total, TAYLOR_ORDER), complex)
    at = 0
    for grid in grids:
        here = slice(at, at + grid.frames)
        at = here.stop
        stop = grid.first + grid.frames * grid.length
        pieces = velocity[grid.first : stop].reshape(grid.frames, grid.length)
        local = np.arange(grid.length) - 0.5 * (grid.length - 1)
        moment, turn = local / sampling_Hz, grid.angle * local
        omega[here] = grid.angle * sampling_Hz
        columns = np.stack([np.cos(turn), -np.sin(turn), np.ones_like(turn)], axis=1)
        powers = np.cumprod(moment[:, None] / np.arange(1, TAYLOR_ORDER + 1), axis=1)
        waves = np.concatenate([powers * columns[:, :1], powers * columns[:, 1:2]], axis=1)
        solver = _solver(columns)
        z = pieces @ np.ascontiguousarray(solver[:2].T)
        spread = np.full(grid.frames, 0.5 * (solver[:2] ** 2).sum())
        own[here], image[here] = _answers(solver @ waves)
        if usable is not None:
            good = usable[grid.first : stop].reshape(pieces.shape)
            count = good.sum(axis=1)
            spread[count < max(0.4 * grid.length, 2 * columns.shape[1])] = np.inf
            for k in np.flatnonzero((count < grid.length) & np.isfinite(spread)):
                solver = _solver(columns[good[k]])
                z[k] = solver[:2] @ pieces[k, good[k]]
                # amplitude and phase are known unequally: the worse counts
                spread[k] = np.linalg.eigvalsh(solver[:2] @ solver[:2].T)[1]
                own[here][k], image[here][k] = _answers(solver @ waves[good[k]])
        middle = grid.first + np.arange(grid.frames) * grid.length + local[-1]
        time[here], std[here] = middle / sampling_Hz, noise * np.sqrt(spread)
        phasor[here] = z[:, 0] + 1j * z[:, 1]
    seen = np.isfinite(std)
    return Frames(*(column[seen] for column in (time, phasor, std, omega, own, image)))


def _answers(fitted: Float[ndarray, "column wave"]) -> Complex[ndarray, "2 half"]:
    """What the first phasor that is fitted answers to relative phasors, and to their conjugates.

    The waves are those of the relative phasors' real parts, then of their imaginary ones.
    """
    real, imaginary = np.split(fitted[0] + 1j * fitted[1], 2)
    return np.stack([0.5 * (real - 1j * imaginary), 0.5 * (real + 1j * imaginary)])


def _solver(columns: Float[ndarray, "sample column"]) -> Float[ndarray, "column sample"]:
    """Least squares as a matrix, regularised a little for what too few samples cannot tell."""
    gram = columns.T @ columns
    gram[np.diag_indices(gram.shape[0])] *= 1.0 + 1e-12
    return np.linalg.solve(gram, columns.T)


def corrected(
    frames: Frames,
    near: slice,
    rate: Complex[ndarray, " near"],
    change: Complex[ndarray, " near"],
) -> Complex[ndarray, " near"]:
    """The phasors of the frames in a range, without what growth and chirp within them add.

    rate, change: first and second derivative of the log-phasor in the middle of each frame.
    """
    d, phasor = rate - 1j * frames.omega[near], frames.phasor[near]
    square = d * d
    terms = (
        d,
        square + change,
        d * (square + 3.0 * change),
        square * (square + 6.0 * change) + 3.0 * change * change,
    )
    terms = np.stack(terms, axis=1)
    grown = 1.0 + (frames.own[near] * terms).sum(axis=1)
    mirrored = (frames.image[near] * terms.conj()).sum(axis=1)
    known = np.where(phasor == 0.0, 1.0, phasor)
    share = grown
    for _ in range(2):
        guess = known / share
        share = grown + mirrored * guess.conj() / guess
    return phasor / share


def natural(
    rate: Float[ndarray, "2 point"], change: Float[ndarray, "2 point"], damping: str
) -> tuple[Float[ndarray, " point"], Float[ndarray, " point"]]:
    """omega_n (rad/s) and loss factor from the displacement's A'/A and omega and their changes.

    With hysteretic damping (3.11) omega_n^2 = omega^2 - A''/A and eta = -(2 omega A'/A + omega') /
    omega_n^2; with viscous damping omega_n^2 = omega^2 - A''/A + 2 (A'/A)^2 + A' omega'/(A omega),
    and the loss factor is twice the damping ratio. omega_n is NaN where its square is negative:
    the mode is lost there.
    """
    alpha, omega = rate
    decline, chirp = change
    square = omega**2 - decline - alpha**2  # A''/A = decline + alpha^2
    if damping == "viscous":
        square = square + 2.0 * alpha**2 + alpha * chirp / omega
    omega_n = np.sqrt(np.where(square > 0.0, square, np.nan))
    if damping == "viscous":
        return omega_n, -(2.0 * alpha + chirp / omega) / omega_n
    return omega_n, -(2.0 * omega * alpha + chirp) / omega_n**2


def gather(
    time: Float[ndarray, " frame"],
    phasor: Complex[ndarray, " frame"],
    std: Float[ndarray, " frame"],
    guess: Complex[ndarray, " frame"],
    most: int = 1500,
) -> tuple[Phasors, Complex[ndarray, " block"]]:
    """Log-phasors of blocks of frames, and what `guess` misses of them.

    guess: the log-phasor as far as it is known; its amplitude, not the noisy one, sets the
    errors. A block is one frame (or the frames over `most`), and grows where the mode is weak
    until its standard error is about `WANTED_STD`, but not beyond a fall of ln A by 0.4. The blocks
    end where the mode is lost: where a block is still worse than `WORST_STD`. Raises ValueError
    where it is lost from the start.
    """
    guess = np.maximum(guess.real, _NO_PHASOR) + 1j * guess.imag
    share = std * np.exp(-guess.real)
    edges = _edges(share, guess.real, -(-time.size // most))
    stop = edges[-1]
    if stop <= 0:  # nothing, or errors that are no numbers
        raise ValueError("expected a mode that stands out of the noise, got none from the start")
    starts = edges[:-1]
    weight = share[:stop] ** -2.0
    sums = np.add.reduceat(
        weight * np.stack([phasor[:stop] * np.exp(-guess[:stop]), guess[:stop]]), starts, axis=1
    )
    total, centre = np.add.reduceat(weight * np.stack([np.ones(stop), time[:stop]]), starts, axis=1)
    relative, known = sums / total
    centre = centre / total
    miss = np.log(np.maximum(np.abs(relative), 1e-300)) + 1j * np.unwrap(np.angle(relative))
    spread = total**-0.5
    lost = np.flatnonzero(spread > WORST_STD)
    keep = slice(0, int(lost[0]) if lost.size else None)
    return Phasors(centre[keep], (known + miss)[keep], spread[keep]), miss[keep]


def _edges(
    share: Float[ndarray, " frame"], level: Float[ndarray, " frame"], fewest: int
) -> Int[ndarray, " edge"]:
    """First frames of the blocks and one past the last: each as long as its first frame asks."""
    own = np.arange(share.size)
    before, after = np.maximum(own - 1, 0), np.minimum(own + 1, share.size - 1)
    fall = (level[before] - level[after]) / np.maximum(after - before, 1)
    length = np.minimum((share / WANTED_STD) ** 2, 0.4 / np.maximum(fall, 1e-12))
    asked = np.maximum(np.ceil(length), fewest).tolist()
    edges = [0]
    # nor where an error is no number
    while edges[-1] < share.size and edges[-1] + asked[edges[-1]] <= share.size:
        edges.append(edges[-1] + int(asked[edges[-1]]))
    return np.array(edges)
