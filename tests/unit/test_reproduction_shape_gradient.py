import numpy as np
import pytest
from bladeroot.fem.geometry import structure_from_mapping
from bladeroot.reproduction.cases import RIGID, Case, build_model, solve_modes
from bladeroot.reproduction.shape_gradient import adjoints, lagrangian
from structure_coarse import coarse_data

CASES = {
    "free": (Case(True), "2Fy"),
    "stretched": (Case(True, force=30e3), "1Fy"),
    "rotating": (Case(True, force=30e3), "Ry"),
    "fixed": (Case(True, kn=RIGID, kt=RIGID), "1Fy"),
    "joined": (Case(True, 12e3, 1.4e9, 2.1e9, slots=True), "2B"),
}


def moved(step):
    """Neck, flank's height and tip moved together (mm), the modulus with them (GPa)."""
    data = coarse_data()
    profile = data["beam"]["profile_mm"]
    for point in (3, 4):
        profile[point][1] += step
    for point in (5, 6, 7, 8):
        profile[point][1] += 0.5 * step
    profile[8][0] += step
    data["material"]["young_modulus_GPa"] += 3.0 * step
    return structure_from_mapping(data)


@pytest.fixture(scope="module")
def solved():
    model = build_model(moved(0.0), True)
    return model, solve_modes(model, list(CASES.values()))


def test_derivatives_are_those_of_solving_again(solved):
    model, modes = solved
    listed = [modes[key] for key in CASES.values()]
    static = model.prestress.displacement.values
    adjoint = adjoints(model, listed)
    base = lagrangian(moved(0.0), True, listed, static, adjoint)
    slopes = (lagrangian(moved(1e-6), True, listed, static, adjoint) - base) / 1e-6
    again = [build_model(moved(step), True) for step in (0.02, -0.02)]
    high, low = (solve_modes(one, list(CASES.values())) for one in again)
    for key, slope in zip(CASES.values(), slopes, strict=True):
        solved_again = (high[key].value - low[key].value) / 0.04
        assert slope == pytest.approx(solved_again, rel=3e-3), key


def test_the_static_stress_matters_to_a_stretched_mode(solved):
    model, modes = solved
    listed = [modes[CASES["stretched"]], modes[CASES["free"]]]
    found = adjoints(model, listed)
    assert np.abs(found[0]).max() > 0
    np.testing.assert_array_equal(found[1], 0.0)


def test_another_layout_is_refused(solved):
    model, modes = solved
    listed = [modes[CASES["free"]]]
    data = coarse_data()
    data["mesh"]["root_element_mm"] = 5
    with pytest.raises(ValueError, match="another number of elements"):
        lagrangian(
            structure_from_mapping(data),
            True,
            listed,
            model.prestress.displacement.values,
            adjoints(model, listed),
        )


def test_a_missing_mode_is_named(solved):
    with pytest.raises(ValueError, match="no mode 9Fy"):
        solve_modes(solved[0], [(Case(True), "9Fy")])
