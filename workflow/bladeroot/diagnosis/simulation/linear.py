"""No simulation at all: each mode is a linear one, with constant frequency and loss factor.

Over a load its frequency follows stress stiffening, f^2 = f0^2 (1 + F/Fc): a line in f^2 over F,
which bends a little downwards, as a mode's shape gives way (perturbation of second order). A speed
stiffens by its square (Southwell).
Level, line and bend are free, so that nothing is said of kn and kt, of the load's gauge or of what
is the same at all loads; all else is judged as with a structure. A law of the contact stiffness
acts on the part of a mode's stiffness that goes through the joint. How the modes' parts differ is
free, but not how large they are on the whole: sizes of such laws are as if that were JOINT, and
their errors hold a factor of JOINT_DOUBT in that.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray

from bladeroot.diagnosis.simulation.interface import Said, Simulation
from bladeroot.diagnosis.simulation.one_mode import OneMode
from bladeroot.inference.problem import Prior, Slopes
from bladeroot.mechanisms.mechanism import Mechanism, Records

LEVEL = 0.3  # of ln f about the expected frequency: another mode lies further
STIFFENING = 0.3  # of f^2 over the range of the load
# Of f^2, over the square of what the line gains: clamped beams bend by 0.03 to 0.07, a string not.
BEND = (0.04, 0.03)
# Part of the stiffness that goes through the joint, geometric mean of the modes: a large one, so
# that no law's size is beyond its limits for want of it; and ln of a mode's part over it.
JOINT = 0.3
JOINT_SPREAD = 1.5
# By which that mean may be less, one standard deviation: 2 % in the shipped dovetail, 5 % in a lap.
JOINT_DOUBT = 10.0
# ln of the scatter of a frequency between clampings, what all modes share and each mode's own.
SCATTER = (np.log(2e-4), 1.5)
SPEED = "rpm"  # unit of a load whose square stiffens
_LEAST = 0.05  # of f^2, where a line in it would pass zero


@dataclass(frozen=True)
class Linear(Simulation):
    """expected: Hz, by mode. load: whether the records have a load. power: of the load over its
    zero that stiffens; a speed's is 2, for its centrifugal force.
    """

    modes: tuple[str, ...]
    expected: Float[ndarray, " mode"]
    load: bool
    power: float = 1.0
    zero: float = 0.0
    structure: str = ""
    kind: str = "none"
    knows_contact: bool = False
    load_range: tuple[float, float] = (-np.inf, np.inf)

    def of_records(
        self, records: Records, hold: Int[ndarray, " record"], rounding: float
    ) -> "_OfRecords":
        """As the interface says."""
        return _OfRecords(self, records, hold, rounding)

    def silent(self, one: Mechanism) -> str:
        """Levels and the gauge, and laws of a load where there is none."""
        if not self.load and one.kind == "direction":
            return "the campaign states no load"
        if one.kind == "level":
            return "what is the same at all loads is free"
        if one.stick is None:
            return ""
        changed = acts_on(one)
        if changed == {"force"} and not {"since", "time", "sign"} & set(one.over):
            return "the line over the load is free, and with it the {gauge}'s scale and zero"
        if not self.load and (changed == {"force"} or one.over == ("force",)):
            return "the campaign states no load"
        return ""

    def doubt(self, one: Mechanism) -> float:
        """The joint's part is assumed: where it is less, laws of its stiffness are larger."""
        of_joint = one.stick is not None and acts_on(one) & {"ln_kn", "ln_kt"}
        return JOINT_DOUBT - 1.0 if of_joint else 0.0


def acts_on(one: Mechanism) -> set[str]:
    """Which coordinates of a record a law changes."""
    some = np.array([6e3, 12e3])
    none = np.zeros(2)
    records = Records(np.zeros(2, int), some, np.array([1.0, -1.0]), none, none, 1.0, 1.0, none)
    return set(one.stick(records, one.values(one.start)[0]).changes)


class _OfRecords(OneMode):
    """Parameters: ln f, line and bend of each mode, ln of its joint's part over the others'."""

    scales = (SCATTER, SCATTER)

    def __init__(self, simulated: Linear, records: Records, hold: ndarray, rounding: float) -> None:
        self.records, self.rounding = records, rounding
        self.modes = modes = len(simulated.modes)
        self.of_mode = np.eye(modes)[records.mode]
        self.power, self.zero = simulated.power, simulated.zero
        stiffens = (records.force - self.zero) ** self.power
        low, high = stiffens.min(initial=np.inf), stiffens.max(initial=-np.inf)
        self.range = float(high - low) if high > low else np.inf
        self.middle = 0.5 * float(low + high) if records.force.size else 0.0
        self.prior = Prior(
            np.concatenate([np.log(simulated.expected), np.repeat([0.0, BEND[0], 0.0], modes)]),
            np.repeat([LEVEL, STIFFENING, BEND[1], JOINT_SPREAD], modes),
        )
        self.same_hold = hold[:, None] == hold
        self.same_mode = records.mode[:, None] == records.mode

    def at(self, theta: ndarray, changes: ndarray, by_place: ndarray | float = 0.0) -> Said:
        """The line at each record's load, and the joint's part of what a law changes."""
        m = self.records.mode
        level, line, bend, joint = theta.reshape(4, self.modes)[:, m]
        load = self.records.force + changes[:, 2] - self.zero
        u = (load**self.power - self.middle) / self.range
        gain = line * u
        square = np.maximum(1.0 + gain - bend * gain**2, _LEAST)
        by_gain = 0.5 * (1.0 - 2.0 * bend * gain) / square
        part = JOINT * np.exp(joint - theta[3 * self.modes :].mean())
        # springs in series: what the joint loses, the mode loses by its part
        both = 0.5 * (changes[:, 0] + changes[:, 1])
        mean = level + 0.5 * np.log(square) + 0.5 * part * both
        slope = np.hstack(
            [
                self.of_mode,
                self.of_mode * (by_gain * u)[:, None],
                self.of_mode * (-0.5 * gain**2 / square)[:, None],
                (self.of_mode - 1.0 / self.modes) * (0.5 * part * both)[:, None],
            ]
        )
        by_k = 0.25 * part
        by_load = self.power * load ** (self.power - 1.0) / self.range
        gradient = np.stack([by_k, by_k, by_gain * line * by_load], axis=1)
        return Said(mean, slope, gradient)

    def scatter(self, gradient: ndarray, scales: ndarray) -> tuple[ndarray, Slopes]:
        """What all modes of a clamping share, each mode's own, and the reading of the load."""
        shared, own = (np.exp(2.0 * scale) for scale in scales)
        parts = [shared * self.same_hold, own * self.same_hold * self.same_mode]
        read = self.rounding * gradient[:, 2]
        whole = parts[0] + parts[1] + np.outer(read, read) * self.same_hold
        return whole, lambda: [2.0 * part for part in parts]
