"""The structure against the thesis's tables, and against what must hold whatever the geometry.

Chapter 4's tables are computed with the pad on the beam, Table 2.2 without it.
"""

from collections.abc import Mapping

import numpy as np
import pandas as pd
import scipy.sparse as sp
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.fem import elasticity
from bladeroot.fem.geometry import Structure, flank_ends
from bladeroot.fem.mesh import Mesh, beam_mesh, build_mesh
from bladeroot.fem.prestress import prestress
from bladeroot.rom.beam_modes import (
    Modes,
    ReducedBeam,
    eigenvalue,
    full_modes,
    hertz,
    reduced_beam,
    reduced_modes,
)
from bladeroot.rom.comparison import checks_dataset, row
from bladeroot.rom.reduction import (
    BeamModel,
    beam_model,
    force_stiffness,
    reduce_structure,
)

# Largest relative residual that the fitted geometry is held to.
LIMITS = {
    "Table 2.2": 0.005,
    "Table 4.1": 0.01,
    "Table 4.2": 0.023,
    "Table 4.4": 0.006,
    "rigid rotation": 1.0e-9,
    "rotation mode at 1 kN": 1.0e-3,
    "reduced against full": 0.0005,
}
_COLUMNS = {
    "table_2_2": ("source", "mode", "frequency_Hz"),
    "table_4_1": ("number", "free_frequency_Hz"),
    "table_4_2": ("mode", "force_N", "frequency_Hz"),
    "table_4_4": ("mode", "force_kN", "frequency_Hz"),
}
# Forces (N) at which the reduced beam meets the full one: none, for which its basis was made, and
# the largest, farthest from it.
_FORCES = (0.0, 30.0e3)


def checks(
    structure: Structure,
    mesh: xr.Dataset,
    stress: xr.Dataset,
    reduced: xr.Dataset,
    tables: Mapping[str, pd.DataFrame],
) -> xr.Dataset:
    """Compare one structure with the published tables and with exact identities: `checks.nc`.

    `mesh`, `stress`, its prestress, and `reduced` are of its loaded case; without the pad they are
    made anew.
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
    if mesh.attrs["with_pad"] != (structure.pad is not None):
        mesh = build_mesh(structure, with_pad=True)
        stress = prestress(structure, mesh)
        reduced = reduce_structure(structure, mesh, stress)
    model = beam_model(structure, mesh, stress)
    beam = reduced_beam(model, reduced)
    full = {force: full_modes(model, force) for force in _FORCES}
    rows = [
        *_table_2_2(structure, tables["table_2_2"]),
        *_table_4_1(full[0.0], tables["table_4_1"]),
        *_table_4_2(beam, tables["table_4_2"]),
        *_table_4_4(beam, tables["table_4_4"]),
        *_rotations(structure, model, beam),
        *_reduction(full, beam),
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


def _rotations(structure: Structure, model: BeamModel, reduced: ReducedBeam) -> list[dict]:
    """Rigid rotations under dead load: omega^2(Ry) = F (Lc - 2 zc) / I_Y, (Rz) = F Lc / I_Z.

    Lc and zc are the flank centroids' distance and half-height. Once as a Rayleigh quotient, where
    the identity is exact (with omega^2(Rx) = -2 F zc / I_X), once as modes at 1 kN, which bend a
    little.
    """
    (x0, z0), (x1, z1) = flank_ends(structure)
    length, height = x0 + x1, (z0 + z1) / 2
    inertia = _inertia(model.mesh, model.mass)
    stiff = {"Rx": -2 * height, "Ry": length - 2 * height, "Rz": length}
    rigid = elasticity.rigid_modes(model.mesh.nodes)[:, 3:]
    twist = np.einsum("di,di->i", rigid, force_stiffness(model) @ rigid)
    force = 1.0e3
    modes = reduced_modes(reduced, force)
    quantity, unit = "omega^2 over force", "rad2/(s2 N)"
    rows = []
    for k, (mode, arm) in enumerate(stiff.items()):
        exact = arm / inertia[k]
        quotient = twist[k] / inertia[k]
        check = "rigid rotation"
        rows.append(row(check, mode, np.nan, exact, quotient, LIMITS[check], quantity, unit))
        check = "rotation mode at 1 kN"
        value = eigenvalue(modes, mode, f"free at {force:g} N") / force
        rows.append(row(check, mode, force, exact, value, LIMITS[check], quantity, unit))
    return rows


def _inertia(mesh: Mesh, mass: sp.csr_array) -> Float[ndarray, "3"]:
    """Moments of inertia (kg m^2) about the axes through the centre of mass."""
    total = mass.sum()
    centred = mesh.nodes - (mass @ mesh.nodes).sum(axis=0) / total
    square = np.einsum("na,na->a", centred, mass @ centred)
    return square.sum() - square


def _reduction(full: Mapping[float, Modes], reduced: ReducedBeam) -> list[dict]:
    """Elastic modes 7 to 12 of the free beam, reduced against full."""
    rows = []
    for force, (values, names) in full.items():
        smaller = reduced_modes(reduced, force)
        for value, name in list(zip(values, names, strict=True))[6:]:
            computed = hertz(eigenvalue(smaller, name, f"reduced at {force:g} N"))
            check = "reduced against full"
            rows.append(row(check, name, force, hertz(value), computed, LIMITS[check]))
    return rows
