"""The blind laboratory: one case from its draw to what a run may see."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr
from bench_curves import campaign_curves, few_dofs
from bladeroot.bench.joint import Parts
from cases import Case, draw_bench, draw_sheet
from fast import LADDER, observations
from findings import seen_in
from rawrecords import load_parts, write_campaign
from tuning import cause_of, conditions_of, effect


@dataclass(frozen=True)
class Laboratory:
    """The specimen that all cases perturb: `reduced` is its file of reduced matrices.

    `library` tells what the workflow found in raw records with faults; without it the fast tier
    has no findings. `bench` and `sheet` draw a case's bench and records from its seed.
    """

    reduced: Path
    library: pd.DataFrame | None = None
    bench: Callable[[int], dict] = draw_bench
    sheet: Callable[[int], pd.DataFrame] = draw_sheet

    @cached_property
    def whole(self) -> Parts:
        return load_parts(self.reduced)

    @cached_property
    def few(self) -> Parts:
        """Of a dovetail; an assembly's lowest modes are rigid motions, and it is small."""
        return self.whole if self.whole.interfaces else few_dofs(self.whole)

    def hidden(self, case: Case, bench: dict, sheet: pd.DataFrame) -> list[tuple[str, float]]:
        """The case's effects with what causes them."""
        pressures = sorted(sheet["pressure_bar"].unique())
        middle = sheet[sheet["pressure_bar"] == pressures[len(pressures) // 2]]
        highest = {}
        if any(hasattr(effect(name), "TUNED") for name, _ in case.effects):
            clean = campaign_curves(
                bench, self.whole, self.few, middle, conditions_of(bench, middle, []), LADDER
            )
            for mode, top in zip(middle["mode"], clean["top"].values, strict=True):
                highest[mode] = max(highest.get(mode, 0.0), float(top))
        rows = sheet.to_dict("records")
        return [
            (name, cause_of(bench, self.whole, rows, highest, name, size))
            for name, size in case.effects
        ]

    def fast(self, case: Case, sheet: pd.DataFrame | None = None) -> xr.Dataset:
        """Observations of a case, without raw records."""
        bench = self.bench(case.seed)
        sheet = self.sheet(case.seed) if sheet is None else sheet
        conditions = conditions_of(bench, sheet, self.hidden(case, bench, sheet))
        curves = campaign_curves(bench, self.whole, self.few, sheet, conditions, LADDER)
        chance = np.random.default_rng([case.seed, 4])
        seen = {}
        if self.library is not None:
            seen = seen_in(self.library, sheet, conditions, chance)
        return observations(curves, bench, sheet, chance, seen)

    def raw(self, case: Case, folder: Path, sheet: pd.DataFrame | None = None) -> None:
        """Write a case's campaign folder."""
        bench = self.bench(case.seed)
        sheet = self.sheet(case.seed) if sheet is None else sheet
        conditions = conditions_of(bench, sheet, self.hidden(case, bench, sheet))
        write_campaign(folder, bench, sheet, conditions, self.reduced)
