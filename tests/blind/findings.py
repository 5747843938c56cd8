"""What the workflow finds in raw records with a fault: a library that the fast tier draws from."""

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr
from bladeroot.bench.conditions import Conditions, Moment, baseline, moments
from cases import draw_bench, draw_sheet
from rawrecords import write_campaign
from runs import make
from tuning import effect

FAULTS = {
    "clipping": "clipped",
    "shaker-recontact": "touched",
    "mode-beating": "beating",
    "mains-hum": "hum",
}
# Sizes over the bound; and records a mode with a fault of a size, or none.
SIZES = (0.5, 1.0, 2.2, 5.0)
REPEATS = 2
CLEAN = 6


def build_library(house: Path, reduced: Path, seed: int) -> pd.DataFrame:
    """Simulate records with each fault, let the workflow judge each, and list its findings.

    Findings belong to a record by itself: the workflow is asked for the cut records alone, without
    the curves.
    """
    bench, sheet = draw_bench(seed), draw_sheet(seed)
    wanted = [(name, size) for name in FAULTS for size in SIZES for _ in range(REPEATS)]
    wanted += [("", 0.0)] * CLEAN
    rows, conditions, library = [], [], []
    for mode in sorted(set(sheet["mode"])):
        own = sheet[sheet["mode"] == mode].iloc[: len(wanted)]
        for row, moment, (name, size) in zip(
            own.to_dict("records"), moments(bench, own), wanted, strict=True
        ):
            rows.append(row)
            conditions.append(_struck(baseline(bench, row), name, size, moment))
            library.append({"fault": name, "size": size, "mode": mode})
    folder = house / "library"
    shutil.rmtree(folder, ignore_errors=True)
    write_campaign(folder, bench, pd.DataFrame(rows), conditions, reduced)
    targets = [f"results/library/records/{row['record']}.nc" for row in rows]
    make(house, *targets, campaign=folder)
    for line, target in zip(library, targets, strict=True):
        with xr.open_dataset(house / target) as judged:
            line["findings"] = ";".join(sorted(set(map(str, judged["finding_id"].values))))
            line["verdict"] = "usable" if judged.attrs["verdict"] == "usable" else "rejected"
    return pd.DataFrame(library)


def _struck(true: Conditions, name: str, size: float, moment: Moment) -> Conditions:
    """The conditions with a fault for certain: the effect itself spares some records."""
    if not name:
        return true
    for again in range(100):
        elsewhere = replace(moment, seed=moment.seed + again)
        struck = effect(name).change(true, size * effect(name).BOUND, elsewhere)
        if struck != true:
            return struck
    raise ValueError(f"{name} never strikes")


def seen_in(
    library: pd.DataFrame,
    sheet: pd.DataFrame,
    conditions: list[Conditions],
    chance: np.random.Generator,
) -> dict[str, tuple[str, str]]:
    """Findings and verdict of each record: those of a library record alike in fault and size."""
    seen = {}
    for row, true in zip(sheet.to_dict("records"), conditions, strict=True):
        here = library[library["mode"] == row["mode"]]
        struck = [name for name, field in FAULTS.items() if getattr(true, field)]
        name = struck[0] if struck else ""
        here = here[here["fault"] == name]
        if name:
            relative = getattr(true, FAULTS[name]) / effect(name).BOUND
            sizes = here["size"].unique()
            nearest = sizes[np.argmin(np.abs(np.log(sizes / relative)))]
            here = here[here["size"] == nearest]
        one = here.iloc[int(chance.integers(len(here)))]
        seen[row["record"]] = (str(one["findings"]), str(one["verdict"]))
    return seen
