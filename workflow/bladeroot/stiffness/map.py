"""The map from contact stiffness to the two bending frequencies of one assembly (section 5.2.1).

A full eigenvalue problem a point would be slow, and sorting modes by number would swap them. So
the shapes of one mode, picked by parity at a few dozen points of the box, make a basis of their
own; in it the mode is always the lowest, and its frequency, being stationary, is wrong only by the
square of what the basis misses. The map knows nothing of measurements.
"""

from dataclasses import dataclass

import numpy as np
import scipy.linalg
import xarray as xr
from jaxtyping import Float
from numpy import ndarray
from scipy.sparse.linalg import LinearOperator, eigsh

from bladeroot.structure.assembly import contact_matrices, find_bending

MODES = ("1B", "2B")
BOX = (1e8, 1e12)  # N/m, flank totals; the thesis searched 3.3e8 to 5e9
GRID = 60
_SHIFT = (2.0 * np.pi * 5.0) ** 2  # keeps a body that nothing holds solvable


@dataclass(frozen=True)
class Basis:
    """Projected matrices of one mode; the projected mass is the identity.

    stiffness: without contact, 1/s^2; normal, tangential: for one N/m of flank stiffness, 1/kg.
    """

    stiffness: Float[ndarray, "vector vector"]
    normal: Float[ndarray, "vector vector"]
    tangential: Float[ndarray, "vector vector"]


def frequency_map(
    assembly: xr.Dataset,
    box: tuple[float, float] = BOX,
    samples: int = 6,
    grid: int = GRID,
    equal_nodes: bool = False,
) -> xr.Dataset:
    """Frequencies of 1B and 2B over a box of flank stiffness, and the basis that gives them.

    assembly: dims dof, as `bladeroot.structure.assembly` makes it. box: smallest and largest kn
    and kt, N/m. samples: exact solutions along each axis of the box, from which the basis is
    drawn (half of them, as on a chessboard). grid: points of the drawn map along each axis.
    equal_nodes: the same spring at every node, as in the thesis, instead of by area.

    The result holds the basis (`basis_stiffness`, `basis_normal`, `basis_tangential`), the map
    on a grid, the frequencies of bonded contact (both stiffnesses infinite), and a check of the
    basis against exact solutions at points it has not seen (`check_error`).
    Raises ValueError if the box is empty, the samples are too few, a mode cannot be named, or its
    frequency falls with rising stiffness, which means that another mode was taken for it.
    """
    if not 0.0 < box[0] < box[1]:
        raise ValueError(f"the box of stiffness must be 0 < low < high N/m, got {box}")
    if samples < 4:
        raise ValueError(f"a basis that can check itself needs at least 4 samples, got {samples}")
    normal, tangential = contact_matrices(assembly, equal_nodes)
    exact = _Exact(assembly, normal, tangential)
    log_box = np.log(box)
    place = 0.5 * (1.0 - np.cos(np.pi * np.arange(samples) / (samples - 1)))
    nodes = log_box[0] + (log_box[1] - log_box[0]) * place
    # every other point of the square, as on a chessboard, spans the shapes as well as all of it
    points = np.array([(p, q) for i, p in enumerate(nodes) for q in nodes[i % 2 :: 2]])
    solved = [exact.at(*np.exp(point)) for point in points]
    _refuse_swaps(points, np.array([f for f, _ in solved]))
    bonded_frequency, bonded_shape = exact.bonded()
    mass = assembly["mass"].values
    bases = []
    for m in range(len(MODES)):
        shapes = np.column_stack([shape[:, m] for _, shape in solved] + [bonded_shape[:, m]])
        v = _orthonormal(shapes, mass)
        parts = (assembly["stiffness"].values, normal, tangential)
        bases.append(Basis(*(_symmetric(v.T @ part @ v) for part in parts)))
    axis = np.linspace(*log_box, grid)
    mesh = np.stack(np.meshgrid(axis, axis, indexing="ij"), axis=-1).reshape(-1, 2)
    drawn = np.stack([frequencies(basis, mesh)[0] for basis in bases])
    unseen = _unseen_points(nodes)
    truth = np.array([exact.at(*np.exp(point))[0] for point in unseen]).T
    guess = np.stack([frequencies(basis, unseen)[0] for basis in bases])
    return _as_dataset(
        bases, axis, drawn.reshape(-1, grid, grid), bonded_frequency, unseen, truth, guess
    ).assign_attrs(
        axial_force=assembly.attrs["axial_force"],
        structure=assembly.attrs["structure"],
        springs="equal at every node" if equal_nodes else "by area",
        exact_solutions=len(points) + len(unseen) + 1,
    )


def bases_of(dataset: xr.Dataset) -> list[Basis]:
    """The projected matrices of a map, one entry a mode in the order of `mode`."""
    names = ("basis_stiffness", "basis_normal", "basis_tangential")
    return [
        Basis(*(dataset[name].values[m] for name in names)) for m in range(dataset.sizes["mode"])
    ]


def frequencies(
    basis: Basis, log_stiffness: Float[ndarray, "point 2"]
) -> tuple[Float[ndarray, " point"], Float[ndarray, "point 2"]]:
    """Frequency (Hz) of the basis's mode and its gradient by (ln kn, ln kt), at many points.

    df/d ln k = k phi^T (dK/dk) phi / (8 pi^2 f), phi of unit modal mass (section 5.3).
    """
    k = np.exp(log_stiffness)[:, :, None, None]
    matrix = basis.stiffness + k[:, 0] * basis.normal + k[:, 1] * basis.tangential
    values, shapes = np.linalg.eigh(matrix)
    phi = shapes[:, :, 0]
    f = np.sqrt(np.maximum(values[:, 0], 0.0)) / (2.0 * np.pi)
    work = [np.einsum("pi,ij,pj->p", phi, part, phi) for part in (basis.normal, basis.tangential)]
    gradient = np.exp(log_stiffness) * np.stack(work, axis=-1)
    return f, gradient / (8.0 * np.pi**2 * np.maximum(f, 1e-300)[:, None])


def all_frequencies(
    bases: list[Basis], log_stiffness: Float[ndarray, "point 2"]
) -> tuple[Float[ndarray, "point mode"], Float[ndarray, "point mode 2"]]:
    """Frequencies of every mode and their Jacobian by (ln kn, ln kt) (eq. 5.16, in log k)."""
    pairs = [frequencies(basis, log_stiffness) for basis in bases]
    return np.stack([f for f, _ in pairs], axis=1), np.stack([g for _, g in pairs], axis=1)


class _Exact:
    """Exact bending modes of the whole assembly, by shift and invert."""

    def __init__(self, assembly: xr.Dataset, normal: ndarray, tangential: ndarray):
        self.assembly, self.normal, self.tangential = assembly, normal, tangential
        self.mass, self.stiffness = assembly["mass"].values, assembly["stiffness"].values

    def at(self, kn: float, kt: float) -> tuple[ndarray, ndarray]:
        """Frequencies (mode), Hz, and shapes (dof, mode) of unit modal mass."""
        return self._solve(self.stiffness + kn * self.normal + kt * self.tangential, self.mass)

    def bonded(self) -> tuple[ndarray, ndarray]:
        """The same with both stiffnesses infinite: each slot node moves with the beam's."""
        size = len(self.mass)
        master = np.arange(size)
        master[self.assembly["slot_dof"].values] = self.assembly["beam_dof"].values
        kept, column = np.unique(master, return_inverse=True)
        join = np.zeros((size, len(kept)))
        join[np.arange(size), column] = 1.0
        return self._solve(join.T @ self.stiffness @ join, join.T @ self.mass @ join, join)

    def _solve(
        self, stiffness: ndarray, mass: ndarray, lift: ndarray | None = None
    ) -> tuple[ndarray, ndarray]:
        size = len(mass)
        factor = scipy.linalg.lu_factor(stiffness + _SHIFT * mass, check_finite=False)
        inverse = LinearOperator(
            (size, size), matvec=lambda b: scipy.linalg.lu_solve(factor, b, check_finite=False)
        )
        for count in (12, 40):
            if count < size - 1:
                values, shapes = eigsh(
                    stiffness,
                    k=count,
                    M=mass,
                    sigma=-_SHIFT,
                    OPinv=inverse,
                    v0=np.linspace(1.0, 2.0, size),  # the same digits at every run
                )
            else:
                values, shapes = scipy.linalg.eigh(stiffness, mass)
            order = np.argsort(values)
            whole = shapes[:, order] if lift is None else lift @ shapes[:, order]
            try:
                column = find_bending(self.assembly, whole)
                break
            except ValueError:
                if count == 40 or count >= size - 1:
                    raise
        chosen = [column[name] for name in MODES]
        return np.sqrt(values[order][chosen]) / (2.0 * np.pi), whole[:, chosen]


def _symmetric(matrix: ndarray) -> ndarray:
    return 0.5 * (matrix + matrix.T)


def _orthonormal(shapes: ndarray, mass: ndarray) -> ndarray:
    """Directions of unit modal mass that span the shapes, by Gram-Schmidt done twice.

    Their small differences matter: stiff contact multiplies them, so only rounding is left out.
    """
    basis = np.empty((len(shapes), 0))
    for shape in shapes.T:
        rest = shape / np.sqrt(shape @ mass @ shape)
        for _ in range(2):
            rest = rest - basis @ (basis.T @ (mass @ rest))
        size = np.sqrt(max(rest @ mass @ rest, 0.0))
        if size > 1e-10:
            rest = rest / size
            rest = rest - basis @ (basis.T @ (mass @ rest))
            basis = np.column_stack([basis, rest / np.sqrt(rest @ mass @ rest)])
    return basis


def _refuse_swaps(points: Float[ndarray, "point 2"], found: Float[ndarray, "point mode"]) -> None:
    """Stiffer contact never lowers a frequency (Rayleigh); if it seems to, modes were swapped."""
    stiffer = np.all(points[:, None, :] <= points[None, :, :], axis=-1)
    falls = stiffer[:, :, None] & (found[None] < found[:, None] * (1.0 - 1e-6))
    if falls.any():
        low, high, m = np.argwhere(falls)[0]
        ends = " to ".join("({:.3g}, {:.3g})".format(*np.exp(points[p])) for p in (low, high))
        raise ValueError(
            f"mode {MODES[m]} is not followed through the box: its frequency falls from (kn, kt) "
            f"= {ends} N/m; narrow the box"
        )


def _unseen_points(nodes: ndarray) -> Float[ndarray, "point 2"]:
    """Middles between sample nodes, spread over the box so that each row and column has one."""
    middle = 0.5 * (nodes[1:] + nodes[:-1])
    count = len(middle)
    pairs = [(i, (2 * i + shift) % count) for shift in (0, 1) for i in range(count)]
    return np.array([(middle[i], middle[j]) for i, j in pairs])


def _as_dataset(bases, axis, drawn, bonded, unseen, truth, guess) -> xr.Dataset:
    size = max(len(basis.stiffness) for basis in bases)
    square = ("mode", "vector", "vector_")

    def stacked(name: str) -> ndarray:
        blocks = [getattr(basis, name) for basis in bases]
        whole = np.zeros((len(blocks), size, size))
        for place, block in zip(whole, blocks, strict=True):
            place[: len(block), : len(block)] = block
            if name == "stiffness":  # a shorter basis is filled up with far-off, uncoupled modes
                spare = np.arange(len(block), size)
                place[spare, spare] = 1e3 * np.trace(block)
        return whole

    def var(dims, values, units: str, long_name: str, source: str = "") -> tuple:
        attrs = {"units": units, "long_name": long_name}
        return (dims, values, attrs | ({"source": source} if source else {}))

    k = np.exp(axis)
    return xr.Dataset(
        {
            "basis_stiffness": var(
                square, stacked("stiffness"), "s-2", "projected stiffness without contact"
            ),
            "basis_normal": var(
                square, stacked("normal"), "kg-1", "projected Kn of unit flank stiffness", "eq. 5.3"
            ),
            "basis_tangential": var(
                square,
                stacked("tangential"),
                "kg-1",
                "projected Kt of unit flank stiffness",
                "eq. 5.3",
            ),
            "map_frequency": var(
                ("mode", "map_kn", "map_kt"), drawn, "Hz", "frequency of the model", "eq. 5.4"
            ),
            "bonded_frequency": var(
                "mode", bonded, "Hz", "frequency with bonded contact (infinite kn and kt)"
            ),
            "check_kn": var("check", np.exp(unseen[:, 0]), "N/m", "normal stiffness of the check"),
            "check_kt": var(
                "check", np.exp(unseen[:, 1]), "N/m", "tangential stiffness of the check"
            ),
            "check_frequency": var(
                ("mode", "check"), truth, "Hz", "exact frequency at points not in the basis"
            ),
            "check_error": var(
                ("mode", "check"), guess / truth - 1.0, "1", "relative error of the map there"
            ),
        },
        coords={
            "mode": list(MODES),
            "map_kn": var("map_kn", k, "N/m", "normal stiffness of a flank"),
            "map_kt": var("map_kt", k, "N/m", "tangential stiffness of a flank"),
        },
        attrs={"largest_relative_error": float(np.abs(guess / truth - 1.0).max())},
    )
