"""Frames against exact waves, and their errors against scatter."""

import numpy as np
import pytest
from bladeroot.decay.track import noise_ratio, without_knocks
from bladeroot.signal.phasors import FrameGrid, corrected, fit_frames, gather

RATE = 25600.0
GRIDS = [FrameGrid(0, 104, 40, 2 * np.pi / 104.0), FrameGrid(4160, 102, 60, 2 * np.pi / 102.0)]
COUNT = 104 * 40 + 102 * 60
TIME = np.arange(COUNT) / RATE
ALL = slice(0, 100)


def log_phasor(time):
    """ln of the analytic signal of a chirp that dies away, and its two derivatives."""
    return (
        -6.0 * time + 5.0 * time**2 + 1j * (2 * np.pi * (246.0 * time + 12.0 * time**2) + 0.7),
        -6.0 + 10.0 * time + 2j * np.pi * (246.0 + 24.0 * time),
        np.full(time.shape, 10.0 + 48.0j * np.pi),
    )


def test_growth_and_chirp_within_frames_are_allowed_for():
    frames = fit_frames(np.exp(log_phasor(TIME)[0]).real, RATE, 1e-3, GRIDS)
    log, rate, change = log_phasor(frames.time)
    raw = np.abs(frames.phasor * np.exp(-log) - 1.0).max()
    better = np.abs(corrected(frames, ALL, rate, change) * np.exp(-log) - 1.0).max()
    assert better < 3e-6 < 1e-4 < raw


def test_standard_errors_of_frames():
    noise = np.random.default_rng(0).standard_normal(COUNT)
    frames = fit_frames(noise, RATE, 1.0, GRIDS)
    z = frames.phasor / frames.std
    assert np.mean(np.abs(z) ** 2) == pytest.approx(2.0, rel=0.25)


def test_masked_samples_have_no_weight():
    rng = np.random.default_rng(1)
    wave = np.exp(log_phasor(TIME)[0]).real
    usable = rng.uniform(size=COUNT) > 0.2
    usable[3000:3200] = False
    frames = fit_frames(np.where(usable, wave, 9.0), RATE, 1e-3, GRIDS, usable)
    log, rate, change = log_phasor(frames.time)
    every = slice(0, frames.time.size)
    assert frames.time.size in (98, 99)
    error = corrected(frames, every, rate, change) * np.exp(-log) - 1.0
    assert np.abs(error).max() < 1e-5
    assert not np.isclose(frames.std, frames.std[0]).all()


def test_blocks_gather_weak_frames_and_end_where_the_mode_is_lost():
    rng = np.random.default_rng(2)
    time = np.arange(1500) * 4e-3
    log = -1.5 * time + 2j * np.pi * 250.0 * time
    phasor = np.exp(log) + 0.02 * (rng.standard_normal(1500) + 1j * rng.standard_normal(1500))
    blocks, miss = gather(time, phasor, np.full(1500, 0.02), log)
    assert blocks.std.max() < 0.3
    assert 2.5 < blocks.time[-1] < 5.0
    off = blocks.log - (-1.5 + 500j * np.pi) * blocks.time
    off -= 2j * np.pi * np.round(off.imag.mean() / (2 * np.pi))
    assert np.abs(off - miss).max() < 0.05
    assert np.mean(np.abs(off) ** 2 / blocks.std**2) == pytest.approx(2.0, rel=0.25)
    # errors that are no numbers end the blocks, not the process
    unknown = np.where(np.arange(1500) < 200, 0.02, np.nan)
    assert gather(time, phasor, unknown, log)[0].time.size <= 200
    # no more blocks than asked for, however many frames
    assert gather(time, np.exp(log), np.full(1500, 1e-9), log, most=500)[0].time.size <= 500


def test_scatter_is_measured_whatever_smooth_curve_it_rides():
    rng = np.random.default_rng(3)
    std = np.geomspace(1.0, 5.0, 800)
    miss = 2.5 * std * rng.standard_normal((2, 800)) + 20.0 * np.sin(np.linspace(0, 6, 800))
    assert noise_ratio(miss, std) == pytest.approx(2.5, rel=0.2)
    assert (noise_ratio(miss[:, :8], std[:8]) == 1.0).all()


@pytest.mark.parametrize("place", [0, 100, 199])
def test_a_knock_is_doubted_wherever_it_is(place):
    rng = np.random.default_rng(4)
    std = np.ones(200)
    miss = rng.standard_normal((2, 200)) + 0.5 * np.arange(200)
    assert (without_knocks(miss, std) == std).all()
    miss[1, place] += 40.0
    doubt = without_knocks(miss, std)
    assert doubt[place] > 20.0
    assert (np.delete(doubt, place) == 1.0).all()
