"""Harmonics beside the mode: known as well as is said, or told where no record can tell."""

import numpy as np
import pytest
from bladeroot.decay.free_decay import free_decay
from bladeroot.decay.harmonic import locked_harmonic, possible
from bladeroot.decay.record import estimate
from bladeroot.io.recording import recording

RATE, COUNT = 2000.0, 120


def frames(seed, part, turns, exponent=0.0, bent=0.3):
    """A mode whose laws bend, a harmonic of a line, that of unit size, and noise."""
    rng = np.random.default_rng(seed)
    time = np.arange(COUNT) / COUNT
    fall = rng.uniform(2.0, 3.5)
    mode = np.exp(-fall * time + bent * np.exp(-2.0 * time) + 2j * np.pi * bent * time**2)
    h = np.exp(-rng.uniform(1.0, 2.5) * time + 2j * np.pi * turns * time + 0.3j * time**2)
    g = part * np.exp(2j * np.pi * rng.uniform())
    noise = 1e-4 * (rng.standard_normal(COUNT) + 1j * rng.standard_normal(COUNT))
    return mode, g * h * np.abs(h) ** exponent, h, noise


@pytest.mark.parametrize("turns", [8.0, 16.0])
@pytest.mark.parametrize(("part", "exponent"), [(0.01, 0.0), (0.04, 0.2)])
def test_a_harmonic_is_known_as_well_as_is_said(part, exponent, turns):
    off = []
    for seed in range(6):
        mode, wave, h, noise = frames(seed, part, turns, exponent)
        law = locked_harmonic(mode + wave + noise, h, turns / COUNT)
        assert law is not None
        clear = np.abs(wave) < 0.3 * np.abs(mode)
        off.append(np.median(np.abs(law.phasor - wave)[clear] / law.error[clear]))
        assert np.median(np.abs(law.phasor - wave)[clear]) < 0.1 * np.median(np.abs(wave))
    assert np.median(off) < 2.0


def test_nothing_is_found_where_nothing_is():
    found = 0
    for seed in range(20):
        mode, _, h, noise = frames(100 + seed, 0.0, 1.0 + seed / 4.0)
        found += locked_harmonic(mode + noise, h, (1.0 + seed / 4.0) / COUNT) is not None
    assert not found


def test_of_what_is_short_no_harmonic_is_told():
    mode, wave, h, _ = frames(0, 0.02, 8.0)
    for count in (0, 2, 5):
        assert locked_harmonic((mode + wave)[:count], h[:count], 8.0 / COUNT) is None


def test_a_part_that_turns_as_the_line_falls_is_seen_in_windows():
    mode, _, h, noise = frames(1, 0.0, 6.0, bent=0.02)
    wave = 0.05 * h * np.exp(0.4j * np.log(np.abs(h)))  # as of modes in resonance
    law = locked_harmonic(mode + wave + noise, h, 6.0 / COUNT)
    share = np.abs(wave) / np.abs(mode)
    assert np.median(np.abs(law.phasor - wave)[share > 0.05] / np.abs(wave)[share > 0.05]) < 0.6


def record(at_Hz, part, seconds, law=2.0):
    """A mode of 120 Hz beside a loud line at its half and that line's harmonic, in m/s."""
    time = np.arange(int(seconds * RATE)) / RATE
    base = np.exp(-0.9 * time)
    turns = 2.0 * np.pi * (0.5 * at_Hz * time - 0.05 * (1.0 - base))
    mode = 0.02 * np.exp(-2.0 * time) * np.cos(2.0 * np.pi * 120.0 * time)
    wave = part * base**law * np.cos(2.0 * turns + 0.7)
    noise = 1e-6 * np.random.default_rng(7).standard_normal(time.size)
    return 0.1 * base * np.cos(turns) + mode + wave + noise


def curve(velocity, other_Hz):
    made = recording(velocity, "m/s", "here", sampling_Hz=RATE)
    judged = free_decay(made, 121.0, (other_Hz,))
    return judged, estimate(judged.assign_attrs(expected_Hz=121.0), damping="viscous")


def wrong(found):
    """Errors of frequency and loss factor over what is stated."""
    eta = 2.0 * 2.0 / (2.0 * np.pi * 120.0)
    off = {"frequency": found["frequency"] - 120.0, "loss_factor": found["loss_factor"] - eta}
    return {name: np.abs(values / found[f"{name}_std"]).values for name, values in off.items()}


def test_a_harmonic_of_three_turns_in_the_record_is_taken_off():
    judged, found = curve(record(118.5, 4e-4, 2.0), 59.2)
    assert "harmonic" in judged["finding_id"].values
    assert judged.attrs["components_Hz"][-1] == pytest.approx(118.5, abs=0.2)
    assert max(np.median(one) for one in wrong(found).values()) < 2.0
    assert np.median(np.abs(found["frequency"].values / 120.0 - 1.0)) < 3e-5


def test_a_harmonic_that_the_record_cannot_tell_is_in_the_errors():
    plain, alone = curve(record(110.0, 0.0, 2.0), 55.0)
    judged, found = curve(record(119.9, 4e-4, 2.0), 59.9)
    assert "harmonic" not in plain["finding_id"].values
    assert "harmonic" in judged["finding_id"].values
    assert len(judged.attrs["components_Hz"]) == 1  # it is no wave that is taken off
    wider = found["frequency_std"].median() / alone["frequency_std"].median()
    assert float(wider) > 10.0
    assert max(one.max() for one in wrong(found).values()) < 3.0


@pytest.mark.parametrize("seconds", [0.6, 1.0, 1.4])
def test_a_forced_harmonic_is_in_the_errors_of_a_record_too_short_to_tell(seconds):
    # near its own frequency a mode answers much to a small force: 5 % of the line, not 0.5 %
    _, found = curve(record(119.5, 5e-3, seconds), 59.75)
    assert np.mean(np.concatenate([*wrong(found).values()]) < 3.0) > 0.95


def test_a_harmonic_that_hides_the_mode_all_along_is_told():
    judged, found = curve(record(119.6, 0.005, 1.2, law=1.2), 59.8)
    # it rings as a second mode does; which it is, is not said
    assert set(judged["finding_id"].values) & {"harmonic", "close-mode"}
    assert all((one < 3.0).all() for one in wrong(found).values())


def test_what_all_windows_leave_possible_holds_the_harmonic():
    held = []
    for seed in range(20):
        mode, wave, h, noise = frames(200 + seed, 0.02, 1.5)
        most = possible(mode + wave + noise, h, 1.5 / COUNT)
        held.append(0.3 < most / 0.02 < 10.0)
    assert np.mean(held) > 0.85
    assert possible(mode[:5], h[:5], 1.5 / COUNT) == np.inf
