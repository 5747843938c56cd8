import numpy as np
import pytest
import xarray as xr
from bladeroot.rom.chebyshev_fit import fit
from bladeroot.stiffness.grid_search import grid_search
from bladeroot.stiffness.interpolation import ForceGauge, fe_forces
from bladeroot.stiffness.roots import all_roots, nearest_point, newton
from bladeroot.stiffness.search import fit_modes, ln_covariance, search
from bladeroot.stiffness.surface import all_frequencies, surface_of_map
from hypothesis import given, settings
from hypothesis import strategies as st
from stiffness_beam import beam_map

FORCE = 12e3
NO_FORCE_ERROR = ForceGauge(1.253e-4, 1e-9, "full-scale")


@pytest.fixture(scope="module")
def drawn():
    return beam_map(FORCE)


@pytest.fixture(scope="module")
def three():
    return beam_map(FORCE, modes=("1B", "2B", "3B"))


def measured(frequencies, std=(0.02, 0.03), force=FORCE):
    """FE forces of a campaign whose levels have one frequency at every force."""
    count = len(frequencies)
    stick = xr.Dataset(
        {
            "mode": ("level", np.repeat(["1B", "2B", "3B"][:count], 2)),
            "force": ("level", np.tile([0.5 * force, 2 * force], count)),
            "frequency": ("level", np.repeat(np.asarray(frequencies, float), 2)),
            "frequency_std": ("level", np.repeat(np.sqrt(9 / 5) * np.asarray(std), 2)),
            "loss_factor": ("level", np.full(2 * count, 0.005)),
            "loss_factor_std": ("level", np.full(2 * count, 1e-4)),
        }
    )
    return fe_forces(stick, np.array([force]), NO_FORCE_ERROR)


def of_truth(drawn, kn, kt):
    f, jacobian = all_frequencies(surface_of_map(drawn), np.log(np.array([[kn, kt]])))
    return f[0], jacobian[0]


def log_axis(drawn):
    return np.log(drawn["map_kn"].values)


TRUTH = np.log([1.4e9, 2.1e9])


def three_modes(three, rng, spread, modulus=1.0):
    """Frequencies of a specimen whose modulus is another, with all errors drawn.

    Stiffness times `modulus`, contact and force as they are: f = sqrt(modulus) f(k / modulus).
    """
    f, _ = all_frequencies(surface_of_map(three), TRUTH[None] - np.log(modulus))
    return f[0] * np.sqrt(modulus) * (1.0 + spread * rng.standard_normal(3))


def fits(three, spread, count, modulus=1.0):
    """Fits of drawn frequencies; of their errors 0.4 is measured and 0.9 the model's."""
    rng, surface, known = np.random.default_rng(8), surface_of_map(three), np.ones(3, bool)
    drawn = [three_modes(three, rng, spread, modulus) for _ in range(count)]
    errors = 0.4 * spread, np.full(3, np.sqrt(0.84) * spread)
    return [fit_modes(surface, f, errors[0] * f, errors[1], known, log_axis(three)) for f in drawn]


@settings(max_examples=30, deadline=None)
@given(kn=st.floats(19.0, 26.0), kt=st.floats(19.0, 26.0))
def test_simulated_truth_is_among_the_roots(drawn, kn, kt):
    target, _ = of_truth(drawn, np.exp(kn), np.exp(kt))
    roots = all_roots(surface_of_map(drawn), target, drawn["map_frequency"].values, log_axis(drawn))
    assert len(roots)
    back, _ = all_frequencies(surface_of_map(drawn), roots)
    np.testing.assert_allclose(back, np.broadcast_to(target, back.shape), rtol=1e-8)
    assert np.abs(roots - [kn, kt]).max(axis=1).min() < 1e-2


def test_search_recovers_the_stiffness(drawn):
    target, _ = of_truth(drawn, 1.4e9, 2.1e9)
    result = search(drawn, measured(target))
    assert str(result["status"].values) == "root"
    near = np.abs(np.log(result["root_kn"].values / 1.4e9)).argmin()
    assert result["root_kn"].values[near] == pytest.approx(1.4e9, rel=1e-5)
    assert result["root_kt"].values[near] == pytest.approx(2.1e9, rel=1e-5)
    assert float(result["kn"]) in result["root_kn"].values
    assert np.all(result["needed_bias"] == 0.0)


def test_two_roots_are_both_found():
    """Two modes that take kn and kt alike, so that (kn, kt) and (kt, kn) both are roots."""

    def alike(points):
        kn, kt = np.exp(points[:, :2].T)
        return 0.5 * np.log(np.stack([2e9 + kn * kt / (kn + kt), 1e8 + kn + kt]))

    low, high = np.log(1e8), np.log(1e12)
    axis = np.linspace(low, high, 60)
    surface = fit(alike, np.array([low, low, FORCE]), np.array([high, high, FORCE]), 1e-6)
    mesh = np.stack(np.meshgrid(axis, axis, indexing="ij"), axis=-1).reshape(-1, 2)
    drawn = all_frequencies(surface, mesh)[0].T.reshape(2, 60, 60)
    for truth in np.log([[3e9, 2e10], [6e9, 6.6e9]]):
        target = all_frequencies(surface, truth[None])[0][0]
        roots = all_roots(surface, target, drawn, axis)
        assert len(roots) == 2
        np.testing.assert_allclose(roots, [truth, truth[::-1]], atol=1e-3)


def test_frequencies_above_bonded_contact_have_no_root(drawn):
    bonded = drawn["bonded_frequency"].values
    result = search(drawn, measured(bonded * [1.004, 1.002]))
    assert str(result["status"].values) == "no root"
    assert np.isnan(result["kn"])
    assert np.isnan(result["ln_kt_std"])
    assert result.sizes["root"] == 0
    assert int(result["needed_bias_at_edge"]) == 1
    np.testing.assert_allclose(result["needed_bias"], [0.004, 0.002], atol=3e-4)


def test_needed_bias_is_the_smallest_and_gives_a_root(drawn):
    """Off the attainable set to the side: both frequencies below bonded, but not together."""
    bonded = drawn["bonded_frequency"].values
    target = bonded * [0.98, 0.9905]  # with 1B there, 2B reaches 0.9886 at most
    fe_bias = {"1B": 0.004, "2B": 0.002}
    result = search(drawn, measured(target), fe_bias)
    assert str(result["status"].values) == "no root"
    needed = result["needed_bias"].values
    surface, weights = surface_of_map(drawn), np.array([0.004, 0.002])
    size = np.sum((needed / weights) ** 2)
    near = target / (1 + needed)
    fine = np.linspace(*log_axis(drawn)[[0, -1]], 200)
    mesh = np.stack(np.meshgrid(fine, fine), axis=-1).reshape(-1, 2)
    f, _ = all_frequencies(surface, mesh)
    others = np.sum((target / f - 1) ** 2 / weights**2, axis=1)
    assert size <= others.min() * 1.01
    assert np.abs(f / near - 1).max(axis=1).min() < 1e-3
    assert 0 < float(result["root_share"]) < 1


def test_measurement_that_is_absent_is_named(drawn):
    result = search(drawn, measured([590.0, 1600.0], force=2 * FORCE))
    assert str(result["status"].values) == "no measurement"
    assert np.isnan(result["kt"])
    assert np.isnan(result["needed_bias"]).all()


def test_fits_of_three_modes_have_their_covariance_and_tell_a_modulus_one_per_cent_wrong(three):
    """In 95 % of drawn cases, with 5 % false alarms."""
    right, wrong = fits(three, 2e-5, 100), fits(three, 2.2e-4, 100, 1.01)
    false, shown = (np.mean([one.probability < 0.05 for one in made]) for made in (right, wrong))
    assert false < 0.05 + 3.0 * np.sqrt(0.05 * 0.95 / 100)
    assert shown >= 0.95
    off = np.array([one.fit.parameters for one in right]) - TRUTH
    np.testing.assert_allclose(off.std(axis=0), right[0].fit.std, rtol=0.25)


def test_search_of_three_modes_says_how_far_each_is_off(three):
    f = three_modes(three, np.random.default_rng(8), 0.0, 1.01)
    known = dict.fromkeys(("1B", "2B", "3B"), 2e-4)
    found = search(three, measured(f, 1e-4 * f), known)
    assert str(found["status"].values) == "fit"
    assert float(found["chi_square"]) == pytest.approx(float((found["misfit"] ** 2).sum()))
    assert int(found["freedom"]) == 1
    assert float(found["probability"]) < 0.01
    sources = np.sqrt(np.diag(found["ln_covariance"].sum("source")))
    np.testing.assert_allclose(sources[0], found["ln_kn_std"], rtol=0.1)


def test_of_one_mode_the_prior_decides_what_it_does_not_tell(drawn):
    target, _ = of_truth(drawn, 1.4e9, 2.1e9)
    found = search(drawn, measured(target).sel(mode=["1B"]), {"1B": 1e-5, "2B": 1e-5})
    assert str(found["status"].values) == "prior"
    back, _ = of_truth(drawn, float(found["kn"]), float(found["kt"]))
    assert back[0] == pytest.approx(target[0], rel=1e-4)
    prior = 0.25 * np.ptp(log_axis(drawn))
    assert 0.5 * prior < max(float(found["ln_kn_std"]), float(found["ln_kt_std"])) <= prior
    assert np.isnan(found["probability"])
    assert np.isnan(found["misfit"].sel(mode="2B"))


def test_covariance_agrees_with_simulated_errors(drawn):
    """Errors small enough for the map to be straight, through the whole search by Newton."""
    surface, truth = surface_of_map(drawn), np.log(np.array([1.4e9, 2.1e9]))
    target, jacobian = of_truth(drawn, *np.exp(truth))
    std, bias = np.array([0.004, 0.007]), np.array([1e-5, 2e-5])
    parts = ln_covariance(jacobian, target, std, bias)
    rng = np.random.default_rng(5)
    draws = target + rng.standard_normal((4000, 2)) * np.hypot(std, bias * target)
    ends, good = newton(surface, draws, np.tile(truth, (4000, 1)), (np.log(1e8), np.log(1e12)))
    assert good.all()
    np.testing.assert_allclose(np.cov(ends.T), parts.sum(axis=0), rtol=0.1)
    weighted = jacobian.T @ np.diag(1 / std**2) @ jacobian
    np.testing.assert_allclose(parts[0], np.linalg.inv(weighted), rtol=1e-8)


def test_parts_of_the_covariance_add_up(drawn):
    target, _ = of_truth(drawn, 1.4e9, 2.1e9)
    result = search(drawn, measured(target), {"1B": 1e-4, "2B": 2e-4})
    total = result["ln_covariance"].sum("source").values
    assert float(result["ln_kn_std"]) == pytest.approx(np.sqrt(total[0, 0]))
    expected = total[0, 1] / np.sqrt(total[0, 0] * total[1, 1])
    assert float(result["correlation"]) == pytest.approx(expected)
    assert expected < -0.8
    doubled = search(drawn, measured(target), {"1B": 2e-4, "2B": 4e-4})
    ratio = doubled["ln_covariance"].values / result["ln_covariance"].values
    np.testing.assert_allclose(ratio[0], 1.0, rtol=1e-6)
    np.testing.assert_allclose(ratio[1], 4.0, rtol=1e-6)


def test_draws_agree_with_the_covariance_where_the_map_is_straight(drawn):
    target, _ = of_truth(drawn, 1.4e9, 2.1e9)
    result = search(drawn, measured(target, (0.02, 0.03)), {"1B": 1e-6, "2B": 1e-6})
    assert float(result["root_share"]) == 1.0
    low, middle, high = np.log(result["kt_quantile"].values)
    assert (high - low) / 2 == pytest.approx(float(result["ln_kt_std"]), rel=0.15)
    assert middle == pytest.approx(np.log(2.1e9), abs=0.2 * float(result["ln_kt_std"]))


def test_known_bias_of_the_model_is_allowed_for(drawn):
    target, _ = of_truth(drawn, 1.4e9, 2.1e9)
    offset = {"1B": 0.02, "2B": -0.01}
    seen = measured(target / [1.02, 0.99])
    assert str(search(drawn, seen, draws=0)["status"].values) == "no root"
    result = search(drawn, seen, fe_offset=offset, draws=0)
    assert float(result["kn"]) == pytest.approx(1.4e9, rel=1e-4)
    np.testing.assert_allclose(result["target_frequency"], target / [1.02, 0.99])


def test_targets_without_error_are_welcome(drawn):
    target, _ = of_truth(drawn, 1.4e9, 2.1e9)
    result = search(drawn, measured(target, (0.0, 0.0)), draws=0)
    assert str(result["status"].values) == "root"
    assert np.all(result["ln_covariance"].sel(source="finite elements").values != 0.0)


def test_doubtful_arguments_are_refused(drawn):
    with pytest.raises(ValueError, match="fe_bias must be positive"):
        search(drawn, measured([590.0, 1600.0]), {"1B": 0.005})


def test_nearest_point_of_an_attainable_target_is_the_root(drawn):
    target, _ = of_truth(drawn, 3e9, 1e9)
    surface, axis = surface_of_map(drawn), log_axis(drawn)
    point = nearest_point(
        surface, target, np.array([1.0, 1.0]), drawn["map_frequency"].values, axis
    )
    f, _ = all_frequencies(surface, point[None])
    np.testing.assert_allclose(f[0], target, rtol=1e-7)


def test_grid_search_accepts_around_the_truth(drawn):
    axis = np.linspace(1e7, 1.5e8, 50) * 33
    target, _ = of_truth(drawn, axis[20], axis[30])
    errors = np.array([0.2, 0.3])
    result = grid_search(surface_of_map(drawn), target, errors, 0 * errors)
    accepted = result["grid_accepted"].values
    assert accepted[20, 30] == 1
    assert 1 <= accepted.sum() < accepted.size / 4
    i, j = np.argwhere(accepted)[0]
    f, _ = of_truth(drawn, axis[i], axis[j])
    miss = np.abs(f - target)
    norm = np.linalg.norm(miss)
    assert norm == 0 or norm < miss @ errors / norm


def test_grid_search_prefers_soft_contact(drawn):
    """Among accepted points 5.23 takes a softer one than the truth: the bias to be shown."""
    axis = np.linspace(1e7, 1.5e8, 50) * 33
    target, _ = of_truth(drawn, axis[25], axis[25])
    result = grid_search(surface_of_map(drawn), target, np.array([0.1, 0.1]), 0.002 * target)
    assert float(result["grid_kn"]) * float(result["grid_kt"]) < axis[25] ** 2
    nothing = grid_search(surface_of_map(drawn), 1.5 * target, np.array([0.1, 0.1]), 0 * target)
    assert np.isnan(nothing["grid_kn"])
    assert nothing["grid_accepted"].sum() == 0
