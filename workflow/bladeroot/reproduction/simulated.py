"""Quantities of chapters 2, 4 and 5: the beam, the joint and the search, structure by structure."""

import numpy as np
import pandas as pd
import scipy.linalg
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.fem.clamped_beam import beam_frequency, stiffening_factor, wave_number
from bladeroot.reproduction.entry import Computed, Evidence
from bladeroot.stiffness.grid_search import FLANK_NODES
from bladeroot.stiffness.search import ln_covariance
from bladeroot.stiffness.surface import MODES, all_frequencies, surface_of_map

_N_PER_MM = 1e3


def _rows(checks: xr.Dataset, check: str) -> pd.DataFrame:
    rows = checks[["check", "mode", "force", "computed", "reference", "residual"]].to_dataframe()
    return rows[rows["check"] == check]


def checked(evidence: Evidence, *checks: str) -> Computed:
    """Computed values of rows of `checks.nc`, in its order, which is the published table's."""
    return {
        name: np.concatenate([_rows(own, check)["computed"].to_numpy() for check in checks])
        for name, own in evidence.checks.items()
    }


def largest_residual(evidence: Evidence, check: str) -> Computed:
    """Per cent, over all rows of one check."""
    return {
        name: np.array([100.0 * _rows(own, check)["residual"].abs().max()])
        for name, own in evidence.checks.items()
    }


def least_slope(evidence: Evidence) -> Computed:
    """Hz^2/N: smallest slope of f^2 over the force among the modes of Table 4.2."""
    return {
        name: np.array([_rows(own, "Table 4.2")["computed"].min()])
        for name, own in evidence.checks.items()
    }


def table_4_2(evidence: Evidence, *modes: str) -> Computed:
    """Hz: f^2 = f0^2 + slope F with the checks' frequencies and slopes; 0 for translations.

    Rx is unstable under dead load: minus the square root of its negative f^2.
    """
    table = evidence.tables["4_2"]
    table = table[table["mode"].isin(modes)]
    out = {}
    for name, own in evidence.checks.items():
        slope = _rows(own, "Table 4.2").set_index("mode")["computed"].to_dict()
        free = _rows(own, "Table 4.1").set_index("mode")["computed"].to_dict()
        twist = _rows(own, "rotation mode at 1 kN").set_index("mode")["computed"]["Rx"]
        slope["Rx"] = twist / (2.0 * np.pi) ** 2
        square = [
            free.get(mode, 0.0) ** 2 + slope.get(mode, 0.0) * force
            for mode, force in zip(table["mode"], table["force_N"], strict=True)
        ]
        out[name] = np.sign(square) * np.sqrt(np.abs(square))
    return out


def table_4_4(evidence: Evidence) -> Computed:
    """Hz, in the order of the table; `checks.nc` orders by force first."""
    table = evidence.tables["4_4"]
    out = {}
    for name, own in evidence.checks.items():
        rows = _rows(own, "Table 4.4").set_index(["mode", "force"])["computed"]
        out[name] = np.array(
            [rows[mode, 1e3 * force] for mode, force in zip(table["mode"], table["force_kN"],
                                                            strict=True)]
        )  # fmt: skip
    return out


def normal_fixed(evidence: Evidence, axis: str, number: int) -> Computed:
    """Hz over the forces of Table 4.3: a beam whose contact nodes move along the flanks only.

    axis: "Z" for bending in the plane of the tension, "Y" for lateral modes. number: 1 for the
    first that is not rigid.
    """
    forces = 1e3 * evidence.tables["4_3"].query("mode == '1B'")["force_kN"].to_numpy()
    return {
        name: _sliding_frequencies(own, forces, axis, number)
        for name, own in evidence.reduced.items()
    }


def _sliding_frequencies(
    reduced: xr.Dataset, forces: Float[ndarray, " force"], axis: str, number: int
) -> Float[ndarray, " force"]:
    pairs = reduced.sizes["pair"]
    turn = np.eye(reduced.sizes["beam_dof"])
    for pair, flank in enumerate(reduced["pair_flank"].values):
        place = slice(3 * pair, 3 * pair + 3)
        turn[place, place] = reduced["flank_frame"].values[flank].T
    free = np.delete(turn, 3 * np.arange(pairs), axis=1)  # the first local axis is the normal
    stiffness, per_newton, mass = (
        free.T @ reduced[f"beam_{part}"].values @ free
        for part in ("stiffness", "geometric_stiffness", "mass")
    )
    shown = reduced["display_shape"].values @ free
    found = []
    for force in forces:
        matrix = stiffness + force * per_newton
        values, shapes = scipy.linalg.eigh(matrix, mass, subset_by_index=[0, 9])
        along = reduced["axis"].values[((shown @ shapes) ** 2).sum(axis=0).argmax(axis=0)]
        elastic = values[(along == axis) & (values > 1e3)]
        found.append(np.sqrt(elastic[number - 1]) / (2.0 * np.pi))
    return np.array(found)


def nodes_of_a_flank(evidence: Evidence) -> Computed:
    """Contact nodes of the mesh over the four flanks."""
    return {
        name: np.array([own.sizes["pair"] / own.sizes["flank"]])
        for name, own in evidence.reduced.items()
    }


def appendix_b(evidence: Evidence) -> Computed:
    """Hz: the clamped beam of B-12 with EI/(mu L^4) and mu L^2 fitted to the whole table."""
    table = evidence.tables["b"]
    mode, force = table["mode"].to_list(), table["force_N"].to_numpy()
    root = np.array([wave_number(n) for n in mode])
    factor = np.array([stiffening_factor(n) for n in mode])
    square = (2.0 * np.pi * table["frequency_Hz"].to_numpy()) ** 2
    weight = 1.0 / np.sqrt(square)  # equal errors of f, not of its square
    design = np.column_stack([root**4, factor * force])
    bending, per_mass = np.linalg.lstsq(design * weight[:, None], square * weight, rcond=None)[0]
    # a beam of length 1 with that mass and that bending stiffness
    mass = 1.0 / per_mass
    values = [
        float(beam_frequency(float(f), n, 1.0, float(bending * mass), float(mass)))
        for n, f in zip(mode, force, strict=True)
    ]
    return {"": np.array(values)}


def _forces(evidence: Evidence) -> Float[ndarray, " force"]:
    return 1e3 * evidence.tables["5_2"]["force_kN"].to_numpy()


def searched(evidence: Evidence, name: str) -> Computed:
    """N/mm a node: `kn`, `kt`, `kn_std` or `kt_std` of the thesis's own search on our maps."""
    stiffness = evidence.stages["stiffness"].reindex(force=_forces(evidence))
    return {
        str(structure): stiffness[f"grid_{name}"].sel(structure=structure).values
        / FLANK_NODES
        / _N_PER_MM
        for structure in stiffness["structure"].values
    }


def growth(evidence: Evidence, name: str) -> Computed:
    """Searched stiffness at the largest force that has one over that at the smallest."""
    out = {}
    for structure, values in searched(evidence, name).items():
        found = values[np.isfinite(values)]
        out[structure] = np.array([found[-1] / found[0] if len(found) > 1 else np.nan])
    return out


def _at_table_5_2(evidence: Evidence) -> dict[str, tuple[ndarray, ndarray]]:
    """Frequencies (mode, force) and slopes by ln k (force, mode, k) at Table 5.2's own points."""
    table = evidence.tables["5_2"]
    points = np.log(FLANK_NODES * _N_PER_MM * table[["kn_N_per_mm", "kt_N_per_mm"]].to_numpy())
    out = {}
    for structure, maps in evidence.maps.items():
        values, slopes = np.full((2, len(table)), np.nan), np.full((len(table), 2, 2), np.nan)
        for i, (force, point) in enumerate(zip(_forces(evidence), points, strict=True)):
            if force in maps:
                surface = surface_of_map(maps[force].sel(mode=list(MODES)))
                (values[:, i],), (slopes[i],) = all_frequencies(surface, point[None])
        out[structure] = values, slopes
    return out


def frequency_at_table_5_2(evidence: Evidence, mode: str) -> Computed:
    """Per cent: model's frequency with Table 5.2's stiffness over the measured one, minus one."""
    measured = evidence.stages["fe_forces"]["frequency"].sel(mode=mode)
    measured = measured.reindex(force=_forces(evidence)).values
    return {
        structure: 100.0 * (values[MODES.index(mode)] / measured - 1.0)
        for structure, (values, _) in _at_table_5_2(evidence).items()
    }


def _covariances_at_table_5_2(evidence: Evidence) -> dict[str, Float[ndarray, "force 2 2"]]:
    """Of ln kn, ln kt by (5.22) with Table 5.1's errors; NaN where this run has no map."""
    table = evidence.tables["5_1"].set_index("force_kN")
    errors = table.loc[evidence.tables["5_2"]["force_kN"]].to_numpy()
    out = {}
    for structure, (values, slopes) in _at_table_5_2(evidence).items():
        known = np.isfinite(slopes).all(axis=(1, 2))
        out[structure] = np.full_like(slopes, np.nan)
        for i in np.flatnonzero(known):
            out[structure][i] = ln_covariance(slopes[i], values[:, i], errors[i], np.zeros(2))[0]
    return out


def std_at_table_5_2(evidence: Evidence, name: str) -> Computed:
    """N/mm a node, at Table 5.2's points."""
    k, row = evidence.tables["5_2"][f"{name}_N_per_mm"].to_numpy(), ("kn", "kt").index(name)
    covariances = _covariances_at_table_5_2(evidence).items()
    return {structure: k * np.sqrt(one[:, row, row]) for structure, one in covariances}


def correlation_at_table_5_2(evidence: Evidence) -> Computed:
    """Correlation of kn and kt at Table 5.2's points."""
    return {
        structure: one[:, 0, 1] / np.sqrt(one[:, 0, 0] * one[:, 1, 1])
        for structure, one in _covariances_at_table_5_2(evidence).items()
    }


def curvature_of_the_map(evidence: Evidence) -> Computed:
    """Slope of 1B by kn at the low end of the thesis's grid (1e4 N/mm a node) over the high end."""
    k = FLANK_NODES * _N_PER_MM * np.array([1e4, 1.5e5])
    points = np.log([(k[0], FLANK_NODES * _N_PER_MM * 6e4), (k[1], FLANK_NODES * _N_PER_MM * 6e4)])
    out = {}
    for structure, maps in evidence.maps.items():
        surface = surface_of_map(maps[min(maps)].sel(mode=["1B"]))
        slope = all_frequencies(surface, points)[1][:, 0, 0] / k
        out[structure] = np.array([slope[0] / slope[1]])
    return out
