"""Sensors of one event against each other."""

import numpy as np
import pytest
import xarray as xr
from bladeroot.pooling.sensors import close_elsewhere, passed_ends, shared_steps, unlike_sensors


def seen(sensor, start=0.0, detuned=0.0, damping=0.01, event="e", mode="1B", verdict="usable"):
    """A softening decay from `start` (s on the event's clock) on, whose errors are 0.01 Hz."""
    time = np.linspace(0.0, 2.0, 60)
    frequency = 100.0 - 2.0 * np.exp(-(time + start)) + detuned
    values = {"time": time, "frequency": frequency, "loss_factor": np.full(60, damping),
              "frequency_std": np.full(60, 0.01), "loss_factor_std": np.full(60, 1e-4)}  # fmt: skip
    decay = xr.Dataset(
        {name: ("point", row) for name, row in values.items()}, attrs={"verdict": verdict}
    )
    facts = {"event": event, "mode": mode, "sensor": sensor, "start_s": start}
    return xr.Dataset(attrs=facts), decay


def found(*pairs):
    return [row[:2] for row in unlike_sensors(*zip(*pairs, strict=True))]


def test_one_motion_is_compared_at_one_time_wherever_the_decays_begin():
    assert found(seen("a"), seen("b", start=0.7), seen("c", start=1.3)) == []
    # amplitudes of one sensor are another's at another time: on a clock of its own it is apart
    record, decay = seen("b", start=0.7)
    assert found(seen("a"), (record.assign_attrs(start_s=0.0), decay)) == [(0, 1), (1, 0)]


@pytest.mark.parametrize("other", [{"detuned": 0.1}, {"detuned": -0.1}, {"damping": 0.012}])
def test_of_three_sensors_the_odd_one_is_told(other):
    assert [k for k, _ in found(seen("a"), seen("b", **other), seen("c"))] == [1]


def test_of_two_sensors_nobody_says_which_is_right():
    assert found(seen("a"), seen("b", detuned=0.1)) == [(0, 1), (1, 0)]
    assert unlike_sensors(*zip(seen("a"), seen("b", detuned=0.1), strict=True))[0][2] == (
        pytest.approx(0.1 / np.hypot(0.01, 0.01) / 4.0)
    )


@pytest.mark.parametrize(
    "other", [{"event": "f"}, {"event": ""}, {"mode": "2B"}, {"verdict": "rejected"}, {"start": 3}]
)
def test_only_usable_curves_of_one_mode_in_one_event_are_compared_while_both_last(other):
    assert found(seen("a"), seen("b", detuned=0.5, **other)) == []


def test_a_difference_within_a_quarter_of_the_time_is_none():
    record, decay = seen("b")
    decay["frequency"][:12] += 0.1
    assert found(seen("a"), (record, decay)) == []
    decay["frequency"][:20] += 0.1
    assert found(seen("a"), (record, decay)) == [(0, 1), (1, 0)]


def test_a_large_difference_in_a_twentieth_of_the_time_is_told():
    record, decay = seen("b")
    decay["frequency"][:4] += 0.1
    assert found(seen("a"), (record, decay)) == []
    decay["frequency"][:4] += 0.1
    assert found(seen("a"), (record, decay)) == [(0, 1), (1, 0)]


def beside(sensor, *lines_Hz, told=False, **facts):
    """A curve near 100 Hz, and what was taken off; with a finding of a close mode."""
    record, decay = seen(sensor, **facts)
    record = record.assign_attrs(components_Hz=list(lines_Hz))
    return record.assign(finding_id=("finding", ["close-mode"] if told else [])), decay


def test_a_close_mode_that_another_sensor_sees_is_told_where_it_is_not_seen():
    ((other, line_Hz),) = [
        row[1:]
        for row in close_elsewhere(
            *zip(
                beside("a", 30.0),
                beside("b", 30.0, 102.0, told=True),
                beside("c", 101.5, 250.0),
                strict=True,
            )
        )
        if row[0] == 0
    ]
    assert (other, line_Hz) == (1, 102.0)


@pytest.mark.parametrize(
    "other",
    [
        beside("b", 102.0),  # of which it is not told that it is a close mode
        beside("b", 106.0, told=True),
        beside("b", 102.0, told=True, event="f"),
        beside("b", 102.0, told=True, mode="2B"),
    ],
)
def test_what_is_far_or_of_another_motion_is_no_close_mode(other):
    assert not close_elsewhere(*zip(beside("a", 30.0), other, strict=True))


def stepping(ratio, at_s=1.0, event="e", mode="1B", verdict="usable"):
    """A judged decay at 100 Hz with the largest step that its check saw."""
    facts = {"event": event, "mode": mode, "verdict": verdict, "expected_Hz": 100.0}
    return xr.Dataset(attrs=facts | {"step_s": at_s, "step_ratio": ratio})


def test_a_step_that_sensors_see_at_one_time_is_told_where_they_see_it_together():
    shared = shared_steps([stepping(0.8), stepping(0.5, at_s=5.0), stepping(0.7, at_s=1.015)])
    assert [row[0] for row in shared] == [0, 2]
    assert shared[0][1:] == (pytest.approx(np.hypot(0.8, 0.7)), 1.0, 2)


def test_a_record_that_tells_of_its_step_makes_the_others_tell_of_it():
    assert [k for k, *_ in shared_steps([stepping(1.7), stepping(0.35)])] == [1]


@pytest.mark.parametrize(
    "other",
    [{"at_s": 1.025}, {"event": "f"}, {"event": ""}, {"mode": "2B"}, {"verdict": "rejected"}],
)
def test_only_steps_of_one_motion_at_one_time_are_shared(other):
    assert not shared_steps([stepping(0.9), stepping(0.9, **other)])


def test_what_is_noise_in_one_sensor_or_nothing_together_is_no_shared_step():
    without = stepping(0.9)
    del without.attrs["step_s"], without.attrs["step_ratio"]
    assert not shared_steps([stepping(0.9), stepping(0.2), without])
    assert not shared_steps([stepping(0.7), stepping(0.7)])


def ending(end_s, reason="the noise", last_s=1.9, **facts):
    """A decay at 100 Hz from 0.1 s on that ends for a reason, and its curve."""
    record, decay = seen("a")
    known = {"verdict": "usable", "expected_Hz": 100.0, "start_s": 0.1, **facts}
    record = record.assign_attrs(known | {"end_s": end_s, "end_reason": reason})
    decay.attrs["verdict"] = known["verdict"]
    return record, decay.assign(time=decay["time"] * (last_s - 0.1) / 2.0)


def test_a_curve_that_goes_on_where_two_sensors_are_disturbed_is_told():
    ended = [ending(at, "disturbed", at) for at in (1.2, 1.21, 0.5)]
    found = passed_ends(*zip(ending(1.9), *ended, strict=True))
    assert found == [(0, 1.2, 2)]
    shorter = ending(1.2, last_s=1.19)
    assert not passed_ends(*zip(shorter, *ended, strict=True))


@pytest.mark.parametrize("other", [{"event": "f"}, {"mode": "2B"}, {"verdict": "rejected"}, {}])
def test_one_sensor_that_is_disturbed_may_be_so_by_itself(other):
    one, two = ending(1.2, "disturbed", 1.2), ending(1.2, "disturbed", 1.2, **other)
    two = two if other else ending(1.25, "disturbed", 1.25)
    assert not passed_ends(*zip(ending(1.9), one, two, strict=True))
