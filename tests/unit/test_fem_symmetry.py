import dataclasses
from itertools import combinations

import numpy as np
import pytest
import scipy.sparse as sp
from bladeroot.fem import elasticity
from bladeroot.fem.symmetry import Reflection, reflections, sectors, symmetric_eigenpairs
from bladeroot.rom.reduction import beam_model, contact_dofs, craig_bampton
from structure_coarse import coarse_loaded


@pytest.fixture(scope="module", params=[False, True], ids=["bare", "with pad"])
def beam(request):
    structure, mesh, loaded = coarse_loaded(with_pad=request.param)
    model = beam_model(structure, mesh, loaded)
    return model, contact_dofs(mesh.pair_node.values[:, 0]), request.param


def test_beam_is_its_own_mirror_image_but_for_the_pad(beam):
    model, _, with_pad = beam
    assert len(reflections(model.mesh.nodes, model.stiffness)) == (2 if with_pad else 3)


def test_a_reduction_by_sectors_is_the_whole_one(beam):
    model, masters, _ = beam
    mass = elasticity.per_axis(model.mass)
    mirrors = reflections(model.mesh.nodes, model.stiffness, mass)
    some = masters[: len(masters) // 4]  # a flank alone is no image of another
    for held in (masters, some):
        plain = craig_bampton(model.stiffness, mass, held, 5)
        quick = craig_bampton(model.stiffness, mass, held, 5, mirrors)
        static = slice(0, len(held))
        np.testing.assert_allclose(quick.columns[:, static], plain.columns[:, static], atol=1e-9)
        whole = plain.eigenvalues[-1]  # what rounding is a part of
        np.testing.assert_allclose(
            quick.eigenvalues, plain.eigenvalues, rtol=1e-9, atol=1e-11 * whole
        )
        overlap = quick.columns[:, len(held) :].T @ (mass @ plain.columns[:, len(held) :])
        np.testing.assert_allclose(np.abs(overlap), np.eye(5), atol=1e-6)


def test_sectors_span_all_dofs_and_are_not_coupled(beam):
    model, _, with_pad = beam
    mirrors = reflections(model.mesh.nodes, model.stiffness)
    parts = sectors(mirrors, model.stiffness.shape[0])
    assert len(parts) == (4 if with_pad else 8)
    whole = sp.hstack([part.columns for part in parts])
    assert abs(whole.T @ whole - sp.eye_array(whole.shape[0])).max() < 1e-14
    size = abs(model.stiffness).max()
    for one, other in combinations(parts, 2):
        assert abs(one.columns.T @ model.stiffness @ other.columns).max() < 1e-9 * size
    for part in parts:
        projected = part.columns.T @ model.stiffness @ part.columns
        assert abs(part.within(model.stiffness) - projected).max() < 1e-9 * size


def test_lowest_modes_that_share_one_sector_are_all_found():
    stiffness = sp.diags_array(np.repeat([1.0, 2.0, 3.0, 40.0, 50.0, 60.0], 2)).tocsr()
    mass = sp.eye_array(12, format="csr")
    mirror = Reflection(np.arange(12) ^ 1, np.ones(12))
    values, shapes = symmetric_eigenpairs(stiffness, mass, 6, mirrors=[mirror])
    np.testing.assert_allclose(values, np.repeat([1.0, 2.0, 3.0], 2), rtol=1e-12)
    np.testing.assert_allclose(shapes.T @ shapes, np.eye(6), atol=1e-12)
    soft = stiffness + 100.0 * (sp.eye_array(12) - sp.csr_array(np.kron(np.eye(6), 1 - np.eye(2))))
    values, _ = symmetric_eigenpairs(sp.csr_array(soft), mass, 6, mirrors=[mirror])
    np.testing.assert_allclose(values, [1.0, 2.0, 3.0, 40.0, 50.0, 60.0], rtol=1e-12)


def test_a_stiffness_without_the_symmetry_is_noticed(beam):
    model, _, with_pad = beam
    spring = model.stiffness.tolil(copy=True)
    spring[0, 0] += 1e9
    found = reflections(model.mesh.nodes, spring.tocsr())
    assert len(found) < (2 if with_pad else 3)
    shifted = dataclasses.replace(model.mesh, nodes=model.mesh.nodes + 1e-3 * np.eye(3)[0])
    assert len(reflections(shifted.nodes, model.stiffness)) == (1 if with_pad else 2)
