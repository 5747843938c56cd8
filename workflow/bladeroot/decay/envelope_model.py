"""All components of a decay as one linear model: slowly varying envelopes on known carriers.

    v(t) = b(t) + sum over k of Re[z_k(t) exp(i omega_k t)] + noise

b and z_k are cubic splines on common, even knots, found together by least squares with a penalty on
their third differences, which bounds how fast each may vary: a component that has a near neighbour
varies slowly, or the two would be one. The carriers' products repeat from knot to knot but for a
turn of phase, so the cost of a record is that of one matrix product and a banded solution.
"""

from dataclasses import dataclass
from typing import no_type_check

import numpy as np
from jaxtyping import Bool, Complex, Float
from numpy import ndarray
from scipy.linalg import lapack

from bladeroot.compiled import njit
from bladeroot.signal.banded import inverse_band

# The envelope of a component varies no faster than this part of its distance to the next one.
SHARE = 0.35
# Splines alive in an interval between knots, and what each weighs in its middle.
ALIVE = 4
_MIDDLE = np.array([1.0, 23.0, 23.0, 1.0]) / 48.0
# Penalty (over an interval's own weight) that carries the splines over samples without weight.
LEAST = 1e-6
# What is added to the diagonal (relative) against rounding.
RIDGE = 1e-13


@dataclass(frozen=True)
class Envelopes:
    """Coefficients of the baseline (column 0) and of each line's envelope (real, imaginary part).

    `design` is an interval's samples by its columns, `turn` each line's phase factor in the
    intervals' middles; `factor` is the normal matrix's Cholesky factor, in its band.
    """

    lines_Hz: Float[ndarray, " line"]
    spacing: int
    samples: int
    coefficient: Float[ndarray, "knot column"]
    design: Float[ndarray, "sample alive_column"]
    turn: Complex[ndarray, "interval line"]
    factor: Float[ndarray, "unknown width"]

    def waves(self, lines: list[int] | None = None, base: bool = True) -> Float[ndarray, " sample"]:
        """The sum of some lines (all, unless told), and of the baseline."""
        kept = np.zeros(self.coefficient.shape[1], bool)
        kept[0] = base
        for k in range(self.lines_Hz.size) if lines is None else lines:
            kept[1 + 2 * k : 3 + 2 * k] = True
        c = np.where(kept, self.coefficient, 0.0)
        count = len(self.turn)
        local = np.stack([c[a : a + count] for a in range(ALIVE)], axis=1)
        z = (local[..., 1::2] + 1j * local[..., 2::2]) * self.turn[:, None]
        local[..., 1::2], local[..., 2::2] = z.real, z.imag
        return (local.reshape(count, -1) @ self.design.T).ravel()[: self.samples]

    def envelope(self, line: int) -> Complex[ndarray, " interval"]:
        """A line's envelope in the middle of each interval, against its carrier."""
        z = self.coefficient[:, 1 + 2 * line] + 1j * self.coefficient[:, 2 + 2 * line]
        return sum(share * z[a : a + len(self.turn)] for a, share in enumerate(_MIDDLE))

    def variance(self, line: int) -> Float[ndarray, " interval"]:
        """Variance of either part of `envelope` (the larger), for noise of unit variance."""
        inverse = inverse_band(self.factor)
        count, columns = len(self.turn), self.coefficient.shape[1]
        parts = np.zeros((2, count))
        for part in (0, 1):
            for a in range(ALIVE):
                for b in range(a + 1):
                    row = (np.arange(count) + b) * columns + 1 + 2 * line + part
                    twice = 1.0 if a == b else 2.0
                    parts[part] += twice * _MIDDLE[a] * _MIDDLE[b] * inverse[row, (a - b) * columns]
        return parts.max(axis=0)


def demodulated(
    velocity: Float[ndarray, " sample"],
    sampling_Hz: float,
    lines_Hz: Float[ndarray, " line"],
    spacing: int,
    usable: Bool[ndarray, " sample"] | None = None,
    base_Hz: float = 0.0,
    course: Complex[ndarray, "line knot"] | None = None,
    beside: Float[ndarray, " other"] | None = None,
) -> Envelopes:
    """The envelopes of all lines and the baseline in a decay, knots every `spacing` samples.

    base_Hz: what is slower than that belongs to the baseline. beside: further lines that bound how
    fast the envelopes may vary, though they are not fitted.
    course: what is known of the envelopes' logarithms at the knots; then it is the ratio to that
    which is penalised, and a decay or a drift of frequency costs nothing.
    """
    intervals, columns = -(-velocity.size // spacing), 2 * lines_Hz.size + 1
    omega = 2.0 * np.pi * lines_Hz / sampling_Hz
    local = np.arange(spacing) - 0.5 * (spacing - 1)
    carriers = np.ones((spacing, columns))
    carriers[:, 1::2], carriers[:, 2::2] = (
        np.cos(np.outer(local, omega)),
        -np.sin(np.outer(local, omega)),
    )
    design = (_splines(spacing)[:, :, None] * carriers[:, None]).reshape(spacing, -1)
    turn = np.exp(1j * np.outer(np.arange(intervals) * spacing + 0.5 * (spacing - 1), omega))
    weight = np.zeros(intervals * spacing, bool)
    weight[: velocity.size] = True if usable is None else usable
    weight = weight.reshape(intervals, spacing)
    padded = np.zeros(intervals * spacing)
    padded[: velocity.size] = velocity
    padded = padded.reshape(intervals, spacing) * weight
    gram = design.T @ design
    band = np.zeros(((intervals + ALIVE - 1) * columns, ALIVE * columns))
    whole = weight.all(axis=1)
    _assemble(band, gram, turn, np.flatnonzero(whole))
    for k in np.flatnonzero(~whole):
        own = design[weight[k]]
        _assemble(band, own.T @ own, turn, np.array([k]))
    right = np.zeros((intervals + ALIVE - 1, columns))
    told = (padded @ design).reshape(intervals, ALIVE, columns)
    z = (told[..., 1::2] + 1j * told[..., 2::2]) * turn.conj()[:, None]
    told[..., 1::2], told[..., 2::2] = z.real, z.imag
    for a in range(ALIVE):
        right[a : a + intervals] += told[:, a]
    every = lines_Hz if beside is None else np.concatenate([lines_Hz, beside])
    stiffness = _stiffness(every, spacing, sampling_Hz, base_Hz)[:columns]
    ratio = np.ones((columns, intervals + ALIVE - 1), complex)
    if course is not None:
        ratio[1::2] = ratio[2::2] = np.exp(-course)
    _penalise(band, ratio, stiffness)
    band[:, 0] *= 1.0 + RIDGE
    factor, failed = lapack.dpbtrf(band.T, lower=1, overwrite_ab=1)
    if failed:
        raise ValueError("the equations of the components are singular: no usable samples?")
    coefficient = lapack.dpbtrs(factor, right.ravel(), lower=1)[0].reshape(-1, columns)
    return Envelopes(lines_Hz, spacing, velocity.size, coefficient, design, turn, factor.T)


def _splines(count: int) -> Float[ndarray, "sample alive"]:
    """The cubic B-splines alive in an interval, at its samples."""
    u = (np.arange(count) + 0.5) / count
    return np.stack(
        [(1 - u) ** 3, 3 * u**3 - 6 * u**2 + 4, -3 * u**3 + 3 * u**2 + 3 * u + 1, u**3], axis=1
    ) / 6.0  # fmt: skip


def _stiffness(
    lines_Hz: Float[ndarray, " line"], spacing: int, sampling_Hz: float, base_Hz: float
) -> Float[ndarray, " column"]:
    """Penalty of each column's third differences, by how far the nearest other line lies."""
    every = np.concatenate([[0.0], lines_Hz])
    apart = np.abs(every[:, None] - every) + np.where(np.eye(every.size), np.inf, 0.0)
    nearest = apart.min(axis=1) if lines_Hz.size else np.array([sampling_Hz])
    bound = 2.0 * np.pi * spacing / sampling_Hz * SHARE * nearest
    bound[0] = max(bound[0], 2.0 * np.pi * spacing / sampling_Hz * base_Hz)
    penalty = np.maximum(bound**-6.0, LEAST) * 0.5 * spacing
    return np.concatenate([penalty[:1], np.repeat(penalty[1:], 2)])


@njit(cache=True)
@no_type_check
def _assemble(band, gram, turn, intervals):
    """Add the normal matrix of some intervals, made in their own phases, to the record's."""
    lines = turn.shape[1]
    columns = 2 * lines + 1
    for k in intervals:
        first = k * columns
        for p in range(lines + 1):
            u = 1.0 + 0.0j if p == 0 else turn[k, p - 1].conjugate()
            for r in range(lines + 1):
                v = 1.0 + 0.0j if r == 0 else turn[k, r - 1].conjugate()
                # as (x, y) of either line turn with u and v
                for a in range(4):
                    at = a * columns + (2 * p - 1 if p else 0)
                    for b in range(a + 1):
                        to = b * columns + (2 * r - 1 if r else 0)
                        if a == b and r > p:
                            continue
                        for i in range(2 if p else 1):
                            for j in range(2 if r else 1):
                                if a == b and p == r and j > i:
                                    continue
                                total = 0.0
                                for m in range(2 if p else 1):
                                    left = u.real if m == i else (-u.imag if i == 0 else u.imag)
                                    for n in range(2 if r else 1):
                                        right = v.real
                                        if n != j:
                                            right = -v.imag if j == 0 else v.imag
                                        total += left * gram[at + m, to + n] * right
                                band[first + to + j, at + i - to - j] += total


@njit(cache=True)
@no_type_check
def _penalise(band, ratio, stiffness):
    """Add the third differences of each column's coefficients times `ratio`, of unit size."""
    columns, knots = ratio.shape
    third = np.array([-1.0, 3.0, -3.0, 1.0])
    for j in range(knots - 3):
        for c in range(columns):
            size = 1.0 / abs(ratio[c, j + 1] * ratio[c, j + 2])
            for a in range(4):
                for b in range(a + 1):
                    both = stiffness[c] * size * third[a] * third[b]
                    z = both * (ratio[c, j + a].conjugate() * ratio[c, j + b])
                    row, lag = (j + b) * columns + c, (a - b) * columns
                    band[row, lag] += z.real
                    if c == 0 or a == b:
                        continue
                    # real and imaginary parts are columns 1, 2; 3, 4; ...
                    if c % 2 == 1:
                        band[row, lag + 1] += z.imag
                    else:
                        band[row, lag - 1] -= z.imag
