"""A parametric structure: frequencies over (ln k..., load), with the model's bias by mode.

ln f = ln f_model(ln k..., F) + bias. Contact stiffness is one law over all loads; each clamping of
the specimen changes kn and kt at random, of all interfaces alike, and the gauge is read to a step.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

import numpy as np
import xarray as xr
from jaxtyping import Float, Int
from numpy import ndarray

from bladeroot.diagnosis.simulation.interface import Said, Simulation
from bladeroot.diagnosis.structures import distinct, solved_change
from bladeroot.inference.problem import Prior, Slopes
from bladeroot.mechanisms.mechanism import Mechanism, Records
from bladeroot.rom.chebyshev import Surface, trimmed
from bladeroot.rom.parametric import (
    Solved,
    ln_frequency,
    ritz_of,
    solved_of,
    surface_of,
)
from bladeroot.rom.ritz import Ritz
from bladeroot.stiffness.priors import (
    BIAS_TILT,
    CORRELATION,
    PRIORS,
    REFERENCE_FORCE,
    SCATTER,
    SMOOTH_EXPONENT,
)

# Relative error of what the axial force does to the model's frequencies, over that of these: a
# depth or length that is off changes the tension's part of the stiffness by some times as much.
TENSION = 4.0
TRIM = 1e-6  # of a frequency, that coefficients of the surface may be left out for


@dataclass(frozen=True)
class Parametric(Simulation):
    """Frequencies over (ln k..., F), bias (std) and known offset by mode, projected problems.

    stiffnesses: their names, kn or kt and the interface. prior: mean and standard
    deviation of each one's logarithm. pivot: the load about which laws and biases tilt; None: the
    middle of the records'. per_load, shift: from a load of the model to the records' (`OwnRange`).
    """

    surface: Surface | Solved
    ritz: tuple[Ritz, ...]
    bias: Float[ndarray, " mode"]
    offset: Float[ndarray, " mode"]
    modes: tuple[str, ...] = ()
    structure: str = ""
    kind: str = "structure"
    knows_contact: bool = True
    stiffnesses: tuple[str, ...] = ("kn", "kt")
    prior: tuple[tuple[float, float], ...] = (PRIORS["ln_kn"][:2], PRIORS["ln_kt"][:2])
    pivot: float | None = REFERENCE_FORCE
    per_load: float = 1.0
    shift: float = 0.0

    @property
    def load_range(self) -> tuple[float, float]:
        """That of the model."""
        low, high = self.surface.low[-1], self.surface.high[-1]
        return (low + self.shift) * self.per_load, (high + self.shift) * self.per_load

    def of_records(
        self, records: Records, hold: Int[ndarray, " record"], rounding: float
    ) -> "_OfRecords":
        """As the interface says."""
        return _OfRecords(self, records, hold, rounding)

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Which of kn and kt each stiffness is, by name in `mechanism.COORDINATES`."""
        return tuple("ln_kt" if name.startswith("kt") else "ln_kn" for name in self.stiffnesses)

    @property
    def biases(self) -> slice:
        """Biases and their tilts stand behind the stiffnesses and the law's exponent."""
        first = len(self.stiffnesses) + 1
        return slice(first, first + 2 * len(self.modes))

    def pivot_of(self, records: Records) -> float:
        """The load about which laws tilt."""
        if self.pivot is not None:
            return self.pivot
        return float(np.exp(np.log(records.force).mean())) if records.force.size else 1.0

    def silent(self, one: Mechanism) -> str:
        """Of a change of what the structure does not have: slots, of an assembly."""
        if one.structure is None:
            return ""
        values, _ = one.values(one.start + one.std)
        changes = [one.structure(ritz, values)[0] for ritz in self.ritz]
        if any(part.any() for one in changes for part in (one.stiffness, one.mass)):
            return ""
        return "the structure has nothing that it would change"


def of_structure(
    model: xr.Dataset,
    measured: Iterable[str],
    bias: Mapping[str, float],
    offset: Mapping[str, float],
) -> Parametric:
    """Of a structure's model, the measured modes whose bias is given; bias, offset relative."""
    measured = set(measured)
    modes = tuple(mode for mode in bias if mode in measured)
    surface = trimmed(surface_of(model.sel(mode=list(modes))), TRIM)
    return Parametric(
        surface, tuple(ritz_of(model, mode) for mode in modes),
        np.array([bias[mode] for mode in modes], float),
        np.array([offset.get(mode, 0.0) for mode in modes]), modes,
        str(model.attrs.get("structure", "")),
    )  # fmt: skip


def of_assembly(model: xr.Dataset, bias: Mapping[str, float], offset: Mapping[str, float],
                usual: float) -> Parametric:  # fmt: skip
    """Of an assembly's model, all its modes; usual: the bias of a mode that is not named.

    What is thought of a stiffness beforehand is its box: two standard deviations to either side.
    """
    modes = tuple(model["mode"].values.astype(str))
    solved = solved_of(model)
    prior = tuple(zip(0.5 * (solved.low + solved.high)[:-1], 0.25 * (solved.high - solved.low)[:-1],
                      strict=True))  # fmt: skip
    return Parametric(
        solved, solved.ritzes, np.array([bias.get(mode, usual) for mode in modes]),
        np.array([offset.get(mode, 0.0) for mode in modes]), modes, str(model.attrs["structure"]),
        kind="assembly",
        stiffnesses=tuple(str(name)[3:] for name in model["coordinate"].values[:-1]), prior=prior,
        pivot=None,
    )  # fmt: skip


def of_clamping(
    scales: Float[ndarray, " scale"], rounding: float
) -> tuple[Float[ndarray, "3 3"], list[Float[ndarray, "3 3"]]]:
    """Covariance of (ln kn, ln kt, load) between clampings, and its derivatives by the scales."""
    s_n, s_t, r = np.exp(scales[0]), np.exp(scales[1]), np.tanh(scales[2])
    alike = s_n * s_t
    both = r * alike
    whole = np.array([[s_n**2, both, 0.0], [both, s_t**2, 0.0], [0.0, 0.0, rounding**2]])
    by_n = np.array([[2.0 * s_n**2, both, 0.0], [both, 0.0, 0.0], [0.0, 0.0, 0.0]])
    by_t = np.array([[0.0, both, 0.0], [both, 2.0 * s_t**2, 0.0], [0.0, 0.0, 0.0]])
    turned = (1.0 - r**2) * alike
    return whole, [by_n, by_t, np.array([[0.0, turned, 0.0], [turned, 0.0, 0.0], [0.0, 0.0, 0.0]])]


def scatter_of_clampings(
    g: Float[ndarray, "record 3"], scales: Float[ndarray, " scale"], rounding: float,
    same_hold: ndarray,
) -> tuple[ndarray, Slopes]:  # fmt: skip
    """Covariance of ln f of such gradients by clampings, and its derivatives by the scales."""
    whole, slopes = of_clamping(scales, rounding)

    def of_hold(scatter: ndarray) -> ndarray:
        return (g @ scatter @ g.T) * same_hold

    return of_hold(whole), lambda: [of_hold(part) for part in slopes]


class _OfRecords:
    """Parameters: each ln k at the pivot, exponent, biases, their tilts, and the error of what the
    load does.
    """

    scales = (SCATTER[:2], SCATTER[:2], CORRELATION[:2])

    def __init__(
        self, simulated: Parametric, records: Records, hold: ndarray, rounding: float
    ) -> None:
        self.surface, self.records, self.rounding = simulated.surface, records, rounding
        self.simulated = simulated
        modes, self.count = len(simulated.ritz), len(simulated.stiffnesses)
        # which of the changes, of kn or of kt, is each stiffness's
        self.kind = np.array([int(name == "ln_kt") for name in simulated.coordinates])
        self.x = np.log(records.force / simulated.pivot_of(records))
        of_mode = np.eye(modes)[records.mode]
        self.bias_rows = np.hstack([of_mode, of_mode * self.x[:, None]])
        bias, none = simulated.bias, np.zeros(modes)
        priors = [
            simulated.prior,
            [SMOOTH_EXPONENT[:2]],
            np.column_stack([np.log1p(simulated.offset), bias]),
            np.column_stack([none, BIAS_TILT * bias]),
            [(0.0, TENSION * bias.mean())],
        ]
        self.prior = Prior(*np.vstack(priors).T.copy())
        self.own = simulated.biases
        self.same_hold = (hold[:, None] == hold).astype(float)

    def structures(
        self, theta: ndarray, one: Mechanism, values: ndarray, changed: ndarray
    ) -> tuple[ndarray, ndarray, ndarray]:
        """Changed matrices, by the modes' shapes at each record's place."""
        points = np.clip(self._places(theta, changed, 0.0), self.surface.low, self.surface.high)
        return solved_change(self.records, self.simulated.ritz, one, values, points)

    def ln_k(self, theta: ndarray) -> ndarray:
        """By the law."""
        return theta[: self.count, None] + theta[self.count] * self.x

    def _places(self, theta: ndarray, changed: ndarray, load: ndarray | float) -> ndarray:
        """(ln k..., load of the model) of each record."""
        own = (self.records.force + load) / self.simulated.per_load - self.simulated.shift
        return np.vstack([self.ln_k(theta) + changed[self.kind], own]).T

    def at(self, theta: ndarray, changes: ndarray, by_place: ndarray | float = 0.0) -> Said:
        """The surface at each record's place, and the bias."""
        count = self.count
        places = self._places(theta, changes[:, :2].T, changes[:, 2])
        value, g, second = self._of_places(places)
        tension = g[:, count] * places[:, count]
        mean = value + self.bias_rows @ theta[self.own]
        by_k = (g + by_place)[:, :count]
        # The first order of the tension's error; how it changes with the rest is of the second.
        return Said(
            mean + theta[-1] * tension,
            np.hstack([by_k, self.others(by_k, tension)]),
            self.together(g),
            lambda: self._turning(second(), theta.size),
        )  # fmt: skip

    def others(
        self, by_k: Float[ndarray, "record stiffness"], tension: Float[ndarray, " record"]
    ) -> Float[ndarray, "record other"]:
        """Slopes by the parameters behind the stiffnesses. tension: slope by ln of the load."""
        exponent = by_k.sum(axis=1) * self.x
        return np.hstack([exponent[:, None], self.bias_rows, tension[:, None]])

    def _turning(self, second: ndarray, size: int) -> tuple[ndarray, ndarray]:
        """Derivatives of `together` by the parameters and by (ln kn, ln kt, load)."""
        by_place = self.together(second)
        turn = np.zeros((len(second), size, 3))
        turn[:, : self.count] = by_place[:, : self.count]
        turn[:, self.count] = by_place[:, : self.count].sum(axis=1) * self.x[:, None]
        return turn, self.together(by_place.transpose(0, 2, 1))

    def _of_places(
        self, places: Float[ndarray, "record coordinate"]
    ) -> tuple[ndarray, ndarray, Callable[[], ndarray]]:
        """ln f of each record's mode at its place, its gradient, and what makes its curvature."""
        points, where = distinct(np.column_stack([places, self.records.mode]))
        value, g, second = ln_frequency(self.surface, points[:, -1].astype(int), points[:, :-1])
        return value[where], g[where], lambda: second()[where]

    def together(self, g: Float[ndarray, "*point coordinate"]) -> Float[ndarray, "*point 3"]:
        """Gradients by all kn alike, by all kt alike, and by the records' load."""
        of_k = [g[..., : self.count][..., self.kind == kind].sum(axis=-1) for kind in (0, 1)]
        return np.stack([*of_k, g[..., self.count] / self.simulated.per_load], axis=-1)

    def scatter(self, g: ndarray, scales: ndarray) -> tuple[ndarray, Slopes]:
        """kn and kt of a clamping, correlated, and its reading of the force."""
        return scatter_of_clampings(g, scales, self.rounding, self.same_hold)

    def turned(
        self, g: ndarray, turn: ndarray, scales: ndarray, vector: ndarray, matrix: ndarray
    ) -> tuple[ndarray, ndarray]:
        """As the interface says."""
        spread = g @ of_clamping(scales, self.rounding)[0]
        held = self.same_hold @ (vector[:, None] * spread)
        others = self.same_hold @ (vector[:, None, None] * turn).reshape(len(g), -1)
        times = np.einsum("npc,nc->np", turn, held)
        times += np.einsum("npc,nc->np", others.reshape(turn.shape), spread)
        return times, 2.0 * np.einsum("npc,nc->p", turn, (self.same_hold * matrix) @ spread)
