"""Patches of constant strain, bars under constant stress, and rates of convergence."""

import itertools

import numpy as np
import pytest
import scipy.optimize
import scipy.sparse as sp
from bladeroot.fem import elasticity
from bladeroot.fem.geometry import Material, flank_ends
from bladeroot.fem.linear import factor, lowest_eigenpairs
from bladeroot.fem.mesh import Mesh, beam_mesh, block, extrude
from bladeroot.fem.outline import Edge
from bladeroot.fem.prestress import solve_free
from structure_coarse import coarse_structure

STEEL = Material(young=200e9, density=7800.0, poisson=0.3)


def box(counts, sizes):
    """Straight block from the origin along X and Z, about y = 0."""
    (nx, ny, nz), (length, width, height) = counts, sizes
    low, high = ((0.0, 0.0), (length, 0.0)), ((0.0, height), (length, height))
    return extrude([block(Edge(*low), Edge(*high), (nx, nz))], width, ny)


def distorted(scatter=0.15, seed=0):
    """3 x 3 x 3 elements whose corners are thrown about; edges stay straight."""
    mesh = box((3, 3, 3), (0.03, 0.03, 0.03))
    corners = np.unique(mesh.elements[:, [0, 2, 6, 8, 18, 20, 24, 26]])
    nodes = mesh.nodes.copy()
    nodes[corners] += 0.01 * np.random.default_rng(seed).uniform(
        -scatter, scatter, (len(corners), 3)
    )
    for k, (i, j, m) in enumerate(itertools.product((0, 1, 2), repeat=3)):
        ends = [[p] if p != 1 else [0, 2] for p in (i, j, m)]
        around = [9 * a + 3 * b + c for a, b, c in itertools.product(*ends)]
        nodes[mesh.elements[:, k]] = nodes[mesh.elements[:, around]].mean(axis=1)
    return Mesh(nodes, mesh.elements, mesh.part), mesh.nodes


def constant(mesh):
    """A displacement of constant gradient, and its stress."""
    slope = np.array([[1.0, 0.3, -0.2], [0.5, -0.7, 0.4], [0.1, 0.2, 0.6]]) * 1e-3
    strain = (slope + slope.T) / 2
    lam = STEEL.young * STEEL.poisson / ((1 + STEEL.poisson) * (1 - 2 * STEEL.poisson))
    stress = lam * np.trace(strain) * np.eye(3)
    stress += STEEL.young / (1 + STEEL.poisson) * strain
    return mesh.nodes @ slope.T, stress


def test_distorted_patch_finds_constant_strain():
    mesh, regular = distorted()
    rule = elasticity.quadrature(mesh)
    stiffness = elasticity.stiffness(mesh, rule, [STEEL])
    exact, stress = constant(mesh)
    outside = (
        np.isclose(regular, regular.min(axis=0)) | np.isclose(regular, regular.max(axis=0))
    ).any(axis=1)
    held = (3 * np.flatnonzero(outside)[:, None] + np.arange(3)).ravel()
    free = np.setdiff1d(np.arange(exact.size), held)
    moves = np.zeros(exact.size)
    moves[held] = exact.ravel()[held]
    rows = stiffness[free]
    moves[free] = factor(sp.csr_array(rows[:, free]))(-(rows[:, held] @ moves[held]))
    assert len(free) == 3 * 5**3
    assert abs(moves - exact.ravel()).max() < 1e-10 * abs(exact).max()
    found = elasticity.stress(mesh, rule, [STEEL], moves.reshape(-1, 3))
    assert abs(found - stress).max() < 1e-10 * abs(stress).max()


def test_distorted_patch_under_its_own_tractions_is_uniformly_stressed():
    """The same with loads instead of displacements: balanced, held at six dofs, freed again."""
    mesh, _ = distorted(seed=1)
    rule = elasticity.quadrature(mesh)
    stiffness = elasticity.stiffness(mesh, rule, [STEEL])
    exact, stress = constant(mesh)
    moves, reactions = solve_free(mesh, stiffness, (stiffness @ exact.ravel()).reshape(-1, 3))
    assert abs(reactions).max() < 1e-9 * abs(stiffness @ exact.ravel()).max()
    found = elasticity.stress(mesh, rule, [STEEL], moves)
    assert abs(found - stress).max() < 1e-10 * abs(stress).max()


def plane(mesh, held):
    """Plane strain: one motion along X and Z across the width; held (node, 2) says which not."""
    _, column = np.unique(np.round(mesh.nodes[:, [0, 2]], 9), axis=0, return_inverse=True)
    keep = np.ones((column.max() + 1, 2), dtype=bool)
    keep[column] &= ~held
    number = np.where(keep, np.cumsum(keep.ravel()).reshape(keep.shape) - 1, -1)
    tie = np.full((len(mesh.nodes), 3), -1)
    tie[:, [0, 2]] = number[column]
    rows = np.flatnonzero(tie.ravel() >= 0)
    return sp.csr_array(
        (np.ones(len(rows)), (rows, tie.ravel()[rows])), shape=(tie.size, keep.sum())
    )


LENGTH, HEIGHT = 0.2, 0.02


def supported(elements, poisson=0.3, pull=0.0):
    """Lowest eigenvalues of a strip in plane strain, its ends free along X and held along Z.

    pull: uniform axial stress (Pa). A plate wave of half-length LENGTH / n meets these ends, so the
    modes are those of an endless plate and smooth.
    """
    material = Material(200e9, 7800.0, poisson)
    mesh = box((elements, 1, max(1, elements // 8)), (LENGTH, 0.005, HEIGHT))
    rule = elasticity.quadrature(mesh)
    stiffness = elasticity.stiffness(mesh, rule, [material])
    mass = elasticity.per_axis(elasticity.mass(mesh, rule, [material]))
    stress = np.zeros((*rule.volumes.shape, 3, 3))
    stress[..., 0, 0] = pull
    stiffness = stiffness + elasticity.per_axis(elasticity.geometric_stiffness(mesh, rule, stress))
    ends = (mesh.nodes[:, 0] < 1e-9) | (mesh.nodes[:, 0] > LENGTH - 1e-9)
    held = np.zeros((len(mesh.nodes), 2), dtype=bool)
    held[ends, 1] = True
    spread = plane(mesh, held)
    values, _ = lowest_eigenpairs(
        sp.csr_array(spread.T @ stiffness @ spread), sp.csr_array(spread.T @ mass @ spread), 4, -1e7
    )
    return values


def plate_wave(n, poisson=0.3):
    """omega^2 of the lowest antisymmetric Rayleigh-Lamb wave of n half-lengths in LENGTH."""
    young, density = 200e9, 7800.0
    fast = young * (1 - poisson) / (density * (1 + poisson) * (1 - 2 * poisson))
    slow = young / (2 * density * (1 + poisson))
    k, h = n * np.pi / LENGTH, HEIGHT / 2

    def equation(square):
        # tanh(q h) / tanh(p h) = (k^2 + q^2)^2 / (4 k^2 p q), antisymmetric, below both wave speeds
        p, q = np.sqrt(k**2 - square / fast), np.sqrt(k**2 - square / slow)
        return 4 * k**2 * p * q * np.tanh(q * h) - (k**2 + q**2) ** 2 * np.tanh(p * h)

    beam = (2 * h) ** 2 / 12 * young / (1 - poisson**2) / density * k**4
    return scipy.optimize.brentq(equation, 0.5 * beam, 1.05 * beam, xtol=1e-3, rtol=1e-14)


def test_smooth_modes_converge_with_the_fourth_order():
    exact = np.array([plate_wave(1), plate_wave(2)])
    errors = np.array([supported(n)[1:3] / exact - 1 for n in (8, 16, 32)])
    assert (errors > 0).all()
    rates = np.log2(errors[:-1] / errors[1:])
    np.testing.assert_allclose(rates, 4.0, atol=0.1)
    assert errors[-1].max() < 1e-4


def test_uniform_stress_stiffens_a_bar_as_a_string():
    """omega^2 grows by (n pi / L)^2 sigma / rho: a string's, whatever the bar's own stiffness."""
    pull = 100e6
    slack, tight = supported(16), supported(16, pull=pull)
    expected = (np.array([1, 2]) * np.pi / LENGTH) ** 2 * pull / 7800.0
    np.testing.assert_allclose((tight - slack)[1:3], expected, rtol=5e-5)


def test_squeeze_buckles_a_bar_at_its_plate_wave():
    """omega^2 is zero where sigma = -rho omega_0^2 / k^2."""
    critical = -7800.0 * plate_wave(1) / (np.pi / LENGTH) ** 2
    assert abs(supported(16, pull=critical)[1]) < 5e-4 * supported(16)[1]


def clamped(elements, poisson):
    """Lowest eigenvalue of a square block in plane strain, clamped along one side."""
    material = Material(200e9, 7800.0, poisson)
    mesh = box((elements, 1, elements), (0.02, 0.005, 0.02))
    rule = elasticity.quadrature(mesh)
    free = np.flatnonzero(mesh.nodes[:, 0] > 1e-9)
    dofs = (3 * free[:, None] + [0, 2]).ravel()
    stiffness = elasticity.stiffness(mesh, rule, [material])[dofs][:, dofs]
    mass = elasticity.per_axis(elasticity.mass(mesh, rule, [material]))[dofs][:, dofs]
    return lowest_eigenpairs(sp.csr_array(stiffness), sp.csr_array(mass), 1)[0][0]


@pytest.mark.parametrize(("poisson", "low", "high"), [(0.0, 1.8, 4.2), (0.3, 1.2, 1.7)])
def test_clamped_corners_lower_the_rate(poisson, low, high):
    """Stress at a clamped corner grows as r^-0.29 for nu = 0.3: a rate of 2 x 0.71, not of 4."""
    values = [clamped(n, poisson) for n in (2, 4, 8, 16)]
    steps = -np.diff(values)
    assert (steps > 0).all()
    rate = np.log2(steps[-2] / steps[-1])
    assert low < rate < high, rate


def halved(mesh):
    """Every element cut in four in X and Z."""
    at = np.linspace(-1, 1, 5)
    shape = np.stack([at * (at - 1) / 2, 1 - at**2, at * (at + 1) / 2], axis=1)
    local = mesh.nodes[mesh.elements].reshape(-1, 3, 3, 3, 3)
    fine = np.einsum("pi,rk,eijkx->epjrx", shape, shape, local)
    flat = fine.reshape(-1, 3)
    _, first, place = np.unique(
        np.round(flat / (np.pi * 1e-8)), axis=0, return_index=True, return_inverse=True
    )
    number = place.reshape(fine.shape[:4])
    parts = [number[:, i : i + 3, :, k : k + 3] for i in (0, 2) for k in (0, 2)]
    elements = np.concatenate([part.reshape(-1, 27) for part in parts])
    return Mesh(flat[first], elements, np.tile(mesh.part, 4))


def dovetail_values(levels):
    """Lowest eigenvalue of the beam in plane strain, flanks fixed, as its mesh is halved."""
    structure = coarse_structure()
    mesh = beam_mesh(structure, with_pad=False)
    (x0, z0), (x1, z1) = flank_ends(structure)
    values = []
    for _ in range(levels):
        x, z = abs(mesh.nodes[:, 0]), abs(mesh.nodes[:, 2])
        fixed = (abs((x - x0) * (z1 - z0) - (z - z0) * (x1 - x0)) < 1e-12) & (x > x0 - 1e-9)
        fixed &= x < x1 + 1e-9
        rule = elasticity.quadrature(mesh)
        spread = plane(mesh, np.repeat(fixed[:, None], 2, axis=1))
        stiffness = elasticity.stiffness(mesh, rule, [structure.material])
        mass = elasticity.per_axis(elasticity.mass(mesh, rule, [structure.material]))
        found, _ = lowest_eigenpairs(
            sp.csr_array(spread.T @ stiffness @ spread), sp.csr_array(spread.T @ mass @ spread), 1
        )
        values.append(found[0])
        mesh = halved(mesh)
    return np.array(values)


@pytest.mark.slow
def test_dovetail_converges_slowly_at_its_corners():
    """Re-entrant and fixed corners leave a rate of 1.4, not 4: a fit belongs to its mesh."""
    steps = -np.diff(dovetail_values(5))
    assert (steps > 0).all()
    rates = np.log2(steps[:-1] / steps[1:])
    assert 1.2 < rates[-1] < 1.7
