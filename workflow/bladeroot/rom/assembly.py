"""Beam and slots joined at one axial force, ready for contact springs (thesis 5.1)."""

import re
from collections.abc import Sequence

import numpy as np
import scipy.linalg
import xarray as xr
from jaxtyping import Float, Int
from numpy import ndarray

from bladeroot.variables import dataset

# Mass-weighted MAC above which a mode is the known one: no second one can have more.
KNOWN_MODE_MAC = 0.5


def assemble(reduced: xr.Dataset, force: float) -> xr.Dataset:
    """Mass and stiffness of beam and slots at axial force `force` (N), before contact springs.

    Dofs are the beam's, then slot Xn's, then slot Xp's (figs 5.1, 5.2). The connectivity (5.1.2)
    gives, for each pair and axis, the dof of the beam's node and of the slot's.
    """
    mass = [reduced.beam_mass.values, *reduced.slot_mass.values]
    stiffness = [
        reduced.beam_stiffness.values + force * reduced.beam_geometric_stiffness.values,
        *reduced.slot_stiffness.values,
    ]
    starts = np.cumsum([0, *(len(block) for block in mass)])
    pairs = len(reduced.pair)
    axes = np.arange(3)
    slot_dof = np.empty((pairs, 3), dtype=np.int64)
    for start, mine in zip(starts[1:], reduced.slot_pairs.values, strict=False):
        slot_dof[mine] = start + 3 * np.arange(len(mine))[:, None] + axes
    flank = reduced.pair_flank.values
    area = np.bincount(flank, reduced.pair_weight.values)
    shape = np.zeros((len(reduced.display), 3, starts[-1]))
    shape[:, :, : starts[1]] = reduced.display_shape.values
    made = dataset(
        "rom/assembly",
        {
            "mass": scipy.linalg.block_diag(*mass),
            "stiffness": scipy.linalg.block_diag(*stiffness),
            "beam_dof": 3 * np.arange(pairs)[:, None] + axes,
            "slot_dof": slot_dof,
            "frame": reduced.flank_frame.values[flank],
            "weight": reduced.pair_weight.values / area[flank],
            "flank": flank,
            "pair_position": reduced.pair_position.values,
            "display_position": reduced.display_position.values,
            "display_shape": shape,
        },
    )
    about = {key: reduced.attrs[key] for key in ("structure", "with_pad")}
    return made.assign_attrs(axial_force=float(force), **about).assign_coords(
        axis=reduced.axis.values, local=reduced.local.values
    )


def gap_rows(
    assembly: xr.Dataset, equal_nodes: bool = False
) -> tuple[Float[ndarray, "pair dof"], Float[ndarray, "slip dof"]]:
    """Rows that give each pair's gap, and its two slips, times the root of its share of the flank.

    With them contact stiffness is kn G'G of the gaps plus kt G'G of the slips, eq. 5.3. Each pair
    carries the flank's stiffness in proportion to the area it stands for. `equal_nodes` gives every
    node the same share instead, as the thesis does; it does not converge with the mesh.
    """
    pairs, size = len(assembly.pair), len(assembly.dof)
    weight = assembly.weight.values
    if equal_nodes:
        flank = assembly.flank.values
        weight = 1.0 / np.bincount(flank)[flank]
    rows = np.zeros((pairs, 3, size))
    place = np.arange(pairs)[:, None, None]
    local = np.arange(3)[None, :, None]
    scaled = np.sqrt(weight)[:, None, None] * assembly.frame.values
    rows[place, local, assembly.beam_dof.values[:, None, :]] = scaled
    rows[place, local, assembly.slot_dof.values[:, None, :]] = -scaled
    return rows[:, 0].copy(), rows[:, 1:].reshape(2 * pairs, size)


def find_modes(
    assembly: xr.Dataset, shapes: Float[ndarray, "dof mode"], names: Sequence[str] = ("1B", "2B")
) -> dict[str, int]:
    """Columns of the named modes, told by how they move and by parity in x, never by order alone.

    A name is a number and a letter: B moves the middle line mostly in Z (bending), L mostly in Y
    with upper and lower flanks alike (lateral bending), T mostly in Y with the flanks opposed
    (torsion). Odd numbers are even in x; 3B is the second even bending mode. `shapes` must be in
    order of frequency. An assembly with shapes of its own (`bodies`) knows its modes by these.
    ValueError if a name is none of these or its mode is not among the shapes.
    """
    if "mode_shape" in assembly:
        return _matched(assembly, shapes, names)
    shown = assembly.display_shape.values @ shapes
    found = {}
    for name in names:
        axis, number = axis_of(name), int(name[:-1])
        sign = 1 if number % 2 else -1
        good = of_parity(assembly.display_position.values, shown, axis, sign)
        if name[-1] != "B":
            good = good[_flanks_alike(assembly, shapes)[good] == (name[-1] == "L")]
        if len(good) <= (number - 1) // 2:
            raise ValueError(
                f"no mode {name} among the lowest {shapes.shape[1]}: "
                f"{'even' if sign > 0 else 'odd'} in x, moving in {'XYZ'[axis]}"
            )
        found[name] = int(good[(number - 1) // 2])
    return found


def axis_of(name: str) -> int:
    """Along which axis a named mode moves the middle line; ValueError if it is no such name."""
    if not re.fullmatch(r"[1-9]\d*[BLT]", name):
        raise ValueError(f"a mode's name must be a number and B, L or T, got {name!r}")
    return 2 if name[-1] == "B" else 1


def of_parity(
    position: Float[ndarray, "display 3"],
    shown: Float[ndarray, "display 3 mode"],
    axis: int,
    sign: int,
) -> Int[ndarray, " found"]:
    """Modes that move the display points mostly along an axis, even (1) or odd (-1) in x."""
    shown = shown[np.argsort(position[:, 0])]
    size = (shown**2).sum(axis=0)
    parity = (shown * shown[::-1]).sum(axis=0) / np.maximum(size, 1e-300)
    share = size / np.maximum(size.sum(axis=0), 1e-300)
    return np.flatnonzero((share[axis] > 0.5) & (sign * parity[axis] > 0.8))


def _matched(
    assembly: xr.Dataset, shapes: Float[ndarray, "dof mode"], names: Sequence[str]
) -> dict[str, int]:
    """Columns most like the shapes that the modes are known by, by mass-weighted MAC."""
    known = dict(
        zip(assembly["mode"].values.astype(str), assembly["mode_shape"].values, strict=True)
    )
    found = {}
    for name in names:
        if name not in known:
            raise ValueError(f"the structure knows modes {', '.join(known)}, not {name}")
        mac = (known[name] @ assembly["mass"].values @ shapes) ** 2
        if not mac.max() > KNOWN_MODE_MAC:
            raise ValueError(
                f"no mode agrees with the shape of mode {name}: largest MAC {mac.max():.2f}, "
                f"expected {KNOWN_MODE_MAC:g}"
            )
        found[name] = int(np.argmax(mac))
    return found


def frames(normal: Float[ndarray, "pair 3"]) -> Float[ndarray, "pair 3 3"]:
    """A unit normal and two tangents at each pair, which may be any: they share one kt."""
    normal = normal / np.linalg.norm(normal, axis=1)[:, None]
    least = np.eye(3)[np.argmin(abs(normal), axis=1)]
    one = np.cross(normal, least)
    one /= np.linalg.norm(one, axis=1)[:, None]
    return np.stack([normal, one, np.cross(normal, one)], axis=1)


def _flanks_alike(assembly: xr.Dataset, shapes: Float[ndarray, "dof mode"]) -> ndarray:
    """Whether upper and lower flanks of each end move alike in Y: lateral motion, not torsion."""
    moves = assembly.weight.values[:, None] * shapes[assembly.beam_dof.values[:, 1]]
    normal = assembly.frame.values[:, 0]
    alike, opposed = 0.0, 0.0
    for end in (-1, 1):
        upper, lower = (
            moves[(np.sign(normal[:, 0]) == end) & (np.sign(normal[:, 2]) == side)].sum(axis=0)
            for side in (1, -1)
        )
        alike, opposed = alike + (upper + lower) ** 2, opposed + (upper - lower) ** 2
    return alike > opposed
