import dataclasses

import numpy as np
import pytest
from bladeroot.fem import elasticity
from bladeroot.fem.mesh import build_mesh
from bladeroot.fem.prestress import prestress
from bladeroot.fem.symmetry import reflections
from bladeroot.rom.reduction import beam_model, contact_dofs, craig_bampton
from structure_coarse import coarse_structure


@pytest.fixture(scope="module", params=[False, True], ids=["bare", "with pad"])
def beam(request):
    structure = coarse_structure()
    mesh = build_mesh(structure, with_pad=request.param)
    model = beam_model(structure, mesh, prestress(structure, mesh))
    return model, contact_dofs(mesh.pair_node.values[:, 0]), request.param


def test_beam_is_its_own_mirror_image_but_for_the_pad(beam):
    model, _, with_pad = beam
    assert len(reflections(model.mesh.nodes, model.stiffness)) == (2 if with_pad else 3)


def test_mirrored_static_modes_are_the_solved_ones(beam):
    model, masters, _ = beam
    mass = elasticity.per_axis(model.mass)
    mirrors = reflections(model.mesh.nodes, model.stiffness)
    plain = craig_bampton(model.stiffness, mass, masters, 5)
    quick = craig_bampton(model.stiffness, mass, masters, 5, mirrors)
    np.testing.assert_allclose(quick.columns, plain.columns, atol=1e-9)
    some = masters[: len(masters) // 4]  # a flank alone is no image of another
    part = craig_bampton(model.stiffness, mass, some, 5, mirrors)
    alone = craig_bampton(model.stiffness, mass, some, 5)
    np.testing.assert_allclose(part.columns, alone.columns, atol=1e-9)


def test_a_stiffness_without_the_symmetry_is_noticed(beam):
    model, _, with_pad = beam
    spring = model.stiffness.tolil(copy=True)
    spring[0, 0] += 1e9
    found = reflections(model.mesh.nodes, spring.tocsr())
    assert len(found) < (2 if with_pad else 3)
    shifted = dataclasses.replace(model.mesh, nodes=model.mesh.nodes + 1e-3 * np.eye(3)[0])
    assert len(reflections(shifted.nodes, model.stiffness)) == (1 if with_pad else 2)
