import numpy as np
import pytest
import scipy.sparse as sp
from bladeroot.fem import elasticity
from bladeroot.fem.follower import load_stiffness, symmetric
from bladeroot.fem.mesh import build_mesh
from bladeroot.fem.prestress import flank_loads, prestress
from bladeroot.rom.beam_modes import eigenvalue, full_modes
from bladeroot.rom.reduction import beam_basis, beam_model, force_stiffness, project_force
from structure_coarse import coarse_structure


@pytest.fixture(scope="module")
def loaded():
    structure = coarse_structure(load="follower")
    mesh = build_mesh(structure, with_pad=True)
    return structure, mesh, beam_model(structure, mesh, prestress(structure, mesh))


def test_is_the_derivative_of_the_pressure_s_force(loaded):
    """Against the force on displaced flanks, by central differences (it is quadratic)."""
    _, mesh, model = loaded
    move = np.random.default_rng(1).standard_normal(model.mesh.nodes.shape) * 1e-4

    def force(factor):
        moved = mesh.assign(node_position=mesh.node_position.copy())
        moved.node_position.values[: len(move)] += factor * move
        return _pressure_force(moved, mesh)

    np.testing.assert_allclose(force(0.0), flank_loads(mesh), atol=1e-13)
    found = load_stiffness(mesh) @ move.ravel()
    np.testing.assert_allclose(found, (force(-1.0) - force(1.0)).ravel() / 2, atol=1e-12)
    assert abs(found).max() > 1e-4


def _pressure_force(moved, mesh):
    """Force per newton on the flanks of a moved mesh, face by face, point by point."""
    x, w = np.polynomial.legendre.leggauss(4)
    total = np.zeros((int((mesh.node_body == 0).sum()), 3))
    for flank, frame in enumerate(mesh.flank_frame.values):
        chosen = mesh.pair_flank.values == flank
        grid = mesh.pair_node.values[chosen, 0].reshape(3, -1)
        pressure = 1 / (2 * abs(frame[0, 0]) * mesh.pair_weight.values[chosen].sum())
        for start in range(0, grid.shape[1] - 2, 2):
            face = grid[:, start : start + 3]
            position = moved.node_position.values[face]
            for s, ws in zip(x, w, strict=True):
                for t, wt in zip(x, w, strict=True):
                    a, da = _quadratic(s)
                    b, db = _quadratic(t)
                    normal = np.cross(
                        np.einsum("i,j,ijk->k", da, b, position),
                        np.einsum("i,j,ijk->k", a, db, position),
                    )
                    normal *= np.sign(normal @ frame[0])
                    total[face] -= pressure * ws * wt * np.multiply.outer(np.outer(a, b), normal)
    return total


def _quadratic(s):
    return np.array([s * (s - 1) / 2, 1 - s * s, s * (s + 1) / 2]), np.array(
        [s - 0.5, -2 * s, s + 0.5]
    )


def test_a_pressure_turns_with_the_body(loaded):
    """Rigid motions cost nothing: load and geometric stiffness cancel, before symmetrisation."""
    _, mesh, model = loaded
    rigid = elasticity.rigid_modes(model.mesh.nodes)
    dead = elasticity.per_axis(model.geometric) @ rigid
    assert abs(dead).max() > 0.1
    assert abs(dead + load_stiffness(mesh) @ rigid).max() < 1e-11


def test_table_4_2_s_rotations_need_a_dead_load(loaded):
    _, _, model = loaded
    rigid = elasticity.rigid_modes(model.mesh.nodes)[:, 4:]
    dead = np.einsum("di,di->i", rigid, elasticity.per_axis(model.geometric) @ rigid)
    follower = np.einsum("di,di->i", rigid, force_stiffness(model) @ rigid)
    assert dead.min() > 0.25
    assert abs(follower).max() < 1e-12


def test_remainder_lives_on_the_flanks_edges(loaded):
    """Nodes inside a flank have a symmetric load stiffness among themselves."""
    _, mesh, _ = loaded
    whole = load_stiffness(mesh)
    remainder = whole - symmetric(whole)
    edges = np.zeros(whole.shape[0] // 3, dtype=bool)
    for flank in range(4):
        grid = mesh.pair_node.values[mesh.pair_flank.values == flank, 0].reshape(3, -1)
        edges[[*grid[0], *grid[-1], *grid[:, 0], *grid[:, -1]]] = True
    inside = np.repeat(~edges, 3)
    assert abs(remainder).max() > 0.1 * abs(whole).max()
    assert abs(remainder[inside]).max() < 1e-12


def test_reduced_as_the_whole(loaded):
    structure, mesh, model = loaded
    basis = beam_basis(model, mesh, structure.beam_modes)
    expected = basis.columns.T @ (force_stiffness(model) @ basis.columns)
    np.testing.assert_allclose(project_force(model, basis), expected, atol=1e-9)


def test_follower_load_stiffens_bending_less(loaded):
    _, _, model = loaded
    both = full_modes(model, 24e3)
    dead = full_modes(type(model)(model.mesh, model.stiffness, model.mass, model.geometric), 24e3)
    for mode in ("1Fy", "2Fy"):
        assert eigenvalue(both, mode, "follower") < 0.99 * eigenvalue(dead, mode, "dead")


def test_a_mode_that_is_not_there_is_named():
    with pytest.raises(ValueError, match=r"free beam: mode 9T not found, only 1Fy, 2Fy$"):
        eigenvalue((np.array([1.0, 2.0]), ["1Fy", "2Fy"]), "9T", "free beam")


def test_symmetric_part():
    matrix = sp.csr_array([[1.0, 2.0], [0.0, 1.0]])
    np.testing.assert_array_equal(symmetric(matrix).toarray(), [[1, 1], [1, 1]])
