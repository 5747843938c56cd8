"""The clamped beam of appendix B against its printed table and against finite differences."""

import numpy as np
import pytest
from bladeroot.fem.clamped_beam import beam_frequency, stiffening_factor, wave_number


def shape(mode, z):
    root = wave_number(mode)
    ratio = (np.sinh(root) - np.sin(root)) / (np.cosh(root) - np.cos(root))
    return np.sinh(root * z) - np.sin(root * z) - ratio * (np.cosh(root * z) - np.cos(root * z))


def test_wave_numbers_as_printed():
    assert wave_number(1) == pytest.approx(4.730, abs=5e-4)
    assert wave_number(2) == pytest.approx(7.853, abs=5e-4)


@pytest.mark.parametrize("mode", [1, 2, 3])
def test_the_stiffening_factor_is_the_ratio_of_the_integrals(mode):
    z = np.linspace(0.0, 1.0, 20001)
    x = shape(mode, z)
    ratio = np.trapezoid(np.gradient(x, z) ** 2, z) / np.trapezoid(x**2, z)
    assert stiffening_factor(mode) == pytest.approx(ratio, rel=1e-5)


def test_the_beam_without_force():
    value = beam_frequency(0.0, 1, 0.3, 400.0, 2.0)
    expected = (wave_number(1) / 0.3) ** 2 * np.sqrt(400.0 / 2.0) / (2 * np.pi)
    assert value == pytest.approx(expected, rel=1e-14)


def test_no_mode_before_the_first():
    with pytest.raises(ValueError, match="mode must be 1 or more"):
        wave_number(0)
