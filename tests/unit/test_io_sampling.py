"""Times that are not even: of samples that are, and of samples that were taken at these."""

import numpy as np
import pytest
from bladeroot.io.recording import recording
from bladeroot.io.sampling import evened
from decay_bench import ringing

RATE, MODE = 200.0, 11.3


def scattered(part, count=3000):
    """Times that lie up to so large a part of a step off even ones."""
    rng = np.random.default_rng(3)
    return (5.0 + np.arange(count) + part * rng.uniform(-1.0, 1.0, count)) / RATE


def motion(time):
    return ringing(time, MODE, 0.3)


@pytest.mark.parametrize("part", [0.15, 0.4])
def test_samples_taken_at_uneven_times_are_brought_to_even_ones(part):
    time = scattered(part)
    made = recording(motion(time), "mm", "a.csv", time)
    even = made.start_s + np.arange(time.size) / made.sampling_Hz
    assert made.sampling_Hz == pytest.approx(RATE, rel=1e-4)
    np.testing.assert_allclose(1e3 * made.samples[3:-3], motion(even)[3:-3], atol=2e-3)
    (note,) = made.notes
    assert "interpolated to even ones (a.csv)" in note


@pytest.mark.parametrize("part", [0.15, 0.4])
def test_times_that_a_computer_wrote_down_late_do_not_move_even_samples(part):
    time = scattered(part)
    samples = motion((5.0 + np.arange(time.size)) / RATE)
    made = recording(samples, "mm", "a.csv", time)
    assert made.sampling_Hz == pytest.approx(RATE, rel=1e-4)
    np.testing.assert_allclose(1e3 * made.samples, samples, rtol=1e-12)
    assert "count as even" in made.notes[0]


def test_numbers_lost_at_the_end_and_uneven_times():
    time = scattered(0.2)
    made = recording(np.append(motion(time[:-5]), [np.nan] * 5), "mm", "a.csv", time)
    assert made.samples.size == time.size - 5


@pytest.mark.parametrize(
    "time",
    [
        np.delete(np.arange(301), 100) / RATE,  # one is missing
        np.arange(300)[::-1] / RATE,
        np.append(np.arange(299) / RATE, np.nan),
        np.arange(299) / RATE,
        np.round(np.arange(300) / RATE, 2),  # too few digits
    ],
)
def test_times_that_do_more_than_scatter_are_not_evened(time):
    samples = motion(np.arange(300) / RATE)
    assert evened(time, samples) is None
    with pytest.raises(ValueError, match=r"time|times"):
        recording(samples, "mm", "a.csv", time)


def test_too_few_samples_a_cycle_do_not_tell_what_lies_between_them():
    time = scattered(0.2)
    assert evened(time, ringing(time, 0.3 * RATE, 0.3)) is None
