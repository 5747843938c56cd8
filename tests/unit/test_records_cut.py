"""The free decay is found in every shape of record, forced samples never in it."""

import numpy as np
import pytest
from bladeroot.records.cut import cut, rejected
from decay_bench import START, ring_down, shaken


@pytest.mark.parametrize("noise_db", [60, 40])
@pytest.mark.parametrize("eta", [0.004, 0.02])
def test_release_and_tip_return(noise_db, eta):
    for seed in range(4):
        velocity, release, returned, noise = shaken(seed, eta, noise_db)
        found = cut(velocity, 25600.0, 245.0)
        assert found.attrs["verdict"] == "usable"
        assert abs(found.attrs["release_s"] - release) * 250.0 < 2.0
        assert release < found.attrs["start_s"] < release + 5.0 / 250.0
        assert found.attrs["noise_velocity"] == pytest.approx(noise, rel=0.1)
        if found.attrs["end_reason"] == "the tip's return":
            assert found.attrs["end_s"] < returned


def test_end_is_a_thousandth():
    velocity, _, _, _ = ring_down(0, noise_db=80, second=0.0, eta=(0.008, 0.008))
    found = cut(velocity, 25600.0, 250.0)
    assert found.attrs["end_reason"] == "0.001 of the first envelope"
    last = np.abs(found["velocity"].values[-100:]).max()
    assert last / START == pytest.approx(1e-3, rel=0.15)


def test_end_is_the_noise():
    velocity, _, _, _ = ring_down(0, noise_db=30, second=0.0)
    found = cut(velocity, 25600.0, 250.0)
    assert found.attrs["end_reason"] == "the noise"
    assert 0.6 < found.attrs["end_s"] < 1.8


def test_record_that_starts_in_the_decay_keeps_its_start():
    velocity, _, _, _ = ring_down(0)
    found = cut(velocity, 25600.0, 250.0)
    assert found.attrs["start_s"] == 0.0
    np.testing.assert_array_equal(found["velocity"][:100], velocity[:100])


def test_hammer_blow():
    velocity, _, _, _ = ring_down(0)
    quiet = 7e-4 * np.random.default_rng(0).standard_normal(5000)
    found = cut(np.concatenate([quiet, velocity]), 25600.0, 250.0)
    assert 5000 / 25600 < found.attrs["start_s"] < 5000 / 25600 + 10 / 250


def test_overview_shows_the_whole_record():
    velocity, _, _, _ = shaken(0)
    found = cut(velocity, 25600.0, 250.0)
    assert found["overview_min"].min() == velocity.min()
    assert found["overview_max"].max() == velocity.max()
    assert 900 < found.sizes["bin"] <= 1000


def clipped():
    return np.clip(ring_down(0, second=0.0)[0], -0.7 * START, 0.7 * START)


@pytest.mark.parametrize(
    ("velocity", "expected_Hz", "text"),
    [
        (clipped(), 250.0, "clipped"),
        (ring_down(0, second=0.0)[0][:1000], 250.0, "too short"),
        (7e-4 * np.random.default_rng(0).standard_normal(25600), 250.0, "no free decay found"),
        (ring_down(0, second=0.0)[0], 13000.0, "above 0.45 of the sampling frequency"),
    ],
)
def test_what_is_wrong_is_said(velocity, expected_Hz, text):
    found = cut(velocity, 25600.0, expected_Hz)
    assert found.attrs["verdict"] == "rejected"
    assert text in found.attrs["findings"]
    assert "\n" not in found.attrs["findings"]


def test_another_mode_dominates():
    velocity, _, _, _ = ring_down(0, second=0.0)
    time = np.arange(velocity.size) / 25600.0
    velocity = 0.1 * velocity + START * np.exp(-3 * time) * np.sin(2 * np.pi * 700 * time)
    found = cut(velocity, 25600.0, 250.0)
    assert "another mode dominates" in found.attrs["findings"]
    assert "700" in found.attrs["findings"]


def test_unreadable_record(tmp_path):
    found = rejected("expected a NetCDF file")
    assert set(found.variables) == set(cut(ring_down(0)[0], 25600.0, 250.0).variables)
    assert found.attrs["verdict"] == "rejected"
    found.to_netcdf(tmp_path / "rejected.nc")
