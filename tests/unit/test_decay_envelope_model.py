"""Envelopes of all components at once, against the same least squares with plain matrices."""

import numpy as np
import pytest
from bladeroot.decay.envelope_model import SPLINES_ALIVE, _splines, _stiffness, demodulated

RATE, SPACING, SAMPLES = 100.0, 20, 205
LINES = np.array([7.0, 19.0])
KNOTS = -(-SAMPLES // SPACING) + SPLINES_ALIVE - 1
COLUMNS = 2 * LINES.size + 1


def plain(course, base_Hz):
    """Design and penalty, as plain matrices."""
    time = np.arange(SAMPLES) / RATE
    carriers = [np.ones(SAMPLES)]
    for line in LINES:
        carriers += [np.cos(2 * np.pi * line * time), -np.sin(2 * np.pi * line * time)]
    design = np.zeros((SAMPLES, KNOTS, COLUMNS))
    for k in range(SAMPLES):
        first = k // SPACING
        weights = _splines(SPACING)[k % SPACING]
        design[k, first : first + SPLINES_ALIVE] = weights[:, None] * np.array(carriers)[:, k]
    stiffness = _stiffness(LINES, SPACING, RATE, base_Hz)
    ratio = np.exp(-course)
    rows = []
    for j in range(KNOTS - 3):
        row = np.zeros((KNOTS, COLUMNS))
        row[j : j + 4, 0] = np.sqrt(stiffness[0]) * np.array([-1.0, 3.0, -3.0, 1.0])
        rows.append(row.ravel())
        for line in range(LINES.size):
            z = np.array([-1.0, 3.0, -3.0, 1.0]) * ratio[line, j : j + 4]
            z = z * np.sqrt(stiffness[1 + 2 * line] / abs(ratio[line, j + 1] * ratio[line, j + 2]))
            for real, imaginary in ((z.real, -z.imag), (z.imag, z.real)):
                row = np.zeros((KNOTS, COLUMNS))
                row[j : j + 4, 1 + 2 * line], row[j : j + 4, 2 + 2 * line] = real, imaginary
                rows.append(row.ravel())
    penalty = np.array(rows)
    return design.reshape(SAMPLES, -1), penalty.T @ penalty


def test_coefficients_waves_and_variances_are_those_of_least_squares():
    rng = np.random.default_rng(0)
    velocity = rng.standard_normal(SAMPLES)
    course = 0.3 * rng.standard_normal((2, KNOTS)) + 1j * rng.standard_normal((2, KNOTS))
    found = demodulated(velocity, RATE, LINES, SPACING, 1.0, course)
    design, penalty = plain(course, 1.0)
    inverse = np.linalg.inv(design.T @ design + penalty)
    expected = inverse @ design.T @ velocity
    np.testing.assert_allclose(found.coefficient.ravel(), expected, rtol=1e-7, atol=1e-9)
    np.testing.assert_allclose(found.waves(), design @ expected, atol=1e-9)
    middle = np.array([1.0, 23.0, 23.0, 1.0]) / 48.0
    for line in range(LINES.size):
        variance = found.variance(line)
        for k in (0, 5, len(variance) - 1):
            parts = []
            for part in (0, 1):
                row = np.zeros((KNOTS, COLUMNS))
                row[k : k + SPLINES_ALIVE, 1 + 2 * line + part] = middle
                parts.append(row.ravel() @ inverse @ row.ravel())
            assert variance[k] == pytest.approx(max(parts), rel=1e-6)


def test_what_is_known_of_a_course_is_free_of_penalty():
    """A decay that the penalty would bend comes out as it is once its course is given."""
    rate, spacing, lines = 1000.0, 40, np.array([50.0, 58.0])
    time = np.arange(2000) / rate
    waves = [
        np.exp(-9.0 * time) * np.cos(2 * np.pi * 50.0 * time),
        0.5 * np.exp(-4.0 * time) * np.cos(2 * np.pi * 58.0 * time + 1.0),
    ]
    intervals = 2000 // spacing
    knot = (np.arange(intervals + SPLINES_ALIVE - 1) - 1.0) * spacing / rate
    course = np.array([-9.0 * knot, -4.0 * knot]).astype(complex)
    missed = []
    for known in (None, course):
        found = demodulated(sum(waves), rate, lines, spacing, 0.0, known)
        missed.append(np.abs(found.waves([0], base=False) - waves[0]))
    assert missed[0].max() > 0.05
    assert missed[1].max() < 1e-3


def test_a_mode_is_less_sure_at_an_end_and_beside_a_near_line():
    velocity = np.random.default_rng(1).standard_normal(4000)
    own = np.array([50.0])
    for line, least, most in ((60.0, 1.2, 2.0), (150.0, 1.0, 1.1)):
        both = demodulated(velocity, 1000.0, np.array([50.0, line]), 40)
        alone = demodulated(velocity, 1000.0, own, 40, 0.0, None, np.array([line]))
        ratio = np.sqrt(both.variance(0) / alone.variance(0))
        assert least < ratio[0] < most
        assert ratio[ratio.size // 2] == pytest.approx(1.0, abs=0.01)
