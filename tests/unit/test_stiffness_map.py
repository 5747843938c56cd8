import numpy as np
import pytest
import xarray as xr
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


def test_gradient_agrees_with_finite_differences(drawn):
    surface = surface_of_map(drawn)
    points = np.log(np.array([[1.4e9, 2e9], [2e8, 6e10], [5e11, 3e8], [1.1e8, 1.1e8]]))
    _, gradient = all_frequencies(surface, points)
    step = 1e-2  # wide enough for stiff contact, where rounding is 1e-9 of the frequency
    for i in range(2):
        move = step * np.eye(2)[i]
        f = [all_frequencies(surface, points + n * move)[0] for n in (-2, -1, 1, 2)]
        rise = (f[0] - 8 * f[1] + 8 * f[2] - f[3]) / (12 * step)
        np.testing.assert_allclose(gradient[:, :, i], rise, rtol=1e-4, atol=3e-4)


def test_map_rises_everywhere_and_stays_below_bonded_contact(drawn):
    f = drawn["map_frequency"].values
    assert np.all(np.diff(f, axis=1) > 0)
    assert np.all(np.diff(f, axis=2) > 0)
    bonded = drawn["bonded_frequency"].values
    assert np.all(f.max(axis=(1, 2)) < bonded)
    np.testing.assert_allclose(f.max(axis=(1, 2)), bonded, rtol=1e-3)


def test_bonded_frequency_is_the_limit(assembly, drawn):
    gap = [drawn["bonded_frequency"].values - exact(assembly, k, k) for k in (1e11, 1e12)]
    np.testing.assert_allclose(gap[0] / gap[1], 10, rtol=0.02)


def test_grid_is_the_model_on_its_axes(drawn):
    kn, kt = drawn["map_kn"].values[17], drawn["map_kt"].values[42]
    f, _ = all_frequencies(surface_of_map(drawn), np.log(np.array([[kn, kt]])))
    np.testing.assert_allclose(drawn["map_frequency"].values[:, 17, 42], f[0], rtol=1e-12)


def test_equal_nodes_differ_from_area_weights(drawn):
    equal = beam_map(equal_nodes=True)
    assert equal.attrs["springs"] == "equal at every node"
    assert np.abs(equal["map_frequency"] - drawn["map_frequency"]).max() > 1e-3
    assert equal.attrs["largest_relative_error"] < 1e-7


def test_tension_raises_the_map(drawn):
    pulled = beam_map(22e3)
    assert pulled.attrs["axial_force"] == 22e3
    assert np.all(pulled["map_frequency"] > drawn["map_frequency"])


def test_map_is_the_same_at_every_run_and_survives_netcdf(drawn, tmp_path):
    xr.testing.assert_identical(beam_map(), drawn)
    drawn.to_netcdf(tmp_path / "map.nc")
    with xr.open_dataset(tmp_path / "map.nc") as again:
        back, surface = surface_of_map(again.load()), surface_of_map(drawn)
        np.testing.assert_array_equal(back.coefficients, surface.coefficients)
    for name, variable in drawn.data_vars.items():
        assert {"units", "long_name"} <= set(variable.attrs), name


def test_what_does_not_fit_together_is_refused(assembly):
    model = parametric_model(beam_joint())
    with pytest.raises(ValueError, match="axial force must lie between 0 and 30000, got 40000"):
        frequency_map(model, beam_assembly(40e3))
    with pytest.raises(ValueError, match="must be of one structure, got beam and other"):
        frequency_map(model, assembly.assign_attrs(structure="other"))
    with pytest.raises(ValueError, match=r"it lacks \{'1B'\}"):
        frequency_map(model.sel(mode=["2B"]), assembly)
