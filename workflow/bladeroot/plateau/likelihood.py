"""Compiled sums behind the evidence of laws: their projections, and the marginal likelihood."""

from typing import no_type_check

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.compiled import njit
from bladeroot.plateau.laws import NODES, hat
from bladeroot.plateau.stretch import integrate

PARTS = NODES + 1  # of a law: the factor's nodes, and ln(e)


@njit(cache=True, error_model="numpy", fastmath=True)
@no_type_check
def projections(
    shape: Float[ndarray, "law cell"],
    between: Float[ndarray, "law cell"],
    first: Float[ndarray, " law"],
    log: Float[ndarray, " cell"],
    length: Float[ndarray, " cell"],
    bend: Float[ndarray, " group"],
    scale: Float[ndarray, " group"],
    line: Float[ndarray, "2 group"],
    y: Float[ndarray, "2 group"],
) -> tuple[
    Float[ndarray, "law part part"], Float[ndarray, "2 law part"], Float[ndarray, "law part 2"]
]:
    """Products of the laws' whitened columns less their lines; with the data; with the lines."""
    laws, groups = shape.shape[0], scale.size
    gram = np.empty((laws, PARTS, PARTS))
    right = np.empty((2, laws, PARTS))
    on_line = np.empty((laws, PARTS, 2))
    x = np.empty((PARTS, groups))
    cells = np.empty(groups - 1)
    for law in range(laws):
        for part in range(PARTS):
            if part < NODES:
                for cell in range(groups - 1):
                    cells[cell] = shape[law, cell] * hat(log[cell], first[law], part)
            else:
                for cell in range(groups - 1):
                    cells[cell] = between[law, cell]
            integrate(cells, length, bend, x[part])
            one = two = 0.0
            for group in range(groups):
                x[part, group] *= scale[group]
                one += x[part, group] * line[0, group]
                two += x[part, group] * line[1, group]
            on_line[law, part, 0], on_line[law, part, 1] = one, two
            for group in range(groups):
                x[part, group] -= one * line[0, group] + two * line[1, group]
            one = two = 0.0
            for group in range(groups):
                one += x[part, group] * y[0, group]
                two += x[part, group] * y[1, group]
            right[0, law, part], right[1, law, part] = one, two
            for other in range(part + 1):
                one = 0.0
                for group in range(groups):
                    one += x[part, group] * x[other, group]
                gram[law, part, other] = gram[law, other, part] = one
    return gram, right, on_line


@njit(cache=True, error_model="numpy")
@no_type_check
def marginal(
    gram: Float[ndarray, "law part part"],
    right: Float[ndarray, "law part"],
    tilt: Float[ndarray, "2 law part"],
    groups: int,
    doubts: Float[ndarray, " doubt"],
) -> tuple[
    Float[ndarray, "law doubt"],
    Float[ndarray, "law doubt part"],
    Float[ndarray, "2 law doubt"],
    Float[ndarray, "2 law doubt"],
]:
    """ln of the marginal likelihood, mean coefficients, what they and their errors do to `tilt`.

    The coefficients are T z with z ~ N(0, 1): the first of z is the size c, alike in all nodes, the
    others are each node's own and that of ln(e). The posterior of z has the precision
    1 + T' gram T, which is factored as L L'.
    """
    laws = right.shape[0]
    evidence = np.empty((laws, doubts.size))
    size = np.empty((laws, doubts.size, PARTS))
    tilted = np.zeros((2, laws, doubts.size))
    spread = np.empty((2, laws, doubts.size))
    low = np.empty((PARTS + 1, PARTS + 1))
    z = np.empty((3, PARTS + 1))  # of the data, and of both rows of `tilt`
    squares = np.empty(3)
    for law in range(laws):
        whole, along = 1e-300, 0.0
        for a in range(NODES):
            along += right[law, a]
            for b in range(NODES):
                whole += gram[law, a, b]
        square = (along / whole) ** 2
        wide = max(square, groups / whole)
        for doubt in range(doubts.size):
            common = np.sqrt(wide)
            own = np.sqrt(square * doubts[doubt] ** 2 + 1e-12 * wide)
            low[0, 0] = 1.0 + wide * whole
            z[0, 0], z[1, 0], z[2, 0] = common * along, 0.0, 0.0
            for a in range(PARTS):
                row = 0.0
                for b in range(NODES):
                    row += gram[law, a, b]
                low[a + 1, 0] = common * own * row
                for b in range(a + 1):
                    low[a + 1, b + 1] = own * own * gram[law, a, b]
                low[a + 1, a + 1] += 1.0
                z[0, a + 1] = own * right[law, a]
                for k in range(2):
                    z[k + 1, a + 1] = own * tilt[k, law, a]
                    if a < NODES:
                        z[k + 1, 0] += common * tilt[k, law, a]
            determinant = 1.0
            squares[:] = 0.0
            for a in range(PARTS + 1):
                for b in range(a + 1):
                    value = low[a, b]
                    for c in range(b):
                        value -= low[a, c] * low[b, c]
                    low[a, b] = np.sqrt(value) if a == b else value / low[b, b]
                determinant *= low[a, a]
                for k in range(3):
                    value = z[k, a]
                    for b in range(a):
                        value -= low[a, b] * z[k, b]
                    z[k, a] = value / low[a, a]
                    squares[k] += z[k, a] ** 2
            evidence[law, doubt] = 0.5 * squares[0] - np.log(determinant)
            spread[0, law, doubt], spread[1, law, doubt] = squares[1], squares[2]
            for a in range(PARTS, -1, -1):
                for b in range(a + 1, PARTS + 1):
                    z[0, a] -= low[b, a] * z[0, b]
                z[0, a] /= low[a, a]
            for a in range(PARTS):
                shared = common * z[0, 0] if a < NODES else 0.0
                size[law, doubt, a] = shared + own * z[0, a + 1]
                for k in range(2):
                    tilted[k, law, doubt] += size[law, doubt, a] * tilt[k, law, a]
    return evidence, size, tilted, spread
