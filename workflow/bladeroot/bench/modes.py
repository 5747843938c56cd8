"""Modes of the stuck specimen, and the contacts' flexibility that the kept modes leave out."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from jaxtyping import Float
from numpy import ndarray
from scipy.linalg import cho_factor, cho_solve, eigh

from bladeroot.bench.joint import Specimen, line_row, stuck_stiffness

# A change of sign counts as a node only between points that move by more than this part.
_NODE_LEVEL = 0.1
# A mode bends the line if its mean square reaches this part of the largest.
_BENDING_LEVEL = 0.1


@dataclass(frozen=True)
class StuckModes:
    """Kept modes of the stuck specimen (mass-normalised), seen at flanks, laser, tip and line.

    `residual` (m/N) is the static flexibility between sliders of all modes that are not kept;
    `geometric` (1/(kg m)) what one newton of axial force adds to the modal stiffness.
    """

    omega: Float[ndarray, " mode"]
    names: tuple[str, ...]
    slider_shape: Float[ndarray, "slider mode"]
    slider_kt: Float[ndarray, " slider"]
    normal_shape: Float[ndarray, "pair mode"]
    normal_kn: Float[ndarray, " pair"]
    residual: Float[ndarray, "slider slider"]
    geometric: Float[ndarray, "mode mode"]
    laser_shape: Float[ndarray, " mode"]
    tip_shape: Float[ndarray, " mode"]
    line_x: Float[ndarray, " point"]
    line_shape: Float[ndarray, "point mode"]


def stuck_modes(
    body: Specimen,
    kn: float,
    kt: float,
    kept: int,
    laser_x: float,
    tip_x: float,
    slipping: bool = True,
    nodes: Mapping[str, int] | None = None,
) -> StuckModes:
    """Lowest `kept` modes of the specimen with all flanks stuck (kn, kt in N/m a flank; x in m).

    Without `slipping` the residual is not worked out and stays zero. `nodes`: how many nodes the
    bending shapes of the named modes have, where that is not one less than their numbers.
    """
    whole = body.parts
    squares, shapes, slider_kt, residual = _solved(body, kn, kt, kept, slipping)
    line = whole.line[:, 2] @ shapes
    return StuckModes(
        omega=np.sqrt(squares),
        names=bending_names(whole.line_x, line, nodes),
        slider_shape=whole.tangential @ shapes,
        slider_kt=slider_kt,
        normal_shape=whole.normal @ shapes,
        normal_kn=kn * whole.share * whole.factor,
        residual=residual,
        geometric=shapes.T @ whole.geometric @ shapes,
        laser_shape=line_row(whole, laser_x) @ shapes,
        tip_shape=line_row(whole, tip_x) @ shapes,
        line_x=whole.line_x,
        line_shape=line,
    )


@lru_cache(maxsize=1)  # one hold serves all its records, wherever laser and tip stand
def _solved(
    body: Specimen, kn: float, kt: float, kept: int, slipping: bool
) -> tuple[ndarray, ndarray, ndarray, ndarray]:
    """omega^2 and shapes of the kept modes, the sliders' springs and the residual."""
    whole = body.parts
    stiffness, slider_kt = stuck_stiffness(body, kn, kt)
    squares, shapes = eigh(stiffness, body.mass, subset_by_index=(0, kept - 1))
    if not squares[0] > 0:
        raise ValueError(f"the stuck specimen is not stable: omega^2 = {squares[0]}")
    at_sliders = whole.tangential @ shapes
    residual = np.zeros((len(slider_kt), len(slider_kt)))
    if slipping:
        static = whole.tangential @ cho_solve(cho_factor(stiffness), whole.tangential.T)
        residual = static - (at_sliders / squares) @ at_sliders.T
    return squares, shapes, slider_kt, (residual + residual.T) / 2


def bending_names(
    x: Float[ndarray, " point"],
    z: Float[ndarray, "point mode"],
    nodes: Mapping[str, int] | None = None,
) -> tuple[str, ...]:
    """Name modes by the nodes of their bending shape: `1B` none, `2B` one, ...; others stay empty.

    `nodes` gives other names: how many nodes each has.

    `z` is the bending displacement of mass-normalised shapes on the middle line. Lateral, axial
    and torsional modes hardly bend that line, so they are told by their small mean square.
    """
    strength = np.trapezoid(z**2, x, axis=0)
    names: list[str] = []
    for k, column in enumerate(z.T):
        moving = column[np.abs(column) > _NODE_LEVEL * np.abs(column).max()]
        count = int(np.sum(moving[1:] * moving[:-1] < 0))
        name = f"{count + 1}B"
        if nodes is not None:
            name = next((one for one, own in nodes.items() if own == count), "")
        bending = strength[k] > _BENDING_LEVEL * strength.max()
        names.append(name if bending and name not in names else "")
    return tuple(names)
