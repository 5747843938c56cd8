"""Boundary elements as an independent check of the closed forms of chapter 6.

Two problems, each from the influence of a loaded cell on the surface of an elastic half-space and
nothing else: the punch pressed on a half-plane (pressure and its width), and a
rigid rectangle moved by a little on a half-space (stiffness of a contact of finite length, whose
pressure rises towards all four edges; the closed forms hold it constant along the length).
"""

from typing import Literal

import numpy as np
import scipy.linalg
from bladeroot.contact.punch import Punch
from jaxtyping import Float
from numpy import ndarray

Direction = Literal["normal", "tangential"]


def line_pressure(
    line_load: float, punch: Punch, reach: float, cells: int = 400
) -> tuple[Float[ndarray, " cell"], Float[ndarray, " cell"]]:
    """Cell centres (m) and constant pressures (Pa) of the punch on a half-plane.

    line_load: P, N/m. reach: half-width of the meshed strip, m; wider than the contact. The gap
    of the profile (eq. 6.3) is closed where pressure acts; cells in tension are let go and cells
    that would penetrate are taken in until neither is left. Raises ValueError when the contact
    fills the strip.
    """
    x, influence = _strip(reach, cells, punch)
    gap = np.maximum(np.abs(x) - punch.flat_half_width, 0.0) ** 2 / (2.0 * punch.edge_radius)
    width = x[1] - x[0]
    inside = np.abs(x) <= max(punch.flat_half_width, 0.5 * reach)
    for _ in range(200):
        value, approach = _held(influence, inside, -gap, line_load / width)
        penetrates = ~inside & (influence @ value + gap - approach < 0.0)
        pulled = inside & (value < 0.0)
        if not (penetrates | pulled).any():
            break
        inside = (inside & ~pulled) | penetrates
    if inside[0] or inside[-1]:
        raise ValueError(f"the contact is wider than the strip of half-width {reach} m")
    return x, value


def rectangle_stiffness(
    half_width: float,
    length: float,
    punch: Punch,
    direction: Direction = "normal",
    cells: tuple[int, int] = (16, 40),
) -> float:
    """Stiffness (N/m) of a rigid rectangle 2 `half_width` x `length` between two half-spaces.

    Normal: without friction. Tangential: across the length, without the small normal coupling.
    cells: over a quarter's width and length, finer towards the edges, where the traction rises
    without bound. Cells are loaded evenly; their influence is that of Boussinesq and Cerruti,
    integrated over the cell in closed form.
    """
    across, along = (
        size * np.sin(np.linspace(0.0, 0.5 * np.pi, count + 1))
        for size, count in zip((half_width, 0.5 * length), cells, strict=True)
    )
    x0, y0 = (part.ravel() for part in np.meshgrid(across[:-1], along[:-1], indexing="ij"))
    x1, y1 = (part.ravel() for part in np.meshgrid(across[1:], along[1:], indexing="ij"))
    x, y = 0.5 * (x0 + x1)[:, None], 0.5 * (y0 + y1)[:, None]
    area = (x1 - x0) * (y1 - y0)
    poisson = punch.poisson_ratio
    weight = poisson / (1.0 - poisson) if direction == "tangential" else 0.0
    influence = sum(
        _cell_integral(x - sx * x0, x - sx * x1, y - sy * y0, y - sy * y1, weight)
        for sx in (1.0, -1.0)
        for sy in (1.0, -1.0)
    ) / (np.pi * punch.contact_modulus)
    traction = np.linalg.solve(influence, np.ones(area.size))
    return float(4.0 * traction @ area)


def _cell_integral(xa, xb, ya, yb, weight: float) -> Float[ndarray, "point cell"]:
    """Integral of 1/rho + weight x^2/rho^3 over a cell, sign of its mirrored corners left out."""

    def corner(x, y):
        across = y * np.arcsinh(x / np.abs(y))  # d2/dxdy = x^2/rho^3
        return x * np.arcsinh(y / np.abs(x)) + (1.0 + weight) * across

    return np.abs(corner(xa, ya) - corner(xb, ya) - corner(xa, yb) + corner(xb, yb))


def _strip(reach: float, cells: int, punch: Punch) -> tuple[ndarray, ndarray]:
    """Centres of even cells over (-reach, reach), and their influence on each other.

    Relative displacement of the two bodies for a unit traction on a cell, up to a constant that
    a half-plane leaves open: -2/(pi E*) int ln|x - r| dr.
    """
    edges = np.linspace(-reach, reach, cells + 1)
    x, half = 0.5 * (edges[1:] + edges[:-1]), 0.5 * (edges[1] - edges[0])
    near, far = np.arange(cells) * 2.0 * half - half, np.arange(cells) * 2.0 * half + half

    def primitive(r):
        return r * np.log(np.abs(r) / reach) - r

    column = -2.0 / (np.pi * punch.contact_modulus) * (primitive(far) - primitive(near))
    return x, scipy.linalg.toeplitz(column)


def _held(
    influence: ndarray, held: ndarray, offset: ndarray, total: float
) -> tuple[Float[ndarray, " cell"], float]:
    """Tractions of the held cells that move them by one approach plus `offset`, and the approach.

    The tractions add up to `total`; the other cells are free.
    """
    count = int(held.sum())
    value = np.zeros(held.size)
    if count == 0:
        return value, 0.0
    system = np.zeros((count + 1, count + 1))
    system[:count, :count] = influence[np.ix_(held, held)]
    scale = system[0, 0]  # brings the row of the sum to the size of the others
    system[:count, count], system[count, :count] = -scale, scale
    found = np.linalg.solve(system, np.append(offset[held], scale * total))
    value[held] = found[:count]
    return value, float(scale * found[count])
