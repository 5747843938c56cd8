"""What a mechanism is: the one interface between the catalogue, the fit and the simulation.

A file of the catalogue holds one `MECHANISM`, a physical cause in one or several forms (laws that
the literature has for it). Its hooks say what it changes: `stick` the contact
stiffness, the axial force or the frequency of a record; `structure` the matrices; `damping` the
stuck joint's loss factor; `curve` frequency and damping over amplitude; `finding` is what the
records' own check calls it. Hooks take the parameters' values and return effects with their
derivatives, so that every fit is a Newton fit.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float, Int
from numpy import ndarray

from bladeroot.rom.ritz import Ritz
from bladeroot.rom.sensitivity import Change

CLASSES = ("amplitude", "force-law", "level", "time", "direction", "record")
REFERENCE_FORCE = 12e3  # N, where laws of the axial force are stated
COORDINATES = ("ln_kn", "ln_kt", "force", "ln_f")  # what a `stick` law may change
# What a law on records may be one of.
VARIABLES = ("force", "time", "clamping", "since", "sign", "temperature")
# The most that a parameter with a `tie` may be, over the part of a mode's energy that the
# simulation has in those springs, and twice its error: the flanks' ends, which move most, give way
# beyond their part.
SHARE_MARGIN = 1.5
_AT_LIMIT = 40.0  # of a bounded coordinate, where its parameter has met its limit
ENERGIES = ("tangential", "normal")  # contact springs whose part of a mode's energy bounds a share


@dataclass(frozen=True)
class Parameter:
    """A parameter with its Gaussian prior; `low` and `high` are what is physically possible.

    The prior is of the parameter's logarithm with `log`, of ln((p - low)/(high - p)) with
    `bounded`; `mean` is then its median (in the parameter's own unit) and `std` that of this
    coordinate. ratio: whether it is another mode's value over the first mode's; each mode from the
    second on has its own (`per_mode`), of the mode of that number. tie: one of `ENERGIES` where it
    is a part of a mode's stiffness, or such parts' ratio: the simulation's own part then bounds it.
    """

    name: str
    unit: str
    mean: float
    std: float
    low: float
    high: float
    source: str
    log: bool = False
    bounded: bool = False
    tie: str = ""
    ratio: bool = False
    number: int = 1

    def __post_init__(self) -> None:
        """ValueError for a prior that is none, or that its limits shut out."""
        if self.log and self.bounded:
            raise ValueError(f"parameter {self.name}: expected log or bounded, not both")
        if self.bounded and not self.low < self.mean < self.high < np.inf:
            raise ValueError(
                f"parameter {self.name}: bounded wants low < mean < high, got {self.low}, "
                f"{self.mean}, {self.high}"
            )
        if self.tie and self.tie not in ENERGIES:
            raise ValueError(
                f"parameter {self.name}: tie must be of {', '.join(ENERGIES)}, got {self.tie!r}"
            )
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
        return self.coordinate(self.mean)

    def coordinate(self, value: float) -> float:
        """The fit's coordinate of a value."""
        if self.bounded:
            return float(np.log((value - self.low) / (self.high - value)))
        return float(np.log(value)) if self.log else float(value)

    def value(self, coordinate: float) -> float:
        """The parameter itself at a coordinate of the fit."""
        if self.bounded:
            share = 1.0 / (1.0 + np.exp(-np.clip(coordinate, -_AT_LIMIT, _AT_LIMIT)))
            return float(self.low + (self.high - self.low) * share)
        return float(np.exp(coordinate)) if self.log else float(coordinate)

    def slope(self, value: float) -> float:
        """Derivative of the parameter by the fit's coordinate."""
        if self.bounded:
            return (value - self.low) * (self.high - value) / (self.high - self.low)
        return value if self.log else 1.0


@dataclass(frozen=True)
class Records:
    """The situations of the stick frequencies, one entry a record.

    sign: +1 loading, -1 unloading, 0 unknown. time: s since the campaign began; since: s since the
    first record of its hold; both 0 where unknown. span, hold_span: s, the longest of each.
    temperature: K off the records' mean, None where it is not known of all.
    """

    mode: Int[ndarray, " record"]
    force: Float[ndarray, " record"]
    sign: Float[ndarray, " record"]
    time: Float[ndarray, " record"]
    since: Float[ndarray, " record"]
    span: float
    hold_span: float
    temperature: Float[ndarray, " record"] | None = None

    @cached_property
    def clamping(self) -> Float[ndarray, " record"]:
        """Number of the clamping by when it began, from 0 to 1."""
        number = np.unique(np.round(self.time - self.since), return_inverse=True)[1]
        return number / max(int(number.max(initial=0)), 1)


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


def rows_of(whole, rows: Int[ndarray, " row"] | Bool[ndarray, " whole"]):
    """Some of the rows of a dataclass of arrays; what is no array stays."""
    parts = {one.name: getattr(whole, one.name) for one in fields(whole)}
    arrays = {name: part[rows] for name, part in parts.items() if isinstance(part, ndarray)}
    return replace(whole, **arrays)


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

    sentence: what it is. splitter: the measurement that would tell it from its siblings; both may
    hold names of `bladeroot.terms` in braces. form: name of the law where there are several;
    forms: the others, mechanisms of the same id, of the same first parameter and as likely as this
    one. over: what a law on records is a function of, of
    `VARIABLES`; in these it is only trusted to some per cent. A `stick` law over the force is given
    the force that there is, as other causes change it (moves_load: whether a law's own change of
    the force is one of the load, not only of what the load does to a frequency).
    starts: coordinates of the fit to begin from besides the prior's mean, a row a start.
    measured_by: the independent measurement of its first parameter, as campaigns call it. needed:
    whether it is never named by itself without that, for its siblings explain the same data.
    finding: ids of findings, joined by semicolons. spoils: those of them that leave no use for
    curves.
    """

    id: str
    kind: str
    sentence: str
    parameters: tuple[Parameter, ...]
    splitter: str
    stick: StickHook | None = None
    structure: StructureHook | None = None
    curve: CurveHook | None = None
    damping: DampingHook | None = None
    finding: str = ""
    over: tuple[str, ...] = ("force",)
    moves_load: bool = True
    starts: tuple[tuple[float, ...], ...] = ()
    measured_by: str = ""
    needed: bool = False
    spoils: str = ""
    form: str = ""
    forms: tuple["Mechanism", ...] = ()

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
        hooks = (self.stick, self.structure, self.curve, self.damping)
        if sum(hook is not None for hook in hooks) != (0 if self.finding else 1):
            raise ValueError(f"mechanism {self.id}: expected one hook or a finding")
        names = [one.form for one in self.every_form]
        if len(set(names)) < len(names) or any(one.forms for one in self.forms):
            raise ValueError(
                f"mechanism {self.id}: forms must have names of their own and no forms"
            )
        if any(one.channel != self.channel for one in self.forms):
            raise ValueError(f"mechanism {self.id}: its forms must have its kind of hook")
        # A file that gives a shipped mechanism another id means all of its forms.
        own = tuple(one if one.id == self.id else replace(one, id=self.id) for one in self.forms)
        object.__setattr__(self, "forms", own)

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
        pairs = list(zip(self.parameters, np.asarray(coordinates, float), strict=True))
        values = np.array([p.value(x) for p, x in pairs])
        return values, np.array([p.slope(v) for p, v in zip(self.parameters, values, strict=True)])

    @property
    def every_form(self) -> tuple["Mechanism", ...]:
        """This form and the others."""
        return (self, *self.forms)

    def also(self, form: str, *own: Parameter, keep: int | None = None, **changes) -> "Mechanism":
        """With one more form, as this one but for its name, hook and other `changes`.

        Its parameters are this one's first `keep` (all of them), then its own.
        """
        parameters = (*self.parameters[:keep], *own)
        one = replace(self, form=form, forms=(), parameters=parameters, **changes)
        return replace(self, forms=(*self.forms, one))

    def of_form(self, form: str) -> "Mechanism":
        """The form of that name. ValueError if there is none."""
        for one in self.every_form:
            if one.form == form:
                return one
        raise ValueError(f"mechanism {self.id} has no form {form!r}")

    def tied(
        self, energy: Mapping[str, Sequence[float]], doubt: Mapping[str, float]
    ) -> "Mechanism":
        """The mechanism in a simulation whose contact springs have so much of each mode's energy.

        energy: by `ENERGIES`, first mode first; what is missing stays as any structure allows.
        doubt: standard deviation of the parts' logarithms, as kn and kt are known.
        """
        tied = tuple(
            _tied(p, energy[p.tie], doubt[p.tie]) if p.tie in energy else p for p in self.parameters
        )
        forms = tuple(one.tied(energy, doubt) for one in self.forms)
        return replace(self, parameters=tied, forms=forms)

    @property
    def channel(self) -> str:
        """Which data show it: `stick`, `damping`, `curve` or `record`."""
        if self.finding:
            return "record"
        if self.damping is not None:
            return "damping"
        return "curve" if self.curve is not None else "stick"


def _tied(parameter: Parameter, energy: Sequence[float], doubt: float) -> Parameter:
    """A parameter by what the simulation's modes have of the energy it is a part of."""
    if parameter.ratio:
        if len(energy) < 2:
            return parameter
        mean = float(energy[parameter.number] / energy[0])
        return replace(parameter, mean=float(np.clip(mean, parameter.low, parameter.high)))
    span = parameter.high - parameter.low
    part = min(float(energy[0]), span)
    high = min(SHARE_MARGIN * part * float(np.exp(2.0 * doubt)), span)
    median = (parameter.mean - parameter.low) / span * min(SHARE_MARGIN * part, high)
    return replace(
        parameter, mean=parameter.low + median, high=parameter.low + high,
        std=float(np.hypot(parameter.std, doubt)),
    )  # fmt: skip
