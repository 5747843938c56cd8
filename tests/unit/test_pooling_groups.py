"""Groups are pooled apart and compared; sensors of one event are no repeats."""

import numpy as np
import pytest
import xarray as xr
from bladeroot.pooling.curves import PLATEAU_VARIABLES, mean_curves
from bladeroot.pooling.groups import group_differences, group_sentences
from bladeroot.pooling.stick import stick_from_records
from pooling_bench import curve, drawn
from scipy.stats import t

GOOD = xr.Dataset({"verdict": "plateau"})


def compared(decays):
    return group_differences(decays, [False] * len(decays))


def test_a_difference_between_groups_is_told_with_its_size():
    found = compared(drawn([1.0, 1.0, 1.4]))
    loss = found.isel(comparison=found["compared_quantity"].values == "loss_factor").squeeze()
    assert float(loss["difference"]) == pytest.approx(0.4, abs=3 * float(loss["difference_std"]))
    assert loss["high_group"].item() == "floor 2"
    assert int(loss["freedom"]) == 6  # nine motions in three groups, however many sensors saw them
    (line,) = group_sentences(found)
    assert "the loss factor of mode m2 depends on the group: in floor 2 it is 4" in line


@pytest.mark.slow
def test_groups_that_are_alike_are_seldom_told_apart():
    chances = np.array([float(compared(drawn([1.0] * 3, seed))["chance"][1]) for seed in range(20)])
    assert (chances < 0.01).sum() <= 1
    assert abs((chances < 0.5).mean() - 0.5) < 0.3


def test_sensors_of_one_motion_do_not_make_a_difference_sure():
    alone, seen = (compared(drawn([1.0, 1.01], 3, sensors=s)) for s in (("a",), tuple("abcdef")))
    assert float(seen["chance"][1]) == pytest.approx(float(alone["chance"][1]), rel=0.05)


def test_groups_without_a_common_amplitude_are_not_compared():
    apart = [curve("one", "a", low=1e-6, high=1e-5), curve("two", "b", low=1e-3, high=1e-2)]
    assert compared(apart) is None
    assert compared([curve("one", "a"), curve("one", "b")]) is None


def test_no_mean_is_taken_over_groups_or_sensors():
    decays = drawn([1.0, 1.4])
    mean = mean_curves(
        decays, [GOOD.assign(dict.fromkeys(PLATEAU_VARIABLES, np.nan))] * len(decays)
    )
    assert mean.sizes["level"] == 4
    assert set(zip(mean["group"].values, mean["sensor"].values, strict=True)) == {
        ("floor 0", "a"), ("floor 0", "b"), ("floor 1", "a"), ("floor 1", "b"),
    }  # fmt: skip
    assert mean["force"].attrs["units"] == ""


def plateau(group, event, sensor, value, std=1e-3):
    names = ("stick_frequency", "loss_factor", "onset_amplitude")
    numbers = {name: value for name in names} | {f"{name}_std": std for name in names}
    numbers |= {name: np.nan for name in ("onset_low", "onset_high", "onset_time",
                "plateau_low_amplitude", "plateau_high_amplitude", "plateau_weight", "onset_bound",
                "frequency_bound", "frequency_bound_std", "limit_low", "limit_high")}  # fmt: skip
    facts = {"mode": "m1", "group": group, "event": event, "sensor": sensor, "load": 0.0,
             "record": f"{event}{sensor}", "hold": event, "load_unit": "",
             "load_name": ""}  # fmt: skip
    return xr.Dataset({**numbers, "plateau_reached": 1, "verdict": "plateau"}, attrs=facts)


def test_stick_frequencies_of_groups_stand_apart_and_events_count_once():
    rng = np.random.default_rng(2)
    found = []
    for group, level in (("a", 10.0), ("b", 11.0)):
        for k in range(4):
            own = level + 0.1 * rng.standard_normal()
            found += [
                plateau(group, f"{group}{k}", s, own + 1e-3 * d) for s, d in (("x", 1), ("y", -1))
            ]
    stick = stick_from_records(found)
    assert stick["group"].values.tolist() == ["a", "b"]
    assert stick["records"].values.tolist() == [8, 8]
    assert stick["holds"].values.tolist() == [4, 4]
    assert float(stick["between_std"][0]) > 0.01
    assert np.all(stick["frequency_std"].values > 0.02)  # of four motions, not of eight records
    assert np.isnan(stick["onset_amplitude"]).all()  # an amplitude belongs to a sensor


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_the_interval_of_a_group_is_students_of_all_events(seed):
    """Three groups of events that two sensors see: what repeats is the event, in its group."""
    rng = np.random.default_rng(seed)
    found, events = [], []
    for name, level in zip("abc", 10.0 + 0.5 * rng.standard_normal(3), strict=True):
        events.append(level + 0.03 * rng.standard_normal(rng.integers(3, 6)))
        found += [
            plateau(name, f"{name}{k}", sensor, own, 1e-5)
            for k, own in enumerate(events[-1])
            for sensor in "xy"
        ]
    stick = stick_from_records(found)
    count = np.array([own.size for own in events])
    freedom = (count - 1).sum()
    scatter = np.sqrt(sum(((own - own.mean()) ** 2).sum() for own in events) / freedom)
    half = t.ppf(0.975, freedom) * scatter / np.sqrt(count)
    assert stick["frequency"].values == pytest.approx([own.mean() for own in events], abs=1e-5)
    assert 1.96 * stick["frequency_std"].values == pytest.approx(half, rel=0.02)


def test_sensors_that_disagree_widen_the_error():
    alike = stick_from_records([plateau("", "e", s, 10.0) for s in "xy"])
    apart = stick_from_records([plateau("", "e", s, v) for s, v in (("x", 10.0), ("y", 10.1))])
    assert float(apart["within_std"][0]) > 10 * float(alike["within_std"][0])
