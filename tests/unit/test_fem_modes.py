import numpy as np
import pytest
import scipy.sparse as sp
from bladeroot.fem import elasticity
from bladeroot.fem.geometry import Material
from bladeroot.fem.linear import lowest_eigenpairs
from bladeroot.fem.mesh import beam_mesh, block, build_mesh, extrude
from bladeroot.fem.modes import mirror_nodes, name_modes, parities
from bladeroot.fem.outline import Edge
from bladeroot.fem.prestress import prestress
from bladeroot.rom.beam_modes import full_modes
from bladeroot.rom.reduction import beam_model
from structure_coarse import coarse_structure

RIGID = ["X", "Y", "Z", "Rx", "Ry", "Rz"]


def solved(with_pad):
    structure = coarse_structure()
    mesh = beam_mesh(structure, with_pad)
    materials = [structure.material, structure.pad.material]
    rule = elasticity.quadrature(mesh)
    stiffness = elasticity.stiffness(mesh, rule, materials)
    mass = elasticity.mass(mesh, rule, materials)
    return mesh, stiffness, mass


@pytest.mark.parametrize("with_pad", [False, True])
def test_free_beam_modes_are_named_whatever_their_order(with_pad):
    mesh, stiffness, mass = solved(with_pad)
    weights = mass.sum(axis=1)
    values, shapes = lowest_eigenpairs(stiffness, elasticity.per_axis(mass), 12, shift=-4e7)
    names = name_modes(mesh.nodes, weights, values, shapes)
    assert sorted(names[:6]) == sorted(RIGID)
    assert names[6:10] == ["1Fy", "1Fz", "2Fy", "3Fy"]
    assert set(names[10:]) == {"1T", "2Fz"}


def test_clamped_ends_start_torsion_even():
    mesh, stiffness, mass = solved(False)
    free = np.flatnonzero(abs(mesh.nodes[:, 0]) < abs(mesh.nodes[:, 0]).max() - 1e-9)
    dofs = (3 * free[:, None] + np.arange(3)).ravel()
    values, part = lowest_eigenpairs(
        sp.csr_array(stiffness[dofs][:, dofs]),
        elasticity.per_axis(sp.csr_array(mass[free][:, free])),
        6,
    )
    shapes = np.zeros((stiffness.shape[0], 6))
    shapes[dofs] = part
    names = name_modes(mesh.nodes, mass.sum(axis=1), values, shapes)
    assert names[:3] == ["1Fy", "1Fz", "2Fy"]
    assert "1T" in names[3:]


def test_pure_fields_have_pure_parity():
    mesh, _, mass = solved(True)
    x, y, z = (mesh.nodes / abs(mesh.nodes).max(axis=0)).T
    zero = np.zeros_like(x)
    fields = {
        (1, 1, -1): (zero, zero, x**2 - 0.3),  # bending in Z, even
        (-1, 1, -1): (zero, zero, x**3 - x),  # bending in Z, odd
        (1, -1, 1): (zero, x**2, zero),  # bending in Y, even
        (-1, -1, -1): (zero, -z * x, y * x),  # torsion, odd
        (1, 1, 1): (x, zero, zero),  # stretching
    }
    shapes = np.stack([np.stack(f, axis=1).ravel() for f in fields.values()], axis=1)
    found = parities(mesh.nodes, mass.sum(axis=1), shapes)
    np.testing.assert_allclose(found, np.array(list(fields)), atol=1e-9)


def test_names_do_not_depend_on_the_sign_or_on_other_modes_order():
    mesh, stiffness, mass = solved(False)
    weights = mass.sum(axis=1)
    values, shapes = lowest_eigenpairs(stiffness, elasticity.per_axis(mass), 12, shift=-4e7)
    names = name_modes(mesh.nodes, weights, values, shapes)
    flipped = shapes * np.where(np.arange(12) % 2, -1, 1)
    assert name_modes(mesh.nodes, weights, values, flipped)[6:] == names[6:]
    swapped = name_modes(mesh.nodes, weights, values[[8, 7, 6, 9]], shapes[:, [8, 7, 6, 9]])
    assert swapped == ["2Fy", "1Fz", "1Fy", "3Fy"]


def test_a_shape_without_parity_is_not_named():
    mesh, _, mass = solved(False)
    x = mesh.nodes[:, 0] / abs(mesh.nodes[:, 0]).max()
    shape = np.zeros((len(x), 3))
    shape[:, 2] = np.where(x > 0, np.sin(6 * np.pi * x), 0.0)
    names = name_modes(mesh.nodes, mass.sum(axis=1), np.array([1.0]), shape.reshape(-1, 1))
    assert names == ["?"]


def test_pad_nodes_have_no_mirror_image_in_z():
    mesh, _, _ = solved(True)
    lonely = mirror_nodes(mesh.nodes, 2) < 0
    floor = coarse_structure().profile[0][1]
    assert lonely.any()
    assert (mesh.nodes[lonely, 2] < -floor - 1e-9).all()
    assert (mirror_nodes(mesh.nodes, 0) >= 0).all()


STEEL = Material(young=200e9, density=7800.0, poisson=0.3)


def straight(width, height, clamped=False, count=12):
    """Modes of a straight bar 0.2 m long: nodes, nodal masses, eigenvalues, shapes."""
    low, high = ((-0.1, -height / 2), (0.1, -height / 2)), ((-0.1, height / 2), (0.1, height / 2))
    mesh = extrude([block(Edge(*low), Edge(*high), (8, 2))], width, 2)
    rule = elasticity.quadrature(mesh)
    stiffness = elasticity.stiffness(mesh, rule, [STEEL])
    mass = elasticity.mass(mesh, rule, [STEEL])
    free = np.flatnonzero(abs(mesh.nodes[:, 0]) < (0.1 - 1e-9 if clamped else 1.0))
    dofs = (3 * free[:, None] + np.arange(3)).ravel()
    values, part = lowest_eigenpairs(
        sp.csr_array(stiffness[dofs][:, dofs]),
        sp.csr_array(elasticity.per_axis(mass)[dofs][:, dofs]),
        count,
        shift=-4e7,
    )
    shapes = np.zeros((stiffness.shape[0], count))
    shapes[dofs] = part
    return mesh.nodes, mass.sum(axis=1), values, shapes


@pytest.mark.parametrize("clamped", [False, True])
def test_equal_bendings_of_a_square_bar_are_told_apart(clamped):
    """Both bendings have one frequency: any mixture solves, the named ones are pure."""
    nodes, weights, values, shapes = straight(0.01, 0.01, clamped)
    names = name_modes(nodes, weights, values, shapes)
    elastic = names if clamped else names[6:]
    assert set(elastic[:2]) == {"1Fy", "1Fz"}
    assert set(elastic[2:4]) == {"2Fy", "2Fz"}
    first = names.index(elastic[0])
    mixed = shapes.copy()
    mixed[:, first : first + 2] = shapes[:, first : first + 2] @ (
        np.array([[0.8, -0.6], [0.6, 0.8]])
    )
    assert set(name_modes(nodes, weights, values, mixed)[first : first + 2]) == {"1Fy", "1Fz"}


@pytest.mark.parametrize("excess", [1e-9, 1e-5, 1e-2])
def test_names_follow_bending_through_the_crossing(excess):
    """A bar as wide as it is high, give or take: the stiffer direction changes, not the names."""
    for width, height in ((0.01 * (1 + excess), 0.01), (0.01, 0.01 * (1 + excess))):
        nodes, weights, values, shapes = straight(width, height)
        names = name_modes(nodes, weights, values, shapes)
        lateral, bending = values[names.index("1Fz")], values[names.index("1Fy")]
        ratio = np.sqrt(lateral / bending)
        np.testing.assert_allclose(ratio, width / height, atol=0.1 * excess + 1e-8)


def test_mixed_bendings_that_differ_in_frequency_are_not_named():
    """A shape between two families is neither; later modes of both are not numbered."""
    nodes, weights, values, shapes = straight(0.013, 0.01)
    names = name_modes(nodes, weights, values, shapes)
    assert names[6:8] == ["1Fy", "1Fz"]
    mixed = shapes.copy()
    mixed[:, 6:8] = shapes[:, 6:8] @ np.array([[1, -1], [1, 1]]) / np.sqrt(2)
    found = name_modes(nodes, weights, values, mixed)
    assert found[6:8] == ["?", "?"]
    for old, new in zip(names[8:], found[8:], strict=True):
        assert new == ("?" if old in ("3Fy", "3Fz") else old)


def test_mixed_rigid_motions_hide_no_elastic_mode():
    nodes, weights, values, shapes = straight(0.013, 0.01)
    names = name_modes(nodes, weights, values, shapes)
    mixed = np.linalg.qr(np.random.default_rng(0).standard_normal((6, 6)))[0]
    loaded = values.copy()
    loaded[:6] = 1e-4 * values[6] * np.arange(1, 7)  # no longer equal, so not separated
    found = name_modes(nodes, weights, loaded, np.hstack([shapes[:, :6] @ mixed, shapes[:, 6:]]))
    assert "?" in found[:6]
    assert found[6:] == names[6:]


def test_torsion_is_told_from_second_bending_where_they_cross():
    """A flat bar's torsion falls below its second lateral bending: by parity, not by order."""
    order = []
    for width in (0.03, 0.06):
        nodes, weights, values, shapes = straight(width, 0.01)
        names = name_modes(nodes, weights, values, shapes)
        order.append([name for name in names if name in ("1T", "2Fy", "1Fz")])
        x, y, _ = nodes.T
        torsion = shapes[:, names.index("1T")].reshape(-1, 3)
        assert abs(np.corrcoef(torsion[:, 2], y * x)[0, 1]) > 0.9
        bending = shapes[:, names.index("2Fy")].reshape(-1, 3)
        assert abs(np.corrcoef(bending[:, 2], y * x)[0, 1]) < 1e-3
    assert order[0] != order[1]


def test_axial_force_swaps_neighbours_and_no_name():
    """The coarse beam's 1T falls and its 3Fy rises with the force; they cross below 24 kN."""
    structure = coarse_structure()
    mesh = build_mesh(structure, with_pad=True)
    model = beam_model(structure, mesh, prestress(structure, mesh))
    found = {}
    for force in (0.0, 12e3, 24e3, 30e3):
        values, names = full_modes(model, force)
        found[force] = [values[names.index(name)] for name in ("1T", "3Fy", "1Fy", "2Fy")]
    torsion, third, first, second = np.array(list(found.values())).T
    assert (np.diff(torsion) < 0).all()
    for stiffened in (third, first, second):
        assert (np.diff(stiffened) > 0).all()
    assert torsion[0] > third[0]
    assert torsion[-1] < third[-1]
