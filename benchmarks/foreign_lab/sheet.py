"""The records of a campaign with what is true of each; laws read it."""

from dataclasses import dataclass, field

import numpy as np

from foreign_lab.specimen import Specimen


@dataclass
class Sheet:
    """Arrays a record each, and the specimen.

    mode: its name. reading: force that the gauge shows, N. hold: number of the clamping. direction:
    1 loading, -1 unloading. time, in_hold: s since the campaign's and the clamping's begin. group:
    operator, 0 or 1. start: amplitude at the laser at release, m. turning: force at which the
    loading turned, N. clamped: how many clampings before. temperature: K off the mean.
    first: how many records the campaign had before any further ones were asked for.
    ln_kn, ln_kt, force, ln_f, ln_eta: the state, which effects change; `begun` is it before them.
    """

    specimen: Specimen
    mode: np.ndarray
    reading: np.ndarray
    hold: np.ndarray
    direction: np.ndarray
    time: np.ndarray
    in_hold: np.ndarray
    group: np.ndarray
    start: np.ndarray
    turning: np.ndarray
    clamped: np.ndarray
    temperature: np.ndarray
    reference: float  # N, middle of the loads
    state: dict[str, np.ndarray] = field(default_factory=dict)
    begun: dict[str, np.ndarray] = field(default_factory=dict)
    first: int | None = None

    def planned(self, name: str) -> np.ndarray:
        """A column of the campaign as it was first made: what laws take their scales from."""
        return getattr(self, name)[: self.first]

    def usual_start(self, mode: str) -> float:
        """Median amplitude (m) of a mode's records at release."""
        return float(np.median(self.planned("start")[self.planned("mode") == mode]))

    def surface(self, record: int):
        """Frequencies of the record's mode."""
        return self.specimen.surfaces[self.mode[record]]

    def ln_frequency(self, state: dict[str, np.ndarray] | None = None) -> np.ndarray:
        """ln f of the stuck joint of every record."""
        s = self.state if state is None else state
        result = np.zeros(len(self.mode))
        for name, surface in self.specimen.surfaces.items():
            mine = self.mode == name
            result[mine] = surface.ln_frequency(
                s["ln_kn"][mine], s["ln_kt"][mine], s["force"][mine]
            )
        return result + s["ln_f"]


@dataclass(frozen=True)
class Record:
    """One row of the sheet with its joint: what laws over amplitude need."""

    sheet: Sheet
    index: int

    @property
    def mode(self) -> str:
        """The mode's name."""
        return self.sheet.mode[self.index]

    def at(self, name: str) -> float:
        """A number of the sheet or of the state."""
        source = self.sheet.state if name in self.sheet.state else vars(self.sheet)
        return float(source[name][self.index])

    @property
    def surface(self):
        """Frequencies of the mode."""
        return self.sheet.surface(self.index)

    @property
    def point(self) -> tuple[float, float, float]:
        """ln kn, ln kt, F."""
        return self.at("ln_kn"), self.at("ln_kt"), self.at("force")

    @property
    def omega(self) -> float:
        """Stuck angular frequency, rad/s."""
        return float(2 * np.pi * np.exp(self.surface.ln_frequency(*self.point) + self.at("ln_f")))

    @property
    def load(self) -> float:
        """Force over the middle of the loads."""
        return max(self.at("force") / self.sheet.reference, 0.02)

    def softened(self, axis: int, ratio: np.ndarray) -> np.ndarray:
        """Change of ln f if kn (0) or kt (1) falls to `ratio` of itself."""
        kn, kt, force = self.point
        moved = [kn, kt]
        moved[axis] = moved[axis] + np.log(ratio)
        return self.surface.ln_frequency(*moved, force) - self.surface.ln_frequency(kn, kt, force)

    def share(self, axis: int, ratio: np.ndarray) -> np.ndarray:
        """Part of the mode's stiffness in kn (0) or kt (1), once it has fallen to `ratio`."""
        kn, kt, force = self.point
        moved = [kn, kt]
        moved[axis] = moved[axis] + np.log(ratio)
        return 2.0 * self.surface.slope(axis, *moved, force)
