"""A jointed structure as a notebook holds it: matrices, contact pairs and named modes."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
import scipy.sparse as sp
from jaxtyping import Float, Int
from numpy import ndarray

from bladeroot.fem.linear import lowest_eigenpairs
from bladeroot.io.names import is_id
from bladeroot.rom.assembly import frames
from bladeroot.rom.bodies import EXTRA_MODES, LEAST_MAC
from bladeroot.rom.full import gaps_along
from bladeroot.shipped_files import structure_file

# Largest difference of a matrix from its transpose, over its largest entry.
_ASYMMETRY = 1e-6
# Shift below the spectrum, over the lowest Rayleigh quotient of a single dof: keeps the factor away
# from the rigid motions of free bodies.
_SHIFT = 1e-3
_MOST_LN_K = 60.0  # of any contact in N/m; more is a stiffness, not its logarithm
# Contact and load at which the dovetail's modes are named by parity.
_NAMING_STIFFNESS = 2e9  # N/m a flank, as the source finds
_NAMING_FORCE = 12e3  # N
# Rigid motions are sought among the lowest modes without load.
_RIGID_SEARCHED = 12  # modes
_RIGID_PART = 1e-7  # omega^2 over the highest of theirs, below which a mode is a rigid motion
# omega^2 (rad^2/s^2) that some dof alone has in any structure that rings: exchanged matrices show
# its inverse.
_LEAST_OMEGA2 = 1.0


@dataclass(frozen=True)
class ContactPairs:
    """Node pairs in contact: which rows of the matrices, which way, how much area each stands for.

    first, second: rows of the three displacements of the two nodes of each pair, -1 where a
    displacement is fixed. normal: of the contact, of any length. area: any unit; only its share of
    the interface counts. interface: name of each pair's interface; each has its own kn and kt.
    """

    first: Int[ndarray, "pair 3"]
    second: Int[ndarray, "pair 3"]
    normal: Float[ndarray, "pair 3"]
    area: Float[ndarray, " pair"]
    interface: tuple[str, ...] = ()

    @property
    def interfaces(self) -> tuple[str, ...]:
        """Names of the interfaces in the pairs' order; one empty name where none is given."""
        return tuple(dict.fromkeys(self.interface)) or ("",)


@dataclass(frozen=True)
class NamedModes:
    """Frequencies (Hz) and mass-normalised shapes of the named modes, in the order of the names.

    apart: distance of each from the nearest other mode, over its frequency.
    """

    frequency: Float[ndarray, " mode"]
    shape: Float[ndarray, "dof mode"]
    apart: Float[ndarray, " mode"]


@dataclass(frozen=True)
class Joint:
    """Bodies and contact: K + load Kg + sum over interfaces of kn Kn + kt Kt, and M.

    stiffness N/m, mass kg, geometric: change of stiffness per unit of load, or None. gap, slip: by
    interface, the rows whose squares are Kn and Kt of 1 N/m (eq. 5.3, by area). modes: by name, the
    order among the elastic modes (from 1) or the shape (a vector over all rows) it is known by.
    """

    mass: sp.csr_array
    stiffness: sp.csr_array
    geometric: sp.csr_array | None
    gap: Mapping[str, sp.csr_array]
    slip: Mapping[str, sp.csr_array]
    modes: Mapping[str, int | Float[ndarray, " dof"]]

    @classmethod
    def from_matrices(
        cls,
        K,
        M,
        pairs: ContactPairs,
        modes: Mapping[str, int | Float[ndarray, " dof"]],
        Kg=None,
    ) -> "Joint":
        """A joint of any bodies, free or held, from matrices without its contact springs.

        Args:
            K, M: stiffness (N/m) and mass (kg), dense or sparse, of the same rows; rotations may be
                without mass.
            pairs: where bodies touch.
            modes: what the measured modes are called, and by what each is known: its order among
                the elastic modes, or its shape.
            Kg: change of K per unit of load, in the units of K over those of the load.

        Raises:
            ValueError: sizes, symmetry or rows that do not fit, an interface without pairs, M and K
                exchanged.

        >>> import numpy as np, bladeroot as br
        >>> K = np.diag([3.0e6, 3.3e6, 3.6e6] * 2)  # two masses, each held to the ground
        >>> one, other = np.array([[0, 1, 2]]), np.array([[3, 4, 5]])  # x, y, z of each
        >>> pairs = br.ContactPairs(one, other, np.array([[1.0, 0.0, 0.0]]), np.ones(1))
        >>> apart = np.eye(3, 6) - np.eye(3, 6, 3)
        >>> br.Joint.from_matrices(K, 2.0 * np.eye(6), pairs, {"n": apart[0], "t": apart[1]})
        joint of 6 dofs: kn, kt; modes n, t
        """
        mass, stiffness = _square("M", M), _square("K", K)
        geometric = None if Kg is None else _square("Kg", Kg)
        for name, matrix in (("M", mass), ("Kg", geometric)):
            if matrix is not None and matrix.shape != stiffness.shape:
                raise ValueError(
                    f"expected {name} with {stiffness.shape[0]} rows as K, got {matrix.shape[0]}"
                )
        _refuse_exchanged(stiffness, mass)
        _check_modes(modes, stiffness.shape[0])
        gap, slip = _contact_rows(pairs, stiffness.shape[0])
        return cls(mass, stiffness, geometric, gap, slip, dict(modes))

    @classmethod
    def dovetail(cls, geometry: str | Path, modes: Sequence[str] = ("1B", "2B")) -> "Joint":
        """The built-in dovetail of a structure file, reduced (4.3 to 4.12); load: axial force, N.

        geometry: the name of a shipped one, such as `dovetail-HB`, or a YAML file as those of
        resources/structures/. Takes some ten seconds. modes: by the names that parity gives them.
        Raises ValueError for what is wrong in the file.
        """
        from bladeroot.rom.joint import joint_of_reduced
        from bladeroot.rom.whole import reduced_structure

        named = isinstance(geometry, str) and is_id(geometry)
        path = structure_file(geometry) if named else geometry
        return _of_operator(joint_of_reduced(reduced_structure(path)), modes)

    @property
    def interfaces(self) -> tuple[str, ...]:
        """Names of the interfaces."""
        return tuple(self.gap)

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of the contact stiffnesses: kn and kt of each interface."""
        return tuple(f"{k} {name}".strip() for name in self.interfaces for k in ("kn", "kt"))

    def modes_at(
        self, ln_k: Float[ndarray, " parameter"], load: float = 0.0, names: Sequence[str] = ()
    ) -> NamedModes:
        """The named modes (all without names) at contact stiffnesses exp(ln_k) N/m and a load.

        Raises:
            ValueError: a load that is no number, one of a joint that no load stiffens, not a finite
                ln k for each parameter, an unknown mode, the joint is not stable there, or a mode
                is not found: no shape among the lowest agrees with its own to a MAC of LEAST_MAC.
        """
        load = load_number(load)
        if load and self.geometric is None:
            raise ValueError(f"a load of {load:g} needs the joint's geometric stiffness Kg")
        names, ln_k = tuple(names) or tuple(self.modes), np.atleast_1d(np.asarray(ln_k, float))
        if unknown := [name for name in names if name not in self.modes]:
            raise ValueError(f"modes must be among {', '.join(self.modes)}, got {unknown}")
        if ln_k.shape != (len(self.parameters),) or not (np.abs(ln_k) < _MOST_LN_K).all():
            raise ValueError(
                f"ln_k must be ln of N/m for {', '.join(self.parameters)}, got {ln_k.tolist()}"
            )
        orders = [self.modes[n] for n in names if not isinstance(self.modes[n], ndarray)]
        count = max([len(self.modes), *orders]) + EXTRA_MODES
        values, shapes = self._elastic(ln_k, load, count)
        chosen = [self._column(name, shapes, values.size) for name in names]
        every = np.sqrt(values) / (2.0 * np.pi)
        away = np.abs(every[chosen, None] - every) / every[chosen, None]
        away[np.arange(len(chosen)), chosen] = np.inf
        return NamedModes(every[chosen], shapes[:, chosen], away.min(axis=1))

    def gradient(
        self, ln_k: Float[ndarray, " parameter"], at: NamedModes
    ) -> Float[ndarray, "mode parameter"]:
        """Slope of ln f by ln k, exact: the contact's share of twice the energy (5.16, in log k).

        A share k phi' Kc phi / omega^2 is what contact carries; half of it is d ln f / d ln k.
        """
        omega2 = (2.0 * np.pi * at.frequency) ** 2
        share = np.array([((row @ at.shape) ** 2).sum(axis=0) for row in self._rows])
        return 0.5 * (np.exp(ln_k)[:, None] * share / omega2).T

    @cached_property
    def _rigid(self) -> Float[ndarray, "dof motion"]:
        """Rigid motions of free bodies, of unit modal mass.

        Neither load nor contact stiffness changes them: where they are sought contact is about as
        stiff as the bodies.
        """
        contact = sp.csr_array(sum(row.T @ row for row in self._rows))
        k = abs(self.stiffness).max() / abs(contact).max()
        values, shapes = self._lowest(self.stiffness + (k or 1.0) * contact, _RIGID_SEARCHED)
        return shapes[:, values < _RIGID_PART * values[-1]]

    @property
    def _rows(self) -> list[sp.csr_array]:
        """Gaps and slips in the order of the parameters."""
        return [rows for name in self.interfaces for rows in (self.gap[name], self.slip[name])]

    def _lowest(self, whole: sp.csr_array, count: int) -> tuple[ndarray, ndarray]:
        """Lowest modes of a stiffness; a shift keeps the factor away from rigid motions."""
        weight = self.mass.diagonal()
        scale = float(np.min(whole.diagonal()[weight > 0.0] / weight[weight > 0.0]))
        count = min(count, whole.shape[0])
        return lowest_eigenpairs(sp.csr_array(whole), self.mass, count, shift=-_SHIFT * scale)

    def _elastic(self, ln_k, load, count) -> tuple[ndarray, ndarray]:
        """Lowest elastic modes: omega^2 and shapes; rigid motions of free bodies are left out.

        A load may stiffen these as if they were elastic, or soften: they are known by their shapes.
        """
        whole = self.stiffness if self.geometric is None else self.stiffness + load * self.geometric
        for k, row in zip(np.exp(ln_k), self._rows, strict=True):
            whole = whole + k * (row.T @ row)
        values, shapes = self._lowest(whole, count + self._rigid.shape[1])
        elastic = ((self._rigid.T @ (self.mass @ shapes)) ** 2).sum(axis=0) < 0.5
        if (values[elastic] <= 0.0).any():
            raise ValueError(f"the joint must be stable, but is not at a load of {load:g}")
        return values[elastic], shapes[:, elastic]

    def _column(self, name: str, shapes: ndarray, count: int) -> int:
        known = self.modes[name]
        if not isinstance(known, ndarray):
            if known > count:
                raise ValueError(
                    f"mode {name} is number {known}, the model has {count} elastic modes"
                )
            return known - 1
        weighted = self.mass @ known
        mac = (weighted @ shapes) ** 2 / (known @ weighted)
        if mac.max() < LEAST_MAC:
            raise ValueError(
                f"no mode agrees with the shape of {name}: largest MAC {mac.max():.2f}, expected "
                f"{LEAST_MAC:g}"
            )
        return int(np.argmax(mac))

    def __repr__(self) -> str:
        """A short table."""
        named = ", ".join(self.modes)
        return (
            f"joint of {self.stiffness.shape[0]} dofs: {', '.join(self.parameters)}; modes {named}"
        )


def _square(name: str, matrix) -> sp.csr_array:
    """A symmetric matrix of finite numbers, sparse."""
    if matrix is None:
        raise ValueError(f"{name} must be a matrix, got None")
    if np.iscomplexobj(matrix.data if sp.issparse(matrix) else np.asarray(matrix)):
        raise ValueError(f"{name} must be real")
    made = sp.csr_array(matrix, dtype=float)
    if made.ndim != 2 or made.shape[0] != made.shape[1]:
        raise ValueError(f"{name} must be square, got shape {made.shape}")
    if not np.isfinite(made.data).all():
        raise ValueError(f"{name} must hold finite numbers")
    off = abs(made - made.T).max()
    if off > _ASYMMETRY * abs(made).max():
        raise ValueError(f"{name} must be symmetric, got differences up to {off:.3g}")
    return sp.csr_array(0.5 * (made + made.T))


def load_number(load: object) -> float:
    """A load that a caller gives. ValueError: it is no finite number."""
    try:
        value = np.nan if isinstance(load, str) else float(load)
    except (TypeError, ValueError):
        value = np.nan
    if not np.isfinite(value):
        raise ValueError(f"load must be a number, in the joint's unit of load, got {load!r}")
    return value


def _refuse_exchanged(stiffness: sp.csr_array, mass: sp.csr_array) -> None:
    held, weight = stiffness.diagonal(), mass.diagonal()
    moving = weight > 0.0
    if (weight < 0.0).any() or not moving.any():
        raise ValueError(f"M must have masses on its diagonal, got from {weight.min():.3g} kg")
    highest = float(np.max(held[moving] / weight[moving]))
    if 0.0 < highest < _LEAST_OMEGA2:
        raise ValueError(
            f"expected K in N/m and M in kg, got no dof faster than {highest:.2g} rad^2/s^2 by "
            "itself: mass and stiffness exchanged, or units"
        )


def _check_modes(modes: Mapping[str, object], rows: int) -> None:
    if not isinstance(modes, Mapping):
        raise ValueError(
            "modes must be a mapping of each mode's name to its order or shape, got a "
            f"{type(modes).__name__}"
        )
    if not modes:
        raise ValueError("modes must name at least one mode")
    for name, known in modes.items():
        if isinstance(known, ndarray):
            if known.shape != (rows,) or not np.isfinite(known).all() or not known.any():
                raise ValueError(f"the shape of mode {name} must be {rows} finite numbers")
        elif isinstance(known, bool) or not isinstance(known, int | np.integer) or known < 1:
            raise ValueError(f"mode {name} must have an order from 1 or a shape, got {known!r}")


def _contact_rows(pairs: ContactPairs, size: int) -> tuple[dict, dict]:
    """Rows of gaps and slips by interface, each pair's times the root of its share of the area."""
    if not isinstance(pairs, ContactPairs):
        raise ValueError(f"pairs must be ContactPairs, got a {type(pairs).__name__}")
    first, second = np.asarray(pairs.first), np.asarray(pairs.second)
    normal, area = np.asarray(pairs.normal, float), np.asarray(pairs.area, float)
    count = len(area)
    if count == 0:
        raise ValueError("pairs must hold at least one pair")
    for name, part in (("first", first), ("second", second), ("normal", normal)):
        if part.shape != (count, 3):
            raise ValueError(f"pairs.{name} must have shape ({count}, 3), got {part.shape}")
    if not (np.isfinite(area).all() and (area > 0.0).all()):
        raise ValueError("pairs.area must be positive")
    if max(first.max(), second.max()) >= size or min(first.min(), second.min()) < -1:
        raise ValueError(f"pairs must name rows from 0 to {size - 1}, or -1 where fixed")
    if ((first == second) & (first >= 0)).any():
        raise ValueError("pairs must join two nodes, got rows that are paired with themselves")
    both = np.hstack([first, second])
    if len(np.unique(both, axis=0)) < count:
        raise ValueError("pairs must name each pair of nodes once")
    length = np.linalg.norm(normal, axis=1)
    if not (np.isfinite(length).all() and (length > 0.0).all()):
        raise ValueError("pairs.normal must not vanish")
    of = np.array(pairs.interface or [""] * count)
    if of.shape != (count,):
        raise ValueError(f"pairs.interface must name {count} interfaces, got {of.size}")
    frame = frames(normal)
    gap, slip = {}, {}
    for name in pairs.interfaces:
        mine = np.flatnonzero(of == name)
        scaled = np.sqrt(area[mine] / area[mine].sum())[:, None, None] * frame[mine]
        gap[name] = gaps_along(scaled[:, :1], first[mine], second[mine], size)
        slip[name] = gaps_along(scaled[:, 1:], first[mine], second[mine], size)
    return gap, slip


def _of_operator(operator, names: Sequence[str]) -> Joint:
    """A Joint of a reduced dovetail, whose modes are known by their shapes at one point."""
    from bladeroot.rom.joint import exact_modes

    middle = np.array([*np.log([_NAMING_STIFFNESS] * 2), _NAMING_FORCE])
    shapes = exact_modes(operator, middle, names).shapes
    return Joint(
        sp.csr_array(operator.mass),
        sp.csr_array(operator.stiffness),
        sp.csr_array(operator.geometric),
        {"": sp.csr_array(operator.gap)},
        {"": sp.csr_array(operator.slip)},
        {name: shapes[:, m].copy() for m, name in enumerate(names)},
    )
