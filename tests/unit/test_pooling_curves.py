"""Mean curves over records and forces, and spectra before and after separation."""

import numpy as np
import pytest
import xarray as xr
from bladeroot.decay.freevib import freevib, no_decay
from bladeroot.decay.spectra import before_and_after, followed_mode
from bladeroot.pooling.curves import PLATEAU_VARIABLES, mean_curves
from decay_bench import ringing, separated_curves


def curve(force, offset=0.0, std=1e-3, low=1e-7, high=1e-5, mode="1B", hold=""):
    amplitude = np.geomspace(high, low, 300)
    frequency = 500.0 - 2.0 * np.log10(amplitude / 1e-7) + offset
    values = {"amplitude": amplitude, "frequency": frequency, "loss_factor": 1e-3 * frequency}
    values |= {"frequency_std": 0.0 * amplitude + std, "loss_factor_std": 0.0 * amplitude + std}
    attrs = {"mode": mode, "force_N": force, "hold": hold}
    return xr.Dataset({name: ("point", value) for name, value in values.items()}, attrs=attrs)


def mean_of(decays, rejected=()):
    verdicts = ["rejected: short" if k in rejected else "plateau" for k in range(len(decays))]
    nothing = dict.fromkeys(PLATEAU_VARIABLES, np.nan)
    return mean_curves(decays, [xr.Dataset({**nothing, "verdict": one}) for one in verdicts])


def test_the_mean_of_records_that_agree_is_theirs_with_a_smaller_error():
    mean = mean_of([curve(4000.0)] * 4)
    here = mean.isel(level=0)
    expected = 500.0 - 2.0 * np.log10(here["amplitude"] / 1e-7)
    assert np.abs(here["frequency"] - expected).max() < 1e-6
    assert float(here["frequency_std"].mean()) == pytest.approx(1e-3 / 2.0, rel=0.02)
    assert float(here["frequency_scatter"].max()) < 2e-4  # its levels agree to 1e-13
    assert float(here["frequency_per_decade"]) == pytest.approx(-2.0, rel=1e-3)
    assert float(here["loss_factor_per_decade"]) == pytest.approx(-2e-3, rel=1e-3)
    assert 0.0 < float(here["frequency_per_decade_std"]) < 1e-3


def test_scatter_between_records_is_found_and_widens_the_error():
    rng = np.random.default_rng(7)
    offsets = rng.normal(0.0, 0.3, 40)
    here = mean_of([curve(4000.0, offset) for offset in offsets]).isel(level=0)
    spread = np.std(offsets, ddof=1)
    assert float(here["frequency_scatter"].mean()) == pytest.approx(spread, rel=0.02)
    student = 2.0227 / 1.96  # 39 degrees of freedom
    error = student * spread / np.sqrt(40)
    assert float(here["frequency_std"].mean()) == pytest.approx(error, rel=0.01)


@pytest.mark.parametrize(("forces", "holds", "campaigns"), [(1, 4, 40), (6, 2, 12)])
def test_records_of_one_hold_are_not_replicates(forces, holds, campaigns):
    rng = np.random.default_rng(4)
    z = []
    for _ in range(campaigns):
        made = [
            curve(1e3 * (1 + k), clamped + 0.02 * rng.standard_normal(), 5e-3, hold=f"{h}")
            for k in range(forces)
            for h, clamped in enumerate(0.1 * rng.standard_normal(holds))
            for _ in range(3)
        ]
        here = mean_of(made).isel(amplitude=30)
        truth = 500.0 - 2.0 * np.log10(float(here["amplitude"]) / 1e-7)
        z += list((here["frequency"].values - truth) / here["frequency_std"].values)
    assert np.mean(np.abs(z) < 1.96) > 0.88


def test_one_hold_is_a_lower_bound():
    text = "1B unknown: a lower bound"
    one = [curve(4000.0, 0.01 * k, hold="a") for k in range(3)]
    assert text in mean_of(one)["frequency_std"].attrs["long_name"]
    two = [*one, curve(4000.0, 0.3, hold="b")]
    assert text not in mean_of(two)["frequency_std"].attrs["long_name"]


def test_records_that_begin_and_end_make_no_step_in_the_mean_and_their_scatter_stays():
    low = [curve(4000.0, -1.5, low=1e-6, high=8e-6), curve(4000.0, -1.4, low=1e-6, high=3e-6)]
    high = [curve(4000.0, 1.4), curve(4000.0, 1.5, high=5e-6)]
    here = mean_of([*low, *high]).isel(level=0).isel(amplitude=slice(1, -1))
    assert set(here["records"].values) >= {1, 2, 4}
    law = 500.0 - 2.0 * np.log10(here["amplitude"] / 1e-7)
    assert np.abs(here["frequency"] - law).max() < 0.02  # the mean is one of ln f
    spread = np.std([-1.5, -1.4, 1.4, 1.5], ddof=1)
    several = here["records"].values > 1
    assert here["frequency_scatter"].values[several] == pytest.approx(spread, rel=0.2)
    student = 3.182 / 1.96  # of three degrees of freedom
    assert here["frequency_std"].values == pytest.approx(student * spread / 2.0, rel=0.1)
    assert here["frequency_change_std"].max() < 5e-3


def test_records_that_share_no_amplitude_keep_their_own_levels():
    here = mean_of([curve(4000.0, 1.0, low=2e-6), curve(4000.0, 0.0, high=1e-6)]).isel(level=0)
    law = 500.0 - 2.0 * np.log10(here["amplitude"] / 1e-7)
    above = (here["amplitude"] > 1.5e-6).values
    known = np.isfinite(here["frequency"].values)
    assert (here["frequency"] - law).values[known & above] == pytest.approx(1.0, abs=1e-6)
    assert (here["frequency"] - law).values[known & ~above] == pytest.approx(0.0, abs=1e-6)


def test_an_uncertain_record_hardly_moves_the_mean():
    here = mean_of([curve(4000.0), curve(4000.0, 0.1, std=1.0)]).isel(level=0)
    expected = 500.0 - 2.0 * np.log10(here["amplitude"] / 1e-7)
    assert np.abs(here["frequency"] - expected).max() < 0.02


def test_nothing_is_extrapolated_and_levels_stay_apart():
    made = [curve(4000.0, low=1e-6), curve(8000.0, high=1e-6), curve(4000.0, 5.0, mode="2B")]
    mean = mean_of(made)
    assert list(mean["mode"].values) == ["1B", "1B", "2B"]
    assert list(mean["force"].values) == [4000.0, 8000.0, 4000.0]
    for level, (low, high) in enumerate([(1e-6, 1e-5), (1e-7, 1e-6), (1e-7, 1e-5)]):
        reached = np.isfinite(mean["frequency"].values[level])
        inside = (mean["amplitude"].values >= low) & (mean["amplitude"].values <= high)
        assert (reached <= inside).all()
        assert reached.sum() >= inside.sum() - 2


def test_a_record_that_is_rejected_has_no_part_in_the_mean():
    made = [curve(4000.0), curve(4000.0, 100.0)]
    here = mean_of(made, rejected=[1]).isel(level=0)
    assert int(here["records"].max()) == 1
    assert float(here["frequency"].max()) < 501.0


def test_no_records_give_an_empty_dataset():
    assert mean_of([]).sizes["level"] == 0


def decaying(rate_Hz=8000.0, seconds=1.0):
    time = np.arange(int(rate_Hz * seconds)) / rate_Hz
    mode = ringing(time, 200.0, 5.0)
    other = ringing(time, 530.0, 9.0, 0.3, 1.0)
    noise = 1e-4 * np.random.default_rng(1).standard_normal(time.size)
    return mode, mode + other + noise


def test_the_followed_mode_leaves_over_the_rest():
    mode, whole = decaying()
    decay = separated_curves(whole, 8000.0, 200.0, 1e-4)
    decay.attrs["expected_Hz"] = 200.0
    inside = slice(100, 6000)
    miss = followed_mode(whole.size, 8000.0, decay)[inside] - mode[inside]
    assert np.sqrt(np.mean(miss**2)) < 3e-4
    found = before_and_after(whole, 8000.0, decay)
    near = np.abs(found["frequency"].values - 200.0) < 3.0
    away = np.abs(found["frequency"].values - 530.0) < 3.0
    assert found["rest"].values[near].max() < 0.01 * found["mode"].values[near].max()
    assert found["mode"].values[away].max() < 0.05 * found["rest"].values[away].max()


def test_where_the_mode_is_not_known_or_not_usable_nothing_is_compared():
    _, whole = decaying()
    usable = np.arange(whole.size) >= 2000
    decay = freevib(whole, 8000.0, 200.0, 1e-4, usable=usable)
    decay.attrs["expected_Hz"] = 200.0
    usable[6000] = False
    found = before_and_after(whole, 8000.0, decay, usable)
    assert found.attrs["from_s"] == pytest.approx(0.25, abs=0.05)
    assert found.attrs["to_s"] == pytest.approx(0.75, abs=1e-3)
    away = np.abs(found["frequency"].values - 400.0) < 50.0
    assert found["rest"].values[away].max() < 2.0 * found["whole"].values[away].max()


def test_the_whole_decay_is_shown_where_no_mode_was_followed():
    _, whole = decaying()
    decay = no_decay().assign_attrs(expected_Hz=200.0)
    found = before_and_after(whole, 8000.0, decay)
    assert (found.attrs["from_s"], found.attrs["to_s"]) == (0.0, 1.0)
    assert found["whole"].max() > 0.0
    assert np.isnan(found["rest"].values).all()
