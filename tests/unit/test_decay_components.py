"""All that rings beside a mode is found, taken off, and known in the curve's errors."""

import numpy as np
import pytest
from bladeroot.decay.components import separated
from bladeroot.decay.envelope_model import Beside
from bladeroot.decay.record import analyse
from bladeroot.io.recording import recording
from blows import MODES, NOISE, RATE, blow, curve, decay
from decay_bench import ring_down, slider


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


def test_a_record_whose_digitiser_is_still_at_last_has_nothing_to_separate_there():
    velocity = blow([(80.0, 0.02, 0.05)], length_s=4.0)
    velocity = np.where(np.arange(velocity.size) < 0.6 * velocity.size, velocity, 0.0)
    parts = separated(velocity, RATE, 80.0, (297.0,), int(0.7 * velocity.size))
    assert parts.velocity is velocity
    assert not parts.lines_Hz
