import numpy as np
import pytest
import scipy.sparse as sp
from bladeroot.structure import elasticity
from bladeroot.structure.linear import lowest_eigenpairs
from bladeroot.structure.mesh import beam_mesh
from bladeroot.structure.modes import mirror_nodes, name_modes, parities
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
