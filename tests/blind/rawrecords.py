"""The raw tier: a campaign's folder as a laboratory leaves it; nothing in it tells the effect."""

import os
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path

import pandas as pd
import xarray as xr
import yaml
from bladeroot.bench.bench import simulate
from bladeroot.bench.conditions import Conditions
from bladeroot.bench.joint import Parts, parts

# Every file gets this time (s since 1970): when it was written tells nothing.
WRITTEN = 1_700_000_000
DESCRIPTION = {
    "title": "Blind campaign",
    "notes": "SIMULATED by the virtual test bench; what is hidden in it is sealed.",
    "structure": ["dovetail-HB"],
    "modes": {
        "1B": {"expected_Hz": 545, "laser_x_mm": 1},
        "2B": {"expected_Hz": 1450, "laser_x_mm": -70},
    },
    "force": {
        "gauge": "pressure",
        "piston_area_cm2": 17.9,
        "full_scale_bar": 700,
        "accuracy_percent": 1,
        "accuracy_of": "reading",
    },
    "fe_forces_kN": [12, 16],
}


def write_campaign(
    folder: Path,
    bench: dict,
    sheet: pd.DataFrame,
    conditions: list[Conditions],
    reduced: Path,
    jobs: int = 2,
) -> None:
    """Write campaign.yaml, records.csv and the raw records of a bench under `conditions`."""
    folder.mkdir(parents=True)
    (folder / "campaign.yaml").write_text(yaml.safe_dump(DESCRIPTION, sort_keys=False))
    sheet.to_csv(folder / "records.csv", index=False)
    every = list(zip(sheet.to_dict("records"), conditions, strict=True))
    write = partial(_write_records, folder, bench, reduced)
    jobs = min(jobs, 1 + len(every) // 8)
    with ProcessPoolExecutor(jobs) as pool:
        list(pool.map(write, [every[k::jobs] for k in range(jobs)]))
    for path in folder.iterdir():
        os.utime(path, (WRITTEN, WRITTEN))


def load_parts(reduced: Path) -> Parts:
    with xr.open_dataset(reduced) as opened:
        return parts(opened.load())


def _write_records(folder: Path, bench: dict, reduced: Path, some: list) -> None:
    whole = load_parts(reduced)
    for row, true in some:
        raw, _ = simulate(bench, whole, row, true)
        for name in raw.variables:  # packed sizes would tell a clipped record from a clean one
            raw[name].encoding |= {"zlib": False, "shuffle": False}
        raw.to_netcdf(folder / row["file"])
