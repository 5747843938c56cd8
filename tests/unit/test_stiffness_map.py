import numpy as np
import pytest
from bladeroot.rom.assembly import find_modes
from bladeroot.rom.parametric_build import parametric_model
from bladeroot.stiffness.map import frequency_map
from bladeroot.stiffness.surface import all_frequencies, surface_of_map
from dense_joint import assembly_modes
from stiffness_beam import beam_assembly, beam_joint, beam_map


@pytest.fixture(scope="module")
def assembly():
    return beam_assembly()


@pytest.fixture(scope="module")
def drawn():
    return beam_map()


def exact(assembly, kn, kt):
    f, shapes = assembly_modes(assembly, kn, kt, count=40)
    column = find_modes(assembly, shapes)
    return np.array([f[column["1B"]], f[column["2B"]]])


def test_map_agrees_with_the_whole_problem(assembly, drawn):
    k = np.exp(np.random.default_rng(1).uniform(*np.log([1e8, 1e12]), (12, 2)))
    found, _ = all_frequencies(surface_of_map(drawn), np.log(k))
    truth = np.array([exact(assembly, *pair) for pair in k])
    np.testing.assert_allclose(found, truth, rtol=1e-7)


def test_own_check_is_honest(assembly, drawn):
    k = np.column_stack([drawn["check_kn"].values, drawn["check_kt"].values])
    np.testing.assert_allclose(
        drawn["check_frequency"].values[:, 2], exact(assembly, *k[2]), rtol=1e-7
    )
    found, _ = all_frequencies(surface_of_map(drawn), np.log(k))
    error = found.T / drawn["check_frequency"].values - 1
    np.testing.assert_allclose(drawn["check_error"], error, atol=1e-12)
    assert np.abs(error).max() == pytest.approx(drawn.attrs["largest_relative_error"], abs=1e-12)
    assert 0 < drawn.attrs["largest_relative_error"] <= drawn.attrs["error_bound"] < 1e-6


def test_grid_is_the_model_on_its_axes(drawn):
    kn, kt = drawn["map_kn"].values[17], drawn["map_kt"].values[42]
    f, _ = all_frequencies(surface_of_map(drawn), np.log(np.array([[kn, kt]])))
    np.testing.assert_allclose(drawn["map_frequency"].values[:, 17, 42], f[0], rtol=1e-12)


def test_what_does_not_fit_together_is_refused(assembly):
    model = parametric_model(beam_joint())
    with pytest.raises(ValueError, match="axial force must lie between 0 and 30000, got 40000"):
        frequency_map(model, beam_assembly(40e3))
    with pytest.raises(ValueError, match="must be of one structure, got beam and other"):
        frequency_map(model, assembly.assign_attrs(structure="other"))
    with pytest.raises(ValueError, match=r"it lacks \{'1B'\}"):
        frequency_map(model.sel(mode=["2B"]), assembly)
