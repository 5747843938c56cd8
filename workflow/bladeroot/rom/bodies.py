"""Any bodies with any interfaces: reduced body by body, joined, and their modes known by name.

A body may be held or free. Its contact nodes are the masters of its Craig-Bampton reduction, whose
static modes then hold the rigid motions of a free body exactly. What comes out has the form of
`assembly.assemble`, with an interface in the place of a flank.
"""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np
import scipy.linalg
import scipy.sparse as sp
import xarray as xr
from jaxtyping import Float, Int
from numpy import ndarray

from bladeroot.rom.assembly import KNOWN_MODE_MAC, frames, gap_rows, of_parity
from bladeroot.rom.joint import Joint, Operator
from bladeroot.rom.reduction import craig_bampton, project, project_stiffness

# Least agreement (MAC) of a mode with a given shape, by which it is named. Measured shapes of one
# mode agree to 0.9 and better; two modes on few points rarely to more than 0.5.
LEAST_MAC = 0.7
# Elastic modes that are searched for the named ones, beyond the highest order asked for.
EXTRA_MODES = 8
# Where two modes agree with a given shape and their MACs differ by less, it is open which is meant:
# on few points two modes look alike.
MAC_DIFFERENCE = 0.1
# A mode that moves less than this part of its largest motion, at the points and in the directions
# of a given shape, is not the one that was measured: in a symmetric structure that is rounding.
LEAST_MOTION = 0.05
# omega^2 below this part of the shift is a rigid motion: rounding leaves less, and an elastic mode
# lies far above, as the shift is a thousandth of what a single dof would have.
RIGID_PART = 1e-5
# Strain energy of a body's translation, over that of its diagonal alone, below which it is free.
_FREE_ENERGY = 1e-7
# What holds a free assembly while it is factored, over the least Rayleigh quotient of one dof.
_SHIFT = 1e-3


@dataclass(frozen=True)
class Body:
    """kg, N/m, 1/m per unit of load (or None); `dof`: row of a node's displacements, -1: held."""

    name: str
    mass: sp.csr_array
    stiffness: sp.csr_array
    geometric: sp.csr_array | None
    nodes: Float[ndarray, "node 3"]
    dof: Int[ndarray, "node 3"]


@dataclass(frozen=True)
class Interface:
    """A pair of surfaces: their contact nodes, and what is known of the stiffness between them.

    body, node: of the two sides of each pair. normal: out of the first. area: of any unit, only its
    share counts. kn, kt: ends of the box that the true one lies in (N/m), or a known value; None:
    tied. share: of the campaign's load, which presses it.
    """

    name: str
    body: Int[ndarray, "pair 2"]
    node: Int[ndarray, "pair 2"]
    normal: Float[ndarray, "pair 3"]
    area: Float[ndarray, " pair"]
    kn: tuple[float, float] | float | None
    kt: tuple[float, float] | float | None
    share: float = 1.0


@dataclass(frozen=True)
class Assembly:
    """Bodies and how they touch.

    display: body and node of the points that show the modes and carry the sensors. modes: by name,
    `order` among the elastic modes, `parity` (with `axis` and `number`) along x, or `shape` at the
    display points, each in the middle of the box. kept: fixed-interface modes of each body.
    load_range: of the loads that the model serves, if not the configuration's (in N) or, where no
    load changes a stiffness, any.
    """

    name: str
    bodies: tuple[Body, ...]
    interfaces: tuple[Interface, ...]
    display: Int[ndarray, "point 2"]
    modes: Mapping[str, Mapping]
    kept: int
    load_range: tuple[float, float] | None = None


def reduce_bodies(assembly: Assembly) -> xr.Dataset:
    """`reduced.nc` of an assembly.

    Raises ValueError, one line, for an interface without pairs, a contact node that does not move
    freely, a body that its contact does not hold, and a mode that is not found.
    """
    name, bodies, interfaces = assembly.name, assembly.bodies, assembly.interfaces
    display, modes = assembly.display, assembly.modes
    for one in interfaces:
        if not len(one.node):
            raise ValueError(f"interface {one.name} has no contact pairs ({name})")
    touching = [_contact_nodes(interfaces, b) for b in range(len(bodies))]
    blocks = [
        _reduced(body, nodes, assembly.kept) for body, nodes in zip(bodies, touching, strict=True)
    ]
    starts = np.cumsum([0, *(len(mass) for mass, *_ in blocks)])
    mass, stiffness, geometric = (
        scipy.linalg.block_diag(*(block[k] for block in blocks)) for k in range(3)
    )
    dofs = np.concatenate([_sides(one, touching, starts) for one in interfaces])
    shape = np.zeros((len(display), 3, starts[-1]))
    for k, (b, node) in enumerate(display):
        own = bodies[b].dof[node]
        moved = blocks[b][3][own[own >= 0]]
        shape[k, own >= 0, starts[b] : starts[b + 1]] = moved
    tied = np.concatenate([np.full(len(one.node), one.kn is None) for one in interfaces])
    join = _join(dofs[tied], int(starts[-1]))
    mass, stiffness, geometric = (join.T @ one @ join for one in (mass, stiffness, geometric))
    place = join.argmax(axis=1)
    interface = np.repeat(np.arange(len(interfaces)), [len(one.node) for one in interfaces])
    area = np.concatenate([one.area for one in interfaces])
    where = np.array([bodies[b].nodes[n] for one in interfaces for b, n in
                      zip(one.body[:, 0], one.node[:, 0], strict=True)])  # fmt: skip
    whole = _dataset(
        name, (mass, stiffness, geometric), place[dofs[~tied]],
        np.concatenate([frames(one.normal) for one in interfaces])[~tied],
        (area / np.bincount(interface, area)[interface])[~tied], interface[~tied], where[~tied],
        np.array([bodies[b].nodes[n] for b, n in display]), shape @ join, interfaces,
    )  # fmt: skip
    if assembly.load_range:
        whole.attrs["load_range"] = list(map(float, assembly.load_range))
    whole.attrs["floating"] = ", ".join(_floating(bodies))
    with telling_of_floating(whole):
        shapes = _named(whole, modes)
    text = {"units": "kg-1/2", "long_name": "shape that a mode is known by, middle of the box"}
    return whole.assign(mode_shape=(("mode", "dof"), shapes, text)).assign_coords(mode=list(modes))


@contextmanager
def telling_of_floating(reduced: xr.Dataset) -> Iterator[None]:
    """A ValueError says, too, which bodies contact alone holds: it may be that they were not meant
    to be, and modes in which they float are in the way of others.
    """
    try:
        yield
    except ValueError as error:
        floating = reduced.attrs["floating"]
        if not floating:
            raise
        raise ValueError(
            f"{error}. Contact alone holds {floating}: if that is not meant, nodes are missing "
            "among the fixed ones"
        ) from None


def joint_of_bodies(reduced: xr.Dataset) -> Joint:
    """The operator over the unknown stiffnesses, known ones put in."""
    normal, slip = gap_rows(reduced)
    slip = slip.reshape(len(normal), 2, -1)
    stiffness = reduced["stiffness"].values.copy()
    names, rows = [], []
    for k, interface in enumerate(reduced["interface"].values.astype(str)):
        mine = reduced["flank"].values == k
        for kind, part in (("kn", normal[mine]), ("kt", slip[mine].reshape(-1, normal.shape[1]))):
            low, high = reduced[f"{kind}_box"].values[k]
            if low < high:
                names.append(f"{kind} {interface}")
                rows.append(part)
            elif mine.any():
                stiffness += low * part.T @ part
    mass = reduced["mass"].values
    whole = stiffness + sum((row.T @ row for row in rows), np.zeros_like(stiffness))
    least = float(np.min(whole.diagonal() / mass.diagonal()))
    return Joint(
        mass, stiffness, reduced["geometric_stiffness"].values, tuple(rows),
        tuple(row.T @ row for row in rows), len(mass), "by area", reduced, tuple(names),
        _SHIFT * least,
    )  # fmt: skip


def box_of(reduced: xr.Dataset) -> Float[ndarray, "parameter 2"]:
    """Ends of the box of each unknown stiffness (N/m), in the order of the operator's."""
    ends = np.stack([reduced["kn_box"].values, reduced["kt_box"].values], axis=1).reshape(-1, 2)
    return ends[ends[:, 0] < ends[:, 1]]


def _floating(bodies: Sequence[Body]) -> list[str]:
    """Bodies that move without strain in some direction, where others do not."""
    found = []
    for body in bodies:
        moves = np.zeros((body.mass.shape[0], 3))
        for axis, rows in enumerate(body.dof.T):
            moves[rows[rows >= 0], axis] = 1.0
        energy = moves.T @ (body.stiffness @ moves)
        diagonal = body.stiffness.diagonal() @ moves
        if np.linalg.eigvalsh(energy)[0] < _FREE_ENERGY * diagonal.mean():
            found.append(body.name)
    return found if len(found) < len(bodies) else []


def _contact_nodes(interfaces: Sequence[Interface], body: int) -> Int[ndarray, " node"]:
    return np.unique(np.concatenate([one.node[one.body == body] for one in interfaces]))


def _sides(one: Interface, touching: list[ndarray], starts: ndarray) -> Int[ndarray, "pair 2 3"]:
    """Rows of the whole that are the two sides' displacements."""
    first = np.empty(one.node.shape, dtype=int)
    for b, nodes in enumerate(touching):
        mine = one.body == b
        first[mine] = starts[b] + 3 * np.searchsorted(nodes, one.node[mine])
    return first[:, :, None] + np.arange(3)


def _reduced(body: Body, contact: ndarray, kept: int) -> tuple[ndarray, ...]:
    """Mass, stiffness, geometric stiffness and the basis that they are in."""
    masters = body.dof[contact].ravel()
    if (masters < 0).any():
        bad = contact[int(np.argmax(masters < 0)) // 3]
        raise ValueError(f"contact node at {body.nodes[bad]} m of {body.name} must move freely")
    if not len(contact):
        raise ValueError(f"body {body.name} has no contact pairs")
    try:
        basis = craig_bampton(body.stiffness, body.mass, masters, kept)
    except ValueError as error:
        raise ValueError(f"body {body.name}, its contact nodes held: {error}") from None
    own, geometric = project_stiffness(body.stiffness, basis), body.geometric
    pull = np.zeros_like(own) if geometric is None else project(geometric, basis)
    return project(body.mass, basis), own, pull, basis.columns


def _join(pairs: Int[ndarray, "pair 2 3"], size: int) -> Float[ndarray, "dof kept"]:
    """Ties the sides of pairs: the second moves with the first."""
    master = np.arange(size)
    for first, second in zip(pairs[:, 0].ravel(), pairs[:, 1].ravel(), strict=True):
        master[master == master[second]] = master[first]
    kept, column = np.unique(master, return_inverse=True)
    join = np.zeros((size, len(kept)))
    join[np.arange(size), column] = 1.0
    return join


def _named(reduced: xr.Dataset, modes: Mapping[str, Mapping]) -> Float[ndarray, "mode dof"]:
    """Shapes of the named modes in the middle of the box."""
    joint, where = joint_of_bodies(reduced), reduced.attrs["structure"]
    middle = np.append(np.log(box_of(reduced)).mean(axis=1), 0.0)
    orders = [one.get("order", one.get("number", 1)) for one in modes.values()]
    count = min(2 * max([*orders, len(modes)]) + EXTRA_MODES + 6, len(joint.mass))
    values, shapes = Operator(joint, middle).lowest(count)
    shapes = shapes[:, values > RIGID_PART * joint.shift]
    shown = np.einsum("daq,qm->dam", reduced["display_shape"].values, shapes)
    found = {name: _place(name, one, reduced, shown, where) for name, one in modes.items()}
    for name, place in found.items():
        same = [other for other, p in found.items() if p == place and other != name]
        if same:
            raise ValueError(f"modes {name} and {same[0]} are one mode of the model ({where})")
    return shapes[:, list(found.values())].T


def _place(name: str, one: Mapping, reduced: xr.Dataset, shown: ndarray, where: str) -> int:
    count = shown.shape[2]
    if "order" in one:
        if one["order"] > count:
            raise ValueError(f"mode {name} is number {one['order']} of {count} modes ({where})")
        return one["order"] - 1
    if "parity" in one:
        sign, axis = {"even": 1, "odd": -1}[one["parity"]], "XYZ".index(one["axis"])
        good = of_parity(reduced["display_position"].values, shown, axis, sign)
        if len(good) < one["number"]:
            raise ValueError(
                f"mode {name}: only {len(good)} of the lowest {count} modes move along "
                f"{one['axis']} and are {one['parity']} in x ({where})"
            )
        return int(good[one["number"] - 1])
    given = one["shape"]
    known = np.isfinite(given)
    seen = shown[known]
    mac = (given[known] @ seen) ** 2 / (given[known] @ given[known]) / (seen**2).sum(axis=0)
    mac *= np.abs(seen).max(axis=0) >= LEAST_MOTION * np.abs(shown).max(axis=(0, 1))
    if not mac.max() >= LEAST_MAC:
        raise ValueError(
            f"no mode of the model agrees with the shape of mode {name}: largest MAC "
            f"{mac.max():.2f}, expected {LEAST_MAC:g} ({where})"
        )
    second, first = np.argsort(mac)[-2:] if count > 1 else (0, 0)
    if count > 1 and mac[second] >= max(LEAST_MAC, mac[first] - MAC_DIFFERENCE):
        raise ValueError(
            f"the shape of mode {name} is that of two modes of the model, numbers {first + 1} and "
            f"{second + 1} (MAC {mac[first]:.2f} and {mac[second]:.2f}): more points, or an order, "
            f"would tell ({where})"
        )
    return int(first)


def _dataset(
    name, matrices, dofs, frame, weight, flank, position, shown, shape, interfaces
) -> xr.Dataset:
    def var(dims, values, units, text):
        return dims, values, {"units": units, "long_name": text}

    def box(kind: str) -> ndarray:
        ends = [getattr(one, kind) for one in interfaces]
        return np.array([[0.0, 0.0] if k is None else k if isinstance(k, tuple) else [k, k]
                         for k in ends], float)  # fmt: skip

    square = ("dof", "dof_")
    return xr.Dataset(
        {
            "mass": var(square, matrices[0], "kg", "reduced mass of all bodies"),
            "stiffness": var(square, matrices[1], "N/m", "reduced stiffness without contact"),
            "geometric_stiffness": var(
                square, matrices[2], "1/m", "change of stiffness per unit of load"
            ),
            "beam_dof": var(("pair", "axis"), dofs[:, 0], "1", "rows of the pair's first side"),
            "slot_dof": var(("pair", "axis"), dofs[:, 1], "1", "rows of the pair's second side"),
            "frame": var(("pair", "local", "axis"), frame, "1", "local axes, normal first"),
            "weight": var("pair", weight, "1", "share of the interface's area"),
            "flank": var("pair", flank, "1", "interface of each pair"),
            "pair_position": var(("pair", "axis"), position, "m", "position of each pair"),
            "display_position": var(("display", "axis"), shown, "m", "points that show the modes"),
            "display_shape": var(
                ("display", "axis", "dof"), shape, "1", "displacement of these points per dof"
            ),
            "kn_box": var(("interface", "end"), box("kn"), "N/m", "ends of kn; alike: known"),
            "kt_box": var(("interface", "end"), box("kt"), "N/m", "ends of kt; alike: known"),
            "preload_share": var(
                "interface", [one.share for one in interfaces], "1", "pressing over the load"
            ),
        },
        coords={"interface": [one.name for one in interfaces], "axis": list("XYZ")},
        attrs={"structure": name, "kind": "assembly", "matched_from_MAC": KNOWN_MODE_MAC},
    )
