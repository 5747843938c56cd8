"""Contact pairs of a model made elsewhere: coincident nodes of beam and slots, flank by flank."""

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.fem.mesh import FLANKS
from bladeroot.rom.external.description import BODIES, Description
from bladeroot.rom.external.nodes import BodyNodes
from bladeroot.rom.external.tables import Table, floats, read_table, whole_numbers

# Largest distance from symmetry about mid-span, over the distance of the two ends.
MIDSPAN_TOLERANCE = 1.0e-3
# Largest distance of a flank's unit normals from their mean.
_NORMAL_TOLERANCE = 1.0e-3


def contact_pairs(
    description: Description, bodies: list[BodyNodes], starts: ndarray
) -> dict[str, ndarray]:
    """Pairs in the order of the flanks, their areas, and the four flanks' local axes.

    `starts` is the first node of each body in the mesh. Values by their names in it. Raises
    ValueError, one line that names file and row, for anything wrong in the table.
    """
    path = description.folder / description.data["contact"]
    columns = ("flank", "beam_node", "slot_node", "area", "nx", "ny", "nz")
    table = read_table(path, columns)
    names = table.columns["flank"]
    for k, name in enumerate(names):
        if name not in FLANKS:
            raise ValueError(
                f"flank must be one of {', '.join(FLANKS)}, got {name!r} ({table.where(k)})"
            )
    flank = np.array([FLANKS.index(name) for name in names])
    area = description.length**2 * floats(table, "area")
    if not (area > 0).all():
        raise ValueError(f"area must be positive ({table.where(int(np.argmin(area > 0)))})")
    normal = np.column_stack([floats(table, name) for name in ("nx", "ny", "nz")])
    pairs = np.empty((len(flank), 2), dtype=np.int64)
    position = np.empty((len(flank), 2, 3))
    places = [body.places() for body in bodies]
    for side, column in enumerate(("beam_node", "slot_node")):
        for k, node in enumerate(whole_numbers(table, column)):
            which = 0 if side == 0 else 1 + int(flank[k]) // 2
            local = places[which].get(int(node))
            if local is None:
                raise ValueError(
                    f"{column} {node} is no node of {BODIES[which]} ({table.where(k)})"
                )
            if not bodies[which].moves_freely(local):
                raise ValueError(
                    f"{column} {node} must be free to move along X, Y and Z ({table.where(k)})"
                )
            pairs[k, side] = local + starts[which]
            position[k, side] = bodies[which].position[local]
    _check_pairs(description, table, flank, pairs, position)
    order = np.argsort(flank, kind="stable")
    return {
        "pair_node": pairs[order],
        "pair_flank": flank[order],
        "pair_weight": area[order],
        "flank_frame": np.stack([_frame(table, k, flank, normal) for k in range(4)]),
    }


def _check_pairs(
    description: Description, table: Table, flank: ndarray, pairs: ndarray, position: ndarray
) -> None:
    """Coincidence, one pair a node, as many pairs at both ends, and the origin at mid-span."""
    tolerance = 1.0e-3 * description.data.get("contact_tolerance_mm", 1.0e-3)
    gap = np.linalg.norm(position[:, 0] - position[:, 1], axis=1)
    worst = int(np.argmax(gap))
    if not gap[worst] <= tolerance:
        raise ValueError(
            f"expected contact nodes that coincide within {1e3 * tolerance:g} mm, got "
            f"{1e3 * gap[worst]:.4g} mm between beam_node {table.columns['beam_node'][worst]} and "
            f"slot_node {table.columns['slot_node'][worst]} ({table.where(worst)}); "
            f"{int((gap > tolerance).sum())} of {len(gap)} pairs are too far apart"
        )
    for side in (0, 1):
        _, first = np.unique(pairs[:, side], return_index=True)
        again = np.setdiff1d(np.arange(len(pairs)), first)
        if len(again):
            raise ValueError(f"expected each node in one pair ({table.where(int(again[0]))})")
    counts = np.bincount(flank, minlength=4)
    if (counts == 0).any():
        raise ValueError(
            f"expected pairs on {FLANKS[int(np.argmin(counts))]}, got none ({table.path})"
        )
    if counts[:2].sum() != counts[2:].sum():
        raise ValueError(
            f"expected as many pairs at Xn as at Xp, got {counts[:2].sum()} and {counts[2:].sum()} "
            f"({table.path})"
        )
    ends = [position[flank // 2 == end, 0, 0].mean() for end in (0, 1)]
    if not ends[0] < 0 < ends[1] or abs(ends[0] + ends[1]) > MIDSPAN_TOLERANCE * (
        ends[1] - ends[0]
    ):
        raise ValueError(
            "expected the beam along X with its origin at mid-span, got flanks Xn around "
            f"x = {1e3 * ends[0]:.4g} mm and Xp around {1e3 * ends[1]:.4g} mm ({table.path})"
        )


def _frame(table: Table, k: int, flank: ndarray, normals: ndarray) -> Float[ndarray, "3 3"]:
    """Normal, along Y and along the slope of one flank, from the normals of its pairs."""
    mine = np.flatnonzero(flank == k)
    unit = normals[mine] / np.maximum(np.linalg.norm(normals[mine], axis=1), 1e-300)[:, None]
    normal = unit.mean(axis=0)
    normal /= max(np.linalg.norm(normal), 1e-300)
    far = np.linalg.norm(unit - normal, axis=1)
    if not far.max() <= _NORMAL_TOLERANCE:
        worst = int(mine[np.argmax(far)])
        raise ValueError(
            f"expected one normal for flank {FLANKS[k]}, got {normals[worst]} beside {normal} "
            f"({table.where(worst)})"
        )
    inwards, outwards = (1, -1)[k // 2], (-1, 1)[k % 2]
    if not (normal[0] * inwards > 0 and normal[2] * outwards > 0):
        raise ValueError(
            f"expected the normal of {FLANKS[k]} to point out of the beam, to mid-span and "
            f"{'up' if outwards > 0 else 'down'}, got {normals[mine[0]]} "
            f"({table.where(int(mine[0]))})"
        )
    along = np.array([0.0, 1.0, 0.0]) - normal[1] * normal
    along /= np.linalg.norm(along)
    return np.stack([normal, along, np.cross(normal, along)])
