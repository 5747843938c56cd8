"""One record from its cut to all that is estimated of it, by either estimator and law."""

import numpy as np
import pytest
import xarray as xr
from bladeroot import artifacts
from bladeroot.decay.freevib import freevib
from bladeroot.decay.record import estimate
from bladeroot.plateau.plateau import record_plateau
from bladeroot.quality.second_opinion import with_second_opinion
from bladeroot.reproduction.thesis_filters import thesis_freevib
from decay_bench import ring_down


@pytest.fixture(scope="module")
def cut():
    velocity, noise, _, _ = ring_down(4, noise_db=55)
    return xr.Dataset(
        {"velocity": ("time", velocity), "usable": ("time", np.ones(velocity.size, np.int8))},
        attrs={
            "verdict": "usable", "findings": "", "sampling_Hz": 25600.0, "expected_Hz": 247.0,
            "noise_velocity": noise,
        },
    )  # fmt: skip


@pytest.mark.parametrize("estimator", [freevib, thesis_freevib])
@pytest.mark.parametrize("damping", ["hysteretic", "viscous"])
def test_every_choice_ends_in_a_stick_frequency(cut, estimator, damping, tmp_path):
    found = with_second_opinion(estimate(cut, damping, estimator=estimator), cut)
    assert {"point", "block", "peak"} <= set(found.dims)
    assert int(found["pff_agrees"]) == 1
    assert all("units" in variable.attrs for variable in found.data_vars.values())
    path = tmp_path / "decay.nc"
    artifacts.save(found, path)
    plateau = record_plateau(artifacts.load(path))
    # 250 Hz is where the bench's hysteretic law sticks: the viscous one adds a millionth
    assert float(plateau["stick_frequency"]) == pytest.approx(250.0, rel=2e-5)


def test_masked_samples_reach_the_estimators(cut):
    spoiled = cut.copy(deep=True)
    spoiled["velocity"][8000:8010] = 0.4
    spoiled["usable"][8000:8010] = 0
    found = with_second_opinion(estimate(spoiled), spoiled)
    assert int(found["pff_agrees"]) == 1
    assert float(found["frequency"].median()) == pytest.approx(
        float(estimate(cut)["frequency"].median()), rel=1e-4
    )


@pytest.mark.parametrize("estimator", [freevib, thesis_freevib])
@pytest.mark.parametrize("masked_s", [0.1, 0.8])
def test_a_start_that_is_masked_is_no_part_of_the_curve(cut, estimator, masked_s):
    spoiled = cut.copy(deep=True)
    count = int(masked_s * 25600.0)
    spoiled["velocity"][:count] *= 3.0
    spoiled["usable"][:count] = 0
    whole, found = (
        with_second_opinion(estimate(one, estimator=estimator), one) for one in (cut, spoiled)
    )
    assert masked_s - 1e-4 < float(found["block_time"][0]) < masked_s + 0.1
    assert int(found["pff_agrees"]) == 1
    middle = slice(found.sizes["point"] // 4, found.sizes["point"] // 2)
    coarse = 1.0 if estimator is freevib else 8.0
    close = {"frequency": 1e-4 * coarse, "loss_factor": 0.05 * coarse}
    for name, most in close.items():
        late = np.interp(found["time"], whole["time"], whole[name])
        assert np.median(np.abs(found[name].values / late - 1.0)[middle]) < most


@pytest.mark.parametrize(
    ("expected_Hz", "other_Hz", "verdict"),
    [(280.0, 255.0, "rejected"), (280.0, 330.0, "usable"), (260.0, 245.0, "usable")],
)
def test_a_curve_far_off_at_another_known_mode_is_refused(cut, expected_Hz, other_Hz, verdict):
    """The mode lies at 250 Hz; one that lies a little off may soften or stiffen."""
    found = estimate(cut.assign_attrs(expected_Hz=expected_Hz), modes_Hz=(other_Hz,))
    assert found.attrs["verdict"] == verdict
    assert (found.sizes["point"] == 0) == (verdict == "rejected")


def test_a_rejected_record_has_no_points(cut):
    rejected = cut.assign_attrs(verdict="rejected", reason="clipped")
    found = with_second_opinion(estimate(rejected), rejected)
    assert found.sizes["point"] == found.sizes["peak"] == 0
    assert np.isnan(found["pff_frequency_difference"])
    short = estimate(cut.isel(time=slice(0, 400)), estimator=thesis_freevib)
    assert short.attrs["verdict"] == "rejected"
    assert "longer" in short.attrs["reason"]
