"""The rows of stick.csv, the table with which a campaign begins at the stick frequencies."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from bladeroot.io.cells import Cells
from bladeroot.io.expected import expected_at
from bladeroot.io.load import COLUMNS, Load, factor_of
from bladeroot.io.outliers import outliers
from bladeroot.io.sheet import read_sheet

if TYPE_CHECKING:
    import pandas as pd

VALUES = ("frequency_Hz", "frequency_std_Hz", "loss_factor", "loss_factor_std")
LOADS = tuple(name for name in COLUMNS if name != "temperature_C")  # of a row, as `load_value`
STICK_COLUMNS = ("mode", *LOADS, *VALUES)
# A stick frequency further than this from the mode's expected one belongs to another mode.
MODE_BAND = 0.25


def stick_table(path: Path, load: Load) -> "pd.DataFrame":
    """The table of a checked `stick.csv`: text of its cells, a column each; as force_N the load in
    its unit.
    """
    import pandas as pd  # late: a plan of the jobs has no use for it

    rows, _ = read_sheet(path, STICK_COLUMNS, STICK_COLUMNS[1:])
    table = pd.DataFrame([values for _, values in rows])
    given = [next(name for name in LOADS if values.get(name)) for _, values in rows]
    return table.assign(
        force_N=[
            round(float(values[name]) * factor_of(name, load), 6)
            for (_, values), name in zip(rows, given, strict=True)
        ]
    )


@dataclass(frozen=True)
class StickRows(Cells):
    """Checks of stick.csv."""

    def stick(self, rows: list[tuple[int, dict]]) -> tuple[dict, ...]:
        """One dict a row."""
        checked = []
        first_row: dict[tuple, int] = {}
        if not self.required(rows, ("mode", *VALUES)):
            return ()
        if self.load is None:
            self.fault("a stick.csv needs a load in campaign.yaml", 1)
            return ()
        for row, values in rows:
            mode, value = self.mode(row, values), self.load_value(row, values)
            line = {"mode": mode, "force_N": value, "load": value}
            for name in VALUES:
                line[name] = self.number(row, values, name, positive=True)
            if mode and line["frequency_Hz"]:
                expected = expected_at(self.description["modes"][mode], self.load, value)
                if abs(line["frequency_Hz"] / expected - 1) > MODE_BAND:
                    self.fault(
                        f"frequency_Hz {values['frequency_Hz']} is not in the band of mode {mode} "
                        f"({expected:g} Hz +- {MODE_BAND:.0%})",
                        row,
                    )
            if mode is not None and value is not None:
                what = f"mode {mode} at {value:g} {self.load.unit}"
                self.once(row, (mode, value), first_row, what)
            checked.append(line)
        if not self.faults:
            self._lone_frequencies([row for row, _ in rows], checked)
        return tuple(checked)

    def _lone_frequencies(self, rows: list[int], checked: list[dict]) -> None:
        """Warn of a frequency that lies far from what its neighbours in load say."""
        for mode in self.description["modes"]:
            mine = [k for k, line in enumerate(checked) if line["mode"] == mode]
            force, frequency = (
                np.array([checked[k][name] for k in mine]) for name in ("force_N", "frequency_Hz")
            )
            if force.size and force.min() <= 0.0:
                continue
            for k, expected in outliers(force, frequency):
                self.warn(
                    f"frequency_Hz {frequency[k]:g} of {mode} at {force[k]:g} {self.load.unit} "
                    f"lies far from {expected:.5g}, which its neighbours in {self.load.name} say: "
                    "a wrong digit?",
                    rows[mine[k]],
                )
