"""Each fault is found where it is and by its name; a clean decay raises nothing."""

import re
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from bladeroot.decay.cut import cut, rejected
from bladeroot.decay.free_decay import free_decay
from bladeroot.io.recording import recording
from bladeroot.quality.findings.sampling_rate import RATIOS
from bladeroot.quality.integrity import carried, checks, examine, examined, judge
from bladeroot.signal.recording import Recording, velocity
from decay_bench import RATE, START, coulomb_decay, course, levels, ring_down, ringing, shaken
from hypothesis import given, settings
from hypothesis import strategies as st
from judging import decay, ids, judged, text, uncut

DOCUMENT = Path(__file__).resolve().parents[2] / "docs" / "findings.md"


def time_of(velocity):
    return np.arange(velocity.size) / RATE


@pytest.mark.parametrize("noise_db", [60, 20])
@pytest.mark.parametrize("softening", [0.002, 0.03])
def test_a_clean_decay_raises_nothing(noise_db, softening):
    for seed in range(2):
        velocity = decay(seed=seed, noise_db=noise_db, softening=softening, second=0.3)
        found = judged(velocity)
        assert not ids(found)
        assert found["usable"].values.all()
        assert found.attrs["verdict"] == "usable"


def test_a_whole_record_with_release_and_return_raises_nothing():
    for seed in range(2):
        velocity, _, _, _ = shaken(seed)
        assert not ids(judged(velocity, 245.0))


@pytest.mark.parametrize("noise_after", [0.0, 0.002])
def test_all_is_masked_up_to_the_last_clipped_top(noise_after):
    clean = decay(second=0.0, noise_db=70)
    top = 0.85 * START
    rng = np.random.default_rng(0)
    velocity = np.clip(clean, -top, top) + noise_after * START * rng.standard_normal(clean.size)
    found = judged(velocity)
    assert ids(found) == {"clipping"}
    assert found.attrs["verdict"] == "usable"
    usable = found["usable"].values == 1
    cut_off = np.abs(clean[: usable.size]) > 1.01 * top
    last = np.flatnonzero(cut_off)[-1]
    assert not usable[: last + 1].any()
    assert usable[last + int(0.05 * RATE) :].all()
    last = last / RATE
    assert found["finding_to_s"].item() == pytest.approx(last, abs=0.1)


def test_wrong_samples_are_masked_and_do_not_end_the_decay():
    clean = decay()
    velocity = clean.copy()
    wrong = [3000, 9000, 9001, 20000]
    velocity[wrong] += np.array([0.3, -0.8, 0.5, 2.0]) * START
    found = judged(velocity)
    assert ids(found) == {"spike"}
    assert np.flatnonzero(found["usable"].values == 0).tolist() == wrong
    plain = judged(clean)
    assert abs(found.sizes["time"] - plain.sizes["time"]) < 0.02 * plain.sizes["time"]


@pytest.mark.parametrize("quantity", ["displacement", "acceleration"])
def test_wrong_samples_of_the_sensor_are_told_before_a_velocity_is_made_of_them(quantity):
    clean, omega = decay(second=0.0), 2.0 * np.pi * 250.0
    samples = clean / omega if quantity == "displacement" else clean * omega
    unit = {"displacement": "m", "acceleration": "m/s^2"}[quantity]
    spoilt, wrong = samples.copy(), [3000, 9000, 9001, 20000]
    spoilt[wrong] += np.array([0.3, -0.8, 0.5, 2.0]) * samples.max()
    plain, found = (
        free_decay(recording(one, unit, "here", sampling_Hz=RATE), 250.0)
        for one in (samples, spoilt)
    )
    assert ids(found) >= {"spike", "lost-samples"}
    assert abs(found.sizes["time"] - plain.sizes["time"]) < 0.02 * plain.sizes["time"]
    assert np.flatnonzero(found["usable"].values == 0).size < 100
    kept = slice(0, min(found.sizes["time"], plain.sizes["time"]))
    off = found["velocity"].values[kept] - plain["velocity"].values[kept]
    assert np.abs(off[found["usable"].values[kept] == 1]).max() < 0.02 * START


def test_a_blow_is_no_wrong_sample():
    rng, time = np.random.default_rng(3), np.arange(20000) / RATE
    modes = [(250.0, 0.002, 1.0), (1900.0, 0.01, 40.0)]
    rings = sum(a * np.exp(-z * 6.283 * f * time) * np.sin(6.283 * f * time) for f, z, a in modes)
    samples = np.concatenate([np.zeros(500), rings]) + 1e-4 * rng.standard_normal(20500)
    samples[500:503] += [30.0, 90.0, 30.0]  # the hammer's contact
    found = free_decay(recording(samples, "m/s^2", "here", sampling_Hz=RATE), 250.0)
    assert not ids(found) & {"spike", "lost-samples"}


@pytest.mark.parametrize("length", [12, 700])
@pytest.mark.parametrize("value", [0.0, None])
def test_dropouts_are_masked(length, value):
    """A gap of seven cycles too: the phase is carried across it, not through its frames."""
    velocity = decay()
    start = 8010
    velocity[start : start + length] = velocity[start] if value is None else value
    found = judged(velocity)
    assert "dropout" in ids(found)
    masked = np.flatnonzero(found["usable"].values == 0)
    assert set(range(start + 1, start + length - 1)) <= set(masked.tolist())
    assert masked.size < length + 30


def test_lost_samples_are_told_and_those_in_the_decay_masked():
    velocity, lost = decay(), np.array([5, 8000, *range(9000, 9300)])
    known = Recording(velocity, RATE, "velocity", lost=lost, over=lost[:1])
    found = uncut(velocity, recording=known)
    assert np.flatnonzero(found["usable"].values == 0).tolist() == lost.tolist()
    first = f"{5 / RATE:.6g} s into the record"
    told = f"302 samples lost (1 over the sensor's range), the first {first}; masked"
    assert text(found, "lost-samples") == told
    none = judge(rejected("no decay"), velocity, 250.0, recording=known)
    assert none.attrs["reason"] == "no decay"


@pytest.mark.parametrize("quantity", ["velocity", "displacement", "acceleration"])
@pytest.mark.parametrize("length", [1, 40, 600])
def test_the_mode_carries_a_record_over_a_gap(quantity, length):
    """Velocity is right on both sides, though acceleration is summed through the gap."""
    clean = ring_down(second=0.0, softening=0.0, noise_db=80)[0]
    made = {
        "velocity": clean,
        "displacement": np.cumsum(clean) / RATE + 3e-3,
        "acceleration": np.gradient(clean, 1.0 / RATE),
    }[quantity]
    lost = np.arange(8000, 8000 + length)
    spoilt = np.where(np.isin(np.arange(made.size), lost), np.nan, made)
    unit = {"velocity": "m/s", "displacement": "m", "acceleration": "m/s^2"}[quantity]
    one, other = (
        velocity(carried(recording(x, unit, "a", sampling_Hz=RATE), 250.0), 250.0)
        for x in (made, spoilt)
    )
    off = np.abs(one - other)
    assert off.max() < 0.05 * np.abs(one[7900:8000]).max()


@pytest.mark.parametrize(("other_Hz", "finding"), [(262.0, "mode-beating"), (215.0, "leftover")])
def test_a_close_mode_beats_and_a_farther_one_is_no_close_mode(other_Hz, finding):
    clean = decay()
    beat = ringing(time_of(clean), other_Hz, np.pi * other_Hz * 0.004)
    found = judged(clean + 0.05 * START * beat)
    assert ids(found) == {finding}
    assert found.attrs["verdict"] == "usable"
    distance = float(re.search(r"a mode ([-+][\d.]+) Hz", text(found, finding))[1])
    assert distance == pytest.approx(other_Hz - 250.0, abs=2.5)
    if finding == "mode-beating":
        assert uncut(clean + 0.6 * START * beat).attrs["verdict"] == "rejected"


@pytest.mark.parametrize("sway_Hz", [7.0, 12.0])
def test_a_gain_that_sways_is_told_with_its_size(sway_Hz):
    clean = decay(noise_db=60)
    turn = 2.0 * np.pi * sway_Hz * time_of(clean)
    found = judged(clean * (1.0 + 0.01 * np.cos(turn)))
    assert ids(found) == {"gain-sways"}
    assert found.attrs["verdict"] == "usable"
    told = re.search(r"by ([\d.]+) % at ([\d.]+) Hz", text(found, "gain-sways"))
    assert float(told[1]) == pytest.approx(1.0, rel=0.25)
    assert float(told[2]) == pytest.approx(sway_Hz, rel=0.15)
    # a clock that sways as much turns the phase and not the amplitude
    assert "gain-sways" not in ids(
        judged(np.interp(np.cumsum(1.0 + 1e-4 * np.cos(turn)), np.arange(clean.size), clean))
    )


@pytest.mark.parametrize("middle", [0.1, 0.2, 0.4])
def test_a_hump_of_damping_is_no_gain_that_sways(middle):
    def alpha(a):
        return -np.pi * 250.0 * (0.002 + 0.008 * np.exp(-0.5 * (np.log(a / middle) / 0.7) ** 2))

    def omega(a):
        return 2.0 * np.pi * 250.0 * (1.0 - 0.01 * a / (a + middle))

    time = np.arange(int(3.0 * RATE)) / RATE
    log, phase = course(alpha, omega, time, levels(7.0))
    noise = 1e-4 * np.random.default_rng(0).standard_normal(time.size)
    assert ids(judged(START * (np.exp(log) * np.cos(phase) + noise))) == set()


@pytest.mark.parametrize(("onset", "softening"), [(0.03, 0.003), (0.06, 0.006), (0.1, 0.01)])
def test_the_bend_where_slip_ends_is_no_beat(onset, softening):
    found = judged(coulomb_decay(onset, softening))
    assert ids(found) == set()
    assert found.attrs["verdict"] == "usable"


@pytest.mark.parametrize("mains", [50.0, 59.97])
def test_hum_is_taken_off(mains):
    clean = decay(noise_db=60)
    size, time = 2e-3 * START, time_of(clean)
    hum = size * np.cos(2 * np.pi * mains * time + 0.4)
    hum += 0.5 * size * np.cos(2 * np.pi * 3 * mains * time - 1.0)
    found = judged(clean + hum)
    assert ids(found) == {"mains-hum"}
    left = found["velocity"].values - clean[: found.sizes["time"]]
    assert np.std(left) < 0.2 * np.std(hum)
    assert f"{size:.2g}" in text(found, "mains-hum") or "0.00" in text(found, "mains-hum")


@pytest.mark.parametrize("line", [300.0, 350.0, 480.0])
def test_hum_near_the_mode_is_taken_off(line):
    clean = decay(noise_db=60)
    hum = 1e-3 * START * np.cos(2 * np.pi * line * time_of(clean) + 0.4)
    found = judged(clean + hum)
    assert "mains-hum" in ids(found)
    left = found["velocity"].values - clean[: found.sizes["time"]]
    assert np.std(left) < 0.2 * np.std(hum)


@pytest.mark.parametrize("count", [19, 23, 27, 40])
def test_a_decay_of_few_samples_is_looked_at_for_hum(count):
    time = np.arange(count) / 22.45
    velocity = START * np.exp(-0.12 * time) * np.cos(2 * np.pi * 7.5 * time)
    attrs = {
        "sampling_Hz": 22.45, "start_s": 0.0, "end_s": time[-1], "noise_velocity": 1e-6 * START,
        "end_reason": "end of the record", "findings": "",
    }  # fmt: skip
    found = judge(xr.Dataset({"velocity": ("time", velocity)}, attrs=attrs), velocity, 7.5)
    assert "mains-hum" not in ids(found)


@pytest.mark.parametrize("held", [1.0, 4.6e-14])
@pytest.mark.parametrize("others", [0, 3, 8])
def test_a_record_of_one_held_value_is_rejected(held, others):
    rng = np.random.default_rng(others)
    velocity = np.full(4096, held)
    velocity[rng.integers(0, velocity.size, others)] += held * rng.standard_normal(others)
    assert uncut(velocity).attrs["verdict"] == "rejected"


def test_hum_that_is_taken_off_does_not_beat():
    clean = decay(frequency_Hz=270.0, second=0.0, noise_db=60)
    hum = 0.01 * START * np.cos(2 * np.pi * 300.0 * time_of(clean) + 0.4)
    assert ids(judged(clean + hum, 270.0)) == {"mains-hum"}


def test_a_decay_that_was_cut_from_a_bridged_dropout_is_rejected():
    velocity = decay()
    found = cut(velocity, RATE, 250.0)
    judged_as = judge(found, np.zeros_like(velocity), 250.0)
    assert "nothing but one value from" in judged_as.attrs["reason"]
    assert judged_as.attrs["verdict"] == "rejected"


def test_no_hum_where_the_mode_itself_lies_on_a_line():
    for frequency in (100.0, 250.0):
        velocity = decay(frequency_Hz=frequency, softening=0.002, eta=(0.003, 0.003))
        assert "mains-hum" not in ids(judged(velocity, frequency))


def test_an_accelerometer_is_clipped_in_its_own_unit():
    """Integrated, flat tops are flat no more."""
    clean = decay(noise_db=60)
    acceleration = np.gradient(clean) * 25600.0
    top = 0.7 * np.abs(acceleration).max()
    for samples in (acceleration, np.clip(acceleration, -top, top)):
        recording = Recording(samples, 25600.0, "acceleration")
        motion = velocity(recording, 250.0)
        found = judge(cut(motion, 25600.0, 250.0), motion, 250.0, recording=recording)
        assert ("clipping" in ids(found)) == (samples is not acceleration)
    assert "m/s^2, the last" in text(found, "clipping")
    masked = 25600.0 * found["finding_to_s"].values[found["finding_id"].values == "clipping"]
    assert not found["usable"].values[: int(masked.item())].any()


def test_driven_residue():
    clean = decay(noise_db=70, eta=(0.01, 0.012))
    tail = 0.02 * START * np.cos(2 * np.pi * 250.0 * time_of(clean))
    found = uncut(clean + tail)
    assert "driven-residue" in ids(found)
    usable = found["usable"].values == 1
    assert usable[: int(0.05 * RATE)].all()
    assert not usable[-int(0.05 * RATE) :].any()


@pytest.mark.parametrize("nepers", [2.5, 2.7])
def test_a_record_that_ends_soon_after_slip_is_no_driven_residue(nepers):
    found = judged(coulomb_decay(0.12, 0.02, nepers=nepers))
    assert not ids(found)
    assert found["usable"].values.all()


def test_hum_far_below_the_mode_is_taken_off_once_and_is_no_mode():
    rate = 102_400.0
    time = np.arange(150_000) / rate
    own = ringing(time, 8000.0, np.pi * 6e-4 * 8000.0, 0.05)
    noise = 1e-6 * np.random.default_rng(1).standard_normal(time.size)
    for size in (0.005, 0.1):
        hum = size * np.cos(2 * np.pi * 50.0 * time)
        found = judged(own + noise + hum, 8000.0, rate)
        first = round(found.attrs["start_s"] * rate)
        left = found["velocity"].values - (own + noise)[first : first + found.sizes["time"]]
        assert "mains-hum" in ids(found)
        assert np.abs(left).max() < 0.01 * size


def test_noise_is_reckoned_with_as_it_is_around_the_mode():
    clean = decay()
    rng = np.random.default_rng(2)
    white = np.fft.rfft(rng.standard_normal(clean.size))
    white[np.fft.rfftfreq(clean.size, 1 / RATE) > 600.0] = 0.0
    before = judged(clean).attrs["noise_velocity"]
    found = judged(clean + 10 * before * np.fft.irfft(white, clean.size))
    assert found.attrs["noise_velocity"] == pytest.approx(10 * before, rel=0.25)


@pytest.mark.parametrize("ratio", [1.28, 1.0 / 1.28])
def test_wrong_sampling_rate_shifts_all_modes(ratio):
    velocity = decay(second=0.3)
    modes = (250.0 / ratio, 6.27 * 250.0 / ratio)
    found = judged(velocity, modes[0], modes_Hz=modes[1:])
    assert "sampling-rate" in ids(found)
    assert found.attrs["verdict"] == "rejected"
    assert "sampling-rate" not in ids(judged(velocity, 250.0, modes_Hz=(6.27 * 250.0,)))
    # one mode at another frequency is not the clock's fault
    assert "sampling-rate" not in ids(judged(velocity, modes[0], modes_Hz=(6.27 * 250.0,)))


def test_a_force_that_moves_all_modes_alike_is_not_the_clocks_fault():
    velocity = decay(second=0.3)
    expected = 250.0 / (48.0 / 44.1)
    assert "sampling-rate" not in ids(judged(velocity, expected, modes_Hz=(6.27 * expected,)))


def test_a_mode_out_of_the_band_names_the_ratio():
    found = judged(decay(second=0.0), 250.0 * 2.56)
    assert found.attrs["verdict"] == "rejected"
    assert found.attrs["findings"].count("0.3906 times the expected frequency") == 1
    assert any(abs(1 / 2.56 - ratio) < 1e-12 for ratio in RATIOS)


def test_another_mode_dominates():
    clean = decay(second=0.0)
    loud = ringing(time_of(clean), 700.0, 3.0, START)
    hum = 2e-3 * np.sin(2 * np.pi * 50 * time_of(clean))
    found = judged(0.1 * clean + loud + hum)
    assert found.attrs["verdict"] == "rejected"
    reason, all_of_them = found.attrs["reason"], found.attrs["findings"]
    assert reason.startswith("another mode dominates: the strongest line is at 700")
    assert "mains hum" in all_of_them  # what warns is told, and is no reason
    assert "mains hum" not in reason
    assert np.isnan(found["finding_from_s"].values).all()  # the whole decay is concerned


def test_two_modes_in_the_band():
    clean = decay(second=0.0)
    rival = ringing(time_of(clean), 300.0, 3.0, 0.8 * START, -np.pi / 2)
    told = uncut(clean + rival).attrs["findings"]
    assert re.search(
        r"two modes in the band: 248.9 and 300 Hz, the second 0\.97 times as loud; "
        r"the first is taken, 250 Hz was expected",
        told,
    )
    louder = uncut(0.3 * clean + rival).attrs["findings"]
    assert re.search(
        r"two modes in the band: 248.9 and 300 Hz, the second 3\.\d times as loud", louder
    )


@pytest.mark.parametrize(("others", "verdict"), [((), "usable"), ((420.0,), "rejected")])
@pytest.mark.parametrize("louder", [3.0, 6.0])
def test_a_louder_mode_beside_one_at_the_expected_frequency(louder, others, verdict):
    time = np.arange(32000) / 20000.0
    clean = ringing(time, 500.0, 4.7)
    rival = ringing(time, 420.0, 2.6, louder, 1.0)
    noise = 1e-3 * np.random.default_rng(3).standard_normal(time.size)
    velocity = np.concatenate([np.zeros(1000), clean + rival + noise])
    found = judged(velocity, 500.0, 20000.0, modes_Hz=others)
    assert "nearer to the expected 500 Hz" in found.attrs["findings"]
    assert found.attrs["verdict"] == verdict


@pytest.mark.parametrize(("others", "verdict"), [((490.0,), "usable"), ((478.0,), "rejected")])
def test_a_mode_nearer_to_another_one_of_the_sheet_is_that_one(others, verdict):
    time = np.arange(32000) / 20000.0
    noise = 1e-3 * np.random.default_rng(3).standard_normal(time.size)
    velocity = np.concatenate([np.zeros(1000), ringing(time, 480.0, 4.7) + noise])
    found = judged(velocity, 484.0, 20000.0, modes_Hz=others)
    assert found.attrs["verdict"] == verdict
    assert ("nearer to another known one" in found.attrs["findings"]) == (verdict != "usable")


@settings(max_examples=8, deadline=None)
@given(exponent=st.floats(-5.0, 3.0), seed=st.integers(0, 3))
def test_the_unit_of_the_velocity_does_not_matter(exponent, seed):
    velocity = decay(seed=seed, count=12800, bits=24)
    first = cut(velocity, RATE, 250.0)
    scaled = 10.0**exponent * velocity
    second = cut(scaled, RATE, 250.0)
    one = dict(examine(examined(first, velocity, 250.0)))
    two = dict(examine(examined(second, scaled, 250.0)))
    assert one.keys() == two.keys()
    for name in one:
        assert two[name].statistic == pytest.approx(one[name].statistic, rel=1e-3, abs=1e-3), name


def test_notes_warn_and_findings_survive_a_file(tmp_path):
    found = judged(decay(), remarks=(("reader", "the file's clock differs from the sheet's"),))
    assert found["finding_id"].values.tolist() == ["reader"]
    assert found.attrs["findings"] == "the file's clock differs from the sheet's"
    assert found.attrs["verdict"] == "usable"
    empty = judged(decay())
    unreadable = judge(rejected("expected a NetCDF file"), np.zeros(0), 250.0)
    assert unreadable["finding_consequence"].values.tolist() == ["drop"]
    assert unreadable.attrs["verdict"] == "rejected"
    for name, made in (("one", found), ("none", empty), ("unreadable", unreadable)):
        made.to_netcdf(tmp_path / f"{name}.nc")
        with xr.open_dataset(tmp_path / f"{name}.nc") as read:
            assert read["finding_text"].values.tolist() == made["finding_text"].values.tolist()
            assert read["usable"].dtype == np.int8
            assert set(read.variables) == set(found.variables)
    assert found["finding_consequence"].isin(["warn", "subtract", "mask", "drop"]).all()


def test_a_record_masked_away_is_dropped():
    velocity = decay(second=0.0, count=12800)
    for start in range(0, velocity.size, 300):
        velocity[start : start + 290] = velocity[start]
    found = uncut(velocity)
    assert found.attrs["verdict"] == "rejected"


def test_every_finding_is_documented_with_its_threshold():
    rows = re.findall(r"^\| `([a-z-]+)` \|", DOCUMENT.read_text(), flags=re.MULTILINE)
    assert set(rows) == set(checks())
    for name, module in checks().items():
        row = re.search(rf"^\| `{name}` \|.*$", DOCUMENT.read_text(), flags=re.MULTILINE)[0]
        assert f"| {module.THRESHOLD:g} |" in row, name
        assert module.STATISTIC in row, name
