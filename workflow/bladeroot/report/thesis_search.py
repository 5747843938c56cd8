"""The part of the report on the thesis's own search and on the errors that its Table 5.2 prints."""

from collections.abc import Sequence

import xarray as xr

from bladeroot.report.numbers import fixed, listed, percent
from bladeroot.report.page import Picture, Table

NODES = 33  # of a flank in the thesis's model (6.16)
SETS = (
    "Solution sets with {} (figs 5.11 to 5.13): lines of constant frequency, accepted points and "
    "the point of minimum error."
)


def thesis_search_parts(
    found: Sequence[xr.Dataset], solution_sets: Sequence[Picture]
) -> list[str | Picture | Table]:
    """Solution sets, the points chosen, and Table 5.2's standard deviations computed anew."""
    error = listed([percent(float(v)) for v in found[0]["fe_error"]])
    return [
        "The thesis's own search, with equal springs at all nodes as it has them: 50 × 50 points, "
        "of which those are accepted whose misfit is below its error (5.10 to 5.12), and of those "
        "the one with the smallest covariance (5.23). It adds an error of the model to (5.12) and "
        f"does not say how large; {error} are used here. The smallest covariance belongs to the "
        "softest accepted point, because a soft contact moves the frequencies most, and not to the "
        "best fit.",
        *solution_sets,
        *[
            _chosen(one)
            if one["grid_accepted"].any()
            else f"With {one.attrs['structure']} no point of the grid is accepted at any force."
            for one in found
        ],
        _deltas(found),
    ]


def _chosen(one: xr.Dataset) -> Table:
    rows = []
    for force in one["force"].values:
        here = one.sel(force=force)
        miss = here["chosen_frequency"] - here["target_frequency"]
        rows.append(
            (
                f"{force / 1e3:g}",
                str(int(here["grid_accepted"].sum())),
                *(
                    cell
                    for name in ("kn", "kt")
                    for cell in (
                        fixed(1e-3 / NODES * float(here[f"grid_{name}"]), 0),
                        fixed(1e-3 / NODES * float(here[f"grid_{name}_std"]), 0),
                    )
                ),
                *(fixed(float(miss.sel(mode=mode)), 1) for mode in ("1B", "2B")),
            )
        )
    return Table(
        f"The thesis's search with {one.attrs['structure']}: points accepted of 2500, the chosen "
        "nodal stiffness with the standard deviations of (5.24), N/mm, and how far it misses",
        ("force / kN", "accepted", "kn", "std", "kt", "std", "1B misses by / Hz",
         "2B misses by / Hz"),
        rows,
    )  # fmt: skip


def _deltas(found: Sequence[xr.Dataset]) -> Table:
    rows = []
    for one in found:
        for force in one["table_force"].values:
            here = one.sel(table_force=force)
            cells = [one.attrs["structure"], f"{force / 1e3:g}"]
            for name in ("kn", "kt"):
                printed, ours, bias = (
                    1e-3 * float(here[key].sel(stiffness=name))
                    for key in ("table_printed_std", "table_std", "table_bias_std")
                )
                cells += [fixed(printed, 0), fixed(ours, 0),
                          f"{100 * (ours / printed - 1.0):+.0f} %", fixed(bias, 0)]  # fmt: skip
            rows.append(tuple(cells))
    header = ["structure", "force / kN"]
    for name in ("kn", "kt"):
        header += [f"δ{name} printed", "computed", "difference", "with the model's bias only"]
    return Table(
        "Standard deviations of Table 5.2, N/mm a node: as printed, computed by (5.22) at its own "
        "points from the errors of Table 5.1, and what a bias of the model's frequencies gives at "
        "the same points",
        header,
        rows,
    )
