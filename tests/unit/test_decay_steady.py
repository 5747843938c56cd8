"""Steady lines beside a mode: hum, a pump, a drive that runs on."""

import numpy as np
import pytest
from bladeroot.decay.envelope_model import demodulated
from bladeroot.decay.free_decay import free_decay
from bladeroot.decay.record import estimate
from bladeroot.decay.steady import steady_line
from bladeroot.io.recording import recording
from blows import NOISE, RATE, blow, curve, decay


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


@pytest.mark.parametrize(("part", "length_s"), [(0.003, 5.5), (0.01, 3.3)])
@pytest.mark.parametrize("away_Hz", [0.3, -0.3])
def test_a_steady_line_that_turns_once_against_the_mode_is_no_slip(part, length_s, away_Hz):
    """It lies where a joint that slips moves a mode to, and decays by nothing."""
    time = np.arange(int(length_s * 2000.0)) / 2000.0
    velocity = decay(48.9, 0.003, 1.0, time) + part * np.cos(
        2.0 * np.pi * (48.9 + away_Hz) * time + 2.0
    )
    velocity += 1e-3 * np.random.default_rng(0).standard_normal(time.size)
    record = recording(0.02 * velocity, "m/s", "here", sampling_Hz=2000.0)
    judged = free_decay(record, 49.6)
    assert "steady-line" in judged["finding_id"].values
    found = estimate(judged.assign_attrs(expected_Hz=49.6), damping="viscous")
    for name, true in (("frequency", 48.9), ("loss_factor", 0.006)):
        off = np.abs(found[name].values - true) / found[f"{name}_std"].values
        assert off.max() < 3.0


def test_a_mode_that_hardly_falls_at_last_is_no_steady_line():
    time = np.arange(int(6.0 * RATE)) / RATE
    fall = np.where(time < 0.6, 8.0 * time, 4.8 + 0.02 * (time - 0.6))
    velocity = 0.02 * np.exp(-fall) * np.sin(2.0 * np.pi * 257.0 * time)
    velocity += NOISE * np.random.default_rng(3).standard_normal(time.size)
    judged, _ = curve(velocity, 255.0)
    assert "steady-line" not in judged["finding_id"].values


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


def test_no_steady_line_rings_where_the_digitiser_is_still():
    velocity = blow([(80.0, 0.004, 0.05)], length_s=8.0)
    last = velocity.size // 2
    velocity[last:] = 0.0
    found = demodulated(velocity[:last], RATE, np.array([80.0]), 128)
    assert steady_line(velocity, found, last, RATE, 0.17, np.zeros(0)) is None
