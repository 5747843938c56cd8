"""The independent check's own parts; with CalculiX installed (slow), the check itself."""

import shutil

import bricks
import calculix
import numpy as np
import pytest
from bladeroot.fem import elasticity
from bladeroot.fem.geometry import Material
from bladeroot.fem.mesh import Mesh, beam_mesh, body_mesh, build_mesh
from bladeroot.fem.prestress import flank_loads, materials_of
from structure_coarse import coarse_structure

STEEL = Material(young=200e9, density=7800.0, poisson=0.3)


@pytest.fixture(scope="module")
def problems():
    structure = coarse_structure()
    whole = build_mesh(structure, with_pad=True)
    mesh, _ = body_mesh(whole, 0)
    about = mesh, materials_of(structure, whole, 0), flank_loads(whole)
    return mesh, calculix.twenty_nodes(*about), calculix.eight_nodes(*about)


def test_serendipity_keeps_quadratic_fields():
    """Twenty nodes carry x^2, x y, ... exactly, and any field's values at their own nodes."""
    mesh = beam_mesh(coarse_structure(), with_pad=False)
    follow, kept = calculix.serendipity(mesh)
    straight = Mesh(mesh.nodes, mesh.elements[:1], mesh.part[:1])
    x, y, z = (straight.nodes[:, k] for k in range(3))
    for field in (x, y * y, z * z, x * y, y * z, x * y * z):
        own = straight.elements[0]
        np.testing.assert_allclose((follow @ field[kept])[own], field[own], atol=1e-12)
    np.testing.assert_array_equal((follow @ x[kept])[kept], x[kept])


def test_rigid_motion_costs_nothing_in_either_element(problems):
    _, *kinds = problems
    for problem in kinds:
        rigid = elasticity.rigid_modes(problem.body.nodes)
        moves = np.zeros((problem.stiffness.shape[0], 6))
        moves[: len(rigid)] = rigid
        assert abs(problem.stiffness @ moves).max() < 1e-10 * abs(problem.stiffness).max()
        beam = elasticity.mass(
            problems[0],
            elasticity.quadrature(problems[0]),
            [STEEL, STEEL],
        ).sum()
        mass = moves[:, 0] @ (problem.mass @ moves[:, 0])
        assert 0.8 * beam < mass < beam


def test_strained_shape_without_strain_is_the_shape(problems):
    for problem in problems[1:]:
        gap = problem.strained(0.0) - problem.stiffness
        assert abs(gap).max() < 1e-12 * abs(problem.stiffness).max()


def test_rigidly_turned_elements_stay_elastic():
    """Green's strain: a stiffness about a finite rotation R is R K R^T."""
    mesh = bricks.bricks((bricks.CORNERS + 1) / 100, np.arange(8)[None], [STEEL])
    angle = 0.7
    turn = np.array(
        [[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]]
    )
    slope = np.broadcast_to(turn - np.eye(3), (*mesh.volumes.shape, 3, 3))
    local = bricks.strained(mesh.gradients, mesh.volumes, mesh.hooke, slope)[0]
    plain = bricks.strained(mesh.gradients, mesh.volumes, mesh.hooke, 0 * slope)[0]
    expected = np.einsum("mi,aibj,nj->ambn", turn, plain, turn)
    np.testing.assert_allclose(local, expected, atol=1e-9 * abs(plain).max())


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX (ccx) is not installed")
def test_calculix_gives_the_same_frequencies():
    rows = calculix.measure(coarse_structure())
    assert {row["force_N"] for row in rows} == set(calculix.FORCES)
    assert {row["mode"] for row in rows} >= {"1Fy", "2Fy", "1Fz", "1T", "Ry", "Rz"}
    for row in rows:
        assert abs(row["difference_strained"]) < 1e-6, row
        if row["ours_Hz"] > 0:
            assert abs(row["difference"]) < calculix.TARGET, row
        if row["force_N"] == 0:
            assert abs(row["difference"]) < 1e-6, row


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX (ccx) is not installed")
def test_calculix_gives_the_same_frequencies_of_a_clamped_slot():
    rows = calculix.measure_slot(coarse_structure())
    assert len(rows) == 2 * calculix.SLOT_MODES
    for row in rows:
        assert abs(row["difference"]) < 1e-6, row
