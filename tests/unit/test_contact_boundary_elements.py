"""Boundary elements against Hertz, Mindlin, and the closed forms of chapter 6."""

import numpy as np
import pytest
from bladeroot.contact.compliance import normal_stiffness, tangential_stiffness
from bladeroot.contact.punch import (
    Punch,
    contact_half_width,
    pressure,
    shear,
    stick_half_width,
)
from boundary_elements import _held, _strip, line_pressure, rectangle_stiffness

STEEL = {"length": 26e-3, "youngs_modulus": 206e9, "poisson_ratio": 0.3, "friction": 0.42}
FLANK = Punch(flat_half_width=0.8e-3, edge_radius=20e-3, **STEEL)
HERTZ = Punch(flat_half_width=0.0, edge_radius=20e-3, **STEEL)


@pytest.mark.parametrize("punch", [FLANK, HERTZ])
@pytest.mark.parametrize("load", [1e5, 6e5])
def test_pressure_and_width_of_the_punch(punch, load):
    b = float(contact_half_width(load, punch))
    x, p = line_pressure(load, punch, 1.4 * b)
    cell = x[1] - x[0]
    assert np.sum(p) * cell == pytest.approx(load, rel=1e-12)
    assert np.abs(x[p > 0]).max() + 0.5 * cell == pytest.approx(b, abs=1.01 * cell)
    inner = np.abs(np.abs(x) - punch.flat_half_width) > 4 * cell
    inner &= np.abs(x) < b - 4 * cell
    assert np.abs(p - pressure(x, load, punch))[inner].max() < 0.01 * p.max()


def test_the_pressure_converges_with_the_cells():
    load, miss = 4e5, []
    b = float(contact_half_width(load, HERTZ))
    for cells in (100, 200, 400):
        x, p = line_pressure(load, HERTZ, 1.5 * b, cells)
        inner = np.abs(x) < 0.9 * b
        miss.append(np.abs(p - pressure(x, load, HERTZ))[inner].max())
    assert miss[2] < 0.6 * miss[0]


def line_shear(position, pressure, shear_load, punch):
    """Shear (Pa) under a monotonic Q = `shear_load` (N/m) after the pressure of `line_pressure`.

    Cells in contact move together until their shear reaches mu p; there it stays (6.1, 6.2).
    """
    width = position[1] - position[0]
    _, influence = _strip(position[-1] + 0.5 * width, position.size, punch)
    limit = punch.friction * pressure
    stuck = pressure > 0.0
    for _ in range(200):
        slipping = np.where(stuck, 0.0, limit)
        rest = shear_load / width - slipping.sum()
        value, _ = _held(influence, stuck, -(influence @ slipping), rest)
        over = stuck & (value > limit)
        if not over.any():
            break
        stuck &= ~over
    return value + slipping


@pytest.mark.parametrize("punch", [FLANK, HERTZ])
@pytest.mark.parametrize("ratio", [0.3, 0.8])
def test_shear_and_stick_width(punch, ratio):
    load = 4e5
    b = float(contact_half_width(load, punch))
    x, p = line_pressure(load, punch, 1.4 * b)
    cell = x[1] - x[0]
    across = ratio * punch.friction * load
    q = line_shear(x, p, across, punch)
    assert np.sum(q) * cell == pytest.approx(across, rel=1e-9)
    assert (q <= punch.friction * p * (1 + 1e-12)).all()
    stuck = np.abs(x[(p > 0) & (q < punch.friction * p * (1 - 1e-9))]).max() + 0.5 * cell
    assert stuck == pytest.approx(float(stick_half_width(load, across, punch)), abs=2.5 * cell)
    exact = shear(x, load, across, punch)
    smooth = np.abs(np.abs(x) - punch.flat_half_width) > 6 * cell
    smooth &= np.abs(np.abs(x) - stuck) > 6 * cell
    assert np.abs(q - exact)[smooth].max() < 0.03 * q.max()


def test_a_square_is_as_stiff_as_known():
    # the pressure under a rigid plate is the charge on a conducting one: a square of side a
    # holds 0.3667896 a of it at unit potential (capacity of the square, 4 pi epsilon = 1)
    side, miss = 1e-3, []
    for cells in (8, 16, 32):
        k = rectangle_stiffness(0.5 * side, side, FLANK, cells=(cells, cells))
        miss.append(np.pi * 0.3667896 - k / (FLANK.contact_modulus * side))
    assert 0.0 < miss[2] < 4e-4
    assert miss[1] / miss[0] < 0.35
    assert miss[2] / miss[1] < 0.35


def test_without_lateral_contraction_both_directions_agree():
    cork = Punch(**{**vars(FLANK), "poisson_ratio": 0.0})
    stiffness = [
        rectangle_stiffness(1e-3, 20e-3, cork, direction, (8, 20))
        for direction in ("normal", "tangential")
    ]
    assert stiffness[0] == pytest.approx(stiffness[1], rel=1e-12)


@pytest.mark.parametrize(
    ("closed", "direction"), [(normal_stiffness, "normal"), (tangential_stiffness, "tangential")]
)
def test_a_long_contact_tends_to_the_closed_form(closed, direction):
    load, gaps = 3e5, []
    b = float(contact_half_width(load, FLANK))
    for length in (20.0, 200.0, 2000.0):
        punch = Punch(**{**vars(FLANK), "length": length * b})
        found = rectangle_stiffness(b, length * b, punch, direction, (10, 60))
        gaps.append(found / float(closed(np.array([load * punch.length]), punch)[0]) - 1.0)
    # constant along the length: the middle is softer than the mean, so theory is too soft
    assert 0.0 < gaps[2] < gaps[1] < gaps[0] < 0.2


def test_a_strip_that_is_too_narrow_is_refused():
    with pytest.raises(ValueError, match="wider than the strip"):
        line_pressure(6e5, FLANK, 0.7e-3)


def test_a_rigid_flank_of_the_thesis_is_a_tenth_stiffer_at_every_force():
    """It presses harder at its ends; the closed forms keep the pressure constant along it."""
    punch = Punch(flat_half_width=1.28325e-3, **STEEL | {"edge_radius": 2.5e-3})
    for axial in (4e3, 22e3):
        normal = np.array([axial / np.sqrt(2.0)])
        half = float(contact_half_width(normal / punch.length, punch)[0])
        for direction, closed in (
            ("normal", normal_stiffness),
            ("tangential", tangential_stiffness),
        ):
            ratio = rectangle_stiffness(half, punch.length, punch, direction, (8, 20)) / closed(
                normal, punch
            )
            assert ratio == pytest.approx(1.105, abs=0.01)
