import numpy as np
import pytest
import scipy.linalg
from bladeroot.fem.elasticity import rigid_modes
from bladeroot.rom.assembly import assemble, find_modes
from bladeroot.rom.reduction import reduce_structure
from dense_joint import assembly_modes, contact_matrices
from structure_coarse import coarse_loaded

BONDED = 1e13


@pytest.fixture(scope="module")
def reduced():
    return reduce_structure(*coarse_loaded())


@pytest.fixture(scope="module")
def assembly(reduced):
    return assemble(reduced, 12e3)


def test_weights_are_shares_of_each_flank(assembly):
    sums = np.bincount(assembly.flank.values, assembly.weight.values)
    np.testing.assert_allclose(sums, 1.0, rtol=1e-12)
    assert (assembly.weight.values > 0).all()


def test_connectivity_reaches_every_contact_dof_once(assembly, reduced):
    pairs = len(assembly.pair)
    both = np.concatenate([assembly.beam_dof.values.ravel(), assembly.slot_dof.values.ravel()])
    assert len(np.unique(both)) == 6 * pairs
    beam = len(reduced.beam_dof)
    assert assembly.beam_dof.values.max() < beam <= assembly.slot_dof.values.min()


def test_force_enters_through_the_geometric_stiffness_of_the_beam_alone(reduced):
    beam = len(reduced.beam_dof)
    change = assemble(reduced, 5e3).stiffness.values - assemble(reduced, 0.0).stiffness.values
    expected = 5e3 * reduced.beam_geometric_stiffness.values
    scale = abs(reduced.beam_stiffness.values).max()
    np.testing.assert_allclose(change[:beam, :beam], expected, atol=1e-14 * scale)
    assert abs(change[beam:]).max() == 0.0


@pytest.mark.parametrize("equal", [False, True])
def test_contact_matrices_are_symmetric_and_positive_semidefinite(assembly, equal):
    for matrix in contact_matrices(assembly, equal):
        np.testing.assert_allclose(matrix, matrix.T, atol=1e-15)
        values = np.linalg.eigvalsh(matrix)
        assert values.min() > -1e-14
        assert values.max() > 1e-2


@pytest.mark.parametrize("equal", [False, True])
def test_joint_motion_of_both_sides_strains_no_spring(assembly, reduced, equal):
    fields = rigid_modes(reduced.pair_position.values).reshape(-1, 3, 6)
    motion = np.zeros((len(assembly.dof), 6))
    motion[assembly.beam_dof.values] = fields
    motion[assembly.slot_dof.values] = fields
    for matrix in contact_matrices(assembly, equal):
        assert abs(matrix @ motion).max() < 1e-14


def test_one_flank_moved_along_its_axes_meets_its_total_stiffness(assembly):
    normal, tangential = contact_matrices(assembly)
    for flank in range(4):
        chosen = assembly.flank.values == flank
        frame = assembly.frame.values[chosen][0]
        for axis, expected in enumerate([(1.0, 0.0), (0.0, 1.0), (0.0, 1.0)]):
            motion = np.zeros(len(assembly.dof))
            motion[assembly.beam_dof.values[chosen]] = frame[axis]
            found = motion @ normal @ motion, motion @ tangential @ motion
            np.testing.assert_allclose(found, expected, atol=1e-12)


def test_element_matrix_is_that_of_eq_5_3(assembly):
    """One pair's 6 x 6 block against Lambda^T K_local Lambda written out."""
    kn, kt, pair = 3.0e8, 7.0e8, 0
    normal, tangential = contact_matrices(assembly)
    dofs = np.r_[assembly.beam_dof.values[pair], assembly.slot_dof.values[pair]]
    rotation = np.kron(np.eye(2), assembly.frame.values[pair])
    springs = np.diag([kn, kt, kt]) * assembly.weight.values[pair]
    local = np.block([[springs, -springs], [-springs, springs]])
    found = (kn * normal + kt * tangential)[np.ix_(dofs, dofs)]
    np.testing.assert_allclose(found, rotation.T @ local @ rotation, rtol=1e-12, atol=1e-4)


def test_stiff_springs_bond_the_joint(assembly):
    """Frequencies rise with kn and kt towards those of the joint with shared nodes."""
    frequencies = []
    for stiffness in (1e8, 1e9, 1e11, BONDED):
        found, shapes = assembly_modes(assembly, stiffness, stiffness)
        modes = find_modes(assembly, shapes)
        frequencies.append([found[modes["1B"]], found[modes["2B"]]])
    assert (np.diff(frequencies, axis=0) > 0).all()
    join = np.eye(len(assembly.dof))
    join[assembly.slot_dof.values.ravel(), assembly.beam_dof.values.ravel()] = 1.0
    join = np.delete(join, assembly.slot_dof.values.ravel(), axis=1)
    values = scipy.linalg.eigh(
        join.T @ assembly.stiffness.values @ join,
        join.T @ assembly.mass.values @ join,
        eigvals_only=True,
        subset_by_index=[0, 9],
    )
    welded = np.sqrt(values) / (2 * np.pi)
    for frequency in frequencies[-1]:
        assert abs(welded / frequency - 1).min() < 1e-3


def test_bending_modes_are_found_whatever_the_sign(assembly):
    _, shapes = assembly_modes(assembly, 1e9, 1e9)
    modes = find_modes(assembly, shapes)
    assert modes["1B"] < modes["2B"]
    assert find_modes(assembly, -shapes) == modes
    lift = np.einsum("dq,q->d", assembly.display_shape.values[:, 2], shapes[:, modes["2B"]])
    middle = np.argmin(abs(assembly.display_position.values[:, 0]))
    assert abs(lift[middle]) < 0.1 * abs(lift).max()


def test_missing_mode_is_an_error(assembly):
    _, shapes = assembly_modes(assembly, 1e9, 1e9)
    modes = find_modes(assembly, shapes)
    with pytest.raises(ValueError, match=r"no mode 2B .*odd in x"):
        find_modes(assembly, shapes[:, : modes["2B"]])
