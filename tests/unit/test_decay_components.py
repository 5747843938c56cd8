"""All that rings beside a mode is found, taken off, and known in the curve's errors."""

import numpy as np
import pytest
from bladeroot.decay.component_lines import meant
from bladeroot.decay.components import onset, separated
from bladeroot.decay.envelope_model import Beside, demodulated
from bladeroot.decay.free_decay import free_decay
from bladeroot.decay.freevib import freevib
from bladeroot.decay.record import analyse, estimate
from bladeroot.decay.steady import steady_line
from bladeroot.io.recording import recording
from bladeroot.signal.lines import loudest, mode_Hz
from decay_bench import ring_down, slider

RATE = 6400.0
NOISE = 2e-5


def decay(line_Hz, zeta, size, time, phase=0.3):
    omega = 2.0 * np.pi * line_Hz
    return size * np.exp(-zeta * omega * time) * np.cos(omega * np.sqrt(1 - zeta**2) * time + phase)


def blow(modes, before_s=0.02, length_s=4.0, seed=0):
    """Velocity of a struck specimen: modes as (Hz, damping ratio, size), and noise."""
    time = np.arange(int(length_s * RATE)) / RATE - before_s
    wave = sum(decay(*mode, np.maximum(time, 0.0), phase=-np.pi / 2) for mode in modes)
    wave = np.where(time >= 0.0, wave, 0.0)
    return wave + NOISE * np.random.default_rng(seed).standard_normal(time.size)


def curve(velocity, expected_Hz, others=()):
    record = recording(velocity, "m/s", "here", sampling_Hz=RATE)
    judged = free_decay(record, expected_Hz, others)
    return judged, estimate(judged.assign_attrs(expected_Hz=expected_Hz), damping="viscous")


MODES = [(80.0, 0.0015, 0.07), (297.0, 0.001, 0.024), (846.0, 0.0024, 0.013), (14.0, 0.003, 0.004)]


@pytest.mark.parametrize("number", [0, 1, 2])
def test_each_of_several_modes_has_its_curve(number):
    line_Hz, zeta, _ = MODES[number]
    others = tuple(mode[0] for k, mode in enumerate(MODES[:3]) if k != number)
    judged, found = curve(blow(MODES), 1.01 * line_Hz, others)
    assert judged.attrs["verdict"] == "usable"
    assert judged.attrs["start_s"] == pytest.approx(0.02, abs=0.03)
    for k in others:
        assert np.abs(np.array(judged.attrs["components_Hz"]) / k - 1.0).min() < 0.02
    amplitude = found["amplitude"].values
    loud = amplitude > 0.05 * amplitude.max()
    assert loud.sum() > 20
    off = found["frequency"].values[loud] / line_Hz - 1.0
    assert np.abs(off).max() < 1e-3
    assert np.median(np.abs(found["loss_factor"].values[loud] / (2 * zeta) - 1.0)) < 0.01
    z = (found["frequency"].values[loud] - line_Hz) / found["frequency_std"].values[loud]
    assert np.mean(np.abs(z) < 3.0) > 0.9


def test_a_weak_mode_between_louder_ones_keeps_its_line():
    # what is not known yet draws a mode's line: away from it no other line would be a line
    modes = [(7.0, 0.02, 1.0), (19.35, 0.004, 0.5), (28.0, 0.0025, 0.05)]
    time = np.arange(int(15.0 * 384.0)) / 384.0
    velocity = sum(decay(*mode, time) for mode in modes) + 0.01 * np.sin(2 * np.pi * 50.02 * time)
    velocity += 2e-5 * np.random.default_rng(2).standard_normal(time.size)
    parts = separated(velocity, 384.0, 28.0, (7.0, 19.35))
    for line_Hz in (7.0, 19.35, 50.02):
        assert np.abs(np.array(parts.lines_Hz) / line_Hz - 1.0).min() < 0.02
    left = parts.velocity[parts.first :] - decay(*modes[2], time)[parts.first : parts.velocity.size]
    loud = slice(40, 700)
    assert np.sqrt(np.mean(left[loud] ** 2)) < 0.02 * modes[2][2]


@pytest.mark.parametrize("seed", [0, 3])  # of the second, all that beats looks like wind's
def test_a_mode_hidden_by_more_lines_than_are_followed_is_seen_in_a_band_of_its_own(seed):
    rng = np.random.default_rng(seed)
    far_Hz = np.concatenate([rng.uniform(60.0, 250.0, 12), rng.uniform(900.0, 2700.0, 14)])
    far = [(line, rng.uniform(3e-4, 1e-3), rng.uniform(0.5, 1.5)) for line in far_Hz]
    velocity = blow([(440.0, 0.002, 0.3), *far], length_s=2.0, seed=seed)
    assert curve(velocity, 441.0)[1].sizes["point"] == 0
    record = recording(velocity, "m/s", "here", sampling_Hz=RATE)
    known = {"expected_Hz": 441.0, "other_modes_Hz": (), "simulated": False}
    judged, found, _ = analyse(record, known, {}, {"damping": "viscous"})
    assert "crowded" in judged["finding_id"].values
    assert found.sizes["point"] > 100
    assert np.median(found["frequency"]) == pytest.approx(440.0, rel=1e-5)
    assert np.median(found["loss_factor"]) == pytest.approx(0.004, rel=0.01)
    off = (found["loss_factor"] - 0.004) / found["loss_factor_std"]
    assert np.mean(np.abs(off) < 3.0) > 0.95


def test_a_suspension_line_of_one_per_cent_does_not_reach_the_damping():
    velocity = blow([(80.0, 0.0015, 0.07), (15.0, 0.0005, 0.0007)])
    _, found = curve(velocity, 80.5)
    amplitude = found["amplitude"].values
    loud = amplitude > 0.1 * amplitude.max()
    error = found["loss_factor"].values[loud] / 0.003 - 1.0
    assert np.median(np.abs(error)) < 0.005
    assert np.abs(error).max() < 0.03


def test_a_known_close_mode_is_told_apart():
    velocity = blow([(80.0, 0.0015, 0.05), (86.0, 0.002, 0.04)])
    _, found = curve(velocity, 80.5, (85.5,))
    amplitude = found["amplitude"].values
    loud = amplitude > 0.1 * amplitude.max()
    assert np.median(np.abs(found["frequency"].values[loud] / 80.0 - 1.0)) < 1e-4
    assert np.median(np.abs(found["loss_factor"].values[loud] / 0.003 - 1.0)) < 0.03


def test_a_weak_mode_under_a_louder_one_is_kept():
    velocity = blow([(80.0, 0.0015, 0.1), (297.0, 0.001, 0.003)])
    judged, found = curve(velocity, 297.0, (80.0,))
    assert judged.attrs["verdict"] == "usable"
    assert np.median(np.abs(found["frequency"].values / 297.0 - 1.0)) < 1e-4


def test_a_mode_by_itself_is_left_as_it_is():
    velocity = ring_down(1, second=0.0)[0]
    found = separated(velocity, 25600.0, 247.0)
    assert found.velocity is velocity
    assert not found.lines_Hz
    # nor one whose frequency rises by a third as it decays
    for expected_Hz in (500.0, 544.73):
        assert not separated(slider(), 51200.0, expected_Hz).lines_Hz


@pytest.mark.parametrize("zeta", [0.03, 0.06, 0.12])
def test_a_mode_that_lasts_a_few_cycles_has_its_curve_and_no_others_beside_it(zeta):
    for seed in range(4):  # where it has died, noise beside its envelope's band is no line
        judged, found = curve(blow([(80.0, zeta, 0.07)], 0.1, seed=seed), 80.5)
        assert not judged.attrs["components_Hz"]
        amplitude = found["amplitude"].values
        assert zeta > 0.1 or amplitude[0] > 0.8 * 0.07 / (2.0 * np.pi * 80.0)
        loud = amplitude > 0.02 * amplitude[0]
        assert np.abs(found["frequency"].values[loud] / 80.0 - 1.0).max() < 2e-3
        assert np.abs(found["loss_factor"].values[loud] / (2.0 * zeta) - 1.0).max() < 0.05


@pytest.mark.parametrize(("close_Hz", "size"), [(86.0, 0.3), (75.0, 0.2)])
def test_a_close_mode_that_nobody_knows_is_told_by_its_beat(close_Hz, size):
    velocity = blow([(80.0, 0.0015, 0.05), (close_Hz, 0.002, 0.05 * size)])
    judged, found = curve(velocity, 80.5)
    assert np.abs(np.array(judged.attrs["components_Hz"]) - close_Hz).min() < 0.5
    loud = found["amplitude"].values > 0.1 * found["amplitude"].values.max()
    assert np.median(np.abs(found["frequency"].values[loud] / 80.0 - 1.0)) < 1e-4


@pytest.mark.parametrize(("close_Hz", "size"), [(77.5, 2.0), (82.0, 0.5)])
def test_a_close_mode_that_dies_before_it_beats_is_taken_off(close_Hz, size):
    velocity = blow([(80.0, 0.001, 0.05), (close_Hz, 0.02, 0.05 * size)])
    judged, found = curve(velocity, 80.5)
    assert "close-mode" in judged["finding_id"].values
    off = np.abs(found["frequency"].values - 80.0)
    assert (off < np.maximum(3.0 * found["frequency_std"].values, 0.01)).all()
    assert off[found["time"].values < 0.3].max() < 0.1


@pytest.mark.parametrize(("away_Hz", "other"), [(-3.6, False), (3.6, True)])
def test_what_lies_lower_and_dies_far_sooner_is_the_mode_that_slips(away_Hz, other):
    """A joint that slips while it is loud; above the mode nothing but another mode lies."""
    velocity = blow([(514.7, 0.0012, 0.02), (514.7 + away_Hz, 0.0204, 0.024)])
    found = [one for one, _ in separated(velocity[128:], RATE, 514.0, (), 0).remarks]
    assert ("close-mode" in found) == other


@pytest.mark.parametrize("part", [0.001, 0.002, 0.005, 0.02])
def test_a_far_weaker_mode_that_lasts_is_not_the_one_that_is_meant(part):
    """The loud mode is where it is expected; the other one, as close as a sheet errs, is not."""
    velocity = blow([(840.0, 1.6e-4, 0.02), (871.5, 8e-5, 0.02 * part)], length_s=6.0)
    _, found = curve(velocity, 840.0)
    assert np.abs(found["frequency"].values / 840.0 - 1.0).max() < 1e-3
    assert found["amplitude"][0] == pytest.approx(0.02 / (2 * np.pi * 840.0), rel=0.1)


@pytest.mark.parametrize("part", [0.001, 0.003])
def test_a_weak_close_mode_counts_where_the_damping_is_low(part):
    """It makes the loss factor, 3.2e-4, swing by a half and more."""
    time = np.arange(6900) / 610.0
    turn = 2.0 * np.pi * np.cumsum(80.0 * (1.0 - 0.005 * np.exp(-0.08 * time))) / 610.0
    beat = part * np.exp(-0.04 * time) * np.cos(2.0 * np.pi * 83.0 * time)
    velocity = 1e-3 * (np.exp(-0.08 * time) * np.cos(turn) + beat)
    velocity += 2e-8 * np.random.default_rng(0).standard_normal(time.size)
    parts = separated(velocity, 610.0, 80.0)
    assert [name for name, _ in parts.remarks] == ["close-mode"]
    taken = parts.time, parts.widening, parts.doubt
    loss = freevib(parts.velocity, 610.0, 80.0, 2e-8, taken=taken)["loss_factor"].values
    middle = slice(loss.size // 4, 3 * loss.size // 4)
    assert np.abs(loss[middle] / 3.2e-4 - 1.0).max() < 0.02


def test_a_mode_of_the_sheet_far_from_both_lines_does_not_choose_between_them():
    lines = np.array([1192.0, 810.0, 1125.0])
    assert meant(lines, 1132.0, (810.0,))[0] == 1125.0
    assert meant(lines, 1132.0, ())[0] == 1125.0
    assert meant(lines, 1185.0, (1120.0,))[0] == 1192.0


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


def test_of_two_close_modes_each_is_the_one_that_is_meant():
    velocity = blow([(78.6, 0.0005, 0.03), (81.1, 0.0005, 0.05)], length_s=8.0)
    for expected_Hz, other_Hz, truth_Hz in ((79.9, 80.1, 78.6), (80.1, 79.9, 81.1)):
        found = separated(velocity, RATE, expected_Hz, (other_Hz,))
        line_Hz = mode_Hz(*loudest(found.velocity[found.first :], RATE, truth_Hz), truth_Hz)
        assert line_Hz == pytest.approx(truth_Hz, abs=0.3)


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


@pytest.mark.parametrize("left", [0, 8])
def test_a_record_that_is_clipped_to_its_last_samples_is_left_as_it_is(left):
    velocity = blow([(400.0, 0.004, 0.02)])
    parts = separated(velocity, RATE, 400.0, first=velocity.size - left)
    assert parts.velocity is velocity
    assert not parts.lines_Hz


def test_what_is_taken_off_shows_in_the_errors_where_the_decay_begins():
    velocity = blow([(80.0, 0.0015, 0.05), (95.0, 0.002, 0.04)], before_s=0.0)
    found = separated(velocity, RATE, 80.0)
    assert found.lines_Hz[0] == pytest.approx(95.0, abs=0.5)
    assert found.widening[0] > 1.2
    assert found.widening[found.widening.size // 2] < 1.05
    assert found.time[0] < found.time[-1] < 1.05 * velocity.size / RATE


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


@pytest.mark.parametrize(("other_Hz", "told"), [(83.0, True), (297.0, False), (93.0, False)])
def test_a_close_mode_of_the_sheet_that_is_not_seen_apart_warns(other_Hz, told):
    """The sheet has two modes near 80 Hz, of which one rings; 93 Hz lies beyond an eighth."""
    judged, found = curve(blow(MODES), 80.8, (other_Hz, 846.0))
    assert ("not-apart" in judged["finding_id"].values) == told
    assert found["frequency"].values[0] == pytest.approx(80.0, rel=1e-3)


def test_a_close_mode_of_the_sheet_that_is_seen_apart_does_not_warn():
    judged, _ = curve(blow([*MODES, (85.5, 0.002, 0.05)]), 80.8, (85.0, 297.0))
    assert "not-apart" not in judged["finding_id"].values


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


@pytest.mark.parametrize(("order", "part"), [(2, 0.01), (3, 0.02), (2, 0.0)])
def test_a_louder_modes_harmonic_beside_the_mode_is_taken_off(order, part):
    loud_Hz, own_Hz, own = 101.0, order * 101.0 - 1.6, (0.002, 0.05)
    time = np.arange(int(3.0 * RATE)) / RATE
    lag = np.exp(-0.0009 * 2 * np.pi * loud_Hz * time)
    # the loud mode softens: its harmonic moves with it
    turns = 2.0 * np.pi * (loud_Hz * time - 0.05 * (1.0 - lag))
    velocity = 0.2 * lag * np.cos(turns) + 0.2 * part * lag**1.7 * np.cos(order * turns + 0.7)
    velocity += decay(own_Hz, *own, time)
    velocity += NOISE * np.random.default_rng(4).standard_normal(time.size)
    judged, found = curve(velocity, own_Hz + 0.5, (loud_Hz,))
    taken_Hz = np.array(judged.attrs["components_Hz"])
    assert (np.abs(taken_Hz - order * loud_Hz) < 1.0).any() == (part > 0.0)
    above = found["amplitude"].values * 2.0 * np.pi * own_Hz > max(0.5 * part * 0.2, 1e-3)
    assert above.sum() > 50
    frequency, loss = found["frequency"].values[above], found["loss_factor"].values[above]
    assert np.abs(frequency / own_Hz - 1.0).max() < 5e-4
    assert np.median(np.abs(loss / 0.004 - 1.0)) < 0.03
    z = (frequency - own_Hz) / found["frequency_std"].values[above]
    assert np.sqrt(np.mean(z**2)) < 3.0


def test_a_decay_begins_after_a_second_blow():
    struck_s, again_s, known = 0.02, 0.05, (RATE, 297.0, (80.0, 846.0), int(0.02 * RATE))
    once = blow(MODES[:3], before_s=struck_s)
    parts = separated(once + 0.4 * blow(MODES[:3], before_s=again_s, seed=1), *known)
    assert again_s <= parts.first / RATE < again_s + 0.06  # some knots further, 10 ms apart
    assert len(parts.lines_Hz) == 2  # what a blow leaves over makes no lines
    assert separated(once, *known).first < (struck_s + 0.01) * RATE


@pytest.mark.parametrize("intervals", [0, 1])
def test_a_mode_hidden_from_its_start_on_is_followed_all_the_same(monkeypatch, intervals):
    monkeypatch.setattr(Beside, "hides", lambda _, found, __: intervals * found.spacing)
    loud_Hz, time = 101.0, np.arange(int(3.0 * RATE)) / RATE
    velocity = decay(2 * loud_Hz - 1.6, 0.002, 0.05, time)
    for order, part in ((1, 0.2), (2, 0.004)):
        velocity += part * np.exp(-0.5 * order * time) * np.cos(2 * np.pi * order * loud_Hz * time)
    velocity += NOISE * np.random.default_rng(4).standard_normal(time.size)
    parts = separated(velocity, RATE, 2 * loud_Hz - 1.1, (loud_Hz,))
    assert any(finding == "harmonic" for finding, _ in parts.remarks)
    assert intervals or parts.velocity.size == velocity.size


@pytest.mark.parametrize("part", [0.84, 0.88, 1.15])
def test_a_mode_a_seventh_away_in_a_long_record_is_taken_off(part):
    velocity = blow([(429.0, 0.001, 0.02), (429.0 * part, 0.002, 0.001)], length_s=6.0)
    judged, found = curve(velocity, 427.0)
    assert np.abs(np.array(judged.attrs["components_Hz"]) / (429.0 * part) - 1.0).min() < 1e-3
    assert "mode-beating" not in judged["finding_id"].values
    loud = found["amplitude"].values > 0.05 * found["amplitude"].values.max()
    assert np.abs(found["loss_factor"].values[loud][3:] / 0.002 - 1.0).max() < 0.02


def test_a_mode_of_the_sheet_that_dies_sooner_is_told_once():
    velocity = blow([(400.0, 0.008, 0.02), (415.0, 0.02, 0.014)], length_s=2.0)
    judged, _ = curve(velocity, 399.0, (415.0,))
    assert np.abs(np.array(judged.attrs["components_Hz"]) / 415.0 - 1.0).min() < 1e-3
    assert judged["finding_id"].values.tolist().count("close-mode") == 1


def test_modes_that_beat_are_not_several_decays():
    velocity = blow([(400.0, 0.0005, 0.02), (405.0, 0.0005, 0.019)], length_s=3.0)
    judged, _ = curve(velocity, 400.0)
    told = judged["finding_id"].values
    assert "close-mode" in told
    assert "several-decays" not in told


def test_a_steady_line_beside_the_mode_is_taken_off():
    velocity = blow([(257.0, 0.003, 0.02)], length_s=6.0)
    time = np.arange(velocity.size) / RATE
    velocity += 2e-4 * np.cos(2.0 * np.pi * 249.95 * time + 1.0)  # a hundredth: 0.4 of the loss
    judged, found = curve(velocity, 255.0)
    assert "steady-line" in judged["finding_id"].values
    assert judged.attrs["components_Hz"][-1] == pytest.approx(249.95, abs=1e-3)
    clear = found["amplitude"].values > 0.003 * found["amplitude"].values.max()
    assert clear.sum() > 200
    assert np.abs(found["frequency"].values[clear] / 257.0 - 1.0).max() < 1e-3
    assert np.abs(found["loss_factor"].values[clear] / 0.006 - 1.0).max() < 0.1


def test_a_steady_line_that_the_mode_has_not_died_beside_is_taken_off():
    """Where the mode sinks to the line it seems to end; it goes on beating with it."""
    velocity = blow([(100.7, 0.0015, 0.02)], length_s=8.0)
    time = np.arange(velocity.size) / RATE
    velocity += 2e-4 * np.cos(2.0 * np.pi * 100.0 * time + 1.0)
    judged, found = curve(velocity, 100.0)
    assert "steady-line" in judged["finding_id"].values
    assert judged.attrs["components_Hz"][-1] == pytest.approx(100.0, abs=0.01)
    clear = found["amplitude"].values > 0.01 * found["amplitude"].values.max()
    assert clear.sum() > 60
    assert np.abs(found["loss_factor"].values[clear] / 0.003 - 1.0).max() < 0.1


def test_a_steady_line_that_only_the_quiet_before_a_blow_shows_is_taken_off():
    """The record ends before the mode has sunk to the line, or has beaten with it twice."""
    velocity = blow([(100.7, 0.0015, 0.02)], before_s=0.6, length_s=2.6)
    line = 1e-4 * np.cos(2.0 * np.pi * 100.0 * np.arange(velocity.size) / RATE + 1.0)
    judged, found = curve(velocity + line, 100.0)
    assert "steady-line" in judged["finding_id"].values
    assert judged.attrs["components_Hz"][-1] == pytest.approx(100.0, abs=0.01)
    assert np.median(np.abs(found["loss_factor"].values / 0.003 - 1.0)) < 0.01
    off = np.abs(found["loss_factor"].values - 0.003) / found["loss_factor_std"].values
    assert off.max() < 3.0


def test_what_rings_of_the_mode_before_a_blow_is_no_steady_line():
    velocity = blow([(100.7, 0.0001, 0.02)], before_s=0.6, length_s=2.6)
    velocity += decay(100.7, 0.0001, 2e-4, np.arange(velocity.size) / RATE)
    judged, _ = curve(velocity, 100.0)
    assert judged.attrs["verdict"] == "usable"
    assert "steady-line" not in judged["finding_id"].values


@pytest.mark.parametrize(("away_Hz", "size"), [(28.0, 0.01), (40.0, 0.02), (40.0, 0.05)])
@pytest.mark.parametrize(("falls", "finding"), [(0.0, "steady-line"), (0.15, "close-mode")])
def test_what_beats_with_the_mode_and_stays_is_no_mode(away_Hz, size, falls, finding):
    """The record ends with the mode, so that nothing shows the line by itself."""
    velocity, zeta = blow([(540.0, 0.001, 0.02)], length_s=1.0), 0.001 * falls
    now = np.arange(velocity.size) / RATE
    velocity += decay(540.0 - away_Hz, zeta, 0.02 * size, now)
    judged, _ = curve(velocity, 541.0)
    told = set(judged["finding_id"].values) & {"steady-line", "close-mode"}
    assert told == {finding}
    assert np.abs(np.array(judged.attrs["components_Hz"]) - 540.0 + away_Hz).min() < 0.1


def test_a_mode_that_hardly_falls_at_last_is_no_steady_line():
    time = np.arange(int(6.0 * RATE)) / RATE
    fall = np.where(time < 0.6, 8.0 * time, 4.8 + 0.02 * (time - 0.6))
    velocity = 0.02 * np.exp(-fall) * np.sin(2.0 * np.pi * 257.0 * time)
    velocity += NOISE * np.random.default_rng(3).standard_normal(time.size)
    judged, _ = curve(velocity, 255.0)
    assert "steady-line" not in judged["finding_id"].values


def test_zeros_behind_a_record_are_no_part_of_it():
    velocity = blow([(250.0, 0.002, 0.02), (126.0, 0.002, 0.01)], length_s=1.0)
    _, found = curve(velocity, 250.0, (126.0,))
    judged, padded = curve(np.pad(velocity, (0, 3000)), 250.0, (126.0,))
    assert "nothing but one value from 1 s on" in judged.attrs["findings"]
    assert found.sizes["point"] > 100
    for name in ("amplitude", "frequency", "loss_factor"):
        assert np.array_equal(padded[name], found[name])


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


@pytest.mark.parametrize("line_Hz", [250.14, 252.4])
def test_a_line_less_than_a_turn_from_a_mode_that_has_died_is_no_end_of_it(line_Hz):
    time = np.arange(int(2.6 * RATE)) / RATE
    velocity = decay(251.2, 0.01, 0.02, time) + 4e-5 * np.cos(2.0 * np.pi * line_Hz * time)
    velocity += NOISE * np.random.default_rng(3).standard_normal(time.size)
    judged, found = curve(velocity, 248.0)
    assert "steady-line" in judged["finding_id"].values
    off = found["frequency"].values / 251.2 - 1.0
    assert (np.abs(off) < np.maximum(3.5 * found["frequency_std"].values / 251.2, 5e-4)).all()
    assert found["amplitude"][-1] < 15e-3 * found["amplitude"][0]


def test_a_steady_line_that_the_mode_draws_near_as_it_dies_is_taken_off():
    """The mode hardens from 70 to 73 Hz as it falls; at last it turns little against the line."""
    time = np.arange(int(3.0 * RATE)) / RATE
    level = np.exp(-8.0 * time)
    phase = 2.0 * np.pi * np.cumsum(73.0 - 3.0 * np.sqrt(level)) / RATE
    velocity = 0.02 * level * np.sin(phase) + 6e-5 * np.cos(2.0 * np.pi * 73.3 * time)
    velocity += 0.3 * NOISE * np.random.default_rng(3).standard_normal(time.size)
    judged, found = curve(velocity, 71.0)
    assert "steady-line" in judged["finding_id"].values
    frequency = found["frequency"].values
    size = found["amplitude"].values * 2.0 * np.pi * frequency / 0.02
    clear = (size > 0.01) & (size < 0.5)
    assert clear.sum() > 15
    assert np.abs(frequency - 73.0 + 3.0 * np.sqrt(size))[clear].max() < 0.1


def test_a_record_whose_digitiser_is_still_at_last_has_nothing_to_separate_there():
    velocity = blow([(80.0, 0.02, 0.05)], length_s=4.0)
    velocity = np.where(np.arange(velocity.size) < 0.6 * velocity.size, velocity, 0.0)
    parts = separated(velocity, RATE, 80.0, (297.0,), int(0.7 * velocity.size))
    assert parts.velocity is velocity
    assert not parts.lines_Hz


def test_no_steady_line_rings_where_the_digitiser_is_still():
    velocity = blow([(80.0, 0.004, 0.05)], length_s=8.0)
    last = velocity.size // 2
    velocity[last:] = 0.0
    found = demodulated(velocity[:last], RATE, np.array([80.0]), 128)
    assert steady_line(velocity, found, last, RATE, 0.17, np.zeros(0)) is None
