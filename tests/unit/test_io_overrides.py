"""A person's overrides: start, end, band and keep, shown among the findings."""

import numpy as np
import pytest
from bladeroot.decay.overrides import in_band, within
from bladeroot.decay.record import analyse
from bladeroot.io.overrides import overruled
from bladeroot.io.recording import part
from bladeroot.signal.recording import Recording

RATE, F, DECAY = 2000.0, 50.0, 3.0
KNOWN = {"record": "r", "mode": "m", "expected_Hz": F, "hold": "r", "direction": "", "load": 0.0,
         "load_name": "", "load_unit": "", "other_modes_Hz": [], "simulated": False}  # fmt: skip
CUTTING, ESTIMATION = {"end": "noise"}, {"damping": "hysteretic"}


def ring(seconds=4.0, begin=0.5, seed=0, other=0.0):
    t = np.arange(seconds * RATE) / RATE
    free = np.where(t >= begin, np.exp(-DECAY * (t - begin)), 0.0)
    x = free * np.sin(2 * np.pi * F * t) + other * np.sin(2 * np.pi * 55.0 * t)
    noise = 1e-5 * np.random.default_rng(seed).standard_normal(t.size)
    return Recording(1e-2 * x + noise, RATE, "velocity")


def made(recording=None, **row):
    known = {**KNOWN, **row, "overruled": overruled(row)}
    return analyse(recording or ring(), known, CUTTING, ESTIMATION)


def test_a_person_sets_where_the_decay_begins_and_ends():
    decay, curves, _ = made(start_s=0.8, end_s=1.6, note="door slammed at 1.7 s")
    assert decay.attrs["start_s"] == pytest.approx(0.8)
    assert decay.attrs["end_s"] == pytest.approx(1.6, abs=1 / RATE)
    assert decay["finding_id"].values[0] == "override"
    assert "start_s 0.8, end_s 1.6 (door slammed" in decay["finding_text"].values[0]
    assert float(np.median(curves["frequency"])) == pytest.approx(F, rel=1e-3)


def test_keep_makes_findings_warn_and_shows_it():
    short = ring(seconds=0.2, begin=0.0)  # ten cycles of a decay that nobody saw begin
    dropped, kept = made(short)[0], made(short, keep=True, start_s=0.0, end_s=0.19)[0]
    assert dropped.attrs["verdict"] == "rejected"
    assert kept.attrs["verdict"] == "usable"
    assert "drop" not in kept["finding_consequence"].values
    assert "keep yes" in kept["finding_text"].values[0]


def test_a_window_without_samples_is_rejected_in_words():
    decay = made(start_s=9.0)[0]
    assert decay.attrs["verdict"] == "rejected"
    assert "nothing between start_s 9 and" in decay.attrs["reason"]


def test_the_band_takes_a_neighbour_off_and_leaves_the_mode():
    t = np.arange(8000) / RATE
    own, other = np.sin(2 * np.pi * 50.0 * t + 0.3), np.sin(2 * np.pi * 90.0 * t)
    found, lost = in_band(own + other, RATE, (35.0, 65.0), 50.0)
    inside = slice(lost, -lost)
    assert np.abs(found - own)[inside].max() < 0.02
    with pytest.raises(ValueError, match="must hold the mode's 50 Hz"):
        in_band(own, RATE, (60.0, 70.0), 50.0)
    with pytest.raises(ValueError, match="must begin above 0 Hz"):
        in_band(own, RATE, (-5.0, 70.0), 50.0)
    with pytest.raises(ValueError, match="needs a decay of over"):
        in_band(own[:200], RATE, (49.0, 51.0), 50.0)


@pytest.mark.parametrize("band", [(40.0, 70.0), (46.0, 120.0), (20.0, 52.0)])
def test_a_band_does_not_change_a_mode_that_moves_in_it(band):
    t = np.arange(20000) / RATE
    for tone in (47.0, 50.0, 51.5):
        own = np.exp(-0.3 * t) * np.sin(2 * np.pi * tone * t)
        found, lost = in_band(own, RATE, band, 50.0)
        inside = slice(lost, own.size - lost)
        assert np.abs((found - own)[inside] / np.exp(-0.3 * t[inside])).max() < 2e-3


def test_a_curve_is_not_given_where_the_mode_leaves_the_band():
    whole = made()[1]
    edge = float(np.median(whole["frequency"]))
    found = within(whole, (edge - 20.0, edge))
    assert 0 < found.sizes["point"] < whole.sizes["point"]
    assert (found["frequency"] < edge).all()
    times = found["time"].values
    assert times[0] <= found["block_time"].values[0] <= found["block_time"].values[-1] <= times[-1]
    with pytest.raises(ValueError, match="lies outside band_Hz, 90 to 95 Hz, all along"):
        within(whole, (90.0, 95.0))


def test_the_band_reaches_the_estimator():
    curves = made(band_Hz=[30.0, 70.0])[1]
    assert curves.attrs["verdict"] == "usable"
    assert float(np.median(curves["frequency"])) == pytest.approx(F, rel=1e-3)
    assert "must hold the mode" in made(band_Hz=[60.0, 70.0])[1].attrs["reason"]


def softening(seed, seconds=4.0):
    """A decay of 180 Hz whose frequency falls by 1 % and whose loss rises with the amplitude."""
    rate, x, turned = 6000.0, 1e-2, 0.0
    amplitude, phase = np.empty((2, int(seconds * rate)))
    for k in range(amplitude.size):
        amplitude[k], phase[k] = x, turned
        bend = x**2 / (x**2 + 2e-3**2)
        omega = 2.0 * np.pi * 180.0 * (1.0 - 0.01 * bend) / rate
        turned += omega
        x *= np.exp(-0.5 * omega * (4e-3 + 3e-3 * bend))
    noise = 3e-6 * np.random.default_rng(seed).standard_normal(amplitude.size)
    return amplitude, Recording(amplitude * np.cos(phase) + noise, rate, "velocity")


def test_errors_hold_in_a_band_although_neighbouring_cycles_share_its_noise():
    z = []
    for seed in range(3):
        amplitude, recording = softening(seed)
        curves = made(recording, expected_Hz=180.0, band_Hz=[165.0, 195.0])[1]
        time = curves["time"].values + curves.attrs["start_s"]
        x = np.interp(time, np.arange(amplitude.size) / 6000.0, amplitude)
        bend = x**2 / (x**2 + 2e-3**2)
        error = curves["loss_factor"].values - (4e-3 + 3e-3 * bend)
        z.append(error / curves["loss_factor_std"].values)
    assert np.mean(np.abs(np.concatenate(z)) < 3.0) > 0.99


def test_nothing_overruled_says_nothing():
    assert overruled({"start_s": None, "keep": False}) == ""
    assert overruled({"band_Hz": [5, 9]}) == "band_Hz 5-9: no note says why"
    assert "override" not in made()[0]["finding_id"].values


def test_each_of_several_decays_in_a_file_can_be_a_record():
    ones = [ring(seed=k).samples * gain for k, gain in enumerate((1.0, 0.6))]
    both = Recording(np.concatenate(ones), RATE, "velocity", start_s=2.0)
    decay = made(both)[0]
    assert decay.attrs["decays"] == 2
    assert "several-decays" in decay["finding_id"].values
    second = part(both, 4.0, None, "f.csv")
    assert second.start_s == 6.0
    decay, curves, _ = made(second)
    assert decay.attrs["decays"] == 1
    assert "several-decays" not in decay["finding_id"].values
    alone = made(Recording(ones[1], RATE, "velocity"))[1]
    np.testing.assert_array_equal(curves["frequency"], alone["frequency"])
    with pytest.raises(ValueError, match=r"between from_s and to_s, got 0 of the file's 8 s \(f"):
        part(both, 8.5, None, "f.csv")
