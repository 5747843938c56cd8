"""The rows of stick.csv, the table with which a campaign begins at the stick frequencies."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from bladeroot.io.cells import Cells
from bladeroot.io.expected import expected_at
from bladeroot.io.outliers import outliers
from bladeroot.io.sheet import read_sheet

if TYPE_CHECKING:
    import pandas as pd

VALUES = ("frequency_Hz", "frequency_std_Hz", "loss_factor", "loss_factor_std")
STICK_COLUMNS = ("mode", "force_N", "load", *VALUES)
# A stick frequency further than this from the mode's expected one belongs to another mode.
MODE_BAND = 0.25


def stick_table(path: Path) -> "pd.DataFrame":
    """The table of a checked `stick.csv`: text of its cells, a column each; the load as force_N."""
    import pandas as pd  # late: a plan of the jobs has no use for it

    rows, _ = read_sheet(path, STICK_COLUMNS, STICK_COLUMNS[1:])
    return pd.DataFrame([values for _, values in rows]).rename(columns={"load": "force_N"})


@dataclass(frozen=True)
class StickRows(Cells):
    """Checks of stick.csv."""

    def stick(self, rows: list[tuple[int, dict]]) -> tuple[dict, ...]:
        """One dict a row."""
        checked = []
        first_row: dict[tuple, int] = {}
        load = "load" if rows and "load" in rows[0][1] else "force_N"
        if not self.required(rows, ("mode", load, *VALUES)):
            return ()
        if self.load is not None and load == "load" and self.load.given != 1.0:
            self.fault("a stick.csv gives a force as force_N", 1)
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
                unit = self.load.unit if self.load else ""
                self.once(row, (mode, value), first_row, f"mode {mode} at {value:g} {unit}")
            checked.append(line)
        if not self.faults:
            self._lone_frequencies([row for row, _ in rows], checked)
        return tuple(checked)

    def _lone_frequencies(self, rows: list[int], checked: list[dict]) -> None:
        """Warn of a frequency that lies far from what its neighbours in load say."""
        unit = self.load.unit if self.load else ""
        for mode in self.description["modes"]:
            mine = [k for k, line in enumerate(checked) if line["mode"] == mode]
            force, frequency = (
                np.array([checked[k][name] for k in mine]) for name in ("force_N", "frequency_Hz")
            )
            if force.size and force.min() <= 0.0:
                continue
            for k, expected in outliers(force, frequency):
                self.warn(
                    f"frequency_Hz {frequency[k]:g} of {mode} at {force[k]:g} {unit} lies far from "
                    f"{expected:.5g}, which its neighbours in force say: a wrong digit?",
                    rows[mine[k]],
                )
