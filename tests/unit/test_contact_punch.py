import numpy as np
import pytest
from bladeroot.contact.punch import (
    Punch,
    contact_half_width,
    pressure,
    punch_from,
    shear,
    stick_half_width,
)
from bladeroot.contact.quadrature import panel_rule
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


def integral(profile, punch, half_width):
    """Integral of an even profile over the contact, with breaks at the ends of the flat."""
    edges = np.sort([0.0, np.arcsin(min(punch.flat_half_width / half_width, 1.0)), 0.5 * np.pi])
    angle, weight = panel_rule(edges)
    x = half_width * np.sin(angle)
    return 2.0 * np.sum(weight * half_width * np.cos(angle) * profile(x))


def as_printed(x, load, punch):
    """Equation 6.4 written out, the exponents applied to whole fractions."""
    a, b = punch.flat_half_width, float(contact_half_width(np.array(load), punch))
    phi, phi0 = np.arcsin(x / b), np.arcsin(a / b)
    tangents = np.abs(np.tan((phi + phi0) / 2) * np.tan((phi - phi0) / 2))
    sines = np.abs(np.sin(phi + phi0) / np.sin(phi - phi0))
    open_angle = np.pi - 2 * phi0
    braces = open_angle * np.cos(phi) + np.sin(phi) * np.log(sines)
    braces += np.sin(phi0) * np.log(tangents)
    return load / b * (2 / np.pi) / (open_angle - np.sin(2 * phi0)) * braces


def test_pressure_agrees_with_equation_6_4_written_out():
    load = 3.26e5
    x = np.linspace(0.013, 0.997, 57) * float(contact_half_width(np.array(load), FLANK))
    np.testing.assert_allclose(
        pressure(x, np.array(load), FLANK), as_printed(x, load, FLANK), rtol=1e-11
    )


@settings(max_examples=60, deadline=None)
@given(ratio=st.floats(1e-3, 10.0), load=st.floats(1e3, 1e7), radius=st.floats(5e-4, 5e-2))
def test_pressure_integrates_to_the_load(ratio, load, radius):
    punch = Punch(**(BODY | {"edge_radius": radius}), flat_half_width=ratio * 1e-3)
    b = float(contact_half_width(np.array(load), punch))
    opened = np.arccos(punch.flat_half_width / b)
    total = integral(lambda x: pressure(x, np.array(load), punch), punch, b)
    # rounding of the closed form grows as the rounded rim narrows
    assert total == pytest.approx(load, rel=1e-14 + 2e-15 / opened**2)


def test_width_becomes_the_cylinder_of_hertz():
    load = np.array([1e3, 1e5, 1e7])
    expected = np.sqrt(4 * load * 2.5e-3 / (np.pi * CYLINDER.contact_modulus))
    np.testing.assert_allclose(contact_half_width(load, CYLINDER), expected, rtol=1e-14)
    for flat, tolerance in ((1e-3, 2e-3), (1e-5, 2e-5)):
        slim = Punch(flat_half_width=flat * expected[0], **BODY)
        found = contact_half_width(load[:1], slim)
        np.testing.assert_allclose(found, expected[:1], rtol=tolerance)


def test_printed_width_law_misses_hertz_by_the_root_of_two():
    printed = Punch(flat_half_width=0.0, **BODY, width_law="printed")
    load = np.array([1e5])
    ratio = contact_half_width(load, printed) / contact_half_width(load, CYLINDER)
    np.testing.assert_allclose(ratio, np.sqrt(2), rtol=1e-14)


def test_pressure_becomes_the_ellipse_of_hertz():
    load = np.array(2e5)
    b = float(contact_half_width(load, CYLINDER))
    x = np.linspace(-1.2, 1.2, 48) * b
    ellipse = 2 * load / (np.pi * b) * np.sqrt(np.maximum(1 - (x / b) ** 2, 0))
    np.testing.assert_allclose(pressure(x, load, CYLINDER), ellipse, rtol=1e-13, atol=1e-3)


@settings(max_examples=80, deadline=None)
@given(load=st.floats(1e-3, 1e9), flat=st.floats(1e-7, 1e-1), radius=st.floats(1e-5, 1.0))
def test_width_solves_equation_6_5(load, flat, radius):
    punch = Punch(**(BODY | {"edge_radius": radius}), flat_half_width=flat)
    b = float(contact_half_width(np.array(load), punch))
    assert b >= flat
    if b > 1.001 * flat:
        phi0 = np.arcsin(flat / b)
        right = (np.pi - 2 * phi0) / (2 * np.sin(phi0) ** 2) - 1 / np.tan(phi0)
        left = 2 * load * radius / (flat**2 * punch.contact_modulus)
        assert right == pytest.approx(left, rel=1e-8)


def test_width_of_a_light_load_follows_the_leading_term():
    """u^3 2/3 = 2PR/(a^2 E*) for u -> 0: the direct form would be rounding noise there."""
    load = np.array([1e-2])
    target = 2 * load * 2.5e-3 / (FLANK.flat_half_width**2 * FLANK.contact_modulus)
    expected = FLANK.flat_half_width * 0.5 * np.cbrt(1.5 * target) ** 2
    grown = contact_half_width(load, FLANK) - FLANK.flat_half_width
    np.testing.assert_allclose(grown, expected, rtol=1e-5)


@pytest.mark.parametrize("share", [0.1, 0.6, 0.95, 1.0])
def test_shear_integrates_to_the_tangential_load(share):
    load = np.array(3.26e5)
    across = share * FLANK.friction * load
    b = float(contact_half_width(load, FLANK))
    c = float(stick_half_width(load, across, FLANK))
    edges = np.arcsin(np.array([0.0, FLANK.flat_half_width, c, b]) / b)
    angle, weight = panel_rule(edges)
    x = b * np.sin(angle)
    total = 2 * np.sum(weight * b * np.cos(angle) * shear(x, load, across, FLANK))
    assert total == pytest.approx(across, rel=1e-12)


def test_shear_obeys_friction_and_reaches_it_only_where_it_slips():
    load = np.array(3.26e5)
    across = 0.7 * FLANK.friction * load
    b = float(contact_half_width(load, FLANK))
    c = float(stick_half_width(load, across, FLANK))
    x = np.linspace(0, b, 401)[:-1]
    ratio = shear(x, load, across, FLANK) / (FLANK.friction * pressure(x, load, FLANK))
    assert FLANK.flat_half_width < c < b
    assert np.all(ratio[x < 0.999 * c] < 1.0)
    np.testing.assert_allclose(ratio[x > c], 1.0)


def test_full_sliding_leaves_the_flat_as_the_last_stick():
    load = np.array(3.26e5)
    c = stick_half_width(load, FLANK.friction * load, FLANK)
    assert float(c) == pytest.approx(FLANK.flat_half_width, rel=1e-12)


def test_impossible_loads_and_geometry_are_refused():
    with pytest.raises(ValueError, match="friction times"):
        shear(np.array(0.0), np.array(1.0), np.array(0.43), FLANK)
    with pytest.raises(ValueError, match="must not be negative"):
        contact_half_width(np.array(-1.0), FLANK)
    with pytest.raises(ValueError, match="edge_radius must be positive"):
        Punch(**(BODY | {"edge_radius": 0.0}), flat_half_width=1e-3)
    with pytest.raises(ValueError, match=r"missing .*flank_angle"):
        punch_from(BODY)
