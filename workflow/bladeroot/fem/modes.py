"""Names of a beam's modes by reflection parity, never by order.

A mode of a beam that is symmetric in X, Y and Z is even or odd in each; the three signs tell
bending in Z ("Fy": about Y), bending in Y ("Fz"), torsion ("T") and axial motion ("A") apart, and
odd from even orders. Rigid modes are X, Y, Z, Rx, Ry, Rz, as in the thesis's Table 4.2.
"""

from functools import lru_cache

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray

from bladeroot.fem.elasticity import rigid_modes

# Signs under reflection in X, Y, Z of each rigid motion.
_RIGID = {
    (-1, 1, 1): "X",
    (1, -1, 1): "Y",
    (1, 1, -1): "Z",
    (1, -1, -1): "Rx",
    (-1, 1, -1): "Ry",
    (-1, -1, 1): "Rz",
}
# Signs under reflection in Y and Z of each family, and the X sign of its first elastic mode
# when the beam is free: torsion starts odd, axial motion even.
_FAMILY = {(1, -1): ("Fy", 1), (-1, 1): ("Fz", 1), (-1, -1): ("T", -1), (1, 1): ("A", 1)}


def mirror_nodes(nodes: Float[ndarray, "node axis"], axis: int) -> Int[ndarray, " node"]:
    """Index of each node's mirror image in the plane normal to `axis`, -1 where there is none."""
    step = np.pi * 1.0e-7
    turn = np.where(np.arange(nodes.shape[1]) == axis, -1.0, 1.0)
    here = np.round(nodes / step).astype(np.int64)
    there = np.round(nodes * turn / step).astype(np.int64)
    index = {tuple(key): k for k, key in enumerate(here)}
    return np.array([index.get(tuple(key), -1) for key in there])


def parities(
    nodes: Float[ndarray, "node 3"],
    weights: Float[ndarray, " node"],
    shapes: Float[ndarray, "dof m"],
) -> Float[ndarray, "m 3"]:
    """Correlation of each shape with its reflections in X, Y, Z: +1 even, -1 odd.

    `weights` are nodal masses (kg). Only nodes that have all their mirror images count, so that a
    pad on one face does not blur the beam's own symmetry.
    """
    mirrors, whole = _mirrors(nodes)
    moves = shapes.reshape(len(nodes), 3, -1)
    size = np.einsum("n,nam->m", weights[whole], moves[whole] ** 2)
    result = np.empty((moves.shape[2], 3))
    for axis in range(3):
        sign = np.where(np.arange(3) == axis, -1.0, 1.0)
        image = moves[mirrors[axis][whole]] * sign[:, None]
        product = np.einsum("n,nam,nam->m", weights[whole], moves[whole], image, optimize=True)
        result[:, axis] = product / size
    return result


def _mirrors(
    nodes: Float[ndarray, "node 3"],
) -> tuple[list[Int[ndarray, " node"]], Int[ndarray, " whole"]]:
    return _mirrors_of(np.ascontiguousarray(nodes, float).tobytes())


@lru_cache(maxsize=2)  # many sets of modes of one mesh are named one after the other
def _mirrors_of(
    raw: bytes,
) -> tuple[list[Int[ndarray, " node"]], Int[ndarray, " whole"]]:
    nodes = np.frombuffer(raw).reshape(-1, 3)
    mirrors = [mirror_nodes(nodes, axis) for axis in range(3)]
    whole = np.flatnonzero(np.all([m >= 0 for m in mirrors], axis=0))
    return mirrors, whole


def separate_equal_modes(
    nodes: Float[ndarray, "node 3"],
    weights: Float[ndarray, " node"],
    values: Float[ndarray, " m"],
    shapes: Float[ndarray, "dof m"],
) -> Float[ndarray, "dof m"]:
    """Rotate modes of equal frequency among themselves until each has pure parity.

    An eigensolver returns any basis of such modes: of the rigid motions at zero force, which this
    turns into X, Y, Z, Rx, Ry, Rz, and of the two bendings of a square section. Equal means closer
    than 1e-6 of the eigenvalue, or below 1e-8 of the largest one given.
    """
    mirrors, whole = _mirrors(nodes)
    order = np.argsort(values)
    sorted_values = values[order]
    near = np.maximum(1e-6 * abs(sorted_values[1:]), 1e-8 * abs(values).max())
    groups = np.split(order, np.flatnonzero(np.diff(sorted_values) > near) + 1)
    shapes = shapes.copy()
    for group in groups:
        if len(group) > 1:
            moves = shapes[:, group].reshape(len(nodes), 3, -1)
            shapes[:, group] = shapes[:, group] @ _pure(moves, weights, mirrors, whole)
    return shapes


def _pure(
    moves: Float[ndarray, "node 3 k"],
    weights: Float[ndarray, " node"],
    mirrors: list[Int[ndarray, " node"]],
    whole: Int[ndarray, " whole"],
) -> Float[ndarray, "k k"]:
    """The combinations of shapes that are even or odd in X, Y and Z."""
    count = moves.shape[2]
    inner = moves[whole].reshape(-1, count) * np.repeat(weights[whole], 3)[:, None]
    mass = inner.T @ moves[whole].reshape(-1, count)
    # Weights 1, 2, 4 give each of the eight parity classes its own eigenvalue.
    mixed = np.zeros_like(mass)
    for axis in range(3):
        sign = np.where(np.arange(3) == axis, -1.0, 1.0)
        image = (moves[mirrors[axis][whole]] * sign[:, None]).reshape(-1, count)
        mixed += 2.0**axis * (inner.T @ image)
    root = np.linalg.cholesky(mass)
    turned = np.linalg.solve(root, np.linalg.solve(root, (mixed + mixed.T) / 2).T)
    _, rotation = np.linalg.eigh(turned)
    return np.linalg.solve(root.T, rotation)


def name_modes(
    nodes: Float[ndarray, "node 3"],
    weights: Float[ndarray, " node"],
    values: Float[ndarray, " m"],
    shapes: Float[ndarray, "dof m"],
) -> list[str]:
    """Names of modes given in order of eigenvalue (rad^2/s^2): X, Ry, 1Fy, 2Fz, 1T, ...

    The order within a family follows from the parity in X: 1Fy, 3Fy are even, 2Fy odd. The lowest
    mode of each family must be among those given. A free or a clamped beam may be named; without
    rigid modes torsion starts even and axial motion odd. A shape with no clear parity is "?"; if it
    is elastic, so is every later one of a family that it might be: its number is not known.
    """
    shapes = separate_equal_modes(nodes, weights, values, shapes)
    signs = parities(nodes, weights, shapes)
    # A clamped beam's first bending mode is 0.7 rigid, a stiffened rigid rotation above 0.99.
    rigid = rigid_fraction(nodes, weights, shapes) > 0.9
    free = bool(rigid.any())
    seen: dict[tuple[str, int], int] = {}
    unclear: list[tuple[int, ...]] = []
    names = []
    for sign, is_rigid in zip(signs, rigid, strict=True):
        key = tuple(int(s) for s in np.where(abs(sign) > 0.5, np.sign(sign), 0))
        hidden = any(all(a in (0, b) for a, b in zip(one, key, strict=True)) for one in unclear)
        if 0 in key or (hidden and not is_rigid) or (is_rigid and key not in _RIGID):
            names.append("?")
            if not is_rigid:
                unclear.append(key)
        elif is_rigid:
            names.append(_RIGID[key])
        else:
            family, first = _FAMILY[key[1:]]
            if not free and family in ("T", "A"):
                first = -first
            count = seen.get((family, key[0]), 0)
            seen[family, key[0]] = count + 1
            names.append(f"{2 * count + (1 if key[0] == first else 2)}{family}")
    return names


def rigid_fraction(
    nodes: Float[ndarray, "node 3"],
    weights: Float[ndarray, " node"],
    shapes: Float[ndarray, "dof m"],
) -> Float[ndarray, " m"]:
    """Share of each shape's kinetic energy that a rigid motion explains, 0..1."""
    root = np.repeat(np.sqrt(weights), 3)[:, None]
    basis, _ = np.linalg.qr(rigid_modes(nodes) * root)
    scaled = shapes * root
    return ((basis.T @ scaled) ** 2).sum(axis=0) / (scaled**2).sum(axis=0)
