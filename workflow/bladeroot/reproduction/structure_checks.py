"""The structure against the thesis's Tables 2.2, 4.1, 4.2 and 4.4, and against exact identities.

Chapter 4's tables are computed with the pad on the beam, Table 2.2 without it.
"""

from collections.abc import Mapping

import numpy as np
import pandas as pd
import xarray as xr

from bladeroot.fem import elasticity
from bladeroot.fem.geometry import Structure
from bladeroot.fem.mesh import beam_mesh
from bladeroot.rom.beam_modes import (
    Modes,
    ReducedBeam,
    eigenvalue,
    full_modes,
    hertz,
    reduced_modes,
)
from bladeroot.rom.checks import checked_beam
from bladeroot.rom.comparison import checks_dataset, row
from bladeroot.rom.reduction import BeamModel

# Largest relative residual that the fitted geometry is held to.
LIMITS = {"Table 2.2": 0.005, "Table 4.1": 0.01, "Table 4.2": 0.023, "Table 4.4": 0.006}
_COLUMNS = {
    "table_2_2": ("source", "mode", "frequency_Hz"),
    "table_4_1": ("number", "free_frequency_Hz"),
    "table_4_2": ("mode", "force_N", "frequency_Hz"),
    "table_4_4": ("mode", "force_kN", "frequency_Hz"),
}


def checks(
    structure: Structure,
    mesh: xr.Dataset,
    stress: xr.Dataset,
    reduced: xr.Dataset,
    tables: Mapping[str, pd.DataFrame],
) -> xr.Dataset:
    """Compare one structure with the published tables and with exact identities: `checks.nc`.

    `mesh`, `stress` and `reduced` as of `rom.checks.checked_beam`.
    `tables` holds `table_2_2` (source, mode, frequency_Hz), `table_4_1` (number,
    free_frequency_Hz), `table_4_2` (mode, force_N, frequency_Hz) and `table_4_4` (mode, force_kN,
    frequency_Hz). One row a comparison: what it is, the reference, what this model gives, the
    relative residual and the limit it is held to (NaN: shown, not required). ValueError if a table
    or a column is missing.
    """
    for name, columns in _COLUMNS.items():
        missing = set(columns) - set(tables[name].columns if name in tables else ())
        if missing:
            raise ValueError(f"{name}: expected columns {', '.join(columns)}; missing {missing}")
    beam, free, identities = checked_beam(structure, mesh, stress, reduced)
    rows = [
        *_table_2_2(structure, tables["table_2_2"]),
        *_table_4_1(free, tables["table_4_1"]),
        *_table_4_2(beam, tables["table_4_2"]),
        *_table_4_4(beam, tables["table_4_4"]),
        *identities,
    ]
    return checks_dataset(rows, structure.name, structure.description)


def _table_2_2(structure: Structure, table: pd.DataFrame) -> list[dict]:
    """Free beam without the pad. The thesis's coarse mesh is shown but not required."""
    beam = beam_mesh(structure, with_pad=False)
    rule = elasticity.quadrature(beam)
    materials = [structure.material]
    stiffness = elasticity.stiffness(beam, rule, materials)
    mass = elasticity.mass(beam, rule, materials)
    modes = full_modes(BeamModel(beam, stiffness, mass, 0.0 * mass), 0.0)
    return [
        row(
            f"Table 2.2, {one.source}",
            one.mode,
            0.0,
            float(one.frequency_Hz),
            hertz(eigenvalue(modes, one.mode, "Table 2.2")),
            np.nan if "coarse" in one.source else LIMITS["Table 2.2"],
        )
        for one in table.itertuples()
    ]


def _table_4_1(full: Modes, table: pd.DataFrame) -> list[dict]:
    """Free beam; the table numbers its modes, the rigid ones being 1 to 6."""
    values, names = full
    return [
        row(
            "Table 4.1",
            names[one.number - 1],
            0.0,
            float(one.free_frequency_Hz),
            hertz(values[one.number - 1]),
            LIMITS["Table 4.1"],
        )
        for one in table.itertuples()
        if one.number > 6
    ]


def _table_4_2(reduced: ReducedBeam, table: pd.DataFrame) -> list[dict]:
    """Slopes of f^2 over the force, least squares on both sides over the table's forces.

    Translations do not stiffen; Rx, which the table shows constant, is checked as a rotation.
    """
    at = {force: reduced_modes(reduced, float(force)) for force in table.force_N.unique()}
    rows = []
    for mode, group in table.groupby("mode", sort=False):
        if mode in ("X", "Y", "Z", "Rx"):
            continue
        squares = [eigenvalue(at[force], mode, f"free at {force:g} N") for force in group.force_N]
        reference = np.polyfit(group.force_N, group.frequency_Hz**2, 1)[0]
        computed = np.polyfit(group.force_N, np.array(squares) / (2 * np.pi) ** 2, 1)[0]
        limit = LIMITS["Table 4.2"]
        quantity = "slope of f^2 over force"
        rows.append(row("Table 4.2", mode, np.nan, reference, computed, limit, quantity, "Hz2/N"))
    return rows


def _table_4_4(reduced: ReducedBeam, table: pd.DataFrame) -> list[dict]:
    """All nodes of the flanks fixed; the table's 1B and 2B are 1Fy and 2Fy."""
    rows = []
    for force, group in table.groupby("force_kN"):
        modes = reduced_modes(reduced, 1e3 * float(force), clamped=True)
        for one in group.itertuples():
            name, where = {"1B": "1Fy", "2B": "2Fy"}[one.mode], f"flanks fixed at {force:g} kN"
            computed = hertz(eigenvalue(modes, name, where))
            limit = LIMITS["Table 4.4"] if force == 0 else np.nan
            rows.append(
                row("Table 4.4", one.mode, 1e3 * force, float(one.frequency_Hz), computed, limit)
            )
    return rows
