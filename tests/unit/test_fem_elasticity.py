import numpy as np
import pytest
import scipy.sparse as sp
from bladeroot.fem import elasticity
from bladeroot.fem.geometry import Material
from bladeroot.fem.linear import factor, lowest_eigenpairs
from bladeroot.fem.mesh import Mesh, beam_mesh, block, extrude
from bladeroot.fem.outline import Edge
from structure_coarse import coarse_structure

STEEL = Material(young=200e9, density=7800.0, poisson=0.3)
LENGTH, HEIGHT, WIDTH = 0.1, 0.01, 0.02


def bar(elements, part=0, height=HEIGHT):
    low, high = ((0.0, 0.0), (LENGTH, 0.0)), ((0.0, height), (LENGTH, height))
    return extrude([block(Edge(*low), Edge(*high), (elements, 1), part)], WIDTH, 1)


def skewed():
    """Two tapered blocks, so that no element is a rectangle."""
    low = Edge((0.0, 0.0), (0.04, 0.004)), Edge((0.04, 0.004), (0.1, 0.0))
    high = Edge((0.0, 0.02), (0.05, 0.03)), Edge((0.05, 0.03), (0.09, 0.02))
    first, second = block(low[0], high[0], (2, 2)), block(low[1], high[1], (1, 2))
    return extrude([first, second], WIDTH, 2)


def matrices(mesh):
    rule = elasticity.quadrature(mesh)
    return rule, elasticity.stiffness(mesh, rule, [STEEL]), elasticity.mass(mesh, rule, [STEEL])


def test_stiffness_is_symmetric_with_exactly_six_rigid_modes():
    mesh = skewed()
    _, stiffness, mass = matrices(mesh)
    assert abs(stiffness - stiffness.T).max() == 0.0
    rigid = elasticity.rigid_modes(mesh.nodes)
    assert abs(stiffness @ rigid).max() < 1e-11 * abs(stiffness).max()
    values, _ = lowest_eigenpairs(
        stiffness, elasticity.per_axis(mass), 8, shift=-((2 * np.pi * 1000) ** 2)
    )
    assert (abs(values[:6]) < 1e-6 * values[6]).all()
    assert values[6] > (2 * np.pi * 1000) ** 2


def test_mass_of_rigid_motion_is_mass_and_inertia():
    mesh = bar(3)
    _, _, mass = matrices(mesh)
    total = STEEL.density * LENGTH * WIDTH * HEIGHT
    assert mass.sum() == pytest.approx(total)
    rigid = elasticity.rigid_modes(mesh.nodes - mesh.nodes.mean(axis=0))
    inertia = rigid[:, 5] @ elasticity.per_axis(mass) @ rigid[:, 5]
    assert inertia == pytest.approx(total * (LENGTH**2 + WIDTH**2) / 12)


def test_parts_take_their_own_material():
    light = Material(young=70e9, density=2700.0, poisson=0.33)
    mesh = bar(2, part=1)
    mass = elasticity.mass(mesh, elasticity.quadrature(mesh), [STEEL, light])
    assert mass.sum() == pytest.approx(2700.0 * LENGTH * WIDTH * HEIGHT)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_geometric_stiffness_turns_rigidly_with_the_stress(axis):
    """R^T Kg R for a rotation is the volume integral of trace(stress) minus the axis's own part."""
    mesh = skewed()
    rule, _, _ = matrices(mesh)
    random = np.random.default_rng(3).standard_normal((3, 3)) * 1e6
    stresses = np.broadcast_to(random + random.T, (*rule.volumes.shape, 3, 3))
    geometric = elasticity.geometric_stiffness(mesh, rule, stresses.copy())
    rotation = elasticity.rigid_modes(mesh.nodes)[:, 3 + axis]
    found = rotation @ (elasticity.per_axis(geometric) @ rotation)
    stress = stresses[0, 0]
    expected = rule.volumes.sum() * (np.trace(stress) - stress[axis, axis])
    assert found == pytest.approx(expected, rel=1e-10)
    assert abs(geometric @ np.ones(len(mesh.nodes))).max() < 1e-9 * abs(geometric).max()


def test_bending_does_not_lock():
    """Tip deflection of a cantilever 10 high and 100 long, against Timoshenko's, within 1 %."""
    slim = Material(young=200e9, density=7800.0, poisson=0.0)
    mesh = bar(4)
    rule = elasticity.quadrature(mesh)
    stiffness = elasticity.stiffness(mesh, rule, [slim])
    free = (3 * np.flatnonzero(mesh.nodes[:, 0] > 1e-9)[:, None] + np.arange(3)).ravel()
    tip = np.flatnonzero(mesh.nodes[:, 0] > LENGTH - 1e-9)
    load = np.zeros(stiffness.shape[0])
    # Simpson's weights spread a unit shear evenly over the tip face of one element.
    order = np.lexsort((mesh.nodes[tip, 2], mesh.nodes[tip, 1]))
    load[3 * tip[order] + 2] = np.outer([1, 4, 1], [1, 4, 1]).ravel() / 36.0
    moved = np.zeros_like(load)
    moved[free] = factor(sp.csr_array(stiffness[free][:, free]))(load[free])
    second = WIDTH * HEIGHT**3 / 12
    shear = 1.2 * LENGTH / (slim.young / 2 * WIDTH * HEIGHT)
    expected = LENGTH**3 / (3 * slim.young * second) + shear
    assert load @ moved == pytest.approx(expected, rel=0.01)


@pytest.mark.parametrize("along", [-1.0, 0.0, np.nan])
def test_element_turned_inside_out_or_nowhere_is_refused(along):
    mesh = bar(1)
    turned = Mesh(mesh.nodes * [along, 1, 1], mesh.elements, mesh.part)
    with pytest.raises(ValueError, match="inside out"):
        elasticity.quadrature(turned)


def test_shipped_profile_gives_sound_elements():
    assert elasticity.quadrature(beam_mesh(coarse_structure(), True)).volumes.min() > 0
