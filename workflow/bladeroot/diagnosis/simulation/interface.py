"""What the diagnosis needs of a simulation, whichever it is.

A simulation says ln f of each record with its derivatives by its own parameters and by ln kn, ln kt
and the load, which causes move; how clampings scatter; and of which causes it cannot speak.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import xarray as xr
from jaxtyping import Float, Int
from numpy import ndarray

from bladeroot.inference.problem import Prior, Slopes
from bladeroot.mechanisms.mechanism import Mechanism, Records


@dataclass(frozen=True)
class Said:
    """ln f of each record, and derivatives by the simulation's parameters and by (ln kn, ln kt,
    load) of the record itself.

    turning: works out the derivatives of `gradient` by the two, where they count.
    """

    mean: Float[ndarray, " record"]
    slope: Float[ndarray, "record parameter"]
    gradient: Float[ndarray, "record 3"]
    turning: Callable[[], tuple[ndarray, ndarray]] | None = None


@runtime_checkable
class OfRecords(Protocol):
    """A simulation of the records of one campaign.

    prior: of its parameters. scales: of its clampings' scatter, mean and standard deviation each.
    """

    prior: Prior
    scales: Sequence[tuple[float, float]]

    def structures(
        self,
        theta: Float[ndarray, " parameter"],
        one: Mechanism,
        values: Float[ndarray, " value"],
        changed: Float[ndarray, "2 record"],
    ) -> tuple[Float[ndarray, " record"], Float[ndarray, "record value"], ndarray]:
        """Change of ln f of each record by changed matrices, and its derivatives by the values and
        by the record's place; changed: ln kn and ln kt by other causes.
        """

    def at(
        self, theta: Float[ndarray, " parameter"], changes: Float[ndarray, "record 4"],
        by_place: ndarray | float = 0.0,
    ) -> Said:  # fmt: skip
        """What is simulated with (ln kn, ln kt, load) changed; the fourth change is not in it.

        by_place: further derivatives by the record's place.
        """

    def scatter(
        self, gradient: Float[ndarray, "record 3"], scales: Float[ndarray, " scale"]
    ) -> tuple[Float[ndarray, "record record"], Slopes]:
        """Covariance of ln f by clampings and the reading of the load, and what makes its
        derivatives by the scales.
        """

    def turned(
        self, gradient: Float[ndarray, "record 3"], turn: Float[ndarray, "record parameter 3"],
        scales: Float[ndarray, " scale"], vector: Float[ndarray, " record"],
        matrix: Float[ndarray, "record record"],
    ) -> tuple[Float[ndarray, "record parameter"], Float[ndarray, " parameter"]]:  # fmt: skip
        """Of that covariance's derivatives by parameters that turn the gradient so: products with a
        vector, and traces of those with a symmetric matrix.
        """


@runtime_checkable
class Simulation(Protocol):
    """A simulation before it is asked of any records.

    modes: their names. structure: its name, "" where nothing is simulated. kind: `structure`,
    `table` or `none`. knows_contact: whether it has kn and kt. load_range: the least and the
    largest load, as of the records, that it speaks of. slip: changes `ln_frequency` and
    `loss_factor` over (mode, force, amplitude), if it has any. stiffnesses: of its parameters the
    contact stiffnesses, which stand first, as kn and kt or with their interface; coordinates: which
    of ln kn and ln kt (`mechanism.COORDINATES`) each is. biases: where a structure's
    biases stand among its parameters.
    """

    modes: tuple[str, ...]
    structure: str
    kind: str
    knows_contact: bool
    load_range: tuple[float, float]
    slip: xr.Dataset | None = None
    stiffnesses: tuple[str, ...] = ()
    coordinates: tuple[str, ...] = ()
    biases: slice = slice(0)

    def of_records(
        self, records: Records, hold: Int[ndarray, " record"], rounding: float
    ) -> OfRecords:
        """For the records of a campaign. rounding: standard deviation of the load's reading."""

    def silent(self, one: Mechanism) -> str:
        """Why it cannot speak of a cause, a phrase, or ""."""

    def doubt(self, one: Mechanism) -> float:
        """Standard error of a cause's size by what the simulation supposes, over the size."""
        return 0.0
