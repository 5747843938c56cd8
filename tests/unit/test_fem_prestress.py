import numpy as np
import pytest
import scipy.sparse as sp
from bladeroot.fem import elasticity
from bladeroot.fem.geometry import flank_ends
from bladeroot.fem.mesh import body_mesh, build_mesh
from bladeroot.fem.prestress import flank_loads, prestress, solve_free
from structure_coarse import coarse_structure


@pytest.fixture(scope="module", params=[False, True], ids=["plain", "pad"])
def loaded(request):
    structure = coarse_structure()
    mesh = build_mesh(structure, with_pad=request.param)
    return structure, mesh, prestress(structure, mesh)


def test_loads_pull_each_end_with_one_newton_and_squeeze_it_with_one(loaded):
    _, mesh, _ = loaded
    loads = flank_loads(mesh)
    for flank, x_sign, z_sign in ((0, -1, 1), (1, -1, -1), (2, 1, 1), (3, 1, -1)):
        nodes = mesh.pair_node.values[mesh.pair_flank.values == flank, 0]
        total = loads[nodes].sum(axis=0)
        np.testing.assert_allclose(total, [x_sign / 2, 0, z_sign / 2], atol=1e-3)
        assert np.hypot(total[0], total[2]) == pytest.approx(1 / (2 * np.sin(np.pi / 4)), rel=1e-3)


def test_free_beam_needs_no_support(loaded):
    _, _, result = loaded
    assert abs(result.resultant).max() < 1e-12
    assert abs(result.reaction).max() < 1e-9
    assert abs(result.virial_error).max() < 1e-9


def test_mid_span_carries_the_axial_force(loaded):
    """Mean axial stress times section over a span element equals one newton."""
    structure, mesh, result = loaded
    beam, _ = body_mesh(mesh, 0)
    volumes = elasticity.quadrature(beam).volumes
    centre = beam.nodes[beam.elements].mean(axis=1)
    chosen = (abs(centre[:, 0]) > 0.05) & (abs(centre[:, 0]) < structure.profile[1][0])
    axial = result.stress.values[..., 0, 0]
    mean = (axial * volumes)[chosen].sum() / volumes[chosen].sum()
    section = 2 * structure.profile[0][1] * structure.width
    assert mean * section == pytest.approx(1.0, rel=1e-9)


def test_rigid_rotations_stiffen_exactly_as_dead_load_says(loaded):
    structure, mesh, result = loaded
    beam, _ = body_mesh(mesh, 0)
    rule = elasticity.quadrature(beam)
    geometric = elasticity.geometric_stiffness(beam, rule, result.stress.values)
    rigid = elasticity.rigid_modes(beam.nodes)
    found = np.einsum("di,di->i", rigid, elasticity.per_axis(geometric) @ rigid)
    (x0, z0), (x1, z1) = flank_ends(structure)
    length, height = x0 + x1, (z0 + z1) / 2
    expected = [0, 0, 0, -2 * height, length - 2 * height, length]
    np.testing.assert_allclose(found, expected, atol=1e-9 * length)


def test_unbalanced_loads_are_refused(loaded):
    _, mesh, _ = loaded
    beam, _ = body_mesh(mesh, 0)
    loads = flank_loads(mesh)
    loads[0, 2] += 1.0
    with pytest.raises(ValueError, match="must balance"):
        solve_free(beam, sp.csr_array((loads.size, loads.size)), loads)
