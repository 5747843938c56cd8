"""Bases of single modes that reach a given accuracy with as few exact solutions as they can.

Greedy choice: solve exactly where the error bound is largest, add the shape, and repeat until the
bound is below the tolerance at every point of a training set. Then come vectors for the shapes by
which the mode answers to perturbations.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
import scipy.linalg
from jaxtyping import Float, Int
from numpy import ndarray
from scipy.sparse.linalg import LinearOperator, eigsh

from bladeroot.rom.joint import (
    Joint,
    Modes,
    described,
    exact_modes,
    held_at,
    stable_factor,
    stiffness_at,
)
from bladeroot.rom.ritz import Pairs, Ritz, solve

# The basis of a mode grows by the exact solution at the training point of the largest error bound.
_TRAINING_POINTS = 250  # random ones inside the box
_TRAINING_PART = 0.5  # of the tolerance, which bounds must meet there: they are larger in between
_MOST_SOLUTIONS = 60  # exact ones of a model, after which the box is refused
_ROUNDING = 1e-12  # of the frequency, where the basis holds the very point
# Whether it is one mode throughout.
_SAME_MODE = 1e-5  # of omega^2: a basis that gives another value than its sample has swapped modes
_COUPLED = 1e-6  # modal product of a sample and a neighbour, above which the two modes may mix
# Vectors for perturbations of stiffness and mass.
_LARGEST_CHANGE = 0.1  # of omega^2: the shape follows perturbations up to this one's size
_LEFT_OUT = 1e-7  # of omega^2 that the answer to such a perturbation may lack

Sample = tuple[Float[ndarray, " coordinate"], Modes]


@dataclass(frozen=True)
class Norm:
    """Cholesky factor of the stiffness at the softest contact, the root of the dual norm.

    coercivity: least ratio of the stiffness at any force of the box to the one of the factor.
    """

    factor: Float[ndarray, "dof dof"]
    coercivity: float


@dataclass(frozen=True)
class Span:
    """Vectors of unit modal mass, and K0, Kg, Kc..., M upon them, plain and in the dual norm."""

    vectors: Float[ndarray, "dof vector"]
    images: Float[ndarray, "dof vector part"]
    dual: Float[ndarray, "dof vector part"]


def find_bases(
    joint: Joint,
    names: Sequence[str],
    low: Float[ndarray, " coordinate"],
    high: Float[ndarray, " coordinate"],
    tolerance: float,
) -> tuple[list[Ritz], int]:
    """One projected mode a name, with error bounds below `tolerance` of the frequency over the box.

    Also the number of exact solutions. Raises ValueError if a mode is not found, is not followed
    through the box, or needs too many of them.
    """
    norm = _norm(joint, low, high)
    corners, training = _corners(low, high), _training(low, high)
    empty = np.empty((len(joint.mass), 0))
    nothing = empty[:, :, None] * np.ones(3 + len(joint.rows))
    spans = [Span(empty, nothing, nothing) for _ in names]
    samples: list[Sample] = []
    missed = [np.arange(len(training))] * len(names)
    wanted = corners
    while len(wanted):
        if len(samples) + len(wanted) > _MOST_SOLUTIONS:
            raise ValueError(
                f"the frequencies of {', '.join(names)} miss the tolerance {tolerance:g} after "
                f"{len(samples)} exact solutions; narrow the box of stiffness or force"
            )
        samples += [(point, exact_modes(joint, point, names)) for point in wanted]
        modes, worst = [], set()
        for m, name in enumerate(names):
            lower, amplification = _neighbours(joint, name, m, samples)
            for (_, found), below in list(zip(samples, lower, strict=True))[-len(wanted) :]:
                for shape in (found.shapes[:, m], *found.all_shapes[:, below].T):
                    spans[m] = _extended(spans[m], joint, norm, shape)
            mode = replace(
                _projected(joint, spans[m]), rank=len(lower[0]), amplification=amplification
            )
            _refuse_swaps(name, mode, m, samples)
            worst_of_mode, missed[m] = _worst(mode, training, tolerance, missed[m])
            worst |= worst_of_mode
            modes.append(mode)
        wanted = training[sorted(worst)]
    for m, mode in enumerate(modes):
        whole = spans[m]
        for vector in _answers(joint, norm, whole, m, samples[: len(corners)]).T:
            whole = _extended(whole, joint, norm, vector)
        modes[m] = replace(
            _projected(joint, whole),
            residual=np.linalg.qr(mode.residual, mode="r"),
            own=mode.own,
            rank=mode.rank,
            amplification=mode.amplification,
        )
    return modes, len(samples)


def _worst(
    mode: Ritz,
    training: Float[ndarray, "point coordinate"],
    tolerance: float,
    missed: Int[ndarray, " missed"],
) -> tuple[set[int], Int[ndarray, " above"]]:
    """The training point where the bound is largest, if that is too much, and all that miss.

    A basis only grows: those that met the tolerance before are asked again once all others do.
    """
    for places in (missed, np.arange(len(training))):
        points = training[places]
        bound = mode.amplification * residual_bound(mode.residual, solve(mode, points), points)
        above = places[~(bound <= _TRAINING_PART * tolerance)]
        if len(above):
            return {int(places[bound.argmax()])}, above
    return set(), places


def error_bound(ritz: Ritz, points: Float[ndarray, "point coordinate"]) -> Float[ndarray, " point"]:
    """Bound of the relative error of the frequency against the whole joint, at many points.

    Kato and Temple's bound for K^-1 M, whose eigenvalues are 1/lambda: the relative error of lambda
    is at most r'K^-1 r / lambda times the amplification, lambda_j / |lambda_j - lambda| of the
    nearest neighbour j. The residual's dual norm is taken at the softest contact, which bounds it
    everywhere, as K only rises with kn and kt. Neighbours are those seen at the basis's samples.
    """
    pairs = solve(ritz, points)
    return _ROUNDING + ritz.amplification * residual_bound(ritz.residual, pairs, points)


def residual_bound(
    residual: Float[ndarray, "row part"], pairs: Pairs, points: Float[ndarray, "point coordinate"]
) -> Float[ndarray, " point"]:
    """The bound before amplification, from any factor of the residual's dual norm."""
    stiffness = np.exp(points[:, :-1].T)
    one = np.ones(len(points))
    weights = np.stack([one, points[:, -1], *stiffness, -pairs.value], axis=1)
    combination = (pairs.shape[:, :, None] * weights[:, None, :]).reshape(len(points), -1)
    return 0.5 * ((combination @ residual.T) ** 2).sum(axis=1) / pairs.value


def _norm(joint: Joint, low: ndarray, high: ndarray) -> Norm:
    middle, reach = 0.5 * (low[-1] + high[-1]), 0.5 * (high[-1] - low[-1])
    softest = np.array([*low[:-1], middle])
    factor = stable_factor(held_at(joint, softest), described(softest))

    def relative(vector: ndarray) -> ndarray:
        inner = scipy.linalg.solve_triangular(factor, vector, lower=True, trans="T")
        return scipy.linalg.solve_triangular(factor, joint.geometric @ inner, lower=True)

    size = len(factor)
    operator = LinearOperator((size, size), matvec=relative, dtype=float)
    start = np.linspace(1.0, 2.0, size)
    # without prestress nothing grows with force, and the iteration could not start
    largest = 0.0
    if joint.geometric.any():
        largest = eigsh(operator, 1, which="LM", v0=start, return_eigenvectors=False)[0]
    # The ratio is concave in the force, so it is least at an end; stiffer contact only raises it.
    coercivity = 1.0 - reach * abs(float(largest))
    if not coercivity > 0.0:
        raise ValueError(
            f"loads from {low[-1]:g} to {high[-1]:g} change the stiffness of the softest "
            "contact too much; narrow the box of force"
        )
    return Norm(factor, coercivity)


def _corners(low: ndarray, high: ndarray) -> Float[ndarray, "point coordinate"]:
    """Corners and centre of the stiffness, at the middle force."""
    middle = 0.5 * (low + high)
    pairs = zip(low[:-1], high[:-1], strict=True)
    return np.array([*((*one, middle[-1]) for one in product(*pairs)), middle])


def _training(low: ndarray, high: ndarray) -> Float[ndarray, "point coordinate"]:
    """A net that includes the edges of the box, and random points between."""
    size = len(low)
    of_k = 5 if size <= 3 else 3  # more stiffnesses: the net would be all that is computed
    points = (*[of_k] * (size - 1), 3)
    net = [np.linspace(bottom, top, n) for bottom, top, n in zip(low, high, points, strict=True)]
    inside = np.random.default_rng(3).uniform(low, high, (_TRAINING_POINTS, size))
    return np.vstack([np.stack(np.meshgrid(*net), axis=-1).reshape(-1, size), inside])


def _extended(span: Span, joint: Joint, norm: Norm, shape: Float[ndarray, " dof"]) -> Span:
    """The span with one more direction, by Gram-Schmidt done twice.

    Small differences of shapes matter: stiff contact multiplies them, so only rounding is left out.
    """
    mass, basis = joint.mass, span.vectors
    rest = shape / np.sqrt(shape @ mass @ shape)
    for _ in range(2):
        rest = rest - basis @ (basis.T @ (mass @ rest))
    size = np.sqrt(max(rest @ mass @ rest, 0.0))
    if size < 1e-10:
        return span
    rest = rest / size
    rest = rest - basis @ (basis.T @ (mass @ rest))
    rest = rest / np.sqrt(rest @ mass @ rest)
    image = np.column_stack(
        [
            joint.stiffness @ rest,
            joint.geometric @ rest,
            *(square @ rest for square in joint.squares),
            mass @ rest,
        ]
    )
    dual = scipy.linalg.solve_triangular(norm.factor, image, lower=True, check_finite=False)
    dual /= np.sqrt(norm.coercivity)
    return Span(
        np.column_stack([basis, rest]),
        np.concatenate([span.images, image[:, None]], axis=1),
        np.concatenate([span.dual, dual[:, None]], axis=1),
    )


def _projected(joint: Joint, span: Span) -> Ritz:
    n, assembly, basis = joint.beam_dofs, joint.assembly, span.vectors

    def upon(part: slice, image: int) -> ndarray:
        matrix = basis[part].T @ span.images[part, :, image]
        return 0.5 * (matrix + matrix.T)

    beam, slots = slice(0, n), slice(n, None)
    sides = [assembly[name].values for name in ("beam_dof", "slot_dof")]
    contact = np.einsum("pla,pav->plv", assembly["frame"].values, basis[sides[0]] - basis[sides[1]])
    return Ritz(
        beam=upon(beam, 0),
        slots=upon(slots, 0),
        geometric=upon(beam, 1),
        springs=tuple(_triangular(rows @ basis) for rows in joint.rows),
        beam_mass=upon(beam, -1),
        contact=contact,
        display=np.einsum("daq,qv->dav", assembly["display_shape"].values, basis),
        display_x=assembly["display_position"].values[:, 0],
        residual=span.dual.reshape(len(basis), -1),
        own=basis.shape[1],
        rank=0,
        amplification=1.0,
    )


def _triangular(rows: Float[ndarray, "row vector"]) -> Float[ndarray, "vector vector"]:
    """Triangular factor with the square of the given rows."""
    count = rows.shape[1]
    return np.linalg.qr(np.vstack([rows, np.zeros((count, count))]), mode="r")


def _neighbours(
    joint: Joint, name: str, m: int, samples: list[Sample]
) -> tuple[list[ndarray], float]:
    """Lower modes that the mode can mix with, by sample, and how near neighbours enlarge errors.

    The latter is the largest lambda_j / |lambda_j - lambda|. Modes of another symmetry, which no
    sample of the mode has a part of, may cross it freely and do not count.
    """
    moved = joint.mass @ np.column_stack([found.shapes[:, m] for _, found in samples])
    lower, amplification = [], 1.0
    for _, found in samples:
        value, values = found.values[m], found.all_values
        mixed = np.abs(moved.T @ found.all_shapes).max(axis=0) > _COUPLED
        mixed &= values != value
        lower.append(np.flatnonzero(mixed & (values < value)))
        enlarged = values[mixed] / np.abs(values[mixed] - value)
        amplification = max(amplification, *enlarged) if len(enlarged) else amplification
    if len({len(below) for below in lower}) > 1:
        raise ValueError(
            f"mode {name} is not followed through the box: another that it mixes with is above it "
            "in one place and below in another; narrow the box"
        )
    return lower, float(amplification)


def _refuse_swaps(name: str, mode: Ritz, m: int, samples: list[Sample]) -> None:
    """A mode's own basis must give back each of its samples, or it holds two modes."""
    points = np.array([point for point, _ in samples])
    values = solve(mode, points).value
    exact = np.array([found.values[m] for _, found in samples])
    wrong = np.flatnonzero(~(np.abs(values / exact - 1.0) <= _SAME_MODE))
    if len(wrong):
        raise ValueError(
            f"mode {name} is not followed through the box: another one is taken for it "
            f"{described(points[wrong[0]])}; narrow the box"
        )


def _answers(
    joint: Joint, norm: Norm, span: Span, m: int, samples: list[Sample]
) -> Float[ndarray, "dof vector"]:
    """Leading directions in which the shape answers to scaled parts and to added masses.

    Each answer is the shape's derivative times an amount that moves omega^2 by a tenth.
    """
    n, rows = joint.beam_dofs, joint.assembly["display_shape"].values
    answers = []
    for point, found in samples:
        value, shape = found.values[m], found.shapes[:, m]
        moved = rows @ shape
        forces = [-value * np.einsum("dq,d->q", r, u) for r, u in zip(rows, moved, strict=True)]
        largest = _LARGEST_CHANGE / (moved**2).sum(axis=1).max()
        columns = largest * np.array(forces).T
        for matrix in (joint.stiffness, -value * joint.mass):
            for part in (slice(0, n), slice(n, None)):
                column = np.zeros_like(shape)
                column[part] = matrix[part, part] @ shape[part]
                columns = np.column_stack([columns, _LARGEST_CHANGE * column])
        modal = joint.mass @ shape
        columns -= np.outer(modal, shape @ columns)
        shifted = stiffness_at(joint, point) - value * joint.mass + value * np.outer(modal, modal)
        answers.append(-scipy.linalg.solve(shifted, columns, assume_a="sym") / np.sqrt(value))
    whole = np.hstack(answers)
    whole -= span.vectors @ (span.images[:, :, -1].T @ whole)
    left, sizes, _ = np.linalg.svd(norm.factor.T @ whole, full_matrices=False)
    kept = left[:, sizes**2 > _LEFT_OUT]
    return scipy.linalg.solve_triangular(norm.factor, kept, lower=True, trans="T")
