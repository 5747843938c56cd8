"""The bench's joined specimen, its modes and its flanks, on a small beam in two slots."""

from dataclasses import replace

import numpy as np
import pytest
from bladeroot.bench.friction import pressure_profile, slider_limits
from bladeroot.bench.joint import line_row, parts, specimen, stuck_stiffness
from bladeroot.bench.modes import bending_names, stuck_modes
from rig_toy import toy_reduced
from scipy.linalg import eigh

KN, KT = 1.4e9, 2.1e9


@pytest.fixture(scope="module")
def reduced():
    return toy_reduced()


@pytest.fixture(scope="module")
def whole(reduced):
    return parts(reduced)


def modes(body, kn=KN, kt=KT, kept=10):
    return stuck_modes(body, kn, kt, kept, 0.0, 0.003)


def frequency(body, name="1B", **changes):
    found = modes(body, **changes)
    return found.omega[found.names.index(name)] / (2 * np.pi)


def test_shares_of_a_flank_add_to_one(whole):
    body = specimen(whole, 1e4)
    np.testing.assert_allclose(np.bincount(body.parts.flank, body.parts.share), 1)


def test_springs_do_not_resist_a_common_displacement(reduced, whole):
    body = specimen(whole, 0.0)
    n_beam, n_slot = reduced.sizes["beam_dof"], reduced.sizes["slot_dof"]
    together = np.zeros((len(body.mass), 3))
    together[: 3 * len(body.parts.share)] = np.tile(np.eye(3), (len(body.parts.share), 1))
    together[n_beam:] = np.tile(np.eye(3), (2 * n_slot // 3, 1))
    springs = stuck_stiffness(body, KN, KT)[0] - body.stiffness
    assert np.abs(springs @ together).max() < 1e-9 * np.abs(springs).max()


def test_spring_totals_of_a_flank(whole):
    """All beam contacts moved along X: each flank resists with (kn + kt) / 2."""
    body = specimen(whole, 0.0)
    moved = np.zeros(len(body.mass))
    moved[0 : 3 * len(body.parts.share) : 3] = 1
    springs = stuck_stiffness(body, KN, KT)[0] - body.stiffness
    assert moved @ springs @ moved == pytest.approx(4 * (KN + KT) / 2)


def test_matrices_are_symmetric_and_the_axial_force_stiffens(whole):
    slack, tight = specimen(whole, 0.0), specimen(whole, 2e4)
    np.testing.assert_array_equal(tight.stiffness, tight.stiffness.T)
    assert frequency(tight) > frequency(slack) * 1.01


def test_perturbations_of_the_specimen(whole):
    base = frequency(specimen(whole, 0.0))
    heavy = frequency(specimen(whole, 0.0, density_factor=1.21))
    stiff = frequency(specimen(whole, 0.0, modulus_factor=1.21), kn=1.21 * KN, kt=1.21 * KT)
    assert heavy == pytest.approx(base / 1.1)
    assert stiff == pytest.approx(base * 1.1)


def test_added_mass_lowers_the_frequency_by_its_kinetic_energy(whole):
    mass, x = 1e-4, 0.01
    body = specimen(whole, 0.0)
    found = modes(body)
    k = found.names.index("1B")
    z = line_row(body.parts, x) @ _shape(body, found.omega[k])
    loaded = frequency(specimen(whole, 0.0, added_mass=mass, added_mass_x=x))
    drop = loaded / (found.omega[k] / (2 * np.pi)) - 1
    assert drop == pytest.approx(-0.5 * mass * z**2, rel=1e-2)


def test_modes_are_named_by_their_nodes(whole):
    found = modes(specimen(whole, 1e4))
    assert found.names[:4] == ("1B", "2B", "3B", "4B")
    x = np.linspace(-1, 1, 41)
    z = np.column_stack([np.sin(np.pi * x), 1e-4 * np.cos(x), np.cos(np.pi / 2 * x)])
    assert bending_names(x, z) == ("2B", "", "1B")


def test_kept_modes_and_residual_give_the_static_flexibility(whole):
    body = specimen(whole, 1e4)
    few, many = modes(body, kept=4), modes(body, kept=40)
    stiffness, _ = stuck_stiffness(body, KN, KT)
    static = body.parts.tangential @ np.linalg.solve(stiffness, body.parts.tangential.T)
    for found in (few, many):
        kept = (found.slider_shape / found.omega**2) @ found.slider_shape.T
        np.testing.assert_allclose(kept + found.residual, static, atol=1e-9 * static.max())
        assert np.linalg.eigvalsh(found.residual).min() > -1e-9 * static.max()
    assert np.trace(many.residual) < np.trace(few.residual)


def test_an_unstable_specimen_is_refused(whole):
    body = specimen(whole, 0.0)
    with pytest.raises(ValueError, match="not stable"):
        modes(replace(body, stiffness=body.stiffness - 1e9 * np.eye(len(body.mass))))


def test_a_sensor_beyond_the_line_is_refused(whole):
    with pytest.raises(ValueError, match="a position between"):
        line_row(whole, 0.2)


def test_too_few_beam_dofs_are_refused(reduced):
    short = reduced.isel(beam_dof=slice(0, 30), beam_dof_=slice(0, 30))
    with pytest.raises(ValueError, match="got 30"):
        parts(short)


def test_places_run_between_the_edges(whole):
    place = whole.place
    np.testing.assert_allclose(place.min(axis=0), -1)
    np.testing.assert_allclose(place.max(axis=0), 1)


def test_friction_limits_add_to_coulomb_and_fall_to_the_edge():
    place = np.array([[0, -1], [0, 0], [0, 1], [0, -1], [0, 0], [0, 1]], dtype=float)
    share = np.array([1, 4, 1, 1, 4, 1]) / 6
    flank = np.array([0, 0, 0, 1, 1, 1])
    even = pressure_profile(place, share, flank, 0.02, np.ones(6))
    assert even[0] / even[1] == pytest.approx(0.02)
    uneven = pressure_profile(place, share, flank, 0.02, np.array([3, 1, 1, 0.2, 2, 1.0]))
    limit = slider_limits(1e4, 0.42, share, uneven)
    np.testing.assert_allclose(np.bincount(flank, limit), 0.42 * 1e4 / np.sqrt(2))


def _shape(body, omega):
    stiffness, _ = stuck_stiffness(body, KN, KT)
    squares, shapes = eigh(stiffness, body.mass)
    return shapes[:, np.argmin(np.abs(squares - omega**2))]
