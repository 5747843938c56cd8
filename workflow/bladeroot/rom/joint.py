"""The joint as an operator that is affine in its contact stiffnesses and the load; exact modes.

K(k, F) = K0 + F Kg + sum over the stiffnesses of k Kc, with a constant mass (eqs 4.1, 5.3). A point
is (ln k..., F): of the dovetail (ln kn, ln kt, F), with flank totals in N/m and the axial force in
N. Contact is kept as rows of gaps and slips, too: a stiff contact multiplies what a matrix's
rounding leaves of a small gap.
"""

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np
import scipy.linalg
import xarray as xr
from jaxtyping import Float, Int
from numpy import ndarray

from bladeroot.fem.linear import lowest_eigenpairs
from bladeroot.fem.symmetry import sector_eigenpairs, whole_shapes
from bladeroot.rom.assembly import assemble, find_modes, gap_rows
from bladeroot.rom.joint_symmetry import JointSector, joint_sectors

_MIRROR_DISTANCE = 1e-7  # m, within which a contact pair's mirror image is another pair
_OUTSIDE_SECTOR = 1e-9  # of a shape's size that may lie outside its sector of symmetry


@dataclass(frozen=True)
class Joint:
    """Beam and slots; the beam's dofs come first.

    mass kg, stiffness N/m, geometric 1/m (stiffness per newton of force). parameters: names of the
    contact stiffnesses; rows: of each, motions whose squares are its Kc of 1 N/m, kept in squares.
    springs: how an interface's stiffness is shared. assembly: by which modes are named. shift:
    1/s^2, by which a body that is free is held while a matrix is factored; no mode is changed.
    """

    mass: Float[ndarray, "dof dof"]
    stiffness: Float[ndarray, "dof dof"]
    geometric: Float[ndarray, "dof dof"]
    rows: tuple[Float[ndarray, "_ dof"], ...]
    squares: tuple[Float[ndarray, "dof dof"], ...]
    beam_dofs: int
    springs: str
    assembly: xr.Dataset
    parameters: tuple[str, ...] = ("kn", "kt")
    shift: float = 0.0

    @property
    def gap(self) -> Float[ndarray, "pair dof"]:
        """Rows of the only interface's gaps."""
        return self.rows[0]

    @property
    def slip(self) -> Float[ndarray, "slip dof"]:
        """Rows of the only interface's slips."""
        return self.rows[1]

    @cached_property
    def flank(self) -> Int[ndarray, " pair"]:
        """The flank that each pair is on."""
        return self.assembly["flank"].values

    @cached_property
    def area(self) -> Float[ndarray, " pair"]:
        """Share of the flank's area that each pair stands for."""
        return self.assembly["weight"].values

    @cached_property
    def normal(self) -> Float[ndarray, "pair 3"]:
        """Unit normal of each pair."""
        return self.assembly["frame"].values[:, 0]

    @cached_property
    def weight(self) -> Float[ndarray, " pair"]:
        """Share of the flank's stiffness that each pair carries."""
        dofs = self.assembly["beam_dof"].values
        return (np.take_along_axis(self.gap, dofs, axis=1) * self.normal).sum(axis=1) ** 2

    @cached_property
    def contact(self) -> Float[ndarray, "pair 3 dof"]:
        """Rows that give the beam's motion against the slot at each pair by local axis."""
        pairs = len(self.gap)
        rows = np.concatenate([self.gap[:, None], self.slip.reshape(pairs, 2, -1)], axis=1)
        return rows / np.sqrt(self.weight)[:, None, None]

    @cached_property
    def edge_distance(self) -> Float[ndarray, " pair"]:
        """Of each pair from its flank's middle, 1 at the nearest edge (along Y or the slope)."""
        assembly = self.assembly
        along = np.einsum(
            "pla,pa->pl", assembly["frame"].values[:, 1:], assembly["pair_position"].values
        )
        flank, far = assembly["flank"].values, np.zeros(len(along))
        for one in np.unique(flank):
            here = flank == one
            low, high = along[here].min(axis=0), along[here].max(axis=0)
            half = np.where(high > low, 0.5 * (high - low), 1.0)
            far[here] = np.abs((along[here] - 0.5 * (low + high)) / half).max(axis=1)
        return far

    @cached_property
    def mirrors(self) -> list[tuple[Int[ndarray, " pair"], Float[ndarray, "pair 3"]]]:
        """Reflections that keep the contacts: each pair's image, and its local axes' signs."""
        place = self.assembly["pair_position"].values
        frame = self.assembly["frame"].values
        found = []
        for axis in range(3):
            flip = np.where(np.arange(3) == axis, -1.0, 1.0)
            distance = np.abs(place[:, None] * flip - place[None]).max(axis=2)
            image = distance.argmin(axis=1)
            turn = np.einsum("pla,a,pma->plm", frame[image], flip, frame)
            kept = distance.min(axis=1).max() <= _MIRROR_DISTANCE
            if kept and np.allclose(np.abs(turn), np.eye(3), atol=1e-9):
                found.append((image, np.einsum("pll->pl", turn)))
        return found

    @cached_property
    def homes(self) -> dict[str, int | None]:
        """The sector of each named mode, as far as it was asked for; None if it is in no one."""
        return {}

    @cached_property
    def sectors(self) -> tuple[JointSector, ...]:
        """The joint by the parities of its motion, which do not mix."""
        matrices = (self.mass, self.stiffness, self.geometric, *self.squares)
        return joint_sectors(self.assembly, *matrices)


def joint_of(
    assembly: xr.Dataset,
    geometric: Float[ndarray, "beam beam"] | None = None,
    equal_nodes: bool = False,
) -> Joint:
    """The operator of an assembly; without `geometric` it knows the assembly's own force alone.

    geometric: the beam's geometric stiffness per newton. equal_nodes: the same spring at every
    node, as in the thesis, instead of by area.
    """
    whole = np.zeros_like(assembly["mass"].values)
    if geometric is not None:
        whole[: len(geometric), : len(geometric)] = geometric
    gap, slip = gap_rows(assembly, equal_nodes)
    return Joint(
        assembly["mass"].values,
        assembly["stiffness"].values,
        whole,
        (gap, slip),
        (gap.T @ gap, slip.T @ slip),
        int(assembly["slot_dof"].values.min()),
        "equal at every node" if equal_nodes else "by area",
        assembly,
    )


def joint_of_reduced(reduced: xr.Dataset, equal_nodes: bool = False) -> Joint:
    """The operator of a reduced beam and its slots (`reduced.nc`), at any force."""
    return joint_of(assemble(reduced, 0.0), reduced["beam_geometric_stiffness"].values, equal_nodes)


def stiffness_at(joint: Joint, point: Float[ndarray, " coordinate"]) -> Float[ndarray, "dof dof"]:
    """Stiffness at (ln k..., F), N/m."""
    return _sum(point, joint.stiffness, joint.geometric, *joint.squares)


def held_at(joint: Joint, point: Float[ndarray, " coordinate"]) -> Float[ndarray, "dof dof"]:
    """The same, with free bodies held by the shift: what can be factored."""
    return _held(stiffness_at(joint, point), joint.mass, joint.shift)


def _sum(point, stiffness, geometric, *squares) -> Float[ndarray, "dof dof"]:
    contact = 0.0
    for k, square in zip(np.exp(point[:-1]), squares, strict=True):
        contact = contact + k * square
    return stiffness + point[-1] * geometric + contact


def _held(stiffness: ndarray, mass: ndarray, shift: float) -> Float[ndarray, "dof dof"]:
    return stiffness + shift * mass if shift else stiffness


def energy(
    joint: Joint, point: Float[ndarray, " coordinate"], shapes: Float[ndarray, "dof mode"]
) -> Float[ndarray, " mode"]:
    """Twice the strain energy of shapes, J; the contact's from the gaps themselves."""
    load = joint.stiffness @ shapes + point[-1] * (joint.geometric @ shapes)
    whole = (shapes * load).sum(axis=0)
    for k, rows in zip(np.exp(point[:-1]), joint.rows, strict=True):
        whole = whole + k * ((rows @ shapes) ** 2).sum(axis=0)
    return whole


@dataclass(frozen=True)
class Modes:
    """The named modes in order of the names, and the lowest modes that they were found among.

    values: omega^2, 1/s^2. shapes: of unit modal mass.
    """

    values: Float[ndarray, " name"]
    shapes: Float[ndarray, "dof name"]
    all_values: Float[ndarray, " mode"]
    all_shapes: Float[ndarray, "dof mode"]


def stable_factor(stiffness: Float[ndarray, "dof dof"], where: str) -> Float[ndarray, "dof dof"]:
    """Lower Cholesky factor. ValueError, saying `where`, if there is none."""
    try:
        return scipy.linalg.cholesky(stiffness, lower=True, check_finite=False)
    except np.linalg.LinAlgError:
        raise ValueError(f"the joint must be stable, but is not {where}") from None


def described(point: Float[ndarray, " coordinate"]) -> str:
    """A point in words."""
    stiffness = ", ".join(f"{k:.3g}" for k in np.exp(point[:-1]))
    return f"at contact stiffnesses {stiffness} N/m and a load of {point[-1]:g}"


class Operator:
    """The stiffness at a point with its factor, and its lowest modes as far as they are asked for.

    Factor and modes cost more than all that is made of them: whoever needs several things at a
    point asks one operator. ValueError, saying `where`, if the joint is not stable there.
    """

    def __init__(self, joint: Joint, point: Float[ndarray, " coordinate"], where: str = "") -> None:
        """Factor the stiffness, free bodies held; where: the point in words."""
        self.joint, self.point = joint, point
        self._parts = [one.part for one in joint.sectors]
        self._problems = [
            (_held(_sum(point, *m), mass, joint.shift), mass)
            for mass, *m in (s.matrices for s in joint.sectors)
        ]
        where = where or described(point)
        self._factors = [stable_factor(stiffness, where) for stiffness, _ in self._problems]
        self._lowest: dict[int, tuple[ndarray, ndarray]] = {}

    def project(
        self, shapes: Float[ndarray, "dof shape"]
    ) -> tuple[Float[ndarray, "shape shape"], Float[ndarray, "shape shape"]]:
        """Mass and stiffness (N/m) between shapes."""
        mass = stiffness = np.zeros((shapes.shape[1],) * 2)
        for part, (held, own) in zip(self._parts, self._problems, strict=True):
            within = part.columns.T @ shapes
            mass = mass + within.T @ (own @ within)
            stiffness = stiffness + within.T @ (held @ within)
        return mass, stiffness - self.joint.shift * mass

    def solve(self, right: Float[ndarray, "dof column"]) -> Float[ndarray, "dof column"]:
        """Displacements (m) under loads (N)."""
        moved = np.zeros_like(right)
        for part, factor in zip(self._parts, self._factors, strict=True):
            moved += part.columns @ _solved(factor, part.columns.T @ right)
        return moved

    def lowest(self, count: int) -> tuple[Float[ndarray, " mode"], Float[ndarray, "dof mode"]]:
        """omega^2 (1/s^2) and shapes of unit modal mass of the lowest modes, rigid ones too.

        Of a sector alone its share of so many.
        """
        if count not in self._lowest:
            solves = [partial(_solved, factor) for factor in self._factors]
            share = len(self.joint.sectors) // len(self._parts)
            values, found = sector_eigenpairs(self._problems, solves, -(-count // share))
            self._lowest[count] = values - self.joint.shift, whole_shapes(self._parts, found)
        return self._lowest[count]

    def holding(self, names: Sequence[str]) -> Float[ndarray, "dof mode"]:
        """Shapes of the lowest modes among which the named ones are. ValueError if one is not."""
        return _holding(self.joint, names, len(self.joint.mass), self.lowest)[1]

    def modes(self, names: Sequence[str]) -> Modes:
        """The named modes. ValueError if one is not found."""
        shapes = self.holding(names)
        return _chosen(self.joint, energy(self.joint, self.point, shapes), shapes, names)

    def sector(self, shape: Float[ndarray, " dof"]) -> int | None:
        """The sector in which a shape lies; None if it has parts in several."""
        sizes = [np.linalg.norm(part.columns.T @ shape) for part in self._parts]
        found = int(np.argmax(sizes))
        return found if sizes[found] > (1.0 - _OUTSIDE_SECTOR) * np.linalg.norm(shape) else None

    def within(self, sector: int | None) -> "Operator":
        """The same for loads and motions of one sector alone, at a fraction of the cost."""
        if sector is None:
            return self
        one = copy(self)
        for name in ("_parts", "_problems", "_factors"):
            setattr(one, name, getattr(self, name)[sector : sector + 1])
        one._lowest = {}
        return one

    def holds(self, loads: Float[ndarray, "dof column"]) -> bool:
        """Whether loads lie in the sectors of this operator alone."""
        left = loads - sum(part.columns @ (part.columns.T @ loads) for part in self._parts)
        return bool(np.abs(left).max() <= _OUTSIDE_SECTOR * np.abs(loads).max())


def _solved(factor: ndarray, right: ndarray) -> ndarray:
    return scipy.linalg.cho_solve((factor, True), right, check_finite=False)


def exact_modes(joint: Joint, point: Float[ndarray, " coordinate"], names: Sequence[str]) -> Modes:
    """Modes of the whole operator at a point, by inverse iteration.

    Raises ValueError if the joint is not stable there or a mode is not found.
    """
    return Operator(joint, point).modes(names)


def bonded_modes(joint: Joint, force: float, names: Sequence[str]) -> Modes:
    """Modes with both stiffnesses infinite: each slot node moves with the beam's."""
    size = len(joint.mass)
    master = np.arange(size)
    master[joint.assembly["slot_dof"].values] = joint.assembly["beam_dof"].values
    kept, column = np.unique(master, return_inverse=True)
    join = np.zeros((size, len(kept)))
    join[np.arange(size), column] = 1.0
    stiffness = join.T @ (joint.stiffness + force * joint.geometric) @ join
    mass = join.T @ joint.mass @ join
    factor = (stable_factor(stiffness, "with bonded contact"), True)

    def solve(right: ndarray) -> ndarray:
        return scipy.linalg.cho_solve(factor, right, check_finite=False)

    def lowest(count: int) -> tuple[ndarray, ndarray]:
        values, shapes = lowest_eigenpairs(stiffness, mass, count, solve=solve)
        return values, join @ shapes

    values, shapes = _holding(joint, names, len(mass), lowest)
    return _chosen(joint, values, shapes, names)


def _chosen(joint: Joint, values: ndarray, shapes: ndarray, names: Sequence[str]) -> Modes:
    column = find_modes(joint.assembly, shapes, names)
    chosen = [column[name] for name in names]
    return Modes(values[chosen], shapes[:, chosen], values, shapes)


def _holding(joint, names, size, lowest) -> tuple[ndarray, ndarray]:
    """As many of the lowest modes, which `lowest` gives by their number, as hold the named ones."""
    for count in (12, 40):
        count = min(count, size)
        values, shapes = lowest(count)
        try:
            find_modes(joint.assembly, shapes, names)
            break
        except ValueError:
            if count in (40, size):
                raise
    return values, shapes
