"""Strange motion through every stage of a record: a verdict in words, never an exception."""

import json
import warnings

import numpy as np
import pytest
from bladeroot.decay.cut import cut
from bladeroot.decay.free_decay import _clipped
from bladeroot.decay.overrides import shortened
from bladeroot.decay.record import estimate
from bladeroot.plateau.plateau import plateau
from bladeroot.quality.integrity import bridged, judge
from bladeroot.signal.recording import Recording

RATE, MODE, COUNT = 8000.0, 400.0, 12000
TIME = np.arange(COUNT) / RATE
RNG = np.random.default_rng(11)
NOISE = 1e-4 * RNG.standard_normal(COUNT)
TONE = np.cos(2 * np.pi * MODE * TIME)
DECAY = 0.1 * np.exp(-6.0 * TIME) * TONE


def only(first, last, signal):
    """A signal between two samples and exact silence elsewhere."""
    made = np.zeros(COUNT)
    made[first:last] = signal[first:last]
    return made


STRANGE = {
    "a single sample": only(COUNT - 1, COUNT, np.ones(COUNT)),
    "a step": (TIME > 0.5).astype(float),
    "motion at the very end": only(COUNT - 8, COUNT, TONE),
    "a square wave": np.sign(TONE),
    "noise": NOISE,
    "brown noise": np.cumsum(NOISE),
    "a ramp": TIME.copy(),
    "a steady tone": TONE,
    "a growing tone": np.exp(5.0 * TIME) * TONE,
    "a decay without noise": DECAY,
    "a decay in silence": only(3000, COUNT, np.roll(DECAY, 3000)),
    "two bits": np.round(DECAY / 0.05) * 0.05,
    "a decay with a hole": np.where((TIME > 0.1) & (TIME < 0.4), 0.0, DECAY) + NOISE,
    "a decay backwards": DECAY[::-1] + NOISE,
    "spikes alone": np.where(RNG.random(COUNT) < 0.01, RNG.standard_normal(COUNT), 0.0),
    "another mode": 0.1 * np.exp(-4.0 * TIME) * np.cos(2 * np.pi * 1.3 * MODE * TIME) + NOISE,
    "a stronger mode that stays": DECAY + 0.02 * np.cos(2 * np.pi * 1.25 * MODE * TIME) + NOISE,
    "huge numbers": 1e9 * (DECAY + NOISE),
    "tiny numbers": 1e-12 * (DECAY + NOISE),
    "an offset that drowns all": 1e6 + DECAY,
}


@pytest.mark.parametrize("name", STRANGE)
def test_strange_motion_is_judged_in_words(name):
    velocity = STRANGE[name]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        decay = cut(bridged(velocity, RATE, MODE), RATE, MODE)
        judged = judge(decay, velocity, MODE, (2.7 * MODE,))
        judged.attrs["expected_Hz"] = MODE
        curves = estimate(judged)
        found = plateau(curves)
    assert judged.attrs["verdict"] in ("usable", "rejected")
    assert judged.attrs["verdict"] == "usable" or judged.attrs["findings"]
    assert json.dumps(str(found["verdict"]))
    frequency = found["stick_frequency"]
    if np.isfinite(frequency):
        assert abs(frequency / MODE - 1.0) < 0.35


@pytest.mark.parametrize("samples", [1, 3, 10])
def test_a_blow_some_samples_before_a_decays_end_leaves_nothing_that_is_clipped(samples):
    decay = cut(DECAY, RATE, MODE)
    left = shortened(decay, DECAY, decay.attrs["end_s"] - (samples - 0.5) / RATE, None)
    assert left.sizes["time"] == samples
    assert _clipped(left, DECAY, MODE, Recording(DECAY, RATE, "velocity")) == (0, ())


def test_a_clean_decay_among_them_is_right():
    velocity = DECAY + NOISE
    judged = judge(cut(velocity, RATE, MODE), velocity, MODE)
    judged.attrs["expected_Hz"] = MODE
    found = plateau(estimate(judged))
    assert found["stick_frequency"] == pytest.approx(MODE, rel=1e-5)
