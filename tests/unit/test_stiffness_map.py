import numpy as np
import pytest
import xarray as xr
from bladeroot.stiffness.map import all_frequencies, bases_of, frequency_map
from bladeroot.structure.assembly import assembly_modes, find_bending
from stiffness_beam import beam_assembly


@pytest.fixture(scope="module")
def assembly():
    return beam_assembly()


@pytest.fixture(scope="module")
def drawn(assembly):
    return frequency_map(assembly)


def exact(assembly, kn, kt):
    f, shapes = assembly_modes(assembly, kn, kt, count=40)
    column = find_bending(assembly, shapes)
    return np.array([f[column["1B"]], f[column["2B"]]])


def test_map_agrees_with_the_whole_problem(assembly, drawn):
    k = np.exp(np.random.default_rng(1).uniform(*np.log([1e8, 1e12]), (12, 2)))
    found, _ = all_frequencies(bases_of(drawn), np.log(k))
    truth = np.array([exact(assembly, *pair) for pair in k])
    np.testing.assert_allclose(found, truth, rtol=1e-6)


def test_own_check_is_honest(assembly, drawn):
    k = np.column_stack([drawn["check_kn"].values, drawn["check_kt"].values])
    np.testing.assert_allclose(
        drawn["check_frequency"].values[:, 2], exact(assembly, *k[2]), rtol=1e-7
    )
    found, _ = all_frequencies(bases_of(drawn), np.log(k))
    error = found.T / drawn["check_frequency"].values - 1
    np.testing.assert_allclose(drawn["check_error"], error, atol=1e-12)
    assert np.abs(error).max() == pytest.approx(drawn.attrs["largest_relative_error"], abs=1e-12)
    assert 0 < drawn.attrs["largest_relative_error"] < 1e-6


def test_gradient_agrees_with_finite_differences(drawn):
    bases = bases_of(drawn)
    points = np.log(np.array([[1.4e9, 2e9], [2e8, 6e10], [5e11, 3e8], [1e8, 1e8]]))
    _, gradient = all_frequencies(bases, points)
    step = 1e-2  # wide enough for stiff contact, where rounding is 1e-9 of the frequency
    for i in range(2):
        move = step * np.eye(2)[i]
        f = [all_frequencies(bases, points + n * move)[0] for n in (-2, -1, 1, 2)]
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


def test_grid_is_the_basis_on_its_axes(drawn):
    kn, kt = drawn["map_kn"].values[17], drawn["map_kt"].values[42]
    f, _ = all_frequencies(bases_of(drawn), np.log(np.array([[kn, kt]])))
    np.testing.assert_allclose(drawn["map_frequency"].values[:, 17, 42], f[0], rtol=1e-12)


def test_equal_nodes_differ_from_area_weights(assembly, drawn):
    equal = frequency_map(assembly, equal_nodes=True)
    assert equal.attrs["springs"] == "equal at every node"
    assert np.abs(equal["map_frequency"] - drawn["map_frequency"]).max() > 1e-3
    even = assembly.assign(weight=0.0 * assembly["weight"] + 0.5)
    xr.testing.assert_allclose(frequency_map(even)["map_frequency"], equal["map_frequency"])


def test_tension_raises_the_map(drawn):
    pulled = frequency_map(beam_assembly(22e3))
    assert pulled.attrs["axial_force"] == 22e3
    assert np.all(pulled["map_frequency"] > drawn["map_frequency"])


def test_map_is_the_same_at_every_run_and_survives_netcdf(assembly, drawn, tmp_path):
    xr.testing.assert_identical(frequency_map(assembly), drawn)
    drawn.to_netcdf(tmp_path / "map.nc")
    with xr.open_dataset(tmp_path / "map.nc") as again:
        assert bases_of(again.load())[1].normal.shape == bases_of(drawn)[1].normal.shape
    for name, variable in drawn.data_vars.items():
        assert {"units", "long_name"} <= set(variable.attrs), name


def test_box_and_modes_are_checked(assembly):
    with pytest.raises(ValueError, match="0 < low < high"):
        frequency_map(assembly, box=(1e9, 1e8))
    with pytest.raises(ValueError, match="at least 4 samples"):
        frequency_map(assembly, samples=3)
    blind = assembly.assign(display_shape=0.0 * assembly["display_shape"])
    with pytest.raises(ValueError, match="no mode"):
        frequency_map(blind)


def test_swapped_modes_are_refused(assembly, monkeypatch):
    """A finder that jumps to the next mode once contact is stiff must not pass."""
    from bladeroot.stiffness import map as module

    calls = []

    def jumps(assembly, shapes):
        calls.append(1)
        column = find_bending(assembly, shapes)
        return column | {"1B": column["2B"]} if len(calls) < 3 else column

    monkeypatch.setattr(module, "find_bending", jumps)
    with pytest.raises(ValueError, match="mode 1B is not followed"):
        frequency_map(assembly)
