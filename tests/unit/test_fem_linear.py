"""A matrix that must not be singular and is."""

import numpy as np
import pytest
import scipy.sparse as sp
from bladeroot.fem import elasticity
from bladeroot.fem.linear import factor, lowest_eigenpairs
from bladeroot.fem.mesh import beam_mesh
from structure_coarse import coarse_structure


@pytest.fixture(scope="module")
def free():
    structure = coarse_structure()
    mesh = beam_mesh(structure, with_pad=False)
    rule = elasticity.quadrature(mesh)
    stiffness = elasticity.stiffness(mesh, rule, [structure.material])
    return stiffness, elasticity.per_axis(elasticity.mass(mesh, rule, [structure.material]))


def test_a_free_body_has_no_static_solution(free):
    with pytest.raises(
        ValueError, match=r"expected a stiffness that holds all .* dofs, got a sing"
    ):
        factor(free[0])


def test_modes_of_a_free_body_need_a_shift(free):
    with pytest.raises(ValueError, match=r"a part moves freely or has no stiffness$"):
        lowest_eigenpairs(*free, 4)


def test_a_dof_without_stiffness_is_named():
    matrix = sp.diags_array(np.where(np.arange(50) == 7, 0.0, 3.0), format="csr")
    with pytest.raises(ValueError, match="dof 7 has none on the diagonal"):
        factor(matrix)


def test_units_and_stiff_springs_do_not_make_a_matrix_singular():
    """A chain held at one end, one link 1e8 times as stiff, rows in units 1e6 apart."""
    links = np.where(np.arange(30) == 12, 1e8, 1.0)
    strain = sp.eye_array(30) - sp.eye_array(30, k=-1)
    units = sp.diags_array(np.where(np.arange(30) % 3, 1e6, 1.0))
    chain = sp.csr_array(units @ (strain.T @ sp.diags_array(links) @ strain) @ units)
    right = np.random.default_rng(0).standard_normal(30)
    moves = factor(chain)(units @ right)
    np.testing.assert_allclose(units @ moves, np.cumsum(np.cumsum(right[::-1])[::-1] / links))


def test_a_soft_support_does_not_spoil_the_modes():
    """All columns of the inverse are nearly the one motion on the support, a chain's as a whole."""
    size = 300
    links = np.diff(np.eye(size), axis=0)
    stiffness = sp.csr_array(links.T @ links + 1e-12 * np.eye(size))
    values, shapes = lowest_eigenpairs(stiffness, sp.eye_array(size, format="csr"), 5)
    exact = 4.0 * np.sin(0.5 * np.pi * np.arange(5) / size) ** 2 + 1e-12
    np.testing.assert_allclose(values[1:], exact[1:], rtol=1e-6)
    np.testing.assert_allclose(shapes.T @ shapes, np.eye(5), atol=1e-10)


def test_dofs_without_mass_follow_the_others():
    """A held chain, every second point without mass: there it lies between its neighbours."""
    size = 300
    links = np.eye(size) - np.eye(size, k=-1)
    light = np.arange(size) % 2 == 0
    mass = sp.diags_array(np.where(light, 0.0, 1.0), format="csr")
    values, shapes = lowest_eigenpairs(sp.csr_array(links.T @ links), mass, 4)
    half = np.eye(size // 2) - np.eye(size // 2, k=-1)
    np.testing.assert_allclose(values, np.linalg.eigvalsh(0.5 * half.T @ half)[:4], rtol=1e-9)
    between = 0.5 * (shapes[1:-1:2] + shapes[3::2])
    np.testing.assert_allclose(shapes[2::2], between, atol=1e-7)
