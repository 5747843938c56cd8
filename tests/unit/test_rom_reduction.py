import numpy as np
import pytest
import scipy.linalg
import scipy.sparse as sp
from bladeroot.fem import elasticity
from bladeroot.fem.linear import lowest_eigenpairs
from bladeroot.fem.mesh import base_nodes, build_mesh, slot_mesh
from bladeroot.rom.reduction import (
    beam_basis,
    beam_model,
    contact_dofs,
    craig_bampton,
    project,
    project_stiffness,
    reduce_structure,
)
from structure_coarse import coarse_loaded


@pytest.fixture(scope="module")
def small():
    """A chain of masses and springs in three directions, free at its ends."""
    rng = np.random.default_rng(5)
    nodes = 14
    size = 3 * nodes
    root = rng.standard_normal((size, size))
    stiffness = sp.csr_array(root @ root.T + size * np.eye(size))
    scalar = rng.standard_normal((nodes, nodes))
    mass = sp.csr_array(scalar @ scalar.T + nodes * np.eye(nodes))
    return stiffness, mass


@pytest.fixture(scope="module")
def beam():
    loaded = coarse_loaded()
    return *loaded, beam_model(*loaded)


def eigenvalues(stiffness, mass):
    return scipy.linalg.eigh(stiffness, mass, eigvals_only=True)


def test_with_all_but_one_mode_the_spectrum_is_all_but_exact(small):
    """Keeping n - 1 of n fixed-interface modes leaves a space that lacks one vector."""
    stiffness, mass = small
    masters = np.arange(6)
    full = eigenvalues(stiffness.toarray(), elasticity.per_axis(mass).toarray())
    basis = craig_bampton(stiffness, elasticity.per_axis(mass), masters, stiffness.shape[0] - 7)
    reduced = eigenvalues(project_stiffness(stiffness, basis), project(mass, basis))
    assert len(reduced) == len(full) - 1
    assert (reduced >= full[:-1] * (1 - 1e-10)).all()
    assert (reduced <= full[1:] * (1 + 1e-10)).all()
    np.testing.assert_allclose(reduced[:5], full[:5], rtol=1e-3)


def test_with_all_modes_the_spectrum_is_exact(small):
    stiffness, mass = small
    mass3 = elasticity.per_axis(mass)
    masters = np.arange(6)
    basis = craig_bampton(stiffness, mass3, masters, 35)
    slaves = np.arange(6, 42)
    inner = (stiffness[slaves][:, slaves].toarray(), mass3[slaves][:, slaves].toarray())
    _, shapes = scipy.linalg.eigh(*inner)
    columns = np.column_stack([basis.columns, np.r_[np.zeros(6), shapes[:, -1]]])
    found = eigenvalues(columns.T @ stiffness @ columns, columns.T @ mass3 @ columns)
    full = eigenvalues(stiffness.toarray(), mass3.toarray())
    np.testing.assert_allclose(found, full, rtol=1e-9)


def test_projections_equal_the_dense_products(small):
    stiffness, mass = small
    basis = craig_bampton(stiffness, elasticity.per_axis(mass), np.array([0, 1, 2, 9, 10, 11]), 7)
    columns = basis.columns
    expected = columns.T @ stiffness @ columns
    np.testing.assert_allclose(
        project_stiffness(stiffness, basis), expected, atol=1e-9 * abs(expected).max()
    )
    expected = columns.T @ elasticity.per_axis(mass) @ columns
    np.testing.assert_allclose(project(mass, basis), expected, rtol=1e-10, atol=1e-10)


def test_reduced_mass_holds_all_four_terms_of_eq_4_12(small):
    """The printed (4.12) drops M_ms Phi and one factor Phi; the four terms are needed."""
    stiffness, mass = small
    mass3 = elasticity.per_axis(mass).toarray()
    masters, slaves = np.arange(6), np.arange(6, 42)
    basis = craig_bampton(stiffness, elasticity.per_axis(mass), masters, 4)
    phi = basis.columns[slaves, :6]
    block = lambda a, b: mass3[np.ix_(a, b)]  # noqa: E731
    expected = (
        block(masters, masters)
        + block(masters, slaves) @ phi
        + phi.T @ block(slaves, masters)
        + phi.T @ block(slaves, slaves) @ phi
    )
    np.testing.assert_allclose(project(mass, basis)[:6, :6], expected, rtol=1e-9, atol=1e-9)


def test_too_many_modes_are_refused(small):
    stiffness, mass = small
    with pytest.raises(ValueError, match="cannot keep 36"):
        craig_bampton(stiffness, elasticity.per_axis(mass), np.arange(6), 36)


@pytest.mark.parametrize("force", [0.0, 30e3])
def test_reduced_beam_meets_the_full_one_at_any_force(beam, force):
    structure, mesh, _, model = beam
    basis = beam_basis(model, mesh, structure.beam_modes)
    reduced = eigenvalues(
        project_stiffness(model.stiffness, basis) + force * project(model.geometric, basis),
        project(model.mass, basis),
    )[6:10]
    full, _ = lowest_eigenpairs(
        sp.csr_array(model.stiffness + force * elasticity.per_axis(model.geometric)),
        elasticity.per_axis(model.mass),
        10,
        shift=-4e7,
    )
    np.testing.assert_allclose(np.sqrt(reduced), np.sqrt(full[6:]), rtol=5e-4)
    assert (reduced > full[6:] * (1 - 1e-9)).all()


def test_reduced_beam_keeps_mass_rigid_motion_and_balance(beam):
    structure, mesh, loaded, _ = beam
    reduced = reduce_structure(structure, mesh, loaded)
    contact = 3 * len(reduced.pair)
    rigid = np.zeros((len(reduced.beam_dof), 6))
    rigid[:contact] = elasticity.rigid_modes(reduced.pair_position.values)
    stiffness = reduced.beam_stiffness.values
    assert abs(stiffness @ rigid).max() < 1e-9 * abs(stiffness).max()
    total = rigid[:, 0] @ reduced.beam_mass.values @ rigid[:, 0]
    volume = 4 * np.trapezoid(*np.array(structure.profile).T[::-1]) * structure.width
    pad = structure.pad
    expected = volume * structure.material.density
    expected += pad.length * pad.thickness * structure.width * pad.material.density
    assert total == pytest.approx(expected, rel=1e-9)
    shown = np.einsum("daq,qr->dar", reduced.display_shape.values, rigid[:, :3])
    np.testing.assert_allclose(shown, np.broadcast_to(np.eye(3), shown.shape), atol=1e-8)


def test_slots_mirror_each_other(beam):
    """Both slots' spectra agree, and so do their stiffnesses seen in mirrored directions."""
    structure, mesh, loaded, _ = beam
    reduced = reduce_structure(structure, mesh, loaded)
    first, second = (
        eigenvalues(reduced.slot_stiffness.values[k], reduced.slot_mass.values[k]) for k in (0, 1)
    )
    np.testing.assert_allclose(first, second, rtol=1e-9)
    masters = 3 * len(reduced.slot_pair)
    direct = _slot(structure, "Xn", mesh, 0)
    np.testing.assert_allclose(
        reduced.slot_stiffness.values[0][:masters, :masters],
        direct,
        atol=1e-7 * abs(direct).max(),
    )


def _slot_matrices(structure, side):
    body = slot_mesh(structure, side)
    rule = elasticity.quadrature(body)
    materials = [structure.slot.material]
    stiffness = elasticity.stiffness(body, rule, materials)
    return body, stiffness, elasticity.mass(body, rule, materials)


def _slot(structure, side, mesh, which):
    """Static stiffness of a slot's contact nodes, by dense condensation."""
    body, stiffness, _ = _slot_matrices(structure, side)
    pairs = len(mesh.pair) // 2
    position = mesh.node_position.values[mesh.pair_node.values[which * pairs :][:pairs, 1]]
    nodes = [int(np.argmin(np.linalg.norm(body.nodes - p, axis=1))) for p in position]
    masters = contact_dofs(np.array(nodes))
    fixed = contact_dofs(base_nodes(body))
    inner = np.setdiff1d(np.arange(stiffness.shape[0]), np.concatenate([masters, fixed]))
    dense = stiffness.toarray()
    cross = dense[np.ix_(inner, masters)]
    solved = np.linalg.solve(dense[np.ix_(inner, inner)], cross)
    return dense[np.ix_(masters, masters)] - cross.T @ solved


def test_fixing_the_base_before_equals_removing_it_after_the_reduction(beam):
    """Eqs 5.1, 5.2: base nodes kept as masters and then struck out leave the same matrices."""
    structure, mesh, loaded, _ = beam
    body, stiffness, mass = _slot_matrices(structure, "Xp")
    pairs = len(mesh.pair) // 2
    position = mesh.node_position.values[mesh.pair_node.values[pairs:, 1]]
    contact = np.array([int(np.argmin(np.linalg.norm(body.nodes - p, axis=1))) for p in position])
    base = base_nodes(body)
    masters = contact_dofs(np.concatenate([contact, base]))
    basis = craig_bampton(stiffness, elasticity.per_axis(mass), masters, structure.slot_modes)
    kept = np.r_[
        np.arange(3 * len(contact)), len(masters) + np.arange(structure.slot_modes)
    ]  # q_F; the base's q_C = 0
    after = [
        matrix[np.ix_(kept, kept)]
        for matrix in (project(mass, basis), project_stiffness(stiffness, basis))
    ]
    reduced = reduce_structure(structure, mesh, loaded)
    before = [reduced.slot_mass.values[1], reduced.slot_stiffness.values[1]]
    for one, other in zip(before, after, strict=True):
        contact_block = slice(0, 3 * len(contact))
        np.testing.assert_allclose(
            one[contact_block, contact_block],
            other[contact_block, contact_block],
            atol=1e-8 * abs(other).max(),
        )
    np.testing.assert_allclose(
        eigenvalues(before[1], before[0]), eigenvalues(after[1], after[0]), rtol=1e-7
    )


def test_mesh_and_prestress_must_agree_on_the_pad(beam):
    structure, _, loaded, _ = beam
    with pytest.raises(ValueError, match="agree on the pad"):
        reduce_structure(structure, build_mesh(structure, with_pad=False), loaded)
