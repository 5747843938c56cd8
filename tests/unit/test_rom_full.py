import numpy as np
import pytest
import scipy.linalg
import scipy.sparse as sp
from bladeroot.fem.linear import lowest_eigenpairs
from bladeroot.rom.accuracy import accuracy
from bladeroot.rom.full import full_frequencies, full_joint
from bladeroot.rom.joint import Operator, joint_of_reduced, stiffness_at
from bladeroot.rom.joint_symmetry import joint_sectors
from bladeroot.rom.parametric import frequencies, surface_of
from bladeroot.rom.parametric_build import parametric_model
from bladeroot.rom.reduction import reduce_structure
from structure_coarse import coarse_loaded


@pytest.fixture(scope="module")
def built():
    loaded = coarse_loaded()
    joint = joint_of_reduced(reduce_structure(*loaded))
    return *loaded, parametric_model(joint), joint


@pytest.fixture(scope="module")
def full(built):
    return full_joint(*built[:3])


def test_followed_modes_are_those_of_a_factor_of_their_own(full):
    kn, kt = 1.4e9, 2.1e9
    found = full_frequencies(full, kn, kt, [0.0, 30e3], ["1B", "2B"])
    for force, pair in zip((0.0, 30e3), found, strict=True):
        matrix = full.stiffness + force * full.geometric + kn * full.normal + kt * full.tangential
        values, _ = lowest_eigenpairs(sp.csr_array(matrix), full.mass, 8)
        exact = np.sqrt(values) / (2 * np.pi)
        assert np.abs(exact[:, None] / pair - 1.0).min(axis=0).max() < 1e-9
    assert np.all(np.diff(found, axis=0) > 0.0)


def test_contact_of_one_flank_carries_its_whole_stiffness(full):
    """Beam moved by 1 m against the slots: 45 degree flanks share kn and kt alike in Z."""
    n = full.geometric.nnz and np.flatnonzero(full.geometric.diagonal())[-1] + 1
    lift = np.zeros(full.mass.shape[0])
    lift[2:n:3] = 1.0
    assert lift @ full.normal @ lift == pytest.approx(2.0)
    assert lift @ full.tangential @ lift == pytest.approx(2.0)


def test_reduction_costs_little_at_any_force_and_contact(built, full):
    model = built[3]
    result = accuracy(full, model, [0.0, 12e3, 30e3])
    assert result["residual"].dims == ("contact", "force", "mode")
    assert np.abs(result["residual"]).max() < 1e-4
    assert result["residual"].min() > -1e-7  # a reduced model is too stiff, never too soft
    point = np.array([*np.log([1.4e9, 2.1e9]), 12e3])
    middle = full_frequencies(full, *np.exp(point[:2]), [12e3], ["1B", "2B"])
    assert np.abs(frequencies(surface_of(model), point[None]) / middle - 1.0).max() < 1e-4
    for name in ("stiffness", "full_frequency", "frequency", "residual"):
        assert {"units", "long_name"} <= set(result[name].attrs)


def test_force_outside_the_model_is_refused(built, full):
    with pytest.raises(ValueError, match="axial force must lie between 0 and 30000"):
        accuracy(full, built[3], [12e3, 31e3])


def test_modes_of_a_joint_by_sectors_are_those_of_the_whole_operator(built):
    joint = built[4]
    assert len(joint.sectors) >= 4
    point = np.array([*np.log([1.4e9, 2.1e9]), 12e3])
    operator = Operator(joint, point)
    values, shapes = operator.lowest(12)
    stiffness = stiffness_at(joint, point)
    exact = scipy.linalg.eigh(stiffness, joint.mass, subset_by_index=[0, 11])[0]
    np.testing.assert_allclose(values, exact, rtol=1e-7)
    np.testing.assert_allclose(shapes.T @ joint.mass @ shapes, np.eye(12), atol=1e-9)
    load = np.random.default_rng(0).standard_normal((len(joint.mass), 2))
    np.testing.assert_allclose(stiffness @ operator.solve(load), load, atol=1e-7)
    mass, between = operator.project(load)
    np.testing.assert_allclose(mass, load.T @ joint.mass @ load, rtol=1e-9)
    np.testing.assert_allclose(between, load.T @ stiffness @ load, rtol=1e-9)
    alone = operator.within(int(operator.sector(shapes[:, 0])))
    np.testing.assert_allclose(alone.project(shapes[:, :1])[1], [[values[0]]], rtol=1e-6)


def test_a_joint_of_unlike_flanks_keeps_the_reflection_that_it_has(built):
    joint = built[4]
    heavier = joint.mass.copy()
    first = joint.assembly["beam_dof"].values[joint.assembly["flank"].values == 0, 0]
    heavier[first, first] *= 1.01  # one flank's nodes, along X
    parts = joint_sectors(joint.assembly, heavier, joint.stiffness)
    assert len(parts) == 2
    assert len(joint_sectors(joint.assembly.drop_vars("pair_position"), heavier)) == 1
