"""A parametric structure: frequencies over (ln kn, ln kt, F), with the model's bias by mode.

ln f = ln f_model(ln kn, ln kt, F) + bias. Contact stiffness is one law over all forces; each
clamping of the specimen changes kn and kt at random, and the gauge is read to a step.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import xarray as xr
from jaxtyping import Float, Int
from numpy import ndarray

from bladeroot.diagnosis.simulation.interface import Said
from bladeroot.diagnosis.structures import Structures
from bladeroot.inference.gaussian import Prior, Slopes
from bladeroot.mechanisms.mechanism import Mechanism, Records
from bladeroot.rom import chebyshev
from bladeroot.rom.chebyshev import Surface, trimmed
from bladeroot.rom.parametric import ritz_of, surface_of
from bladeroot.rom.ritz import Ritz
from bladeroot.stiffness.priors import (
    BIAS_TILT,
    CORRELATION,
    LN_K,
    REFERENCE_FORCE,
    SCATTER,
    SMOOTH_EXPONENT,
)

TRIM = 1e-6  # of a frequency, that coefficients of the surface may be left out for
# Of (ln kn, ln kt, F): scatter of kn, of kt, and of both together.
_AXES = (
    np.diag([1.0, 0.0, 0.0]),
    np.diag([0.0, 1.0, 0.0]),
    np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]]),
)


@dataclass(frozen=True)
class Parametric:
    """Frequencies over (ln kn, ln kt, F), bias (std) and known offset by mode, projected problems.

    shapes: those already worked out (`Structures`).
    """

    surface: Surface
    ritz: tuple[Ritz, ...]
    bias: Float[ndarray, " mode"]
    offset: Float[ndarray, " mode"]
    modes: tuple[str, ...] = ()
    structure: str = ""
    shapes: dict = field(default_factory=dict)
    kind: str = "structure"
    knows_contact: bool = True

    def of_records(
        self, records: Records, hold: Int[ndarray, " record"], rounding: float
    ) -> "_OfRecords":
        """As the interface says."""
        return _OfRecords(self, records, hold, rounding)

    def silent(self, one: Mechanism) -> str:
        """It speaks of every cause."""
        return ""

    def curves(self) -> xr.Dataset | None:
        """It has no slip of its own."""
        return None


def parametric(
    model: xr.Dataset, modes: Sequence[str], bias: Sequence[float], offset: Sequence[float]
) -> Parametric:
    """From `bladeroot.rom.parametric`; bias and offset relative, by mode."""
    here = model.sel(mode=list(modes))
    ritz = tuple(ritz_of(model, mode) for mode in modes)
    surface = trimmed(surface_of(here), TRIM)
    name = str(model.attrs.get("structure", ""))
    return Parametric(surface, ritz, np.array(bias), np.array(offset), tuple(modes), name)


def biases(modes: int) -> slice:
    """Where the model's biases and their tilts stand among the parameters."""
    return slice(3, 3 + 2 * modes)


class _OfRecords:
    """Parameters: ln kn and ln kt at the reference force, exponent, biases, their tilts."""

    scales = (SCATTER[:2], SCATTER[:2], CORRELATION[:2])

    def __init__(
        self, simulated: Parametric, records: Records, hold: ndarray, rounding: float
    ) -> None:
        self.surface, self.records, self.rounding = simulated.surface, records, rounding
        modes = len(simulated.ritz)
        self.x = np.log(records.force / REFERENCE_FORCE)
        of_mode = np.eye(modes)[records.mode]
        self.bias_rows = np.hstack([of_mode, of_mode * self.x[:, None]])
        bias = simulated.bias
        self.prior = Prior(
            np.concatenate(
                [
                    [LN_K[0], LN_K[0], SMOOTH_EXPONENT[0]],
                    np.log1p(simulated.offset),
                    np.zeros(modes),
                ]
            ),
            np.concatenate([[LN_K[1], LN_K[1], SMOOTH_EXPONENT[1]], bias, BIAS_TILT * bias]),
        )
        self.own = biases(modes)
        self.structures = Structures(records, simulated.ritz, simulated.surface, simulated.shapes)
        self.same_hold = hold[:, None] == hold

    def ln_k(self, theta: ndarray) -> ndarray:
        """By the law."""
        return theta[:2, None] + theta[2] * self.x

    def at(self, theta: ndarray, changes: ndarray) -> Said:
        """The surface at each record's place, and the bias."""
        ln_kn, ln_kt = self.ln_k(theta) + changes[:, :2].T
        places = np.stack([ln_kn, ln_kt, self.records.force + changes[:, 2]], axis=1)
        points, where = _distinct(places)
        value, gradient = ln_frequency(self.surface, points)
        mean = value[where, self.records.mode] + self.bias_rows @ theta[self.own]
        g = gradient[where, self.records.mode]
        slope = [g[:, :1], g[:, 1:2], (g[:, :2].sum(axis=1) * self.x)[:, None], self.bias_rows]
        return Said(mean, np.hstack(slope), g)

    def scatter(self, g: ndarray, scales: ndarray) -> tuple[ndarray, Slopes]:
        """kn and kt of a clamping, correlated, and its reading of the force."""
        s_n, s_t, r = np.exp(scales[0]), np.exp(scales[1]), np.tanh(scales[2])
        normal, tangential = s_n**2 * _AXES[0], s_t**2 * _AXES[1]
        both = s_n * s_t * _AXES[2]

        def of_hold(scatter: ndarray) -> ndarray:
            return (g @ scatter @ g.T) * self.same_hold

        read = np.diag([0.0, 0.0, self.rounding**2])

        def slopes() -> list[ndarray]:
            return [
                of_hold(2.0 * normal + r * both),
                of_hold(2.0 * tangential + r * both),
                of_hold((1.0 - r**2) * both),
            ]

        return of_hold(normal + tangential + r * both + read), slopes


def ln_frequency(
    surface: Surface, points: Float[ndarray, "point 3"]
) -> tuple[Float[ndarray, "point mode"], Float[ndarray, "point mode 3"]]:
    """ln f and its gradient; straight on outside the box."""
    inside = np.clip(points, surface.low, surface.high)
    value, slope = chebyshev.evaluate(surface, inside, order=1)
    return value + np.einsum("pma,pa->pm", slope, points - inside), slope


def _distinct(points: Float[ndarray, "point 3"]) -> tuple[ndarray, ndarray]:
    """The different points, and which of them each is; `np.unique` of rows takes far longer."""
    order = np.lexsort(points.T)
    placed = points[order]
    new = np.ones(len(points), dtype=bool)
    new[1:] = (placed[1:] != placed[:-1]).any(axis=1)
    where = np.empty(len(points), dtype=int)
    where[order] = np.cumsum(new) - 1
    return placed[new], where
