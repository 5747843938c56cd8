"""Does a table of simulated frequencies give the cause that the structure gives?

    python benchmarks/table_simulation.py STRUCTURE [--cases 20] [--seed N]

STRUCTURE is results/structures/dovetail-HB of a run. A case is a campaign of the blind
laboratory's fast tier (`tests/blind`) with one effect of the force law, of time, of direction or of
amplitude, in turn. It is judged twice: against the parametric model, and against a table that the
same model makes at one stiffness, the prior's middle: frequencies at ten forces and how they change
with ln kn and ln kt. A table does not tell where mass and stiffness sit, so causes of the level are
not drawn.
"""

import argparse
import os
import sys
import time
from pathlib import Path

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(_name, "1")
ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests/blind"))

import numpy as np  # noqa: E402
import pandas as pd  # noqa: E402
import xarray as xr  # noqa: E402
import yaml  # noqa: E402
from bladeroot.diagnosis.judged import judge  # noqa: E402
from bladeroot.mechanisms.catalogue import catalogue  # noqa: E402
from bladeroot.rom.parametric import ln_frequencies, surface_of  # noqa: E402
from bladeroot.stiffness.priors import LN_K  # noqa: E402
from cases import catalogue as effects  # noqa: E402
from cases import draw_case, draw_sheet  # noqa: E402
from lab import Laboratory  # noqa: E402
from runs import SEARCH  # noqa: E402
from tuning import effect  # noqa: E402

CLASSES = ("force-law", "time", "direction", "amplitude")
FORCES = np.linspace(1.5e3, 28.5e3, 10)  # N, of the table
LOAD = {"load_name": "axial force", "load_unit": "N"}


def table(model: xr.Dataset) -> pd.DataFrame:
    """The model's frequencies and sensitivities at the prior's middle."""
    points = np.column_stack([np.full((FORCES.size, 2), LN_K[0]), FORCES])
    ln_f, slope = ln_frequencies(surface_of(model), points)
    rows = [
        {"mode": mode, "load": force, "frequency_Hz": np.exp(ln_f[k, m]),
         "by_ln_kn": slope[k, m, 0], "by_ln_kt": slope[k, m, 1]}
        for m, mode in enumerate(model["mode"].values.astype(str).tolist())
        for k, force in enumerate(FORCES.tolist())
    ]  # fmt: skip
    made = pd.DataFrame(rows)
    made.attrs["name"] = "table"
    return made


def causes(verdict: dict) -> list[str]:
    """What is named or leads, in the order of the alphabet."""
    return sorted(one["mechanism"] for one in verdict["causes"] if one["shown"])


def main() -> None:
    asked = argparse.ArgumentParser(description=__doc__)
    asked.add_argument("structure", type=Path)
    asked.add_argument("--cases", type=int, default=20)
    asked.add_argument("--seed", type=int, default=20261124)
    options = asked.parse_args()
    began, lab = time.process_time(), Laboratory(options.structure / "reduced.nc")
    model = xr.load_dataset(options.structure / "parametric.nc")
    config = yaml.safe_load((ROOT / "config/config.yaml").read_text())
    facts = {**config["diagnosis"], **SEARCH, "expected_Hz": {"1B": 545.0, "2B": 1450.0}}
    simulations, chance = (model, table(model)), np.random.default_rng(options.seed)
    same, right = 0, np.zeros(2, int)
    for k in range(options.cases):
        kind = CLASSES[k % len(CLASSES)]
        hidden = str(chance.choice([name for name in effects() if kind == effect(name).CLASS]))
        case = draw_case(options.seed + k, (hidden,))
        seen = lab.fast(case, draw_sheet(case.seed, cycles=1)).assign_attrs(LOAD)
        said = [judge(seen, one, facts, catalogue())[1] for one in simulations]
        found = [causes(one) for one in said]
        same += found[0] == found[1]
        right += [hidden in one for one in found]
        told = [f"{one['answer']} {'+'.join(names)}".strip()
                for one, names in zip(said, found, strict=True)]  # fmt: skip
        print(f"{k + 1:2d} {kind}, {hidden}: structure {told[0]}; table {told[1]}", flush=True)
    print(f"the same cause {same} of {options.cases}; what was hidden is named or leads: structure "
          f"{right[0]}, table {right[1]}; seed {options.seed}, "
          f"{time.process_time() - began:.0f} CPU-s")  # fmt: skip


if __name__ == "__main__":
    main()
