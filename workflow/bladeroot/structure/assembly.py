"""Beam and slots joined at one axial force, ready for contact springs (thesis 5.1)."""

import numpy as np
import scipy.linalg
import xarray as xr
from jaxtyping import Float
from numpy import ndarray


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
    return xr.Dataset(
        {
            "mass": (
                ("dof", "dof_"),
                scipy.linalg.block_diag(*mass),
                {"units": "kg", "long_name": "mass of beam and slots", "source": "fig. 5.4"},
            ),
            "stiffness": (
                ("dof", "dof_"),
                scipy.linalg.block_diag(*stiffness),
                {
                    "units": "N/m",
                    "long_name": "stiffness of beam (prestressed) and slots, without contact",
                    "source": "eqs 4.1, 5.2",
                },
            ),
            "beam_dof": (
                ("pair", "axis"),
                3 * np.arange(pairs)[:, None] + axes,
                {
                    "units": "1",
                    "long_name": "dof of the beam's contact node",
                    "source": "section 5.1.2",
                },
            ),
            "slot_dof": (
                ("pair", "axis"),
                slot_dof,
                {
                    "units": "1",
                    "long_name": "dof of the slot's contact node",
                    "source": "section 5.1.2",
                },
            ),
            "frame": (
                ("pair", "local", "axis"),
                reduced.flank_frame.values[flank],
                {
                    "units": "1",
                    "long_name": "local axes of each pair, normal out of the beam",
                    "source": "eq. 5.3",
                },
            ),
            "weight": (
                "pair",
                reduced.pair_weight.values / area[flank],
                {"units": "1", "long_name": "share of the flank's area"},
            ),
            "flank": ("pair", flank, {"units": "1", "long_name": "flank of each pair"}),
            "display_position": reduced.display_position,
            "display_shape": (
                ("display", "axis", "dof"),
                shape,
                {"units": "1", "long_name": "displacement of display nodes per dof"},
            ),
        },
        coords={"axis": reduced.axis.values, "local": reduced.local.values},
        attrs={
            "axial_force": float(force),
            "structure": reduced.attrs["structure"],
            "with_pad": reduced.attrs["with_pad"],
        },
    )


def contact_matrices(
    assembly: xr.Dataset, equal_nodes: bool = False
) -> tuple[Float[ndarray, "dof dof"], Float[ndarray, "dof dof"]]:
    """Kn and Kt for one N/m of flank stiffness: contact adds k_n Kn + k_t Kt, eq. 5.3.

    Each pair carries the flank's stiffness in proportion to the area it stands for. `equal_nodes`
    gives every node the same share instead, as the thesis does; it does not converge with the mesh.
    """
    pairs, size = len(assembly.pair), len(assembly.dof)
    weight = assembly.weight.values
    if equal_nodes:
        flank = assembly.flank.values
        weight = 1.0 / np.bincount(flank)[flank]
    # Row (pair, local axis): the slip or gap of that pair per dof.
    gap = np.zeros((pairs, 3, size))
    place = np.arange(pairs)[:, None, None]
    local = np.arange(3)[None, :, None]
    gap[place, local, assembly.beam_dof.values[:, None, :]] = assembly.frame.values
    gap[place, local, assembly.slot_dof.values[:, None, :]] = -assembly.frame.values
    weighted = weight[:, None, None] * gap
    normal = gap[:, 0].T @ weighted[:, 0]
    tangential = sum(gap[:, k].T @ weighted[:, k] for k in (1, 2))
    return normal, tangential


def assembly_modes(
    assembly: xr.Dataset, kn: float, kt: float, count: int = 24, equal_nodes: bool = False
) -> tuple[Float[ndarray, " mode"], Float[ndarray, "dof mode"]]:
    """Lowest `count` frequencies (Hz) and mass-normalised shapes with flank stiffness kn, kt (N/m).

    An eigenvalue below zero is given as a negative frequency.
    """
    normal, tangential = contact_matrices(assembly, equal_nodes)
    stiffness = assembly.stiffness.values + kn * normal + kt * tangential
    values, shapes = scipy.linalg.eigh(
        stiffness, assembly.mass.values, subset_by_index=[0, count - 1], driver="gvx"
    )
    return np.sign(values) * np.sqrt(abs(values)) / (2 * np.pi), shapes


def find_bending(assembly: xr.Dataset, shapes: Float[ndarray, "dof mode"]) -> dict[str, int]:
    """Columns of the first bending modes "1B" (even in x) and "2B" (odd), by display shape.

    A bending mode moves the middle line mostly in Z. `shapes` must be in order of frequency.
    ValueError if one of the two is not among them.
    """
    position = assembly.display_position.values[:, 0]
    shown = np.einsum("daq,qm->dam", assembly.display_shape.values, shapes)
    size = (shown**2).sum(axis=0)
    moves_z = size[2] > 0.5 * size.sum(axis=0)
    order = np.argsort(position)
    lift = shown[order, 2]
    parity = (lift * lift[::-1]).sum(axis=0) / np.maximum((lift**2).sum(axis=0), 1e-300)
    found = {}
    for name, sign in (("1B", 1), ("2B", -1)):
        good = np.flatnonzero(moves_z & (sign * parity > 0.8))
        if len(good) == 0:
            raise ValueError(
                f"no mode of {shapes.shape[1]} is bending in Z and "
                f"{'even' if sign > 0 else 'odd'} in x; ask for more modes"
            )
        found[name] = int(good[0])
    return found
