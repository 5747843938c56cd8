"""Sliders with a spread of slip thresholds: how stiffness is lost and energy dissipated.

Not a mechanism itself; `joint_slip` and `normal_load_variation` are made of it. Functions are of
z = ln(amplitude / threshold) and come with their derivative.
"""

from collections.abc import Callable

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.contact.laws.closed_forms import equivalent_stiffness
from bladeroot.mechanisms.mechanism import CurveEffect, Points

# Normal distribution of ln threshold, in standard deviations. Sliders begin to slip one by one:
# with a coarser rule (15 Gauss-Hermite nodes) a fit finds a false summit at each of them.
_NODES = np.linspace(-4.5, 4.5, 61)
_WEIGHTS = np.exp(-0.5 * _NODES**2) / np.exp(-0.5 * _NODES**2).sum()

Array = Float[ndarray, "..."]
Lost = Callable[[Array], tuple[Array, Array, Array, Array]]


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


def curve(points: Points, values: ndarray, element: Lost) -> CurveEffect:
    """Softening and damping of `element`, spread over thresholds that are proportional to force.

    values: share of the mode's stiffness that can slip; that of the other modes over the first's;
    threshold amplitude per newton (m/N); that of the other modes over the first's; spread (standard
    deviation of ln threshold); loss over what a slider dissipates.
    """
    share, share_ratio, threshold, threshold_ratio, spread, dissipation = values
    other = (points.mode > 0).astype(float)
    size = share * np.where(points.mode > 0, share_ratio, 1.0)
    where = threshold * np.where(points.mode > 0, threshold_ratio, 1.0) * points.force
    z = np.log(points.amplitude / where)
    lost, lost_slope, loss, loss_slope = element(z[:, None] - spread * _NODES)
    spread_lost, spread_loss = (part @ (-_NODES * _WEIGHTS) for part in (lost_slope, loss_slope))
    lost, lost_slope, loss, loss_slope = (
        part @ _WEIGHTS for part in (lost, lost_slope, loss, loss_slope)
    )

    def slopes(value: ndarray, by_z: ndarray, by_spread: ndarray) -> ndarray:
        rows = [
            value / share,
            value * other / share_ratio,
            -size * by_z / threshold,
            -size * by_z * other / threshold_ratio,
            size * by_spread,
        ]
        return np.stack(rows, axis=1)

    none = np.zeros((len(z), 1))
    return CurveEffect(
        -0.5 * size * lost,
        dissipation * size * loss,
        np.hstack([-0.5 * slopes(size * lost, lost_slope, spread_lost), none]),
        np.hstack(
            [dissipation * slopes(size * loss, loss_slope, spread_loss), (size * loss)[:, None]]
        ),
    )
