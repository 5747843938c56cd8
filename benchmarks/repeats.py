"""How often a record is said to be unlike its repeats where nothing is wrong, and where it is.

    python benchmarks/repeats.py [campaigns]

Campaigns of one mode drawn afresh: 1 to 8 forces from 2 to 24 kN, 1 to 4 clampings of each, with 1
to 3 records (at least two at a force). Records of a clamping scatter by 3 to 300 ppm; clampings at
7 kN by the size printed, falling with the force by a power of up to 0.5 (1 in the last columns);
loading up and down differ by up to 0.2 %. Then one record, or one clamping, has a sampling rate
2.4 % too low.
"""

import sys

import numpy as np
import xarray as xr
from bladeroot.pooling.repeats import unlike_repeats

WRONG = np.log(25000 / 25600)
NO_CURVE = xr.Dataset({"frequency": ("point", np.zeros(0))})


def campaign(rng: np.random.Generator, scatter: float, steepest: float) -> list[xr.Dataset]:
    """Plateaus of all records, in the order of forces and clampings."""
    clampings, records = rng.integers(1, 5), rng.integers(1, 4)
    records = max(records, 2 if clampings == 1 else 1)
    within, sides = 10 ** rng.uniform(-5.5, -3.5), rng.uniform(0.0, 0.002)
    power, plateaus = rng.uniform(0.0, steepest), []
    for force in np.geomspace(2e3, 24e3, rng.integers(1, 9)):
        for clamping in range(clampings):
            fall = (force / 7e3) ** -power
            shift = scatter * fall * rng.standard_normal() + sides * (clamping % 2)
            for _ in range(records):
                log = shift + within * rng.standard_normal()
                made = {"stick_frequency": 500.0 * np.exp(log), "verdict": "plateau"}
                attrs = {"mode": "1B", "force_N": force, "hold": f"{force} {clamping}"}
                plateaus.append(xr.Dataset(made, attrs=attrs))
    return plateaus


def share(campaigns: int, scatter: float, steepest: float, wrong: str) -> float:
    """Part of the campaigns in which a record is named; where one is wrong, that one."""
    rng, hits = np.random.default_rng(701), 0
    for _ in range(campaigns):
        plateaus = campaign(rng, scatter, steepest)
        meant = set()
        if wrong:
            of = plateaus[int(rng.integers(len(plateaus)))]
            same = [k for k, p in enumerate(plateaus) if p.attrs["hold"] == of.attrs["hold"]]
            meant = set(same if wrong == "clamping" else same[:1])
            for k in meant:
                plateaus[k]["stick_frequency"] *= np.exp(WRONG)
        found = {k for k, _, _ in unlike_repeats([NO_CURVE] * len(plateaus), plateaus)}
        hits += meant <= found if wrong else bool(found)
    return hits / campaigns


def main() -> None:
    campaigns = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
    print("clampings scatter | nothing wrong | a record | a clamping | nothing wrong, falls by 1")
    for scatter in (1e-4, 5e-4, 1e-3, 2e-3, 4e-3):
        cells = [share(campaigns, scatter, 0.5, wrong) for wrong in ("", "record", "clamping")]
        cells.append(share(campaigns, scatter, 1.0, ""))
        print(f"{100 * scatter:.2f} % |", " | ".join(f"{100 * cell:.1f} %" for cell in cells))


if __name__ == "__main__":
    main()
