import numpy as np
import pytest
import xarray as xr
from bladeroot.reproduction.published import published_stiffness
from bladeroot.stiffness.interpolation import ForceGauge, fe_forces
from bladeroot.stiffness.search import search
from bladeroot.stiffness.summary import power_law, summarise
from bladeroot.stiffness.surface import all_frequencies, surface_of_map
from stiffness_beam import beam_map

FORCES = np.array([10e3, 12e3, 16e3, 20e3])


@pytest.fixture(scope="module")
def maps():
    return [beam_map(force) for force in FORCES]


def campaign(maps, kn, kt, raised=1.0):
    """Levels at every force whose frequencies follow from given stiffness."""
    f = np.array(
        [
            all_frequencies(surface_of_map(m), np.log(np.array([pair])))[0][0]
            for m, pair in zip(maps, np.column_stack([kn, kt]), strict=True)
        ]
    )
    stick = xr.Dataset(
        {
            "mode": ("level", np.repeat(["1B", "2B"], len(FORCES))),
            "force": ("level", np.tile(FORCES, 2)),
            "frequency": ("level", (raised * f).T.ravel()),
            "frequency_std": ("level", np.full(2 * len(FORCES), 0.01)),
            "loss_factor": ("level", np.full(2 * len(FORCES), 0.005)),
            "loss_factor_std": ("level", np.full(2 * len(FORCES), 1e-4)),
        }
    )
    return fe_forces(stick, FORCES, ForceGauge(0.1253, 1e-6, "full-scale"))


@pytest.fixture(scope="module")
def lawful(maps):
    """kn = 1.4e9 (F/12 kN)^0.6, kt = 2.1e9 (F/12 kN)^0.3."""
    ratio = FORCES / 12e3
    targets = campaign(maps, 1.4e9 * ratio**0.6, 2.1e9 * ratio**0.3)
    return targets, [search(m, targets, {"1B": 1e-5, "2B": 1e-5}, draws=40) for m in maps]


def test_laws_are_recovered(lawful):
    targets, found = lawful
    result = summarise({"beam": found}, targets).sel(structure="beam")
    assert int(result["root_count"]) == 4
    for name, reference, exponent in (("kn", 1.4e9, 0.6), ("kt", 2.1e9, 0.3)):
        assert float(result[f"{name}_law_reference"]) == pytest.approx(reference, rel=1e-4)
        assert float(result[f"{name}_law_exponent"]) == pytest.approx(exponent, abs=1e-4)
        assert 0 < float(result[f"{name}_law_exponent_std"]) < 1
    np.testing.assert_allclose(result["kn_nodal"], result["kn"] / 33)


def test_structures_and_published_values_stand_side_by_side(lawful, maps):
    targets, found = lawful
    out_of_reach = campaign(maps, np.full(4, 1e9), np.full(4, 1e9), raised=1.1)
    lost = [search(m, out_of_reach, draws=0) for m in maps[:2]]
    table = {
        "force_kN": [12, 14],
        "kn_N_per_mm": [41428.6, 50000.0],
        "kn_delta_N_per_mm": [4866.6, 10042.7],
        "kt_N_per_mm": [64285.7, 61428.6],
        "kt_delta_N_per_mm": [6587.3, 10822.9],
    }
    result = summarise({"good": found, "bad": lost}, targets, published_stiffness(table))
    assert result["kn"].dims == ("structure", "force")
    assert result["status"].sel(structure="bad").values.tolist() == [
        "no root",
        "no root",
        "no measurement",
        "no measurement",
    ]
    assert np.isnan(result["kn_law_exponent"].sel(structure="bad"))
    assert (result["needed_bias"].sel(structure="bad", force=12e3) > 0.05).all()
    assert float(result["published_kn_nodal"].sel(force=12e3)) == pytest.approx(41428.6e3)
    assert np.isnan(result["published_kn_nodal"].sel(force=16e3))
    assert result["kn"].attrs["units"] == "N/m"


def test_one_force_twice_is_refused(lawful):
    targets, found = lawful
    with pytest.raises(ValueError, match="structure beam: two searches"):
        summarise({"beam": [found[0], found[0]]}, targets)


def test_power_law_std_covers_simulated_errors():
    """Correlated measurement errors and a common shift, by simulation."""
    force = np.array([10e3, 12e3, 15e3, 19e3, 24e3])
    rng = np.random.default_rng(8)
    mix = 0.05 * (np.eye(5) + 0.5 * np.eye(5, k=1))
    measured, gain = mix @ mix.T, np.array([0.3, 0.28, 0.25, 0.22, 0.2])
    shared = np.outer(gain, gain)
    truth = np.log(2e9) + 0.5 * np.log(force / 12e3)
    fits = []
    for _ in range(4000):
        noisy = truth + mix @ rng.standard_normal(5) + gain * rng.standard_normal()
        fits.append(power_law(force, noisy, measured, shared)[0])
    law, covariance, scatter = power_law(force, truth, measured, shared)
    np.testing.assert_allclose(law, [np.log(2e9), 0.5], atol=1e-10)
    np.testing.assert_allclose(np.cov(np.array(fits).T), covariance, rtol=0.1)
    assert scatter == pytest.approx(0.0, abs=1e-10)


def test_scatter_beyond_the_errors_widens_the_law():
    force = np.array([10e3, 12e3, 15e3, 19e3, 24e3])
    ln_k = 21 + 0.5 * np.log(force / 12e3) + 0.1 * np.array([1, -1, 1, -1, 1])
    zero = np.zeros((5, 5))
    _, tight, _ = power_law(force, ln_k, 0.01**2 * np.eye(5), zero)
    _, loose, scatter = power_law(force, ln_k, 0.1**2 * np.eye(5), zero)
    np.testing.assert_allclose(tight, loose, rtol=0.5)
    assert 0.05 < scatter < 0.1
