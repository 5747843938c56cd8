import numpy as np
import pytest
from bladeroot.contact.compliance import (
    dissipated_energy,
    normal_approach,
    normal_stiffness,
    tangential_displacement,
    tangential_stiffness,
)
from bladeroot.contact.punch import Punch, contact_half_width
from hypothesis import given, settings
from hypothesis import strategies as st

BODY = {
    "edge_radius": 2.5e-3,
    "length": 26e-3,
    "youngs_modulus": 210e9,
    "poisson_ratio": 0.3,
    "friction": 0.42,
}
FLANK = Punch(flat_half_width=1.28325e-3, **BODY)
CYLINDER = Punch(flat_half_width=0.0, **BODY)
FORCES = np.array([500.0, 4e3, 8485.0, 2e4])


def by_quadrature(n, punch, kernel="slender", shear=False):
    """1 over the derivative of the approach, or of the displacement at T = 0 (6.10), in N."""

    def moved(force):
        constant = punch.poisson_ratio / (1.0 - punch.poisson_ratio) if shear else 0.0
        load = 2.0 / (np.pi * punch.contact_modulus) * force / punch.length
        return normal_approach(force, punch, kernel) + constant * load

    step = 0.01 * n
    pairs = ((1, 0.75), (2, -0.15), (3, 1.0 / 60.0))  # a central difference of sixth order
    return step / sum(c * (moved(n + k * step) - moved(n - k * step)) for k, c in pairs)


@settings(max_examples=25, deadline=None)
@given(
    force=st.floats(300.0, 5e4), flat=st.just(0.0) | st.floats(1e-9, 4e-3), nu=st.floats(0.0, 0.45)
)
def test_quadrature_agrees_with_the_closed_forms(force, flat, nu):
    punch = Punch(**(BODY | {"poisson_ratio": nu}), flat_half_width=flat)
    n = np.array([force])
    # a contact that is nearly all flat loses digits in the pressure itself
    opened = np.arccos(np.minimum(flat / contact_half_width(n / punch.length, punch), 1.0))
    tolerance = float(1e-10 + 1e-13 / opened[0] ** 3)
    by_sum = by_quadrature(n, punch)
    np.testing.assert_allclose(by_sum, normal_stiffness(n, punch), rtol=tolerance)
    by_sum = by_quadrature(n, punch, shear=True)
    np.testing.assert_allclose(by_sum, tangential_stiffness(n, punch), rtol=tolerance)


def test_finite_length_adds_the_next_term_of_the_logarithm():
    """arsinh(L/2r) = ln(L/r) + r^2/L^2 + ..., averaged over a flat punch: b^2/(2 L^2)."""
    b = contact_half_width(FORCES / FLANK.length, FLANK)
    logarithm = np.log(2 * FLANK.length / b)
    expected = logarithm / (logarithm + 0.5 * (b / FLANK.length) ** 2)
    ratio = by_quadrature(FORCES, FLANK, "finite") / normal_stiffness(FORCES, FLANK)
    np.testing.assert_allclose(ratio, expected, rtol=1e-5)


def test_approach_of_a_cylinder_is_the_one_of_hertz():
    """With b of Hertz: delta = 2P/(pi E*) (ln(2L/b) + 1/2) for a slender line."""
    load = FORCES / CYLINDER.length
    b = contact_half_width(load, CYLINDER)
    factor = 2 * load / (np.pi * CYLINDER.contact_modulus)
    expected = factor * (np.log(2 * CYLINDER.length / b) + 0.5)
    found = normal_approach(FORCES, CYLINDER, "slender")
    np.testing.assert_allclose(found, expected, rtol=1e-12)


def test_tangential_stiffness_is_the_start_of_the_displacement_curve():
    small = 1e-5 * FLANK.friction * FORCES
    secant = small / tangential_displacement(FORCES, small, FLANK)
    np.testing.assert_allclose(secant, tangential_stiffness(FORCES, FLANK), rtol=1e-5)


def test_cylinder_at_full_sliding_dissipates_half_pi():
    """Appendix C's check value, the whole-cycle loss over (2/pi)^2 (mu P)^2/E*."""
    limit = CYLINDER.friction * FORCES
    per_metre = dissipated_energy(FORCES, limit, CYLINDER) / CYLINDER.length
    unit = (2 / np.pi * limit / CYLINDER.length) ** 2 / CYLINDER.contact_modulus
    np.testing.assert_allclose(per_metre / unit, np.pi / 2, rtol=1e-10)


def test_small_cycles_of_a_cylinder_dissipate_with_the_cube():
    n = np.full(2, 8e3)
    t = np.array([0.02, 0.04]) * CYLINDER.friction * n
    energy = dissipated_energy(n, t, CYLINDER)
    assert energy[1] / energy[0] == pytest.approx(8.0, rel=0.03)


def test_too_large_a_shear_is_refused():
    with pytest.raises(ValueError, match="friction times"):
        tangential_displacement(np.array([1.0]), np.array([0.5]), FLANK)
