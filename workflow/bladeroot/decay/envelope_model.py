"""All components of a decay as one linear model: slowly varying envelopes on known carriers.

    v(t) = b(t) + sum over k of Re[z_k(t) exp(i omega_k t)] + noise

b and z_k are cubic splines on common, even knots, found together by least squares with a penalty on
their third differences, which bounds how fast each may vary: a component that has a near neighbour
varies slowly, or the two would be one. Against a carrier's phase at each knot all intervals have
the same matrix, so the cost of a record is that of one matrix product and a banded solution.

What rings beside the mode and is no line of its own (a steady line, a harmonic, a mode that dies
sooner) is a wave that is taken off, with its error (`Beside`).
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float
from numpy import ndarray
from scipy.linalg import lapack

from bladeroot.signal.banded import inverse_band

# How fast the envelopes may vary. A faster one would take in the line next to it.
ENVELOPE_BANDWIDTH = 0.35  # of the distance (Hz) from a component to the nearest other one
# The cubic B-splines, and what keeps their equations solvable.
SPLINES_ALIVE = 4  # splines that are not zero in an interval between knots
_MIDDLE_VALUES = np.array([1.0, 23.0, 23.0, 1.0]) / 48.0  # of these splines in its middle
LEAST_PENALTY = 1e-6  # over an interval's own weight: determines splines where samples do not
RIDGE = 1e-13  # added to the diagonal, relative to it, against rounding
# Standard error of what was taken off over the mode's amplitude: above it the mode counts as hidden
# and its curve ends.
HIDDEN_ABOVE = 0.3


@dataclass(frozen=True)
class Envelopes:
    """Coefficients of the baseline (column 0) and of each line's envelope (real, imaginary part).

    `design` maps an interval's coefficients to its samples, with each line's phase counted from
    the middle of the interval. `phase` is exp(i phase) of each carrier there. `factor` is the
    banded Cholesky factor of the normal matrix for coefficients against these phases.
    """

    lines_Hz: Float[ndarray, " line"]
    spacing: int
    samples: int
    coefficient: Float[ndarray, "knot column"]
    design: Float[ndarray, "sample alive_column"]
    phase: Complex[ndarray, "knot line"]
    factor: Float[ndarray, "unknown width"]

    @property
    def intervals(self) -> int:
        """Number of intervals between knots."""
        return len(self.phase) - SPLINES_ALIVE + 1

    @property
    def turn(self) -> Complex[ndarray, "interval line"]:
        """exp(i phase) of each line's carrier in the middle of each interval."""
        return self.phase[: self.intervals]

    def waves(self, lines: list[int] | None = None, base: bool = True) -> Float[ndarray, " sample"]:
        """The sum of some lines (None: of all), with the baseline unless `base` is False."""
        kept = np.zeros(self.coefficient.shape[1], bool)
        kept[0] = base
        for k in range(self.lines_Hz.size) if lines is None else lines:
            kept[1 + 2 * k : 3 + 2 * k] = True
        c = _times(np.where(kept, self.coefficient, 0.0), self.phase)
        local = np.concatenate([c[a : a + self.intervals] for a in range(SPLINES_ALIVE)], axis=1)
        return (local @ self.design.T).ravel()[: self.samples]

    def envelope(self, line: int) -> Complex[ndarray, " interval"]:
        """A line's envelope in the middle of each interval, against its carrier."""
        z = self.coefficient[:, 1 + 2 * line] + 1j * self.coefficient[:, 2 + 2 * line]
        return sum(share * z[a : a + self.intervals] for a, share in enumerate(_MIDDLE_VALUES))

    def variance(self, line: int) -> Float[ndarray, " interval"]:
        """Variance of the real or imaginary part of `envelope`, the larger, for unit noise."""
        inverse = inverse_band(self.factor)
        count, columns = self.intervals, self.coefficient.shape[1]
        knot = np.arange(count)
        # what a knot's two coefficients add to the real and to the imaginary part
        shares = []
        for a, share in enumerate(_MIDDLE_VALUES):
            z = share * self.phase[a : a + count, line]
            shares += [(a, 0, np.stack([z.real, -z.imag])), (a, 1, np.stack([z.imag, z.real]))]
        total = np.zeros((2, count))
        for n, (a, p, one) in enumerate(shares):
            for b, q, other in shares[: n + 1]:
                row = (knot + b) * columns + 1 + 2 * line + q
                twice = 1.0 if (a, p) == (b, q) else 2.0
                total += twice * one * other * inverse[row, (a - b) * columns + p - q]
        return total.max(axis=0)


@dataclass(frozen=True)
class Beside:
    """What was found beside the mode, as it is taken off.

    wave: m/s, at the record's samples. error: its standard error (m/s) at `time` (s), evenly
    spaced. finding: the finding's id. alike: how many cycles of the mode share the same error.
    """

    frequency_Hz: float
    wave: Float[ndarray, " sample"]
    time: Float[ndarray, " interval"]
    error: Float[ndarray, " interval"]
    finding: str
    remark: str
    alike: float = 1.0

    def over(self, mode: Complex[ndarray, " middle"], time: Float[ndarray, " middle"]) -> ndarray:
        """The wave's error over the mode's amplitude, at times (s)."""
        return np.interp(time, self.time, self.error) / np.maximum(np.abs(mode), 1e-300)

    def doubt(self, mode: Complex[ndarray, " middle"], time: Float[ndarray, " middle"]) -> ndarray:
        """`over` as an error of independent cycles, larger by the root of `alike`; 1 at most."""
        return np.minimum(self.over(mode, time) * np.sqrt(self.alike), 1.0)

    def hides(self, found: Envelopes, sampling_Hz: float) -> int:
        """Samples until the wave's error is more than `HIDDEN_ABOVE` of the mode."""
        mode = found.envelope(0)
        time = (np.arange(mode.size) + 0.5) * found.spacing / sampling_Hz
        hidden = np.flatnonzero(self.over(mode, time) > HIDDEN_ABOVE)
        return int(hidden[0]) * found.spacing if hidden.size else found.samples


def demodulated(
    velocity: Float[ndarray, " sample"],
    sampling_Hz: float,
    lines_Hz: Float[ndarray, " line"],
    spacing: int,
    base_Hz: float = 0.0,
    course: Complex[ndarray, "line knot"] | None = None,
    beside: Float[ndarray, " other"] | None = None,
) -> Envelopes:
    """The envelopes of all lines and the baseline in a decay, knots every `spacing` samples.

    base_Hz: what is slower than that belongs to the baseline. beside: frequencies (Hz) of further
    lines that bound how fast the envelopes may vary, though they are not fitted.
    course: logarithms of the envelopes at the knots, as far as known. The penalty then acts on the
    envelopes divided by exp(course), so that a decay or a drift of frequency is not penalised.
    """
    intervals, columns = -(-velocity.size // spacing), 2 * lines_Hz.size + 1
    knots, wide = intervals + SPLINES_ALIVE - 1, SPLINES_ALIVE * columns
    omega = 2.0 * np.pi * lines_Hz / sampling_Hz
    middle = 0.5 * (spacing - 1)
    phase = np.exp(1j * np.outer(np.arange(knots) * spacing + middle, omega))
    design = np.repeat(_splines(spacing)[:, :, None], columns, axis=2)
    since = np.arange(spacing)[:, None] - middle - np.arange(SPLINES_ALIVE) * spacing
    design[..., 1::2] *= np.cos(since[..., None] * omega)
    design[..., 2::2] *= -np.sin(since[..., None] * omega)
    design = design.reshape(spacing, wide)
    padded = np.zeros(intervals * spacing)
    padded[: velocity.size] = velocity
    padded = padded.reshape(intervals, spacing)
    band = np.zeros((knots * columns, wide))
    whole = velocity.size // spacing
    _add(band, design.T @ design, whole)
    if whole < intervals:
        last = design[: velocity.size - whole * spacing]
        _add(band[whole * columns :], last.T @ last)
    right = np.zeros((knots, columns))
    projected = (padded @ design).reshape(intervals, SPLINES_ALIVE, columns)
    for a in range(SPLINES_ALIVE):
        right[a : a + intervals] += projected[:, a]
    every = lines_Hz if beside is None else np.concatenate([lines_Hz, beside])
    stiffness = _stiffness(every, spacing, sampling_Hz, base_Hz)[:columns]
    ratio = np.ones((columns, knots), complex)
    ratio[1::2] = ratio[2::2] = phase.conj().T * (1.0 if course is None else np.exp(-course))
    _penalise(band.reshape(knots, columns, wide), ratio, stiffness)
    band[:, 0] *= 1.0 + RIDGE
    factor, failed = lapack.dpbtrf(band.T, lower=1, overwrite_ab=1)
    if failed:
        raise ValueError("the equations of the components are singular")
    coefficient = lapack.dpbtrs(factor, right.ravel(), lower=1)[0].reshape(-1, columns)
    coefficient = _times(coefficient, phase.conj())
    return Envelopes(lines_Hz, spacing, velocity.size, coefficient, design, phase, factor.T)


def _times(
    coefficient: Float[ndarray, "knot column"], factor: Complex[ndarray, "knot line"]
) -> Float[ndarray, "knot column"]:
    """The coefficients, each line's multiplied by complex factors."""
    z = (coefficient[:, 1::2] + 1j * coefficient[:, 2::2]) * factor
    made = coefficient.copy()
    made[:, 1::2], made[:, 2::2] = z.real, z.imag
    return made


def _splines(count: int) -> Float[ndarray, "sample alive"]:
    """The cubic B-splines that are not zero in an interval, at its samples."""
    u = (np.arange(count) + 0.5) / count
    return np.stack(
        [(1 - u) ** 3, 3 * u**3 - 6 * u**2 + 4, -3 * u**3 + 3 * u**2 + 3 * u + 1, u**3], axis=1
    ) / 6.0  # fmt: skip


def _stiffness(
    lines_Hz: Float[ndarray, " line"], spacing: int, sampling_Hz: float, base_Hz: float
) -> Float[ndarray, " column"]:
    """Weight of each column's third differences, by the distance to the nearest other line."""
    every = np.concatenate([[0.0], lines_Hz])
    apart = np.abs(every[:, None] - every) + np.where(np.eye(every.size), np.inf, 0.0)
    nearest = apart.min(axis=1) if lines_Hz.size else np.array([sampling_Hz])
    bound = 2.0 * np.pi * spacing / sampling_Hz * ENVELOPE_BANDWIDTH * nearest
    bound[0] = max(bound[0], 2.0 * np.pi * spacing / sampling_Hz * base_Hz)
    penalty = np.maximum(bound**-6.0, LEAST_PENALTY) * 0.5 * spacing
    return np.concatenate([penalty[:1], np.repeat(penalty[1:], 2)])


def _add(
    band: Float[ndarray, "unknown width"],
    gram: Float[ndarray, "alive_column alive_column"],
    intervals: int = 1,
) -> None:
    """Add one interval's normal matrix to the record's for each of the first intervals."""
    columns = len(gram) // SPLINES_ALIVE
    for u in range(len(gram)):
        band[u : u + columns * intervals : columns, : len(gram) - u] += gram[u:, u]


def _penalise(
    band: Float[ndarray, "knot column width"],
    ratio: Complex[ndarray, "column knot"],
    stiffness: Float[ndarray, " column"],
) -> None:
    """Add the penalty on third differences of the coefficients, each times its `ratio`.

    A third difference is scaled by the ratio's size at its middle, so that the penalty does not
    depend on how large the envelope is.
    """
    columns, knots = ratio.shape
    ratio, count = ratio.T, knots - 3
    scale = stiffness / np.abs(ratio[1 : 1 + count] * ratio[2 : 2 + count])
    third = (-1.0, 3.0, -3.0, 1.0)
    own = np.arange(columns)
    real, imaginary = own[1::2], own[2::2]
    for a in range(4):
        for b in range(a + 1):
            z = third[a] * third[b] * scale * ratio[a : a + count].conj() * ratio[b : b + count]
            here, lag = slice(b, b + count), (a - b) * columns
            band[here, own, lag] += z.real
            if a > b:
                band[here, real, lag + 1] += z.imag[:, real]
                band[here, imaginary, lag - 1] -= z.imag[:, imaginary]
