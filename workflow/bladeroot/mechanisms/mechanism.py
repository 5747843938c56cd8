"""What a mechanism is: the one interface between the catalogue, the fit and the simulation.

A file of the catalogue holds one `MECHANISM`. Its hooks say what it changes: `stick` the contact
stiffness, the axial force or the frequency of a record; `structure` the matrices; `damping` the
stuck joint's loss factor; `curve` frequency and damping over amplitude; `finding` is what the
records' own check calls it. Hooks take the parameters' values and return effects with their
derivatives, so that every fit is a Newton fit.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray

from bladeroot.structure.ritz import Ritz
from bladeroot.structure.sensitivity import Change

CLASSES = ("amplitude", "force-law", "level", "time", "direction", "record")
COORDINATES = ("ln_kn", "ln_kt", "force", "ln_f")  # what a `stick` law may change
VARIABLES = ("force", "time", "since", "sign")  # what a law on records may be one of


@dataclass(frozen=True)
class Parameter:
    """A parameter with its Gaussian prior; `low` and `high` are what is physically possible.

    With `log` the prior is of the parameter's logarithm: `mean` is then its median (in the
    parameter's own unit) and `std` that of the logarithm.
    """

    name: str
    unit: str
    mean: float
    std: float
    low: float
    high: float
    source: str
    log: bool = False

    def __post_init__(self) -> None:
        """ValueError for a prior that is none, or that its limits shut out."""
        if not 0.0 < self.std < np.inf:
            raise ValueError(f"parameter {self.name}: std must be positive, got {self.std}")
        if self.log and not self.mean > 0.0:
            raise ValueError(
                f"parameter {self.name}: mean must be positive with log, got {self.mean}"
            )
        if not (self.low < self.high and self.low <= self.mean <= self.high):
            raise ValueError(
                f"parameter {self.name}: expected low <= mean <= high, got {self.low}, "
                f"{self.mean}, {self.high}"
            )

    @property
    def start(self) -> float:
        """Mean of the Gaussian in the fit's coordinate."""
        return float(np.log(self.mean)) if self.log else self.mean

    def value(self, coordinate: float) -> float:
        """The parameter itself at a coordinate of the fit."""
        return float(np.exp(coordinate)) if self.log else float(coordinate)


@dataclass(frozen=True)
class Records:
    """The situations of the stick frequencies, one entry a record.

    sign: +1 loading, -1 unloading, 0 unknown. time: s since the campaign began; since: s since the
    first record of its hold; both 0 where unknown. span, hold_span: s, the longest of each.
    """

    mode: Int[ndarray, " record"]
    force: Float[ndarray, " record"]
    sign: Float[ndarray, " record"]
    time: Float[ndarray, " record"]
    since: Float[ndarray, " record"]
    span: float
    hold_span: float


@dataclass(frozen=True)
class StickEffect:
    """Changes of ln kn, ln kt, axial force (N) and ln f, and each one's derivatives.

    Parts that a mechanism leaves alone are missing. Derivatives have a column a parameter.
    """

    changes: dict[str, Float[ndarray, " record"]] = field(default_factory=dict)
    slopes: dict[str, Float[ndarray, "record parameter"]] = field(default_factory=dict)


@dataclass(frozen=True)
class Points:
    """Points of the curves over amplitude: mode, axial force (N), amplitude at the sensor (m), and
    the loss factor of the plateau.
    """

    mode: Int[ndarray, " point"]
    force: Float[ndarray, " point"]
    amplitude: Float[ndarray, " point"]
    loss: Float[ndarray, " point"]


@dataclass(frozen=True)
class CurveEffect:
    """Changes of ln f and of the loss factor over amplitude, with derivatives."""

    ln_f: Float[ndarray, " point"]
    loss: Float[ndarray, " point"]
    ln_f_slope: Float[ndarray, "point parameter"]
    loss_slope: Float[ndarray, "point parameter"]


StickHook = Callable[[Records, Float[ndarray, " parameter"]], StickEffect]
# Change of ln(loss factor) of the stuck joint, and its derivatives.
DampingHook = Callable[
    [Records, Float[ndarray, " parameter"]],
    tuple[Float[ndarray, " record"], Float[ndarray, "record parameter"]],
]
CurveHook = Callable[[Points, Float[ndarray, " parameter"]], CurveEffect]
# The change of the matrices at some values of the parameters, and its derivative by each.
StructureHook = Callable[[Ritz, Float[ndarray, " parameter"]], tuple[Change, list[Change]]]


@dataclass(frozen=True)
class Mechanism:
    """One possible cause.

    sentence: what it is. splitter: the measurement that would tell it from its siblings. course:
    factor by which a `structure` hook's effect differs between records. over: what a law on records
    is a function of (force, time, since, sign); in these it is only trusted to some per cent. A
    `stick` law over the force is given the force that there is, as other causes change it.
    starts: coordinates of the fit to begin from besides the prior's mean, a row a start.
    measured_by: the independent measurement of its first parameter, as campaigns call it. needed:
    whether it is never named by itself without that, for its siblings explain the same data.
    finding: ids of findings, joined by semicolons. spoils: whether a record with such a finding is
    no use for curves.
    """

    id: str
    kind: str
    sentence: str
    parameters: tuple[Parameter, ...]
    splitter: str
    stick: StickHook | None = None
    structure: StructureHook | None = None
    course: Callable[[Records], Float[ndarray, " record"]] | None = None
    curve: CurveHook | None = None
    damping: DampingHook | None = None
    finding: str = ""
    over: tuple[str, ...] = ("force",)
    starts: tuple[tuple[float, ...], ...] = ()
    measured_by: str = ""
    needed: bool = False
    spoils: bool = False

    def __post_init__(self) -> None:
        """ValueError for an unknown class or variable, no parameter, not one hook, or no chance of
        a finding.
        """
        if self.kind not in CLASSES:
            raise ValueError(f"class must be one of {', '.join(CLASSES)}, got {self.kind!r}")
        if not set(self.over) <= set(VARIABLES):
            raise ValueError(f"over must be of {', '.join(VARIABLES)}, got {self.over}")
        if self.finding and not (self.parameters and 0.0 < self.parameters[0].mean < 1.0):
            raise ValueError(f"mechanism {self.id}: its share must be expected between 0 and 1")
        if not self.parameters:
            raise ValueError(f"mechanism {self.id}: expected at least one parameter")
        if sum(hook is not None for hook in self.hooks) != (0 if self.finding else 1):
            raise ValueError(f"mechanism {self.id}: expected one hook or a finding")

    @property
    def hooks(self) -> tuple:
        """The hooks, None where there is none."""
        return (self.stick, self.structure, self.curve, self.damping)

    @property
    def start(self) -> Float[ndarray, " parameter"]:
        """Means of the priors in the fit's coordinates."""
        return np.array([p.start for p in self.parameters])

    @property
    def std(self) -> Float[ndarray, " parameter"]:
        """Standard deviations of the priors in the fit's coordinates."""
        return np.array([p.std for p in self.parameters])

    def values(
        self, coordinates: Float[ndarray, " parameter"]
    ) -> tuple[Float[ndarray, " parameter"], Float[ndarray, " parameter"]]:
        """Values of the parameters, and their derivative by the fit's coordinates."""
        log = np.array([p.log for p in self.parameters])
        values = np.where(log, np.exp(np.where(log, coordinates, 0.0)), coordinates)
        return values, np.where(log, values, 1.0)

    @property
    def channel(self) -> str:
        """Which data show it: `stick`, `damping`, `curve` or `record`."""
        if self.finding:
            return "record"
        if self.damping is not None:
            return "damping"
        return "curve" if self.curve is not None else "stick"
