"""The joint as an operator that is affine in kn, kt and axial force, and its exact modes.

K(kn, kt, F) = K0 + F Kg + kn Kn + kt Kt, with a constant mass (eqs 4.1, 5.3). A point is
(ln kn, ln kt, F), with flank totals in N/m and the axial force in N. Contact is kept as rows of
gaps and slips, too: a stiff contact multiplies what a matrix's rounding leaves of a small gap.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np
import scipy.linalg
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.fem.linear import lowest_eigenpairs
from bladeroot.fem.symmetry import sector_eigenpairs, whole_shapes
from bladeroot.rom.assembly import assemble, find_modes, gap_rows
from bladeroot.rom.joint_symmetry import JointSector, joint_sectors

COORDINATES = ("ln_kn", "ln_kt", "force")


@dataclass(frozen=True)
class Joint:
    """Beam and slots; the beam's dofs come first.

    mass kg, stiffness N/m, geometric 1/m (stiffness per newton of force). normal, tangential: Kn
    and Kt of 1 N/m of flank stiffness; gap, slip: the rows whose squares they are. springs: how a
    flank's stiffness is shared. assembly: by which modes are named.
    """

    mass: Float[ndarray, "dof dof"]
    stiffness: Float[ndarray, "dof dof"]
    geometric: Float[ndarray, "dof dof"]
    normal: Float[ndarray, "dof dof"]
    tangential: Float[ndarray, "dof dof"]
    gap: Float[ndarray, "pair dof"]
    slip: Float[ndarray, "slip dof"]
    beam_dofs: int
    springs: str
    assembly: xr.Dataset

    @cached_property
    def sectors(self) -> tuple[JointSector, ...]:
        """The joint by the parities of its motion, which do not mix."""
        matrices = (self.mass, self.stiffness, self.geometric, self.normal, self.tangential)
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
        gap.T @ gap,
        slip.T @ slip,
        gap,
        slip,
        int(assembly["slot_dof"].values.min()),
        "equal at every node" if equal_nodes else "by area",
        assembly,
    )


def joint_of_reduced(reduced: xr.Dataset, equal_nodes: bool = False) -> Joint:
    """The operator of a reduced beam and its slots (`reduced.nc`), at any force."""
    return joint_of(assemble(reduced, 0.0), reduced["beam_geometric_stiffness"].values, equal_nodes)


def stiffness_at(joint: Joint, point: Float[ndarray, "3"]) -> Float[ndarray, "dof dof"]:
    """Stiffness at (ln kn, ln kt, F), N/m."""
    return _sum(point, joint.stiffness, joint.geometric, joint.normal, joint.tangential)


def _sum(point, stiffness, geometric, normal, tangential) -> Float[ndarray, "dof dof"]:
    kn, kt = np.exp(point[:2])
    return stiffness + point[2] * geometric + (kn * normal + kt * tangential)


def energy(
    joint: Joint, point: Float[ndarray, "3"], shapes: Float[ndarray, "dof mode"]
) -> Float[ndarray, " mode"]:
    """Twice the strain energy of shapes, J; the contact's from the gaps themselves."""
    kn, kt = np.exp(point[:2])
    load = joint.stiffness @ shapes + point[2] * (joint.geometric @ shapes)
    return (
        (shapes * load).sum(axis=0)
        + kn * ((joint.gap @ shapes) ** 2).sum(axis=0)
        + kt * ((joint.slip @ shapes) ** 2).sum(axis=0)
    )


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


def described(point: Float[ndarray, "3"]) -> str:
    """A point in words."""
    kn, kt = np.exp(point[:2])
    return f"at kn {kn:.3g}, kt {kt:.3g} N/m and {point[2]:g} N"


class Operator:
    """The stiffness at a point with its factor, and its lowest modes as far as they are asked for.

    Factor and modes cost more than all that is made of them: whoever needs several things at a
    point asks one operator. ValueError, saying `where`, if the joint is not stable there.
    """

    def __init__(self, joint: Joint, point: Float[ndarray, "3"], where: str = "") -> None:
        """Factor the stiffness; where: the point in words."""
        self.joint, self.point = joint, point
        self._parts = [one.part for one in joint.sectors]
        self._problems = [
            (_sum(point, *m), mass) for mass, *m in (s.matrices for s in joint.sectors)
        ]
        where = where or described(point)
        self._factors = [stable_factor(stiffness, where) for stiffness, _ in self._problems]
        self._lowest: dict[int, tuple[ndarray, ndarray]] = {}

    @cached_property
    def stiffness(self) -> Float[ndarray, "dof dof"]:
        """Of the whole joint, N/m."""
        return stiffness_at(self.joint, self.point)

    def solve(self, right: Float[ndarray, "dof column"]) -> Float[ndarray, "dof column"]:
        """Displacements (m) under loads (N)."""
        moved = np.zeros_like(right)
        for part, factor in zip(self._parts, self._factors, strict=True):
            moved += part.columns @ _solved(factor, part.columns.T @ right)
        return moved

    def lowest(self, count: int) -> tuple[Float[ndarray, " mode"], Float[ndarray, "dof mode"]]:
        """omega^2 (1/s^2) and shapes of unit modal mass of the lowest modes."""
        if count not in self._lowest:
            solves = [partial(_solved, factor) for factor in self._factors]
            values, found = sector_eigenpairs(self._problems, solves, count)
            self._lowest[count] = values, whole_shapes(self._parts, found)
        return self._lowest[count]

    def modes(self, names: Sequence[str]) -> Modes:
        """The named modes. ValueError if one is not found."""
        _, shapes = _holding(self.joint, names, len(self.joint.mass), self.lowest)
        return _chosen(self.joint, energy(self.joint, self.point, shapes), shapes, names)


def _solved(factor: ndarray, right: ndarray) -> ndarray:
    return scipy.linalg.cho_solve((factor, True), right, check_finite=False)


def exact_modes(joint: Joint, point: Float[ndarray, "3"], names: Sequence[str]) -> Modes:
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
