"""What a calibration compares: numbers of the thesis's tables, and the cases that compute them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd

from bladeroot.reproduction.cases import RIGID, Case, Mode
from bladeroot.stiffness.grid_search import FLANK_NODES

_STRETCHED = 30.0e3
_BENDING = {"1B": "1Fy", "2B": "2Fy"}
# With the flanks held in normal direction only, the beam turns about Z on them near the frequency
# that Table 4.3 prints as its first bending mode.
_LATERAL = {"1B": "Rz", "2B": "2Fy"}


@dataclass(frozen=True)
class Target:
    """One number of a table and the modes that compute it.

    A frequency (Hz) of `case`, or, with `slope`, the mean slope of f^2 over the force (Hz^2/N) from
    none to the case's; a rigid mode (`rests` False) starts from zero. `model_std` is the model's
    error, common to all numbers of one mode in one table, `own_std` the number's own; both in the
    reference's unit.
    """

    table: str
    mode: str
    case: Case
    reference: float
    model_std: float
    own_std: float
    slope: bool = False
    rests: bool = True

    @property
    def tolerance(self) -> float:
        """Standard deviation of the whole."""
        return float(np.hypot(self.model_std, self.own_std))

    @property
    def terms(self) -> list[tuple[tuple[Case, str], float]]:
        """The modes whose eigenvalues enter, each with its sign."""
        own = [((self.case, self.mode), 1.0)]
        return own + [((Case(self.case.pad), self.mode), -1.0)] * (self.slope and self.rests)

    def value(self, modes: Mapping[tuple[Case, str], Mode]) -> float:
        """The model's number."""
        square = sum(sign * modes[key].value for key, sign in self.terms) / (2 * np.pi) ** 2
        return square / self.case.force if self.slope else float(np.sqrt(max(square, 0.0)))

    def derivative(
        self, modes: Mapping[tuple[Case, str], Mode], slopes: Mapping[tuple[Case, str], np.ndarray]
    ) -> np.ndarray:
        """Of the number by each parameter, from the derivatives of the eigenvalues."""
        square = sum(sign * slopes[key] for key, sign in self.terms) / (2 * np.pi) ** 2
        return square / self.case.force if self.slope else square / (2 * self.value(modes))


def targets_of(tables: Mapping[str, pd.DataFrame], trusted: Mapping[str, float]) -> list[Target]:
    """Targets of the tables that `trusted` names ("2.2", "4.1 without pad", ...).

    `tables` are the published ones by file name (`table_2_2`, ...); `trusted` gives per cent of one
    standard deviation for the model. A number's own error is its rounding; that of Table 5.2 is
    Table 5.1's, and one tenth of a per cent for the step of the grid on which it was searched.
    """
    found = []
    for table, percent in trusted.items():
        for mode, case, reference, own, extra in _ROWS[table](tables):
            model = 0.01 * percent * reference
            found.append(Target(table, mode, case, reference, model, own, **extra))
    return found


def _rounding(digit: float) -> float:
    """Standard deviation of what rounding to a digit leaves open."""
    return digit / 12.0**0.5


Row = tuple[str, Case, float, float, dict]


def _table_2_2(tables: Mapping[str, pd.DataFrame]) -> list[Row]:
    """Free beam without pad: the mean of the measurement and the refined mesh."""
    table = tables["table_2_2"]
    kept = table[~table.source.str.contains("coarse")].groupby("mode").frequency_Hz.mean()
    return [(mode, Case(False), float(value), _rounding(1.0), {}) for mode, value in kept.items()]


def _table_4_1(pad: bool) -> Callable[[Mapping[str, pd.DataFrame]], list[Row]]:
    # The table numbers its modes; with every shape near the published values the order is this.
    names = {7: "1Fy", 8: "1Fz", 9: "2Fy", 10: "3Fy", 11: "1T", 12: "2Fz"}

    def rows(tables: Mapping[str, pd.DataFrame]) -> list[Row]:
        table = tables["table_4_1"].set_index("number").free_frequency_Hz
        return [(name, Case(pad), float(table[k]), _rounding(0.1), {}) for k, name in names.items()]

    return rows


def _table_4_2(tables: Mapping[str, pd.DataFrame]) -> list[Row]:
    """Slopes of f^2 over the force, least squares over the table's forces."""
    rows = []
    for mode, group in tables["table_4_2"].groupby("mode", sort=False):
        if mode in ("X", "Y", "Z", "Rx"):  # not stiffened, or unstable under dead load
            continue
        slope = np.polyfit(group.force_N, group.frequency_Hz**2, 1)[0]
        own = 2 * _rounding(0.1) * float(group.frequency_Hz.max()) / _STRETCHED
        extra = {"slope": True, "rests": mode not in ("Ry", "Rz")}
        rows.append((mode, Case(True, _STRETCHED), float(slope), own, extra))
    return rows


def _table_fixed(
    name: str, kt: float, modes: Mapping[str, str]
) -> Callable[[Mapping[str, pd.DataFrame]], list[Row]]:
    def rows(tables: Mapping[str, pd.DataFrame]) -> list[Row]:
        table = tables[name]
        case = Case(True, kn=RIGID, kt=kt)
        return [
            (modes[one.mode], case, float(one.frequency_Hz), _rounding(1.0), {})
            for one in table[table.force_kN == 0].itertuples()
        ]

    return rows


def _table_5_2(tables: Mapping[str, pd.DataFrame]) -> list[Row]:
    """The joint at the published kn, kt, against Tables 3.1 and 3.2 between their forces (5.13)."""
    measured = {"1B": tables["table_3_1"], "2B": tables["table_3_2"]}
    errors = tables["table_5_1"].set_index("force_kN")
    rows = []
    for one in tables["table_5_2"].itertuples():
        force = 1e3 * float(one.force_kN)
        flank = [1e3 * FLANK_NODES * k for k in (one.kn_N_per_mm, one.kt_N_per_mm)]
        for mode, table in measured.items():
            reference = float(np.interp(force, table.force_N, table.frequency_Hz))
            measured_std = float(errors.loc[one.force_kN, f"frequency_delta_{mode}_Hz"])
            own = float(np.hypot(measured_std, 1e-3 * reference))
            rows.append((mode, Case(True, force, *flank, slots=True), reference, own, {}))
    return rows


_ROWS = {
    "2.2": _table_2_2,
    "4.1": _table_4_1(True),
    "4.1 without pad": _table_4_1(False),
    "4.2": _table_4_2,
    "4.3": _table_fixed("table_4_3", 0.0, _BENDING),
    "4.3 as lateral": _table_fixed("table_4_3", 0.0, _LATERAL),
    "4.4": _table_fixed("table_4_4", RIGID, _BENDING),
    "5.2": _table_5_2,
}
