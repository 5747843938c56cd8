"""What a blind case is drawn from: a bench, a sheet of records, and what is hidden in them."""

from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
import pandas as pd
import yaml
from tuning import effect, ids

BENCH = Path(__file__).parent / "bench.yaml"
PRESSURES = (10, 20, 30, 43, 67, 100, 134)
CYCLES = 2
# Drive (A) of each mode for some 20 um (1B) and 7 um (2B) at the laser, and of a hold's records.
DRIVES = {"1B": 2.5, "2B": 10.0}
LOUDNESS = (0.7, 1.0)
RECORD_INTERVAL_S, HOLD_INTERVAL_S = 180, 900
# A drawn size lies between the bound and so many times it.
SIZE_RANGE = 5.0


@dataclass(frozen=True)
class Case:
    """One blind case: a seed for all scatter, and the hidden effects with their sizes (SI)."""

    seed: int
    effects: tuple[tuple[str, float], ...]

    def answer(self) -> dict:
        """What is sealed."""
        return asdict(self)


def catalogue() -> list[str]:
    """Effects that a diagnosis may name."""
    return [name for name in ids() if effect(name).CLASS != "outside"]


def outsiders() -> list[str]:
    """Effects that no catalogue has."""
    return [name for name in ids() if effect(name).CLASS == "outside"]


def size_of(name: str, chance: np.random.Generator, relative: float | None = None) -> float:
    """A size (SI) of an effect: `relative` times its bound, or drawn log-uniformly."""
    if relative is None:
        relative = np.exp(chance.uniform(0, np.log(SIZE_RANGE)))
    sign = -1.0 if effect(name).SIGNED and chance.uniform() < 0.5 else 1.0
    return float(sign * relative * effect(name).BOUND)


def draw_case(entropy: int, names: tuple[str, ...], relative: float | None = None) -> Case:
    """A case that hides the named effects (none, one or more) in sizes drawn from `entropy`."""
    chance = np.random.default_rng([entropy, 1])
    hidden = tuple((name, size_of(name, chance, relative)) for name in names)
    return Case(seed=int(np.random.default_rng([entropy, 0]).integers(2**31)), effects=hidden)


def draw_bench(seed: int) -> dict:
    """The bench of a case: the fixed part, and structure, contact, damping and noise drawn."""
    bench = yaml.safe_load(BENCH.read_text(encoding="utf-8"))
    chance = np.random.default_rng([seed, 2])
    bench["seed"] = seed
    for name in ("modulus_factor", "density_factor"):
        bench["specimen"][name] = float(np.exp(0.001 * chance.standard_normal()))
    for name in ("kn_N_per_m", "kt_N_per_m"):
        bench["joint"][name] *= float(np.exp(chance.uniform(-0.4, 0.4)))
    for name, low, high in (("1B", 0.002, 0.0036), ("2B", 0.0036, 0.006)):
        bench["damping"]["loss_factor"][name] = float(np.exp(chance.uniform(*np.log([low, high]))))
    # 80 to 60 dB below the velocity (rms) at release, some 60 mm/s.
    bench["laser"]["noise_m_per_s"] = float(np.exp(chance.uniform(np.log(6e-6), np.log(6e-5))))
    return bench


def draw_sheet(seed: int, pressures: tuple[int, ...] = PRESSURES, cycles: int = CYCLES):
    """The sheet of a campaign: every force up and down, both modes in turn, twice in each hold."""
    chance = np.random.default_rng([seed, 3])
    directions = [("up", pressures), ("down", pressures[::-1])] * cycles
    holds = [(direction, bar) for direction, bars in directions for bar in bars]
    rows, clock = [], 0
    for number, (direction, bar) in enumerate(holds, start=1):
        for loudness in LOUDNESS:
            for mode, drive in DRIVES.items():
                record = f"r{len(rows) + 1:03d}"
                rows.append(
                    {
                        "record": record,
                        "file": f"{record}.nc",
                        "mode": mode,
                        "pressure_bar": bar,
                        "hold": f"h{number:02d}",
                        "direction": direction,
                        "time_s": clock,
                        "drive_A": round(drive * loudness * float(chance.uniform(0.95, 1.05)), 3),
                    }
                )
                clock += RECORD_INTERVAL_S
        clock += HOLD_INTERVAL_S
    return pd.DataFrame(rows)
