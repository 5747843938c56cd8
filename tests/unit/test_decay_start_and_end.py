"""Where a free decay begins, and where it ends."""

import bladeroot as br
import numpy as np
import pytest
from bladeroot.decay.components import onset, separated
from bladeroot.decay.free_decay import free_decay
from bladeroot.decay.record import estimate
from bladeroot.io.recording import recording
from blows import MODES, NOISE, RATE, blow, curve, decay


def test_steps_are_blurred_only_while_something_louder_rings():
    """What blurs the digitiser's steps at first must not carry the curve on below them."""
    velocity = blow([(80.0, 0.0015, 0.05), (297.0, 0.003, 0.1)], length_s=12.0)
    step = 5e-4
    judged, _ = curve(step * np.round(velocity / step), 80.0, (297.0,))
    assert judged.attrs["end_reason"] == "the digitiser's steps"


def test_a_curve_ends_where_what_blurs_the_steps_has_died():
    velocity = blow([(80.0, 0.0015, 0.02), (297.0, 0.0005, 1.0)], length_s=12.0)
    step = 5e-4
    judged, found = curve(step * np.round(velocity / step), 80.0, (297.0,))
    assert judged.attrs["end_reason"] == "the digitiser's steps"
    assert 4.0 < judged.attrs["end_s"] < 6.0  # the mode has 8 steps at 2 s, the other one at 6 s
    off = np.abs(found["frequency"].values - 80.0) / found["frequency_std"].values
    assert off.size > 50
    assert np.mean(off < 3.0) > 0.95


def test_a_decay_begins_where_it_grows_no_more_and_ends_where_it_grows_again():
    time = np.arange(int(4.0 * RATE)) / RATE
    level = np.where(time < 0.2, 0.5 + 2.5 * time, np.exp(-0.8 * (time - 0.2)))
    level = np.where(time > 3.0, level * (1.0 + 3.0 * (1.0 - np.exp(-(time - 3.0) / 0.1))), level)
    noise = NOISE * np.random.default_rng(0).standard_normal(time.size)
    judged, found = curve(0.05 * level * np.cos(2 * np.pi * 80.0 * time) + noise, 80.0)
    seen_s = found["time"].values[[0, -1]] + judged.attrs["start_s"]
    assert 0.18 <= seen_s[0] < 0.3
    assert 2.5 < seen_s[1] < 3.1
    assert (found["loss_factor"].values > 0.0).all()


@pytest.mark.parametrize("part", [1e-4, 1e-3, 1e-2])
def test_what_is_held_at_first_is_no_part_of_the_curve(part):
    time = np.arange(int(4.0 * RATE)) / RATE
    velocity = np.exp(-2.5 * np.maximum(time - 0.25, 0.0)) * np.cos(2 * np.pi * 80.0 * time)
    velocity += part * np.random.default_rng(4).standard_normal(time.size)
    judged, found = curve(velocity, 80.0)  # held for twenty cycles
    assert 0.25 < found["time"].values[0] + judged.attrs["start_s"] < 0.32
    off = found["loss_factor"].values - 5.0 / (2.0 * np.pi * 80.0)
    assert np.abs(off / found["loss_factor_std"].values)[:20].max() < 5.0


@pytest.mark.parametrize("quantity", ["m/s", "m"])
def test_a_clipped_wave_harmonics_are_no_components(quantity):
    """A decay begins where it is clipped no more."""
    size = {"m/s": 1.0, "m": 1.0 / (2.0 * np.pi * 80.0)}[quantity]
    time = np.arange(int(4.0 * RATE)) / RATE - 0.02
    wave = np.where(time < 0.0, 0.0, decay(80.0, 0.0018, 1.0, np.maximum(time, 0.0)))
    noise = 2e-4 * np.random.default_rng(3).standard_normal(time.size)
    record = recording(size * (np.clip(wave, -0.7, 0.7) + noise), quantity, "", sampling_Hz=RATE)
    judged = free_decay(record, 80.0)
    last = time[np.abs(wave) > 0.7][-1] + 0.02
    assert last < judged.attrs["start_s"] < last + 0.02
    assert "clipping" in judged["finding_id"].values
    found = estimate(judged.assign_attrs(expected_Hz=80.0))
    off = found["loss_factor"].values / 0.0036 - 1.0
    assert np.abs(off[: off.size // 4]).max() < 0.02


@pytest.mark.parametrize("before_s", [0.005, 0.3])
def test_a_blow_is_seen_to_the_sample(before_s):
    velocity = blow(MODES, before_s) + 0.01 * np.sin(np.arange(int(4.0 * RATE)) / 3000.0)
    assert onset(velocity, RATE / 80.0) == pytest.approx(before_s * RATE, abs=2)


def test_a_record_that_ends_early_in_its_decay_says_so():
    velocity = decay(297.0, 0.0003, 0.02, np.arange(3200) / RATE)
    velocity += NOISE * np.random.default_rng(5).standard_normal(velocity.size)
    judged, found = curve(velocity, 300.0)
    assert judged.attrs["verdict"] == "usable"
    assert "short-record" in judged["finding_id"].values
    off = np.abs(found["loss_factor"].values - 0.0006) / found["loss_factor_std"].values
    assert off.max() < 3.5
    assert np.abs(found["frequency"].values / 297.0 - 1.0).max() < 1e-4


@pytest.mark.parametrize(
    ("rate", "line_Hz", "zeta", "hold_s", "noise"),
    [(200.0, 8.0, 0.05, 3.0, 2e-3), (340.0, 19.0, 0.05, 1.5, 2e-3), (530.0, 8.0, 0.09, 0.6, 5e-4)],
)
def test_a_specimen_let_go_from_a_deflection_is_seen_by_a_displacement_sensor(
    rate, line_Hz, zeta, hold_s, noise
):
    """Twice differentiated, its noise hides the instant from single samples."""
    time = np.arange(int((hold_s + 64.0 / line_Hz) * rate)) / rate
    free = decay(line_Hz, zeta, 1.0, np.maximum(time - hold_s, 0.0), phase=-np.arcsin(zeta))
    held = np.where(time < hold_s, 1.0, free / np.sqrt(1.0 - zeta**2))
    seen = held + noise * np.random.default_rng(1).standard_normal(time.size)
    record = recording(1e-4 * seen, "m", "here", sampling_Hz=rate)
    judged = free_decay(record, line_Hz)
    found = estimate(judged.assign_attrs(expected_Hz=line_Hz), damping="viscous")
    assert judged.attrs["release_s"] == pytest.approx(hold_s, abs=0.25 / line_Hz)
    assert judged["finding_id"].size == 0
    assert found["amplitude"].values[0] > 0.6e-4
    loss, std = found["loss_factor"].values, found["loss_factor_std"].values
    assert np.abs((loss - 2.0 * zeta) / std).max() < 3.5
    assert np.median(np.abs(loss / (2.0 * zeta) - 1.0)) < 0.02


def test_what_begins_in_motion_or_grows_slowly_was_not_struck():
    assert onset(blow(MODES, before_s=0.0), RATE / 80.0) == 0
    time = np.arange(int(4.0 * RATE)) / RATE
    driven = np.minimum(time, 1.0) * np.cos(2 * np.pi * 80.0 * time)
    assert onset(driven, RATE / 80.0) == 0


def test_a_decay_begins_after_a_second_blow():
    struck_s, again_s, known = 0.02, 0.05, (RATE, 297.0, (80.0, 846.0), int(0.02 * RATE))
    once = blow(MODES[:3], before_s=struck_s)
    parts = separated(once + 0.4 * blow(MODES[:3], before_s=again_s, seed=1), *known)
    assert again_s <= parts.first / RATE < again_s + 0.06  # some knots further, 10 ms apart
    assert len(parts.lines_Hz) == 2  # what a blow leaves over makes no lines
    assert separated(once, *known).first < (struck_s + 0.01) * RATE


def test_zeros_behind_a_record_are_no_part_of_it():
    velocity = blow([(250.0, 0.002, 0.02), (126.0, 0.002, 0.01)], length_s=1.0)
    _, found = curve(velocity, 250.0, (126.0,))
    judged, padded = curve(np.pad(velocity, (0, 3000)), 250.0, (126.0,))
    assert "nothing but one value from 1 s on" in judged.attrs["findings"]
    assert found.sizes["point"] > 100
    for name in ("amplitude", "frequency", "loss_factor"):
        assert np.array_equal(padded[name], found[name])


@pytest.mark.parametrize("seed", [0, 2, 3])
def test_a_deleted_frame_of_a_video_is_a_gap_and_no_wrong_samples(seed):
    rng = np.random.default_rng(seed)
    rate, own_Hz, eta = 400.0, 16.0, 0.012
    time = np.arange(1500) / rate
    motion = np.exp(-np.pi * own_Hz * eta * time)
    motion *= np.cos(2.0 * np.pi * own_Hz * time + rng.uniform(0.0, 6.0))
    motion += 1.5e-3 * rng.standard_normal(time.size)
    motion = np.delete(motion, int(rng.uniform(0.3, 0.6) * time.size))
    judged = free_decay(recording(0.02 * motion, "m", "here", sampling_Hz=rate), 16.3)
    assert judged["finding_id"].values.tolist() == ["gap"]
    found = estimate(judged.assign_attrs(expected_Hz=16.3))
    off = np.abs(found["frequency"].values - own_Hz) / found["frequency_std"].values
    assert off.max() < 3.5


@pytest.mark.parametrize(("size", "verdict"), [(0.0, "usable"), (0.1, "rejected")])
def test_a_knock_ends_a_decay_only_where_it_moves_the_mode(size, verdict):
    """The mode falls by 3.4 in all, by too little for a decay on either side of the knock."""
    velocity = blow([(122.0, 0.0008, 0.02)], before_s=0.0, length_s=2.0)
    velocity += 0.01 * size * blow([(122.0, 0.0008, 1.0)], before_s=1.0, length_s=2.0)
    rng = np.random.default_rng(5)
    velocity[6400:6700] += 2e-4 * rng.standard_normal(300)
    judged, found = curve(velocity, 122.0)
    assert judged.attrs["verdict"] == verdict
    if not size:
        assert judged.attrs["end_reason"] == "end of the record"
        clear = (
            np.abs(np.log(found["amplitude"].values / np.median(found["amplitude"].values))) > 0.2
        )
        assert clear.sum() > 50
        assert np.abs(found["loss_factor"].values[clear] / 0.0016 - 1.0).max() < 0.02


@pytest.mark.parametrize("held", [0.0, 1.3])
@pytest.mark.parametrize("cycles", [12, 30])
def test_the_start_of_a_displacement_is_as_right_as_that_of_a_velocity(held, cycles):
    """Of 90 samples a cycle, its frequency rises by 1.9 % with the amplitude squared."""
    line_Hz, rate, loss = 1.0, 90.0, 0.6 / cycles
    step = 1.0 / (rate * 20)
    since = np.arange(0.0, cycles / line_Hz, step)
    level = np.exp(-np.pi * loss * line_Hz * since)
    phase = 2.0 * np.pi * line_Hz * np.cumsum(step * (1.0 + 0.019 * level**2))
    free = (level * np.cos(phase))[::20]
    seen = np.concatenate([np.ones(int(held * rate)), free])
    seen += 1e-4 * np.random.default_rng(2).standard_normal(seen.size)
    found = br.ringdown(1e-3 * seen, line_Hz, sampling_Hz=rate, quantity="displacement", unit="m")
    amplitude = 1e3 * found.curves["amplitude"].values
    off = found.curves["frequency"].values / (line_Hz * (1.0 + 0.019 * amplitude**2)) - 1.0
    assert found.findings == ()
    assert amplitude[0] > 0.8
    assert np.abs(off[amplitude > 0.4]).max() < 1.5e-3
    damping = found.curves["loss_factor"].values[amplitude > 0.4]
    assert np.abs(damping / loss - 1.0).max() < 0.06
