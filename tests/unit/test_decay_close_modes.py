"""Modes so close that they beat: each is told apart, or said not to be."""

import numpy as np
import pytest
from bladeroot.decay.component_lines import meant
from bladeroot.decay.components import separated
from bladeroot.decay.freevib import freevib
from bladeroot.signal.lines import loudest, mode_Hz
from blows import MODES, NOISE, RATE, blow, curve


def test_a_known_close_mode_is_told_apart():
    velocity = blow([(80.0, 0.0015, 0.05), (86.0, 0.002, 0.04)])
    _, found = curve(velocity, 80.5, (85.5,))
    amplitude = found["amplitude"].values
    loud = amplitude > 0.1 * amplitude.max()
    assert np.median(np.abs(found["frequency"].values[loud] / 80.0 - 1.0)) < 1e-4
    assert np.median(np.abs(found["loss_factor"].values[loud] / 0.003 - 1.0)) < 0.03


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


@pytest.mark.parametrize("softening", [0.0, 0.004])
@pytest.mark.parametrize("part", [0.05, 0.2])
def test_a_doublet_that_beats_four_times_in_all_is_told_apart(part, softening):
    """Bells and strings; or a mode that a joint softens where it is loud."""
    time, fall = np.arange(int(6.0 * RATE)) / RATE, np.pi * 440.0 * 1e-3
    level = np.exp(-fall * time)
    frequency = 440.0 * (1.0 - softening * np.maximum(level - 0.3, 0.0) / 0.7)
    velocity = level * np.cos(2.0 * np.pi * np.cumsum(frequency) / RATE)
    velocity += part * level * np.cos(2.0 * np.pi * (440.0 + 0.5 * fall) * time + 1.0)
    velocity += 1e-3 * np.random.default_rng(1).standard_normal(time.size)
    judged, found = curve(0.02 * velocity, 442.0)
    assert "close-mode" in judged["finding_id"].values
    size = found["amplitude"].values * 2.0 * np.pi * 440.0 / 0.02
    clear = size > 0.02
    assert clear.sum() > 100
    true = 440.0 * (1.0 - softening * np.maximum(size - 0.3, 0.0) / 0.7)
    off = np.abs(found["frequency"].values - true)
    std = found["frequency_std"].values
    assert np.mean((off < np.maximum(3.0 * std, 5e-4 * 440.0))[clear]) > 0.95
    off = np.abs(found["loss_factor"].values - 440.0 * 1e-3 / true)
    std = found["loss_factor_std"].values
    assert np.mean((off < np.maximum(3.0 * std, 1e-4))[clear]) > 0.95


@pytest.mark.parametrize("bend", [0.05, -0.05])
def test_a_law_that_bends_at_the_start_is_no_second_mode(bend):
    time = np.arange(int(4.0 * RATE)) / RATE
    level = np.exp(-2.0 * time)
    frequency = 80.0 * (1.0 + bend * level**2)
    velocity = 0.02 * level * np.cos(2.0 * np.pi * np.cumsum(frequency) / RATE)
    velocity += NOISE * np.random.default_rng(1).standard_normal(time.size)
    judged, _ = curve(velocity, 80.0)
    assert not set(judged["finding_id"].values) & {"close-mode", "steady-line"}


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


def test_of_two_close_modes_each_is_the_one_that_is_meant():
    velocity = blow([(78.6, 0.0005, 0.03), (81.1, 0.0005, 0.05)], length_s=8.0)
    for expected_Hz, other_Hz, truth_Hz in ((79.9, 80.1, 78.6), (80.1, 79.9, 81.1)):
        found = separated(velocity, RATE, expected_Hz, (other_Hz,))
        line_Hz = mode_Hz(*loudest(found.velocity[found.first :], RATE, truth_Hz), truth_Hz)
        assert line_Hz == pytest.approx(truth_Hz, abs=0.3)


@pytest.mark.parametrize(("other_Hz", "told"), [(83.0, True), (297.0, False), (93.0, False)])
def test_a_close_mode_of_the_sheet_that_is_not_seen_apart_warns(other_Hz, told):
    """The sheet has two modes near 80 Hz, of which one rings; 93 Hz lies beyond an eighth."""
    judged, found = curve(blow(MODES), 80.8, (other_Hz, 846.0))
    assert ("not-apart" in judged["finding_id"].values) == told
    assert found["frequency"].values[0] == pytest.approx(80.0, rel=1e-3)


def test_a_close_mode_of_the_sheet_that_is_seen_apart_does_not_warn():
    judged, _ = curve(blow([*MODES, (85.5, 0.002, 0.05)]), 80.8, (85.0, 297.0))
    assert "not-apart" not in judged["finding_id"].values


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
