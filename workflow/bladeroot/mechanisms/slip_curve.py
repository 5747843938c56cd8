"""Sliders with a spread of slip thresholds: how stiffness is lost and energy dissipated.

Not a mechanism itself; `joint_slip` and `normal_load_variation` are made of it. Functions are of
z = ln(amplitude / threshold) and come with their derivative. A spread is a distribution of
thresholds about the one of the law: elements in parallel, as any law of Masing's kind can be taken
apart into (Iwan 1966, Segalman 2005).
"""

from collections.abc import Callable

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.contact.laws.closed_forms import equivalent_stiffness
from bladeroot.mechanisms.mechanism import REFERENCE_FORCE, CurveEffect, Parameter, Points

# Normal distribution of ln threshold, in standard deviations. Sliders begin to slip one by one, and
# the loss has a kink where each does: with a coarser rule a fit finds a false maximum at each.
_NORMAL = np.linspace(-4.5, 4.5, 121)
_NORMAL_WEIGHTS = np.exp(-0.5 * _NORMAL**2) / np.exp(-0.5 * _NORMAL**2).sum()
# For distributions with a strongest slider: ln of thresholds over its own, or of the part of all
# that is weaker; what lies further down slides whole in any record.
_LN_WEAKER = np.linspace(-14.0, 0.0, 225)
_CELL_ENDS = np.append(0.5 * (_LN_WEAKER[1:] + _LN_WEAKER[:-1]), 0.0)
_EVEN_WEIGHTS = np.exp(_LN_WEAKER) * np.where(_LN_WEAKER < 0.0, 1.0, 0.5)  # trapezoidal rule
_EVEN_WEIGHTS = _EVEN_WEIGHTS / _EVEN_WEIGHTS.sum()
# A narrow normal distribution of ln threshold, in standard deviations.
_NARROW = np.linspace(-2.0, 2.0, 17)
_NARROW_WEIGHTS = np.exp(-0.5 * _NARROW**2) / np.exp(-0.5 * _NARROW**2).sum()
# Free distribution: places of ln threshold about the law's, each a narrow distribution.
PLACES = np.linspace(-3.2, 3.2, 9)
_PLACE_STD = 0.35
# Standard deviation of ln threshold of sliders that give way together: a level's curve is a mean
# over clampings, whose friction differs.
_TOGETHER_STD = 0.15
_LEAST_STIFFNESS = 0.02  # part of a mode's stiffness that is left at any amplitude

Array = Float[ndarray, "..."]
Lost = Callable[[Array], tuple[Array, Array, Array, Array]]
# Nodes of ln(threshold over the law's), their weights, and derivatives of both by the shape.
Spread = Callable[[Float[ndarray, " shape"]], tuple[ndarray, ndarray, ndarray, ndarray]]


def parameters(
    tie: str, share: str, threshold: str, ratio: str, exponent: str
) -> tuple[Parameter, ...]:
    """The first five values of `curve`; tie: the contact springs that have the share; then what
    each is by.
    """
    return (
        Parameter("share", "1", 0.2, 1.2, 0.0, 1.0, share, bounded=True, tie=tie),
        Parameter(
            "share_ratio", "1", 1.0, 0.7, 1e-3, 1e3, "another mode over the first",
            log=True, tie=tie, ratio=True,
        ),
        Parameter("threshold", "m/N", 3e-10, 1.8, 1e-14, 1e-5, threshold, log=True),
        Parameter("threshold_ratio", "1", 0.5, 0.8, 1e-3, 1e3, ratio, log=True, ratio=True),
        Parameter("threshold_exponent", "1", 1.0, 0.2, 0.5, 1.5, exponent),
    )  # fmt: skip


def starts(*own: float) -> tuple[tuple[float, ...], ...]:
    """Coordinates to begin from: shares and thresholds, small to large, then a law's own."""
    return tuple(
        (share, 0.0, np.log(threshold), np.log(0.5), 1.0, *own)
        for share, threshold in ((-3.0, 1e-10), (-1.5, 1e-9), (0.0, 1e-8))
    )


def coulomb(z: Array) -> tuple[Array, Array, Array, Array]:
    """Lost stiffness and loss of a slider of unit stiffness (eq. 3.19), and derivatives by z."""
    real, imaginary = equivalent_stiffness(np.exp(z), 1.0, 1.0)
    s = np.exp(-np.maximum(z, 0.0))
    lost_slope = np.where(z > 0.0, 8.0 / np.pi * s * np.sqrt(s * (1.0 - s)), 0.0)
    loss_slope = np.where(z > 0.0, -4.0 / np.pi * s * (1.0 - 2.0 * s), 0.0)
    return 1.0 - real, lost_slope, imaginary, loss_slope


def lift_off(z: Array) -> tuple[Array, Array, Array, Array]:
    """The same of a preloaded contact that opens in one half of the cycle: it loses stiffness.

    What it dissipates at the closing edge is taken in proportion to what it loses.
    """
    s = np.exp(-np.maximum(z, 0.0))
    angle = np.arccos(s)
    lost = (angle - 0.5 * np.sin(2.0 * angle)) / np.pi
    slope = np.where(z > 0.0, 2.0 / np.pi * s * np.sin(angle), 0.0)
    return lost, slope, lost, slope


def lognormal(shape: Float[ndarray, " 1"]) -> tuple[ndarray, ndarray, ndarray, ndarray]:
    """Standard deviation of ln threshold: pressure that varies over the flank."""
    return shape[0] * _NORMAL, _NORMAL_WEIGHTS, _NORMAL[:, None], np.zeros((_NORMAL.size, 1))


def power(shape: Float[ndarray, " 2"]) -> tuple[ndarray, ndarray, ndarray, ndarray]:
    """Iwan's four-parameter density (Segalman 2005): threshold to the power `shape[0]`, cut off at
    the strongest, about which a part `shape[1]` of all sliders stands.
    """
    steep, at_once = shape
    weaker = np.exp((1.0 + steep) * _CELL_ENDS)
    part, by_steep = np.diff(weaker, prepend=0.0), np.diff(_CELL_ENDS * weaker, prepend=0.0)
    by_weights = np.zeros((part.size + _NARROW.size, 2))
    by_weights[: part.size] = np.column_stack([(1.0 - at_once) * by_steep, -part])
    by_weights[part.size :, 1] = _NARROW_WEIGHTS
    return (
        np.append(_LN_WEAKER, _TOGETHER_STD * _NARROW),
        np.append((1.0 - at_once) * part, at_once * _NARROW_WEIGHTS),
        np.zeros(by_weights.shape), by_weights,
    )  # fmt: skip


def rounded(shape: Float[ndarray, " 1"]) -> tuple[ndarray, ndarray, ndarray, ndarray]:
    """Cattaneo's and Mindlin's contact: stiffness falls by (1 - x/x_slip)^shape, one half for a
    sphere; slip begins at once, at the contact's edge.
    """
    left = np.maximum(-np.expm1(_LN_WEAKER), 1e-6)
    root = left ** (1.0 / shape[0])
    nodes = np.log(np.maximum(1.0 - root, 1e-9))
    slope = np.where(1.0 - root > 1e-9, root * np.log(left) / (shape[0] ** 2 * (1.0 - root)), 0.0)
    return nodes, _EVEN_WEIGHTS, slope[:, None], np.zeros((nodes.size, 1))


def free(shape: Float[ndarray, " place"]) -> tuple[ndarray, ndarray, ndarray, ndarray]:
    """Any density: ln of the weights at `PLACES`, up to a constant."""
    part = np.exp(shape - shape.max())
    part = part / part.sum()
    by_part = np.diag(part) - np.outer(part, part)
    nodes = (PLACES[:, None] + _PLACE_STD * _NARROW).ravel()
    weights = (part[:, None] * _NARROW_WEIGHTS).ravel()
    by_weights = (by_part[:, None, :] * _NARROW_WEIGHTS[:, None]).reshape(nodes.size, shape.size)
    return nodes, weights, np.zeros((nodes.size, shape.size)), by_weights


def curve(points: Points, values: ndarray, element: Lost, spread: Spread) -> CurveEffect:
    """Softening and damping of elements in parallel.

    values: share of the mode's stiffness that can slip; that of the other modes over the first's;
    threshold amplitude per newton at 12 kN (m/N); that of the other modes over the first's; its
    exponent over the axial force; loss over what an element dissipates; the spread's shape.
    """
    share, share_ratio, threshold, threshold_ratio, exponent, dissipation = values[:6]
    other = (points.mode > 0).astype(float)
    size = share * np.where(points.mode > 0, share_ratio, 1.0)
    x = np.log(points.force / REFERENCE_FORCE)
    where = np.log(threshold * REFERENCE_FORCE) + exponent * x + other * np.log(threshold_ratio)
    nodes, weights, by_nodes, by_weights = spread(values[6:])
    lost, lost_slope, loss, loss_slope = element(
        (np.log(points.amplitude) - where)[:, None] - nodes
    )

    def slopes(value: ndarray, slope: ndarray) -> tuple[ndarray, ndarray]:
        """The sum over elements, and its derivatives but by dissipation."""
        whole, by_z = value @ weights, slope @ weights
        shape = value @ by_weights - slope @ (weights[:, None] * by_nodes)
        rows = [
            whole / share,
            whole * other / share_ratio,
            -by_z / threshold,
            -by_z * other / threshold_ratio,
            -by_z * x,
            np.zeros(x.size),
        ]
        return size * whole, size[:, None] * np.hstack([np.stack(rows, axis=1), shape])

    lost, lost_slope = slopes(lost, lost_slope)
    loss, loss_slope = slopes(loss, loss_slope)
    loss_slope = dissipation * loss_slope
    loss_slope[:, 5] = loss
    # Frequency and loss factor go by the stiffness that is left.
    left = np.maximum(1.0 - lost, _LEAST_STIFFNESS)
    whole = (dissipation * loss + points.loss) / left
    return CurveEffect(
        0.5 * np.log(left), whole - points.loss, -0.5 * lost_slope / left[:, None],
        (loss_slope + whole[:, None] * lost_slope) / left[:, None],
    )  # fmt: skip
