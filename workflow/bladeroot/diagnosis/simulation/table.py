"""A table of simulated frequencies over the load, from any solver.

ln f = ln f_table(load) + bias of the mode + what the fit may move. Columns that begin with `by_`
are derivatives of ln f by a named parameter, which moves within PRIOR; by_ln_kn and by_ln_kt let
laws of the contact act, a spring in series with the rest: half of the share of the mode's energy
that it has, which falls as it stiffens.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import pandas as pd
import xarray as xr
from jaxtyping import Float, Int
from numpy import ndarray

from bladeroot.diagnosis.simulation.interface import Said, Simulation
from bladeroot.diagnosis.simulation.linear import acts_on
from bladeroot.diagnosis.simulation.one_mode import OneMode
from bladeroot.diagnosis.simulation.over_load import OverLoad
from bladeroot.diagnosis.simulation.parametric import scatter_of_clampings
from bladeroot.inference.gaussian import Fit
from bladeroot.inference.problem import Prior, Slopes
from bladeroot.mechanisms.mechanism import Mechanism, Records
from bladeroot.stiffness.priors import BIAS_TILT, CORRELATION, SCATTER
from bladeroot.terms import CONTACT

# Standard deviation beforehand of a named parameter: its column says in what unit it is one.
PRIOR = 1.0
# The same of ln kn and ln kt, which are known to a factor of some two.
PRIOR_LN_K = 0.7


@dataclass(frozen=True)
class Table(Simulation):
    """frequencies: Hz and sensitivities: of ln f, over the table's loads by mode; slip: simulated
    changes over amplitude, if the table has any. bias, offset: relative, by mode.
    """

    modes: tuple[str, ...]
    loads: tuple[Float[ndarray, " load"], ...]
    ln_f: tuple[Float[ndarray, " load"], ...]
    names: tuple[str, ...]
    sensitivities: tuple[Float[ndarray, "load name"], ...]
    bias: Float[ndarray, " mode"]
    offset: Float[ndarray, " mode"]
    slip: xr.Dataset | None = None
    structure: str = ""
    kind: str = "table"

    @cached_property
    def over_load(self) -> tuple[tuple[OverLoad, tuple[OverLoad, ...]], ...]:
        """ln f and each sensitivity, by mode."""
        return tuple(
            (OverLoad(loads, ln_f), tuple(OverLoad(loads, column) for column in own.T))
            for loads, ln_f, own in zip(self.loads, self.ln_f, self.sensitivities, strict=True)
        )

    @property
    def knows_contact(self) -> bool:
        """Whether it has sensitivities to kn and kt."""
        return set(CONTACT) <= set(self.names)

    @property
    def load_range(self) -> tuple[float, float]:
        """What every mode has."""
        return max(x.min() for x in self.loads), min(x.max() for x in self.loads)

    @property
    def std(self) -> Float[ndarray, " name"]:
        """Standard deviation beforehand of each named parameter."""
        return np.array([PRIOR_LN_K if name in CONTACT else PRIOR for name in self.names])

    def of_records(
        self, records: Records, hold: Int[ndarray, " record"], rounding: float
    ) -> "_OfRecords":
        """As the interface says."""
        return _OfRecords(self, records, hold, rounding)

    def silent(self, one: Mechanism) -> str:
        """Changed matrices by their part in a mode, and laws of kn and kt without sensitivities."""
        if one.structure is not None and one.kind == "level":
            return "a table does not tell where mass and stiffness sit"
        if one.stick is not None and acts_on(one) & {"ln_kn", "ln_kt"} and not self.knows_contact:
            return f"the table has no columns {' and '.join(CONTACT)}"
        return ""


class _OfRecords(OneMode):
    """Parameters: one of each sensitivity, bias and tilt of each mode."""

    scales = (SCATTER[:2], SCATTER[:2], CORRELATION[:2])

    def __init__(self, simulated: Table, records: Records, hold: ndarray, rounding: float) -> None:
        self.records, self.rounding, self.table = records, rounding, simulated
        modes = len(simulated.modes)
        of_mode = np.eye(modes)[records.mode]
        middle = np.mean([loads.mean() for loads in simulated.loads])
        wide = max(np.ptp(loads) for loads in simulated.loads) or 1.0
        self.bias_rows = np.hstack([of_mode, of_mode * ((records.force - middle) / wide)[:, None]])
        self.count = len(simulated.names)
        self.prior = Prior(
            np.concatenate([np.zeros(self.count), np.log1p(simulated.offset), np.zeros(modes)]),
            np.concatenate([simulated.std, simulated.bias, BIAS_TILT * simulated.bias]),
        )
        self.contact = [
            simulated.names.index(name) if name in simulated.names else None for name in CONTACT
        ]
        self.same_hold = hold[:, None] == hold
        error, between = np.zeros(records.force.size), np.zeros(records.force.size, dtype=int)
        for m, (ln_f, _) in enumerate(simulated.over_load):
            mine = records.mode == m
            error[mine], between[mine] = ln_f.error(records.force[mine])
        alike = (records.mode[:, None] == records.mode) & (between[:, None] == between)
        self.between = np.outer(error, error) * alike

    def at(self, theta: ndarray, changes: ndarray, by_place: ndarray | float = 0.0) -> Said:
        """The table at each record's load, moved along its sensitivities."""
        n, force = self.records.force.size, self.records.force + changes[:, 2]
        value, by_force, by_name = np.zeros(n), np.zeros(n), np.zeros((n, self.count))
        for m, (ln_f, own) in enumerate(self.table.over_load):
            mine = self.records.mode == m
            value[mine], by_force[mine] = ln_f(force[mine])
            for k, one in enumerate(own):
                by_name[mine, k] = one(force[mine])[0]
        moved = by_name * theta[: self.count]
        stiffer, shares = changes[:, :2].copy(), np.zeros((n, 2))
        for axis, k in enumerate(self.contact):
            if k is not None:
                stiffer[:, axis] += theta[k]
                shares[:, axis] = 2.0 * np.maximum(by_name[:, k], 0.0)
                moved[:, k] = 0.0
        softer, by_k = in_series(shares, stiffer)
        for axis, k in enumerate(self.contact):
            if k is not None:
                by_name[:, k] = by_k[:, axis]
        mean = value + moved.sum(axis=1) + softer + self.bias_rows @ theta[self.count :]
        slope = np.hstack([by_name, self.bias_rows])
        return Said(mean, slope, np.column_stack([by_k, by_force]))

    def scatter(self, gradient: ndarray, scales: ndarray) -> tuple[ndarray, Slopes]:
        """kn and kt of a clamping; without their sensitivities, all modes alike and each its own.

        The reading of the load with either.
        """
        g = gradient.copy()
        if None in self.contact:  # of frequencies: a hundredth of the contact's scatter
            g[:, 0], g[:, 1] = 0.01, np.where(self.records.mode % 2 == 0, 0.01, -0.01)
        whole, slopes = scatter_of_clampings(g, scales, self.rounding, self.same_hold)
        return whole + self.between, slopes


def in_series(
    shares: Float[ndarray, "record spring"], stiffer: Float[ndarray, "record spring"]
) -> tuple[Float[ndarray, " record"], Float[ndarray, "record spring"]]:
    """Change of ln f by springs in series with the rest of a mode, and its slopes.

    shares: of the mode's compliance, which are those of its energy; stiffer: ln of the springs'
    stiffness over that at which they have these shares.
    """
    shares = shares / np.maximum(shares.sum(axis=1, keepdims=True), 1.0)
    left = shares * np.exp(-stiffer)
    whole = 1.0 - shares.sum(axis=1) + left.sum(axis=1)
    return -0.5 * np.log(whole), 0.5 * left / whole[:, None]


def moved(table: Table, records: Records, ln_f: Float[ndarray, " record"], fitted: Fit) -> str:
    """How far measured ln f lie from the table, and what a fit takes that for, in words."""
    bare = _OfRecords(table, records, np.arange(ln_f.size), 0.0)
    off = ln_f - bare.at(0.0 * bare.prior.mean, np.zeros((ln_f.size, 4))).mean
    above = [
        f"{100.0 * np.expm1(np.median(off[records.mode == m])):+.2g} % ({mode})"
        for m, mode in enumerate(table.modes)
        if (records.mode == m).any()
    ]
    values, std = fitted.parameters, fitted.std
    taken = [
        f"{name.removeprefix('by_ln_')} times {np.exp(values[k]):.3g} (a factor of "
        f"{np.exp(std[k]):.3g})"
        if name in CONTACT
        else f"{name.removeprefix('by_')} {values[k]:+.2g} +- {std[k]:.2g}"
        for k, name in enumerate(table.names)
    ]
    taken += [
        f"an FE bias of {100.0 * values[k]:+.2g} +- {100.0 * std[k]:.2g} % ({mode})"
        for k, mode in enumerate(table.modes, len(table.names))
    ]
    return (
        f"the measured frequencies lie from the table's by {', '.join(above)}, which the fit takes "
        f"for {', '.join(taken)}"
    )


def table_of(
    rows: pd.DataFrame, name: str, bias: dict[str, float], offset: dict[str, float]
) -> Table:
    """From the rows of a checked table (`bladeroot.io.table`): mode, load, frequency_Hz and
    optionally loss_factor, amplitude_m and sensitivities; loads in the campaign's unit.
    """
    modes = tuple(dict.fromkeys(rows["mode"]))
    names = tuple(column for column in rows.columns if column.startswith("by_"))
    loads, ln_f, own = [], [], []
    small = rows
    if "amplitude_m" in rows:
        small = rows.sort_values("amplitude_m").groupby(["mode", "load"], as_index=False).first()
    for mode in modes:
        here = small[small["mode"] == mode].sort_values("load")
        loads.append(here["load"].to_numpy(float))
        ln_f.append(np.log(here["frequency_Hz"].to_numpy(float)))
        own.append(here[list(names)].to_numpy(float).reshape(len(here), len(names)))
    return Table(
        modes, tuple(loads), tuple(ln_f), names, tuple(own),
        np.array([bias.get(mode, bias[""]) for mode in modes]),
        np.array([offset.get(mode, 0.0) for mode in modes]), _slip(rows, modes), name,
    )  # fmt: skip


def with_loads(table: Table, per_load: float, shift: float, per_metre: float) -> Table:
    """The table with its loads and amplitudes in other units."""
    slip = table.slip
    if slip is not None:
        slip = slip.assign_coords(
            force=(slip["force"] + shift) * per_load, amplitude=slip["amplitude"] * per_metre
        )
    return replace(table, loads=tuple((x + shift) * per_load for x in table.loads), slip=slip)


def _slip(rows: pd.DataFrame, modes: tuple[str, ...]) -> xr.Dataset | None:
    """Changes over amplitude against the smallest one, where every mode and load has the same."""
    if "amplitude_m" not in rows:
        return None
    loads, amplitudes = np.unique(rows["load"]), np.unique(rows["amplitude_m"])
    shape = (len(modes), loads.size, amplitudes.size)
    parts = {}
    for name, column in (("ln_frequency", "frequency_Hz"), ("loss_factor", "loss_factor")):
        grid = np.zeros(shape)
        if column in rows:
            index = pd.MultiIndex.from_product([modes, loads, amplitudes])
            found = rows.set_index(["mode", "load", "amplitude_m"])[column].reindex(index)
            grid = found.to_numpy(float).reshape(shape)
            grid = np.log(grid) if name == "ln_frequency" else grid
            grid = grid - grid[:, :, :1]
        parts[name] = (("mode", "force", "amplitude"), grid)
    return xr.Dataset(parts, coords={"mode": list(modes), "force": loads, "amplitude": amplitudes})
