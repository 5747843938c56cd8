"""A campaign as it is drawn from a seed: specimen, loads, passes, clampings, excitation, noise."""

from dataclasses import dataclass

import numpy as np

from stranger_lab import laws, plan
from stranger_lab.specimen import Beam

ON_THE_GAUGE = {"zero", "gain", "lagging-load", "relaxation"}  # need a load that acts as tension
SIMULATED_EXPONENT = 0.15  # of contact stiffness over load, where a table of frequencies says so
MOST_ROWS = 96


@dataclass
class Visit:
    """A record: which modes are excited, when and under what."""

    load: int
    direction: str
    clamping: int
    time_s: float  # since the first record
    since_clamping_s: float
    modes: list[int]
    day: int
    operator: str = "A"


@dataclass
class State:
    """What holds in a visit before anything moves."""

    load: float  # N, true, and at least 10
    frequencies_Hz: np.ndarray
    by_kn: np.ndarray
    by_kt: np.ndarray


class Bench:
    """All of a campaign but its signals."""

    def __init__(self, seed: int, kind: str = "", effect: str = ""):
        """Draw it; `kind` and `effect` are drawn too where they are not given."""
        self.seed, rng = seed, np.random.default_rng(seed)
        self.rng = rng
        self.kind, self.model, hidden = plan.drawn(rng, kind, effect)
        self.effects = {name: laws.draw(name, rng) for name in hidden}
        self.tension = bool(rng.integers(2)) or bool(ON_THE_GAUGE & set(hidden))
        if self.model == "none" and "contact-law" in hidden:
            self.tension = False
        self._specimen()
        self._measurement()
        self._visits()
        self._surroundings()

    def _specimen(self) -> None:
        """Dimensions (m), modes, contact (N/m), loss factors, and what no drawing says."""
        rng = self.rng
        self.geometry = {
            "length": round(rng.uniform(0.2, 0.3), 3),
            "thickness": round(rng.uniform(0.010, 0.016), 4),
            "width": round(rng.uniform(0.022, 0.03), 4),
            "root": round(rng.uniform(0.02, 0.032), 3),
        }
        self.beam = Beam(**self.geometry)
        others = [one for one in ("edge1", "flap2", "tors1") if one in self.beam.shapes]
        chosen = rng.permutation(others)[: int(rng.integers(1, 4))]
        self.modes = [one for one in self.beam.shapes if one == "flap1" or one in chosen]
        self.modulus = (1 + rng.normal(0, 0.0035)) ** 2
        self.mode_bias = rng.normal(0, 0.0012, len(self.modes))
        self.kn = 10 ** rng.uniform(8.8, 9.4)
        self.kt = self.kn * 10 ** rng.uniform(-0.35, 0.15)
        self.loss = rng.uniform(0.0015, 0.005, len(self.modes))

    def _measurement(self) -> None:
        """Loads (kN), excitation, sampling, noise (m/s)."""
        rng, count = self.rng, int(self.rng.integers(4, 9))
        spaced, most = (np.geomspace, 4) if rng.random() < 0.5 else (np.linspace, 5)
        self.loads = np.round(spaced(rng.uniform(2, most), rng.uniform(14, 22), count), 1)
        self.excitation = str(rng.choice(["hammer", "release", "shaker"]))
        if {"clipping", "touch"} & set(self.effects):
            self.excitation = "release"
        tension = 1e3 * self.loads.mean() * self.tension
        self.expected_Hz = self.beam.frequencies(self.modes, self.kn, self.kt, tension)
        self.largest = rng.uniform(15e-6, 60e-6) * (3 if "hardening" in self.effects else 1)  # m
        self.sampling_Hz = 25600 if self.expected_Hz.max() * 2.6 > 6000 else 12800
        self.speed = self.largest * 2 * np.pi * self.expected_Hz[0]  # m/s
        self.noise = self.speed * 10 ** rng.uniform(-4.3, -3.5)
        together = len(self.modes) if self.excitation == "hammer" else 1
        self.full_scale = 2.2 * self.speed * together  # m/s

    def _passes(self) -> list[str]:
        """`up` and `down`, as often as there is time for."""
        few, both = len(self.loads) < 7, self.rng.random() < 0.8 or "lagging-load" in self.effects
        repeats = int(self.rng.integers(2, 4) if few else self.rng.integers(1, 3))
        one = ["up", "down"] if both else ["up"]
        size = len(self.loads) * len(self.modes) * len(one)
        while size * repeats > MOST_ROWS and repeats > 1:
            repeats -= 1
        return one * repeats

    def _visits(self) -> None:
        """The sheet's order: passes over the loads, a clamping for each load or for each pass."""
        rng, passes, self.visits = self.rng, self._passes(), []
        gaps = rng.random() < 0.35
        each = rng.random() < 0.75 or bool({"lagging-load", "relaxation"} & set(self.effects))
        repeats = 1 if len(self.loads) * len(passes) * len(self.modes) > 40 else 2
        repeats = 3 if "relaxation" in self.effects else repeats
        numbers = list(range(len(self.modes)))
        groups = [numbers] if self.excitation == "hammer" else [[one] for one in numbers]
        clamping, now = 0, 0.0
        for turn, direction in enumerate(passes):
            if turn and rng.random() < 0.5:
                now += rng.uniform(10, 20) * 3600  # another day
            order = list(range(len(self.loads)))[:: 1 if direction == "up" else -1]
            for load in order:
                if gaps and rng.random() < 0.15:
                    continue
                clamping += each or load == order[0]
                now += rng.uniform(200, 700)
                clamped = now
                count = repeats + (int(rng.integers(-1, 2)) if gaps else 0)
                for group in groups * max(count, 1):
                    now += rng.uniform(40, 160)
                    since, day = now - clamped, int(now // 43200)
                    self.visits.append(
                        Visit(load, direction, clamping, now, since, list(group), day)
                    )
        begin = self.visits[0].time_s
        for one in self.visits:
            one.time_s -= begin
        self.clampings, self.span_s = max(clamping, 1), self.visits[-1].time_s

    def _surroundings(self) -> None:
        """Scatter of clampings, operators, temperature (C), damp days, the gauge's own gain."""
        rng, shape = self.rng, (self.clampings + 1, 2)
        self.scatter, heavy = rng.uniform(0.02, 0.06), rng.random() < 0.3
        drawn = rng.standard_t(3, shape) / np.sqrt(3) if heavy else rng.normal(size=shape)
        alike = rng.uniform(0.3, 0.9)
        root = np.linalg.cholesky([[1, alike], [alike, 1]])
        self.contact = self.scatter * drawn @ root.T
        operators = rng.choice(["A", "B"], self.clampings + 1)
        for one in self.visits:
            one.operator = str(operators[one.clamping])
        self.with_group = "operator" in self.effects and bool(rng.integers(2))
        times = np.array([one.time_s for one in self.visits])
        self.temperature = 20 + rng.normal(0, 0.3, len(times))
        if one := self.effects.get("temperature"):
            turn = 2 * np.pi * times / 86400 * one["cycles_a_day"]
            self.temperature += one["range_K"] * (0.5 - 0.5 * np.cos(turn))
        self.damp = rng.uniform(-1, 1, 1000)
        self.gauge = 1 + rng.normal(0, 0.004)
        self.jitter = 1e-5 * rng.uniform(0.5, 2)  # of frequencies, relative

    def simulated(self, load: float) -> float:
        """Contact stiffness over load (N) as the simulation knows it, over that at 10 kN."""
        return (load / 10e3) ** SIMULATED_EXPONENT if self.model == "table" else 1.0

    def state(self, number: int) -> State:
        """The specimen in a visit."""
        visit, effects, rng = self.visits[number], self.effects, self.rng
        stated = 1e3 * self.loads[visit.load] * self.gauge * (1 + rng.normal(0, 0.002))
        load = laws.true_load(effects, stated, visit.direction, visit.since_clamping_s)
        tension, pressing = load * self.tension, max(load, 10.0)
        passed, clamped = visit.time_s / self.span_s, visit.clamping / self.clampings
        change = laws.contact(effects, pressing, passed, clamped, self.span_s)
        kn, kt = (
            k * self.simulated(pressing) * np.exp(scatter + one)
            for k, scatter, one in zip(
                (self.kn, self.kt), self.contact[visit.clamping], change, strict=True
            )
        )
        more_m = effects["tip-mass"]["mass_kg"] * self.beam.tip_mass if "tip-mass" in effects else 0
        crack, more_k = effects.get("crack"), 0.0
        if crack:
            lost = crack["size"] * passed ** crack["power"]
            more_k = -lost * self.beam.slice_stiffness(crack["at"])
        known = (self.modes, kn, kt, tension, self.modulus)
        found = self.beam.frequencies(*known, more_k, more_m) * (1 + self.mode_bias)
        found *= laws.frequency_factor(
            effects, self.temperature[number] - 20, passed, visit.operator == "B"
        )
        found *= np.exp(rng.normal(0, self.jitter, len(found)))
        return State(pressing, found, *self.beam.slopes(*known))

    def truth(self) -> dict:
        """What is sealed."""
        names = ("seed", "kind", "model", "effects", "tension", "modes", "excitation", "geometry")
        numbers = {name: float(getattr(self, name)) for name in ("modulus", "kn", "kt", "scatter")}
        return {name: getattr(self, name) for name in names} | numbers
