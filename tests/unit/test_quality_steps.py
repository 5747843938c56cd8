"""Steps of a decay: touches, samples that are missing, and what is neither."""

import numpy as np
import pytest
from decay_bench import RATE, START, coulomb_decay, ring_down, ringing
from judging import decay, ids, judged, text, uncut
from scipy.signal import hilbert


def stepped(factor, at, noise=1e-3):
    """A decay whose mode changes by a complex factor at a sample."""
    analytic = hilbert(ring_down(second=0.0, noise_db=120, bits=24)[0])
    after = np.arange(analytic.size) >= at
    velocity = np.where(after, analytic * factor, analytic).real
    return velocity + noise * START * np.random.default_rng(0).standard_normal(after.size)


@pytest.mark.parametrize("factor", [1.1, np.exp(-0.1j)])
def test_shaker_recontact(factor):
    found = judged(stepped(factor, 12000))
    assert "shaker-recontact" in ids(found)
    usable = found["usable"].values == 1
    assert usable.mean() > 0.2
    # nothing on one side of the step is used, and three cycles around it neither
    kept = np.flatnonzero(usable)
    assert kept[0] > 12000 or kept[-1] < 12000


def test_missing_samples():
    velocity = np.delete(decay(second=0.0, bits=24), slice(12000, 12040))
    found = judged(velocity)
    kept = found.attrs["start_s"], found.attrs["end_s"]
    assert "gap" in ids(found) or not kept[0] < 12000 / RATE < kept[1]


@pytest.mark.parametrize("factor", [1.01, np.exp(0.01j)])
def test_the_cycles_beside_a_small_step_are_masked(factor):
    found = judged(stepped(factor, 15000, 5e-5))
    assert ids(found) == {"shaker-recontact"}
    masked = np.flatnonzero(found["usable"].values == 0) + round(found.attrs["start_s"] * RATE)
    assert 28 < masked.size * 250.0 / RATE < 45
    assert masked.mean() == pytest.approx(15000, abs=5 * RATE / 250.0)


@pytest.mark.parametrize(("factor", "told"), [(1.1, True), (1.01, True), (1.0045, False)])
def test_when_a_decay_steps_stands_beside_it_whether_it_is_told_or_not(factor, told):
    found = judged(stepped(factor, 15000, 5e-5))
    assert ("shaker-recontact" in ids(found)) == told == (found.attrs["step_ratio"] > 1.0)
    assert found.attrs["step_s"] == pytest.approx(15000 / RATE, abs=3.0 / 250.0)


def without(lost, at=14000):
    """A decay without some samples, or with some twice."""
    velocity = coulomb_decay(0.2, 0.003)
    return np.concatenate([velocity[:at], velocity[at + lost :]])


@pytest.mark.parametrize("lost", [1, 2, -1])
def test_a_step_in_phase_by_whole_samples_is_a_gap(lost):
    found = judged(without(lost))
    assert "gap" in ids(found)
    assert "shaker-recontact" not in ids(found)


@pytest.mark.parametrize(("lost", "what"), [(512, "missing (512"), (-1024, "repeated (1024")])
def test_a_step_that_a_longer_gap_would_make_is_told_as_either(lost, what):
    told = text(judged(without(lost)), "shaker-recontact")
    assert f"or samples are {what} would fit)" in told


def test_a_step_that_no_gap_makes_is_a_touch():
    told = text(judged(stepped(1.04 * np.exp(0.1j), 12000)), "shaker-recontact")
    assert told.startswith("a disturbance, as if something touched the specimen: ")


@pytest.mark.parametrize(("plateau", "more"), [(0.005, 5.0), (0.003, 9.0)])
def test_a_hump_of_damping_without_softening_is_no_touch(plateau, more):
    """A damping ratio that is up to 6 or 10 times its plateau's where ln A falls by some units."""
    level = -np.linspace(0.0, 9.0, 20_001)
    part = np.exp(level) / 0.2
    rate = 2.0 * np.pi * 250.0 * plateau * (1.0 + 4.0 * more * part / (1.0 + part) ** 2)
    slope = 1.0 / rate
    at = np.append(0.0, np.cumsum(0.5 * (slope[1:] + slope[:-1]) * (level[0] - level[1])))
    time = np.arange(int(min(at[-1], 4.0) * RATE)) / RATE
    velocity = START * np.exp(np.interp(time, at, level)) * np.cos(2.0 * np.pi * 250.0 * time)
    velocity += 1e-4 * START * np.random.default_rng(0).standard_normal(time.size)
    assert "shaker-recontact" not in ids(uncut(velocity))


@pytest.mark.parametrize("slope", [0.0, -1.5])
@pytest.mark.parametrize("seed", range(4))
def test_noise_that_is_louder_around_the_mode_makes_no_step(slope, seed):
    """Noise behind a filter at 600 Hz, and noise that falls with the frequency."""
    noise = np.fft.rfft(np.random.default_rng(seed).standard_normal(40_000))
    frequency = np.fft.rfftfreq(40_000, 1.0 / RATE)
    noise *= (frequency > 20.0) * np.maximum(frequency / 250.0, 0.05) ** slope
    noise *= (frequency < 600.0) if slope == 0.0 else 1.0
    noise = np.fft.irfft(noise)
    velocity = START * ringing(np.arange(noise.size) / RATE, 250.0, 8.0)
    found = ids(uncut(velocity + 0.01 * START * noise / noise.std()))
    assert not found & {"shaker-recontact", "gap"}
