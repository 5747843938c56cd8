"""Specimens: what is true of the frequencies of a joint, and the model that the analyst has of it.

A specimen is one of its own frames (another mesh, geometry and material than the analyst's) or the
shipped dovetail with beam, slots and tension changed smoothly. Frequencies come from this file's
own eigenvalues; the parametric model of the dovetail is read as a public artifact.
"""

import pickle
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import scipy.linalg
import xarray as xr

from foreign_lab.jointed_beam import Geometry, as_it_is, assemble, draw_geometry
from foreign_lab.surface import Surface, sample

MODES = ("1B", "2B", "3B")
SHIPPED = "dovetail-HB"
FORCE = (0.0, 30e3)
WIDE = np.log(8.0)  # how far kn and kt may go from their nominal values
BIAS = 0.005  # the shipped default: standard deviation of the model's frequency, per mode
SPECIMENS = 6  # of a set; the first is the shipped one


@dataclass(frozen=True)
class Specimen:
    """Truth by mode, nominal contact (ln N/m), the laser's places (m), the analyst's geometry.

    `told` is None where the analyst has the shipped structure.
    """

    name: str
    surfaces: dict[str, Surface]
    ln_kn: float
    ln_kt: float
    laser: dict[str, float]
    told: Geometry | None


def shares(surface: Surface, ln_kn: float, ln_kt: float, force: float) -> tuple[float, float]:
    """Normal and tangential contact's part of a mode's modal stiffness (Hellmann-Feynman)."""
    return (
        2.0 * float(surface.slope(0, ln_kn, ln_kt, force)),
        2.0 * float(surface.slope(1, ln_kn, ln_kt, force)),
    )


def specimen(seed: int, folder: Path, shipped: Path) -> Specimen:
    """The specimen of a campaign's seed, from the cache in `folder` if it is there.

    `shipped`: `parametric.nc` of the shipped structure.
    """
    rng = np.random.default_rng([seed, 1])
    block, index = seed // 1000, 0 if rng.random() < 0.3 else int(rng.integers(1, SPECIMENS))
    path = folder / f"specimen-{block}-{index}.pickle"
    if path.is_file():
        return pickle.loads(path.read_bytes())
    rng = np.random.default_rng([block, index, 2])
    made = _dovetail(rng, shipped) if index == 0 else _own(rng, f"specimen-{block}-{index}")
    folder.mkdir(parents=True, exist_ok=True)
    path.write_bytes(pickle.dumps(made))
    return made


def _own(rng: np.random.Generator, name: str) -> Specimen:
    """Frames are drawn until a contact stiffness exists that takes the drawn part of the energy."""
    for _ in range(100):
        told = draw_geometry(rng)
        true = as_it_is(rng, told)
        wanted, ratio = rng.uniform(0.015, 0.12), rng.uniform(0.5, 1.5)
        system = FrameSystem(true, laser={"1B": 0.0, "2B": -0.2, "3B": 0.0})
        for ln_kt in np.log(np.geomspace(8e9, 0.35e9, 14)):
            ln_kn = ln_kt + np.log(ratio)
            _, tangential, frequency = system.parts(ln_kn, ln_kt, 12e3)
            if tangential[0] >= wanted:
                break
        if 0.015 < tangential[0] < 0.15 and frequency[0] > 100 and frequency[1] < 2000:
            break
    else:
        raise RuntimeError("no specimen with the wanted contact energy in 100 draws")
    laser = {mode: float(system.laser_x[mode]) for mode in MODES}
    surfaces = _surfaces(system, ln_kn, ln_kt)
    return Specimen(name, surfaces, ln_kn, ln_kt, laser, told)


def _dovetail(rng: np.random.Generator, shipped: Path) -> Specimen:
    system = ShippedSystem(shipped, 1 + 3e-3 * rng.normal(), np.exp(0.15 * rng.normal()),
                           1 + 0.02 * rng.normal())  # fmt: skip
    ln_kn = np.log(1.4e9) + rng.uniform(-0.3, 0.3)
    ln_kt = np.log(2.1e9) + rng.uniform(-0.3, 0.3)
    return Specimen(SHIPPED, _surfaces(system, ln_kn, ln_kt), ln_kn, ln_kt, system.laser_x, None)


def _surfaces(system, ln_kn: float, ln_kt: float) -> dict[str, Surface]:
    low = np.array([ln_kn - WIDE, ln_kt - WIDE, FORCE[0]])
    high = np.array([ln_kn + WIDE, ln_kt + WIDE, FORCE[1]])
    coefficients = sample(system.ln_frequencies, low, high)
    motion = system.motion(ln_kn, ln_kt, 12e3)
    return {mode: Surface(coefficients[k], low, high, *motion[k]) for k, mode in enumerate(MODES)}


class FrameSystem:
    """Modes of an own frame."""

    def __init__(self, geometry: Geometry, laser: dict[str, float]):
        """`laser`: places along the beam as parts of its length."""
        self.parts_of = assemble(geometry)
        self.gap2 = self.parts_of.gap.T @ self.parts_of.gap
        self.slip2 = self.parts_of.slip.T @ self.parts_of.slip
        self.heavy = geometry.density * geometry.width * geometry.depth * geometry.length  # kg
        x = self.parts_of.axis_x
        self.at = {m: int(np.argmin(abs(x - p * geometry.length))) for m, p in laser.items()}
        self.laser_x = {mode: x[k] for mode, k in self.at.items()}

    def modes(self, ln_kn: float, ln_kt: float, force: float) -> tuple[np.ndarray, np.ndarray]:
        """omega^2 and mass-normalised shapes of 1B, 2B, 3B: bending in Z, told by parity."""
        a = self.parts_of
        k = a.stiffness + force * a.geometric
        k = k + np.exp(ln_kn) * self.gap2 + np.exp(ln_kt) * self.slip2
        values, shapes = scipy.linalg.eigh(k, a.mass, subset_by_index=[0, 9])
        w, v = shapes[a.axis_z], shapes[a.axis_z - 1]
        # modes of the slots alone hardly move the axis
        bends = (w**2).sum(axis=0) > np.maximum((v**2).sum(axis=0), 0.02 / self.heavy * len(w))
        even = (w * w[::-1]).sum(axis=0) > 0
        evens, odds = np.flatnonzero(bends & even), np.flatnonzero(bends & ~even)
        chosen = [evens[0], odds[0], evens[1]]
        return values[chosen], shapes[:, chosen]

    def ln_frequencies(self, ln_kn: float, ln_kt: float, force: float) -> np.ndarray:
        """ln f of the three modes."""
        values, _ = self.modes(ln_kn, ln_kt, force)
        return 0.5 * np.log(values) - np.log(2 * np.pi)

    def parts(self, ln_kn: float, ln_kt: float, force: float):
        """Normal and tangential part of each mode's stiffness, and the frequencies."""
        values, shapes = self.modes(ln_kn, ln_kt, force)
        normal = np.exp(ln_kn) * ((self.parts_of.gap @ shapes) ** 2).sum(axis=0) / values
        slip = np.exp(ln_kt) * ((self.parts_of.slip @ shapes) ** 2).sum(axis=0) / values
        return normal, slip, np.sqrt(values) / (2 * np.pi)

    def motion(self, ln_kn: float, ln_kt: float, force: float) -> list[tuple]:
        """rms slip, rms gap per metre at the laser, modal mass there, of each mode."""
        _, shapes = self.modes(ln_kn, ln_kt, force)
        found = []
        for k, mode in enumerate(MODES):
            there = abs(shapes[self.parts_of.axis_z[self.at[mode]], k])
            slip = np.sqrt(((self.parts_of.slip @ shapes[:, k]) ** 2).sum() / 4) / there
            gap = np.sqrt(((self.parts_of.gap @ shapes[:, k]) ** 2).sum() / 4) / there
            found.append((slip, gap, 1 / there**2))
        return found


class ShippedSystem:
    """Modes of the shipped dovetail in its published bases, with changed beam, slots, tension."""

    def __init__(self, path: Path, beam: float, slots: float, tension: float):
        """Factors of the stiffness of the beam and the slots and of the tension's effect."""
        with xr.open_dataset(path) as data:
            self.data = data.load()
        self.factors = (beam, slots, tension)
        self.laser_x, self.bases = {}, []
        # each basis spans the bending modes below its own, too, so that order tells them
        for mode, wanted in zip(MODES, (0.0, -0.07, 0.0), strict=True):
            one = self.data.sel(mode=mode)
            n = int(one.vectors)
            x = one.display_x.values
            at = int(np.argmin(abs(x - wanted)))
            self.laser_x[mode] = float(x[at])
            square = {
                name: one[name].values[:n, :n]
                for name in ("beam", "slots", "geometric", "gap", "slip")
            }
            shown = one.display.values[at, 2, :n]
            self.bases.append((square, shown))

    def _mode(self, k: int, ln_kn: float, ln_kt: float, force: float) -> tuple[float, np.ndarray]:
        square, _ = self.bases[k]
        beam, slots, tension = self.factors
        whole = beam * square["beam"] + slots * square["slots"]
        whole = whole + tension * force * square["geometric"]
        for k_contact, name in ((np.exp(ln_kn), "gap"), (np.exp(ln_kt), "slip")):
            whole = whole + k_contact * square[name].T @ square[name]
        values, shapes = scipy.linalg.eigh(whole, subset_by_index=[k, k])
        return values[0], shapes[:, 0]

    def ln_frequencies(self, ln_kn: float, ln_kt: float, force: float) -> np.ndarray:
        """ln f of the three modes."""
        values = [self._mode(k, ln_kn, ln_kt, force)[0] for k in range(len(MODES))]
        return 0.5 * np.log(values) - np.log(2 * np.pi)

    def motion(self, ln_kn: float, ln_kt: float, force: float) -> list[tuple]:
        """rms slip, rms gap per metre at the laser, modal mass there, of each mode."""
        found = []
        for k in range(len(MODES)):
            square, shown = self.bases[k]
            _, shape = self._mode(k, ln_kn, ln_kt, force)
            there = abs(shown @ shape)
            slip = np.sqrt(((square["slip"] @ shape) ** 2).sum() / 4) / there
            gap = np.sqrt(((square["gap"] @ shape) ** 2).sum() / 4) / there
            found.append((slip, gap, 1 / there**2))
        return found
