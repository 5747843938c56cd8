"""What a curve's stated errors hold: starts, drives, sways, modes beside it, gains, bumps."""

import numpy as np
import pytest
from bladeroot.decay import curve_errors
from bladeroot.decay.curve_errors import acting, beats, bumps, driven, gains
from bladeroot.decay.freevib import freevib
from bladeroot.signal.phasors import Phasors
from decay_bench import START, ring_down, ringing, separated_curves


def logs(more, std=1e-3):
    """Blocks of a mode that bends, with something besides, as a function of their number."""
    own = np.arange(60.0)
    log = (-0.02 + 0.3j) * own + (2e-5 - 4e-5j) * own**2 + more(own)
    noise = np.random.default_rng(5).standard_normal((2, own.size))
    return Phasors(4e-3 * own, log + std * (noise[0] + 1j * noise[1]), np.full(own.size, std))


@pytest.mark.parametrize("count", [3, 6, 12])
def test_rates_are_unsure_by_what_still_acts_at_the_start(count):
    """A frequency and a damping that are off by 5/s in the first blocks, and right after them."""
    blocks = logs(lambda own: -(3.5 + 3.5j) * 4e-3 * np.clip(count - own, 0.0, None))
    error = acting(blocks)
    np.testing.assert_allclose(error[: count - 1], 5.0, rtol=0.5)
    assert not error[12:].any()


@pytest.mark.parametrize("size", [0.0, 0.02])
def test_what_is_alike_all_along_is_no_start(size):
    assert not acting(logs(lambda own: size * np.sin(own))).any()


@pytest.mark.parametrize("power", [0.0, 1.0, 4.0])
def test_what_holds_a_mode_up_at_the_start_is_in_the_rates_errors(power):
    """A mode whose decay rate goes with 1/A^power, and what slows it down for ten points."""
    fall = np.linspace(0.0, 1.0, 101)
    law = 4.0 * np.exp(min(power, 1.0) * fall)
    slow = law * (np.exp(power * (fall - 0.1)) if power > 1.0 else 1.0)
    rate = np.where(fall < 0.1, slow, law)
    found = driven(-fall, rate, np.full(101, 0.01))
    if power > 1.0:
        missed = law[:8] - rate[:8]
        assert (found[:8] > 0.3 * missed).all()
        assert (found[:8] < 1.1 * missed).all()
        assert (np.diff(found) <= 0.0).all()
        assert not found[11:].any()
    else:
        assert not found.any()


def test_noise_holds_no_mode_up():
    rate = 4.0 + 0.1 * np.random.default_rng(2).standard_normal(60)
    assert not driven(np.linspace(0.0, -0.6, 60), rate, np.full(60, 0.1)).any()


def test_a_drive_that_ends_within_a_record_is_no_law():
    """It holds the mode at its level for 14 cycles; the record begins with it."""
    time = np.arange(4800) / 9600.0
    since = np.maximum(time - 0.03, 0.0)
    level = 0.02 * np.exp(-11.0 * since)
    velocity = level * np.cos(2.0 * np.pi * 450.0 * time)
    noise = 1e-5
    velocity += noise * np.random.default_rng(4).standard_normal(time.size)
    curve = freevib(velocity, 9600.0, 445.0, noise)
    off = (curve["loss_factor"] - 22.0 / (2.0 * np.pi * 450.0)) / curve["loss_factor_std"]
    assert np.abs(off.values).max() < 3.0


def test_errors_that_are_large_fall_no_faster_than_what_acts_dies():
    velocity, noise, *_ = ring_down(3, noise_db=60)
    velocity[:300] *= np.linspace(0.9, 1.0, 300)
    curve = separated_curves(velocity, 25600.0, 247.0, noise)
    error = curve["loss_factor_std"].values
    assert (error[1:] > np.exp(-0.7) * error[:-1]).all()


def test_errors_are_larger_where_damping_is_hardly_known(monkeypatch):
    velocity, noise, *_ = ring_down(3, noise_db=40)
    stated = separated_curves(velocity, 25600.0, 247.0, noise)
    monkeypatch.setattr(curve_errors, "WEAK", 0.0)
    plain = separated_curves(velocity, 25600.0, 247.0, noise)
    part = (plain["loss_factor_std"] / plain["loss_factor"]).values
    assert part[24:].min() < 0.01
    assert part.max() > 0.05
    for name in ("frequency_std", "loss_factor_std"):
        ratio = (stated[name] / plain[name]).values
        assert (ratio[:2] == 1.0).all()  # the start's own part is larger there
        np.testing.assert_allclose(ratio[24:], 1.0 + 4.0 * part[24:], rtol=1e-3)
    np.testing.assert_array_equal(stated["amplitude_std"], plain["amplitude_std"])


def test_a_gain_that_sways_is_in_the_errors():
    at = np.arange(102400) / 25600.0
    steady = START * ringing(at, 250.0, 0.004 * np.pi * 250.0)
    noise = 1e-4 * START
    missed = {False: [], True: []}
    for seed in range(3):
        rng = np.random.default_rng(seed)
        sway = sum(np.sin(2 * np.pi * (f * at + rng.uniform())) for f in rng.uniform(2.0, 20.0, 6))
        for gain, swaying in ((1.0, False), (1.0 + 0.004 * sway, True)):
            curve = separated_curves(
                gain * steady + noise * rng.normal(size=at.size), 25600.0, 250.0, noise
            )
            std = curve["loss_factor_std"].values
            missed[swaying].extend(np.abs(curve["loss_factor"].values - 0.004) / std)
            middle = slice(curve.sizes["point"] // 4, curve.sizes["point"] // 2)
            assert (np.median(std[middle]) / 0.004 > 0.03) == swaying
    for z in missed.values():
        assert np.mean(np.array(z) < 3.0) > 0.97


def test_a_phase_that_sways_is_in_the_frequency_errors():
    """So does what is left of another mode in it."""
    rng, at = np.random.default_rng(0), np.arange(102400) / 25600.0
    sway = sum(np.sin(2 * np.pi * (f * at + rng.uniform())) for f in rng.uniform(2.0, 20.0, 6))
    for part, swaying in ((0.0, False), (0.004, True)):
        phase = 2 * np.pi * 250.0 * at + part * sway
        velocity = START * np.exp(-0.004 * np.pi * 250.0 * at) * np.cos(phase)
        noise = 1e-4 * START
        velocity += noise * rng.normal(size=at.size)
        curve = separated_curves(velocity, 25600.0, 250.0, noise)
        own = 250.0 * np.sqrt(1.0 - 0.002**2)
        z = np.abs(curve["frequency"].values - own) / curve["frequency_std"].values
        assert np.mean(z < 3.0) > 0.95
        middle = slice(curve.sizes["point"] // 4, curve.sizes["point"] // 2)
        assert (np.median(curve["frequency_std"].values[middle]) > 0.01) == swaying


def test_a_close_mode_that_dies_early_is_in_the_errors_of_the_start():
    rng, at = np.random.default_rng(0), np.arange(2048) / 512.0
    own, noise = 33.64, 1e-4 * START
    velocity = START * ringing(at, own, 0.8) + 0.15 * START * ringing(at, own + 2.2, 3.2)
    curve = freevib(velocity + noise * rng.normal(size=at.size), 512.0, own, noise)
    loss = 1.6 / (2.0 * np.pi * own)
    z = np.abs(curve["loss_factor"] - loss) / curve["loss_factor_std"]
    assert np.mean(z.values < 3.0) > 0.97
    part = curve["loss_factor_std"].values / loss
    assert part[:20].min() > 0.1 > 5.0 * np.median(part[part.size // 2 :])


@pytest.mark.parametrize("turns", [1, 3])
def test_a_law_that_turns_a_few_times_does_not_beat(turns):
    fall = np.linspace(0.0, 2.0, 300)
    law = np.stack([0.01 * np.cos(np.pi * (turns + 1) * fall / 2.0)] * 2)
    assert not beats(-fall, law, np.full(law.shape, 1e-4)).any()


def test_where_a_mode_gains_its_rates_are_as_wrong_as_that():
    growth, std = np.full(40, -2.0), np.full(40, 0.1)
    growth[18:21] = 0.29, 0.5, 0.31  # within three errors at first
    growth[5] = 0.2
    error = gains(growth, std)
    expected = np.zeros(40)
    expected[15:25] = 0.5  # two points that gain, and four on either side
    assert np.array_equal(error, expected)
    assert not gains(np.full(4, -1.0), np.full(4, 0.1)).any()
    assert np.array_equal(gains(np.ones(4), np.full(4, 0.1)), np.ones(4))


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_bump_too_narrow_for_a_law_is_in_the_errors_of_both_rates(sign):
    """The rates swing at one place; the one that swings less is unsure by its own half."""
    fall = np.linspace(0.0, 3.0, 301)
    bump = np.exp(-(((fall - 1.0) / 0.03) ** 2))
    rates = np.stack([-4.0 - 0.1 * sign * bump, 200.0 + sign * bump])
    found = bumps(-fall, rates, np.full(rates.shape, 0.01))
    off = np.abs(fall - 1.0)
    np.testing.assert_allclose(found[:, off < 0.05].max(axis=1), [0.05, 0.5], rtol=0.02)
    assert (found[:, off < 0.05] > 0.0).all()
    assert not found[:, off > 0.2].any()


@pytest.mark.parametrize(("width", "height"), [(0.3, 1.0), (0.03, 0.04)])
def test_a_law_s_own_hump_and_noise_are_no_bumps(width, height):
    fall = np.linspace(0.0, 3.0, 301)
    law = height * np.exp(-(((fall - 1.0) / width) ** 2)) + 10.0 * fall
    law += 0.01 * np.random.default_rng(4).standard_normal(fall.size)
    assert not bumps(-fall, np.stack([law, law]), np.full((2, fall.size), 0.02)).any()


def test_a_slip_of_phase_within_a_decay_is_in_the_errors():
    at = np.arange(51200) / 25600.0
    noise = 1e-3 * START
    slip = np.where(at > 1.0, 0.1, 0.0)
    velocity = START * np.exp(-1.5 * at) * np.cos(2.0 * np.pi * 250.0 * at + slip)
    velocity += noise * np.random.default_rng(0).standard_normal(at.size)
    curve = freevib(velocity, 25600.0, 250.0, noise)
    z = np.abs(curve["frequency"].values - 250.0) / curve["frequency_std"].values
    assert np.abs(curve["frequency"].values - 250.0).max() > 0.1
    assert z.max() < 4.0


def test_a_second_mode_that_dies_sooner_and_lets_the_envelope_rise_is_in_the_errors():
    rate = 2000.0
    time = np.arange(int(rate)) / rate
    own = 0.01 * np.exp(-0.5 * time) * np.cos(2.0 * np.pi * 100.0 * time)
    other = 0.02 * np.exp(-5.0 * time) * np.cos(2.0 * np.pi * 101.0 * time)
    velocity = own + other + 1e-5 * np.random.default_rng(1).standard_normal(time.size)
    found = freevib(velocity, rate, 100.0, 1e-5)
    assert found.sizes["point"] > 40
    assert (found["loss_factor"] > -3.0 * found["loss_factor_std"]).all()
