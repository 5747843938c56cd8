import dataclasses

import numpy as np
import pytest
import xarray as xr
from bladeroot.rom import chebyshev
from bladeroot.rom import joint as joint_module
from bladeroot.rom.assembly import assemble, find_modes
from bladeroot.rom.changed import changed_frequencies
from bladeroot.rom.greedy import error_bound
from bladeroot.rom.joint import (
    bonded_modes,
    exact_modes,
    joint_of,
    joint_of_reduced,
    stiffness_at,
)
from bladeroot.rom.parametric import (
    frequencies,
    ln_frequencies,
    ritz_of,
    surface_of,
)
from bladeroot.rom.parametric_build import parametric_model
from bladeroot.rom.reduction import reduce_structure
from bladeroot.rom.ritz import frequency, solve
from bladeroot.rom.sensitivity import Change, motion, scaled
from stiffness_beam import beam_joint
from structure_coarse import coarse_loaded

MODES = ("1B", "2B")
SCALES = ("beam_stiffness", "slot_stiffness", "beam_mass", "slot_mass")


@pytest.fixture(scope="module")
def reduced():
    return reduce_structure(*coarse_loaded())


@pytest.fixture(scope="module")
def joint(reduced):
    return joint_of_reduced(reduced)


@pytest.fixture(scope="module")
def model(joint):
    return parametric_model(joint)


@pytest.fixture(scope="module")
def points(model):
    """Random points of the box, its corners among them."""
    low, high = model["box"].values
    drawn = np.random.default_rng(11).uniform(low, high, (16, 3))
    drawn[:8] = np.stack(np.meshgrid(*zip(low, high, strict=True)), axis=-1).reshape(-1, 3)
    return drawn


@pytest.fixture(scope="module")
def exact(joint, points):
    return np.array([frequency(exact_modes(joint, p, MODES).values) for p in points])


def inner_points(model, count=5):
    low, high = model["box"].values
    margin = 0.1 * (high - low)
    return np.random.default_rng(12).uniform(low + margin, high - margin, (count, 3))


def test_affine_operator_is_the_assembly_at_every_force(reduced, joint):
    there = assemble(reduced, 17e3)
    at_17_kn = joint_of(there)
    point = np.array([20.0, 22.0, 17e3])
    expected = stiffness_at(at_17_kn, np.array([20.0, 22.0, 0.0]))
    np.testing.assert_allclose(stiffness_at(joint, point), expected, rtol=1e-12, atol=1e-3)


def test_true_error_stays_below_the_bound_and_the_tolerance(model, points, exact):
    f = frequencies(surface_of(model), points)
    assert np.abs(f / exact - 1.0).max() < 1e-7
    assert np.all(np.abs(f / exact - 1.0).max(axis=0) < model["error_bound"].values)
    for m, mode in enumerate(MODES):
        ritz = ritz_of(model, mode)
        bound = error_bound(ritz, points)
        error = frequency(solve(ritz, points).value) / exact[:, m] - 1.0
        assert np.all(np.abs(error) <= bound)
        assert bound.max() < 1e-7
        assert error.min() > -1e-11  # frequencies of a basis come from above


def test_bound_holds_where_it_is_large(joint, points, exact):
    """A basis of a loose tolerance errs visibly, and the bound still covers it, not wildly."""
    loose = parametric_model(joint, tolerance=1e-3)
    for m, mode in enumerate(MODES):
        ritz = ritz_of(loose, mode)
        error = frequency(solve(ritz, points).value) / exact[:, m] - 1.0
        bound = error_bound(ritz, points)
        assert error.max() > 1e-6
        assert np.all(np.abs(error) <= bound)
        assert np.median(bound / np.maximum(error, 1e-12)) < 300


def test_own_check_is_honest(model, joint):
    f = frequencies(surface_of(model), model["check_point"].values).T
    np.testing.assert_allclose(f / model["check_frequency"] - 1.0, model["check_error"], atol=1e-13)
    again = exact_modes(joint, model["check_point"].values[2], MODES)
    np.testing.assert_allclose(
        frequency(again.values), model["check_frequency"].values[:, 2], rtol=1e-11
    )


def test_frequencies_rise_with_both_stiffnesses(model):
    low, high = model["box"].values
    drawn = np.random.default_rng(13).uniform(low, high, (2000, 3))
    _, gradient = ln_frequencies(surface_of(model), drawn)
    assert np.all(gradient[..., :2] > 0.0)


def test_stiff_contact_tends_to_bonded(model, joint):
    high = model["box"].values[1]
    bonded = frequency(bonded_modes(joint, high[2], MODES).values)
    steps = np.array([high - [shift, shift, 0.0] for shift in (np.log(10.0), 0.0)])
    gap = bonded - frequencies(surface_of(model), steps)
    assert np.all(gap > 0.0)
    assert np.all((gap[0] / gap[1] > 7.0) & (gap[0] / gap[1] < 10.0))
    stiffer = frequency(exact_modes(joint, high + 5.0 * np.array([1, 1, 0]), MODES).values)
    np.testing.assert_allclose(stiffer, bonded, rtol=1e-4)


def test_soft_contact_tends_to_a_rigid_body_on_springs(reduced, joint):
    """Flanks at 45 degrees: 2 (kn + kt) lifts the whole beam: the even mode in Z."""
    mass = reduced["beam_mass"].values
    lift = np.zeros(len(mass))
    lift[2 : 3 * reduced.sizes["pair"] : 3] = 1.0
    found = exact_modes(joint, np.array([np.log(30.0), np.log(8.0), 0.0]), ["1B"]).values
    np.testing.assert_allclose(found, 2.0 * 38.0 / (lift @ mass @ lift), rtol=1e-4)


def test_gradient_agrees_with_differences_of_exact_solutions(model, joint):
    points = inner_points(model)
    ln_f, slope = ln_frequencies(surface_of(model), points)
    gradient = np.exp(ln_f)[..., None] * slope
    for axis, step in enumerate((0.02, 0.02, 300.0)):
        move = step * np.eye(3)[axis]
        f = [
            np.array([frequency(exact_modes(joint, p + n * move, MODES).values) for p in points])
            for n in (-1, 1)
        ]
        rise = (f[1] - f[0]) / (2 * step)
        np.testing.assert_allclose(gradient[:, :, axis], rise, rtol=1e-3, atol=1e-5 / step * 0.02)


def added_mass(ritz, x):
    """1 kg on the display line at x (m), moving with it."""
    rows = motion(ritz, x)
    return Change(np.zeros_like(ritz.beam), rows.T @ rows)


def altered(joint, part, amount):
    """The joint with one part scaled, or with a mass (kg) on one of its display nodes."""
    mass, stiffness = joint.mass.copy(), joint.stiffness.copy()
    n = joint.beam_dofs
    if part in SCALES:
        place = slice(0, n) if part.startswith("beam") else slice(n, None)
        (stiffness if part.endswith("stiffness") else mass)[place, place] *= 1.0 + amount
    else:
        rows = joint.assembly["display_shape"].values[int(part)]
        mass += amount * rows.T @ rows
    return dataclasses.replace(joint, mass=mass, stiffness=stiffness)


@pytest.mark.parametrize("part", [*SCALES, "0", "4"])
def test_perturbations_agree_with_a_joint_that_has_them(model, joint, part):
    points = inner_points(model, 3)
    amount = 0.02 if part in SCALES else 0.002
    x = None if part in SCALES else joint.assembly["display_position"].values[int(part), 0]
    changed = altered(joint, part, amount)
    for m, mode in enumerate(MODES):
        ritz = ritz_of(model, mode)
        change = scaled(ritz, part) if x is None else added_mass(ritz, x)
        expected = [frequency(exact_modes(changed, p, MODES).values)[m] for p in points]
        finite = changed_frequencies(ritz, points, [change], np.full((len(points), 1), amount))
        np.testing.assert_allclose(finite, expected, rtol=2e-6)


def test_further_modes_are_followed_among_those_they_mix_with():
    joint = beam_joint()
    both = parametric_model(joint, ["3B", "1L"])
    assert int(both["rank"].sel(mode="3B")) >= 1  # 1B is as even as 3B
    low, high = both["box"].values
    points = np.random.default_rng(5).uniform(low, high, (12, 3))
    truth = [frequency(exact_modes(joint, p, ["3B", "1L"]).values) for p in points]
    found = frequencies(surface_of(both), points)
    assert np.all(np.abs(found / truth - 1.0) < both["error_bound"].values)
    assert float(both["error_bound"].max()) < 2e-7


def test_equal_nodes_differ_from_area_weights():
    equal = parametric_model(beam_joint(equal_nodes=True))
    assert equal.attrs["springs"] == "equal at every node"
    points = np.array([[21.0, 22.0, 12e3]])
    by_area = frequencies(surface_of(parametric_model(beam_joint())), points)
    assert np.abs(frequencies(surface_of(equal), points) - by_area).max() > 1e-3


def test_model_is_the_same_at_every_run_and_survives_netcdf(tmp_path):
    model = parametric_model(beam_joint())
    xr.testing.assert_identical(parametric_model(beam_joint()), model)
    model.to_netcdf(tmp_path / "parametric.nc")
    with xr.open_dataset(tmp_path / "parametric.nc") as again:
        points = np.array([[20.0, 25.0, 3e3]])
        np.testing.assert_array_equal(
            frequencies(surface_of(again), points), frequencies(surface_of(model), points)
        )
        assert error_bound(ritz_of(again, "2B"), points) < 1e-7
    for name, variable in model.data_vars.items():
        assert {"units", "long_name"} <= set(variable.attrs), name


def test_bad_input_is_one_line():
    joint = beam_joint()
    with pytest.raises(ValueError, match="stiffness must be 0 < low < high"):
        parametric_model(joint, stiffness=(1e9, 1e8))
    with pytest.raises(ValueError, match="load must be low < high"):
        parametric_model(joint, force=(2e3, 2e3))
    with pytest.raises(ValueError, match="number and B, L or T, got 'X1'"):
        parametric_model(joint, ["X1"])
    with pytest.raises(ValueError, match="must be stable"):
        parametric_model(joint, force=(-3e6, 0.0))
    with pytest.raises(ValueError, match="must lie on the display line"):
        added_mass(ritz_of(parametric_model(joint), "1B"), 2.0)
    with pytest.raises(ValueError, match="a scaled part must be one of"):
        scaled(ritz_of(parametric_model(joint), "1B"), "pad")
    with pytest.raises(ValueError, match=r"has modes .*, not 3B"):
        ritz_of(parametric_model(joint), "3B")


def test_swapped_modes_are_refused(monkeypatch):
    """A finder that jumps to the next mode at some points must not pass."""
    calls = []

    def jumps(assembly, shapes, names):
        calls.append(1)
        column = find_modes(assembly, shapes, ("1B", "2B"))
        return {"1B": column["2B"]} if len(calls) < 3 else {"1B": column["1B"]}

    monkeypatch.setattr(joint_module, "find_modes", jumps)
    with pytest.raises(ValueError, match="mode 1B is not followed through the box"):
        parametric_model(beam_joint(), ["1B"])


def test_surface_is_a_cut_of_the_model(model, points):
    surface = surface_of(model)
    cut = chebyshev.at_force(surface, 9e3)
    here = np.column_stack([points[:, :2], np.full(len(points), 9e3)])
    np.testing.assert_allclose(frequencies(cut, here), frequencies(surface, here), rtol=1e-12)
