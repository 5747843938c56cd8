"""The public face: a ring-down from any source, and a campaign to its verdict."""

import doctest
from importlib import import_module
from pathlib import Path

import bladeroot as br
import numpy as np
import pandas as pd
import pytest
import xarray as xr
from bladeroot.report.verdict import answer_of
from decay_bench import RATE as SHAKEN_HZ
from decay_bench import START, shaken
from matplotlib.image import imread
from scipy.io import wavfile
from two_masses import against, two_masses

RATE, MODE, LOSS = 8192.0, 211.0, 0.004
NATURAL = MODE * np.sqrt(1.0 - (LOSS / 2.0) ** 2)  # omega_n^2 = omega^2 - A''/A (3.11)


def samples(seed=1):
    t = np.arange(int(3.0 * RATE)) / RATE
    rate = np.pi * MODE * LOSS
    noise = 1e-6 * np.random.default_rng(seed).standard_normal(t.size)
    return 0.01 * np.exp(-rate * t) * np.cos(2 * np.pi * MODE * t) + noise


def test_samples_that_were_cut_towards_zero_are_made_good_and_it_is_said():
    step = 5e-6
    cut, rounded = (
        br.ringdown(step * form(samples() / step), mode_Hz=210.0, sampling_Hz=RATE)
        for form in (np.trunc, np.round)
    )
    assert "cut towards zero" in " ".join(cut.findings)
    assert "cut towards zero" not in " ".join(rounded.findings)
    assert np.median(cut.curves["loss_factor"]) == pytest.approx(LOSS, rel=0.02)


def test_masked_samples_are_lost_ones():
    masked = np.ma.masked_array(samples(), np.arange(int(3.0 * RATE)) // 50 == 60)
    decay, whole = (br.ringdown(v, mode_Hz=210.0, sampling_Hz=RATE) for v in (masked, samples()))
    assert decay.findings == (
        f"50 samples lost, the first {3000 / RATE:.6g} s into the record; masked",
    )
    assert decay.stick_frequency[0] == pytest.approx(whole.stick_frequency[0], rel=1e-6)


@pytest.mark.parametrize(
    "given",
    [{"from_s": np.nan}, {"to_s": "end"}, {"band_Hz": 210.0}, {"band_Hz": (200.0, None)}],
)
@pytest.mark.wrong_shape
def test_ends_that_are_no_numbers_are_told_by_name(given):
    with pytest.raises(ValueError, match=f"{next(iter(given))}.* must be two numbers, got"):
        br.ringdown(samples(), mode_Hz=210.0, sampling_Hz=RATE, **given)


@pytest.mark.parametrize("kind", ["datetime64[ns]", "timedelta64[us]"])
def test_times_of_a_data_array_may_be_dates(kind):
    seconds = np.arange(int(3.0 * RATE)) / RATE
    time = np.round(1e9 * seconds).astype("timedelta64[ns]").astype(kind)
    array = xr.DataArray(samples(), dims="time", coords={"time": time}, attrs={"units": "m/s"})
    plain = array.assign_coords(time=seconds)
    one, other = (br.ringdown(x, mode_Hz=210.0, sampling_Hz=RATE) for x in (array, plain))
    assert one.stick_frequency[0] == pytest.approx(other.stick_frequency[0], rel=1e-9)


def test_the_index_of_a_series_is_its_time():
    time = np.arange(int(3.0 * RATE)) / RATE
    array = br.ringdown(samples(), mode_Hz=210.0, sampling_Hz=RATE)
    for index in (time, pd.to_timedelta(time, unit="s").round("ns")):
        series = br.ringdown(pd.Series(samples(), index), mode_Hz=210.0, unit="m/s")
        assert series.stick_frequency[0] == pytest.approx(array.stick_frequency[0], rel=1e-9)
    numbered = pd.Series(samples())
    with pytest.raises(ValueError, match="needs sampling_Hz"):
        br.ringdown(numbered, mode_Hz=210.0)
    same = br.ringdown(numbered, mode_Hz=210.0, sampling_Hz=RATE)
    assert same.stick_frequency == array.stick_frequency


def test_times_of_a_data_array_are_in_their_unit():
    time = np.arange(int(3.0 * RATE)) / RATE
    plain = xr.DataArray(samples(), {"time": time}, attrs={"units": "m/s"})
    in_ms = plain.assign_coords(time=("time", 1e3 * time, {"units": "ms"}))
    one, other = (br.ringdown(x, mode_Hz=210.0) for x in (plain, in_ms))
    assert one.stick_frequency[0] == pytest.approx(other.stick_frequency[0], rel=1e-9)
    with pytest.raises(ValueError, match="time is in 'fortnights', expected s, ms or us"):
        br.ringdown(
            plain.assign_coords(time=("time", time, {"units": "fortnights"})), mode_Hz=210.0
        )


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"sampling_Hz": 0.5 * RATE}, "sampling_Hz contradicts: .* stated, .* DataArray's time"),
        ({"unit": "m/s^2"}, "unit contradicts: 'm/s\\^2' stated, 'm/s' in the DataArray"),
    ],
)
def test_what_contradicts_a_data_array_is_told(given, told):
    time = np.arange(int(3.0 * RATE)) / RATE
    array = xr.DataArray(samples(), {"time": time}, attrs={"units": "m/s"})
    with pytest.raises(ValueError, match=told):
        br.ringdown(array, mode_Hz=210.0, **given)
    assert br.ringdown(array, 210.0, sampling_Hz=RATE, unit="metres/second").verdict == "usable"


def test_whole_numbers_have_no_full_scale():
    steps = np.round(1e6 * samples()).astype(np.int32)
    given = {"mode_Hz": 210.0, "sampling_Hz": RATE}
    with pytest.raises(ValueError, match="whole numbers have no full scale"):
        br.ringdown(steps, **given, unit="FS", sensitivity="1 m/s/FS")
    counted = br.ringdown(steps, **given, unit="count", sensitivity="1e-6 m/s/count")
    parts = br.ringdown(1e-6 * steps, **given, unit="FS", sensitivity="1 m/s/FS")
    np.testing.assert_allclose(counted.curves["amplitude"], parts.curves["amplitude"], rtol=1e-6)


def test_an_array_of_one_column_is_one_channel():
    one, other = (
        br.ringdown(x, mode_Hz=210.0, sampling_Hz=RATE) for x in (samples(), samples()[:, None])
    )
    np.testing.assert_array_equal(one.curves["amplitude"], other.curves["amplitude"])


def test_a_start_before_the_release_is_rejected_in_words():
    rng = np.random.default_rng(0)
    rest = 1e-7 * rng.standard_normal(int(0.3 * RATE))
    made = br.ringdown(
        np.concatenate([rest, samples()]), mode_Hz=210.0, sampling_Hz=RATE, start_s=0.1
    )
    assert "empty" not in made.verdict


def test_a_sensitivity_may_be_a_factor():
    one, other = (
        br.ringdown(x, mode_Hz=210.0, sampling_Hz=RATE, sensitivity=factor)
        for x, factor in ((samples(), None), (2.0 * samples(), 0.5))
    )
    np.testing.assert_array_equal(one.curves["amplitude"], other.curves["amplitude"])


def test_each_finding_is_told_once_and_by_itself():
    v = samples()
    v += 1e-3 * np.cos(2 * np.pi * 50.0 * np.arange(v.size) / RATE)
    v[5000] = 0.05
    decay = br.ringdown(v, mode_Hz=210.0, sampling_Hz=RATE)
    assert len(decay.findings) == len(set(decay.findings)) >= 2
    assert sum("wrong sample" in one for one in decay.findings) == 1


@pytest.mark.parametrize("seed", [4, 26, 29])
def test_a_drive_ends_where_it_does_beside_modes_that_it_does_not_reach(seed):
    v, release_s, _, _ = shaken(seed, tip=False)
    since = np.arange(v.size) / SHAKEN_HZ - release_s
    for f, size, decline in ((110.0, 0.03, 0.7), (390.0, 0.015, 7.4)):
        wave = np.exp(-decline * since) * np.cos(2 * np.pi * f * since + 0.9)
        v = v + size * START * np.where(since > 0.0, wave, 0.0)
    known = {"sampling_Hz": SHAKEN_HZ, "other_modes_Hz": (110.0, 390.0)}
    decay = br.ringdown(v, mode_Hz=250.0, **known).free_decay
    assert -1.0 < (decay.attrs["start_s"] - release_s) * 250.0 < 12.0
    parts = {"from_s": release_s - 0.1, "to_s": release_s + 1.5, "start_s": 0.3, "end_s": 1.2}
    found = br.ringdown(v, mode_Hz=250.0, **known, **parts)
    assert found.free_decay.attrs["start_s"] == pytest.approx(0.3, abs=1e-3)
    assert found.free_decay.attrs["end_s"] == pytest.approx(1.2, abs=1e-3)
    assert "decay           0.3 to 1.2 s, its end: end_s" in repr(found)
    with pytest.raises(ValueError, match="end_s must be in order"):
        br.ringdown(v, mode_Hz=250.0, **known, start_s=1.0, end_s=0.5)


@pytest.mark.parametrize(
    ("first", "second", "told"),
    [
        ([[0, 1, 2]], [[0, 4, 5]], "paired with themselves"),
        ([[0, 1, 2]] * 2, [[3, 4, 5]] * 2, "each pair of nodes once"),
    ],
)
def test_pairs_that_are_none_are_refused(first, second, told):
    first, second = np.array(first), np.array(second)
    normal = np.tile([1.0, 0.0, 0.0], (len(first), 1))
    pairs = br.ContactPairs(first, second, normal, np.ones(len(first)))
    k, m = np.diag([3.0e6, 3.3e6, 3.6e6] * 2), 2.0 * np.eye(6)
    with pytest.raises(ValueError, match=told):
        br.Joint.from_matrices(k, m, pairs, {"n": 1})
    with pytest.raises(ValueError, match="K must be real"):
        br.Joint.from_matrices(k * 1j, m, pairs, {"n": 1})


def test_what_is_held_before_it_is_let_go_is_not_clipped():
    t = np.arange(int(4.0 * RATE)) / RATE - 0.5
    x = np.where(t > 0.0, np.exp(-2.0 * t) * np.cos(2 * np.pi * 30.0 * t), 1.0)
    x = 1e-3 * (x + 1e-4 * np.random.default_rng(0).standard_normal(t.size))
    decay = br.ringdown(x, mode_Hz=30.0, sampling_Hz=RATE, quantity="displacement")
    assert decay.findings == ()


def test_a_ring_down_from_array_file_and_data_array_is_one_and_the_same(tmp_path):
    v = samples()
    time = np.arange(v.size) / RATE
    array = xr.DataArray(1e3 * v, {"time": time}, attrs={"units": "mm/s"})
    path = tmp_path / "a.csv"
    np.savetxt(path, np.c_[time, v], delimiter=",", header="time_s,velocity_m/s", comments="")
    made = [
        br.ringdown(v, mode_Hz=210.0, sampling_Hz=RATE),
        br.ringdown(array, mode_Hz=210.0),
        br.ringdown(path, mode_Hz=210.0),
    ]
    for one in made:
        assert one.verdict == "usable"
        value, std = one.stick_frequency
        assert abs(value - NATURAL) < 4 * std
        assert np.median(one.curves["loss_factor"]) == pytest.approx(LOSS, rel=0.01)
        np.testing.assert_allclose(one.curves["frequency"], made[0].curves["frequency"], rtol=1e-6)
    assert "stick frequency" in repr(made[0])
    drawn = made[0].plot()
    assert len(drawn.axes) == 2
    assert drawn._repr_html_().startswith("<svg style=")  # a notebook shows it


def test_a_record_of_noise_is_rejected_with_a_reason_and_no_exception():
    noise = np.random.default_rng(0).standard_normal(20_000)
    found = br.ringdown(1e-3 * noise, mode_Hz=300.0, sampling_Hz=RATE)
    assert found.verdict.startswith("rejected: ")
    assert np.isnan(found.stick_frequency[0])


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"mode_Hz": -1.0, "sampling_Hz": RATE}, "mode_Hz must be positive"),
        pytest.param(
            {"mode_Hz": None, "sampling_Hz": RATE},
            "mode_Hz must be positive, in Hz, got None",
            marks=pytest.mark.wrong_shape,
        ),
        pytest.param(
            {"mode_Hz": 210.0, "sampling_Hz": "fast"},
            "sampling_Hz must be positive",
            marks=pytest.mark.wrong_shape,
        ),
        (
            {"mode_Hz": 210.0, "sampling_Hz": RATE, "other_modes_Hz": [300.0, np.nan]},
            "other_modes_Hz must be positive",
        ),
        ({"mode_Hz": 210.0, "sampling_Hz": RATE, "quantity": "strain"}, "one of velocity, disp"),
        ({"mode_Hz": 210.0, "sampling_Hz": RATE, "damping": "none"}, "damping must be hyst"),
        ({"mode_Hz": 200.0}, "needs sampling_Hz"),
        ({"mode_Hz": 200.0, "sampling_Hz": RATE, "unit": "V"}, "needs a sensitivity"),
        (
            {"mode_Hz": 200.0, "sampling_Hz": RATE, "sensitivity": "100 mV/g"},
            "a sensitivity of '100 mV/g' needs the samples' unit, such as 'V'",
        ),
        (
            {"mode_Hz": 200.0, "sampling_Hz": RATE, "unit": "FS", "sensitivity": "100 mV/g"},
            "makes no motion of 'FS'; expected one such as 125 mm/s/FS",
        ),
        (
            {"mode_Hz": 200.0, "sampling_Hz": RATE, "start_s": -1.0},
            "start_s and end_s must not be negative",
        ),
    ],
)
def test_what_is_missing_is_told_in_one_line(given, told):
    with pytest.raises(ValueError, match=told) as error:
        br.ringdown(samples(), **given)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("module", ["decay", "joint", "contact_fit", "diagnosis"])
def test_the_docstrings_examples_hold(module, tmp_path, monkeypatch):
    if module == "diagnosis":
        two_modes(tmp_path / "two-modes")
    monkeypatch.chdir(tmp_path)
    found = doctest.testmod(import_module(f"bladeroot.public.{module}"))
    assert found.attempted
    assert not found.failed


@pytest.mark.slow
def test_the_examples_of_readme_and_library_run(tmp_path, monkeypatch):
    """A WAV file, a dovetail, matrices and a campaign of one's own in their places."""
    two_modes(tmp_path / "path" / "to" / "campaign")
    t = np.arange(3 * 25_600) / 25_600
    v = 0.2 * np.exp(-5.0 * t) * np.cos(2 * np.pi * 540.0 * t)
    noise = 1e-5 * np.random.default_rng(0).standard_normal(t.size)
    wavfile.write(tmp_path / "a.wav", 25_600, np.round(32_767 * (v + noise)).astype(np.int16))
    monkeypatch.chdir(tmp_path)
    readme = (Path(__file__).parents[2] / "README.md").read_text(encoding="utf-8")
    library = br.__doc__.partition("\n\n")[2].replace('{"1B": 1, "2B": 2}', "shapes")
    shapes = {"1B": against(0), "2B": against(1)}
    K, M, pairs = two_masses()
    for text in (readme.partition("```python")[2].partition("```")[0], library):
        made = {"K": K, "M": M, "pairs": pairs, "Kg": 0.0 * K, "shapes": shapes}
        exec(text, made)
        assert made["decay"].stick_frequency[0] == pytest.approx(540.0, rel=1e-5)
        assert made["fit"].kn > 0.0
        assert made["verdict"].answer == "nothing-missing"
    assert imread("a.png").min() < 0.5  # no blank page


def two_modes(folder):
    """A campaign of raw files: three records of each of two modes, linear ones."""
    folder.mkdir(parents=True)
    (folder / "campaign.yaml").write_text(
        "title: two modes\nnotes: drawn\nsimulation: none\n"
        "modes:\n  low: {expected_Hz: 100}\n  high: {expected_Hz: 260}\n"
    )
    chance = np.random.default_rng(3)
    t = np.arange(40_000) / 8_000
    lines = ["record,file,mode,sampling_Hz,quantity,unit"]
    for mode, f, rate in (("low", 100.0, 3.0), ("high", 260.0, 5.0)):
        for k in range(3):
            v = 0.01 * np.exp(-rate * t) * np.cos(2.0 * np.pi * f * t + k)
            np.savetxt(
                folder / f"{mode}{k}.csv", v + 1e-6 * chance.standard_normal(t.size), fmt="%.9f"
            )
            lines.append(f"{mode}{k},{mode}{k}.csv,{mode},8000,velocity,m/s")
    (folder / "records.csv").write_text("\n".join(lines) + "\n")


def test_a_campaign_without_workflow_gives_the_stages_verdict(tmp_path):
    """Raw files of two modes, three records each: the same verdict as by the scripts' functions."""
    folder = tmp_path / "two-modes"
    two_modes(folder)
    verdict = br.diagnose(folder)
    assert sorted(verdict.curves) == ["high0", "high1", "high2", "low0", "low1", "low2"]
    stuck = verdict.observations["stick_frequency"].values
    undamped = [
        np.sqrt(f**2 - (rate / (2 * np.pi)) ** 2) for f, rate in ((260.0, 5.0), (100.0, 3.0))
    ]
    assert stuck == pytest.approx(np.repeat(undamped, 3), rel=1e-6)
    assert verdict.answer == verdict.said["answer"] == verdict.diagnosis.attrs["answer"]
    assert sum(verdict.probabilities.values()) == pytest.approx(1.0, abs=1e-6)
    assert not verdict.causes
    assert "two-modes" in repr(verdict)
    assert len(verdict.plot().axes) == 4
    with pytest.raises(ValueError, match="campaign folder not found"):
        br.diagnose(tmp_path / "nowhere")


def test_what_is_odd_in_a_sheet_is_a_warning(tmp_path):
    folder = tmp_path / "two-modes"
    two_modes(folder)
    sheet = folder / "records.csv"
    sheet.write_text(sheet.read_text().replace("low1.csv", "low0.csv"))
    with pytest.warns(UserWarning, match=r"low0.csv stands in row 2 already \(.*, row 3\)"):
        br.diagnose(folder)


@pytest.mark.wrong_shape
def test_no_campaign_is_told():
    with pytest.raises(ValueError, match="must be a folder, got a NoneType"):
        br.diagnose(None)


def test_a_campaign_without_a_usable_record_is_no_evidence_of_nothing(tmp_path):
    folder = tmp_path / "two-modes"
    two_modes(folder)
    place = folder / "campaign.yaml"
    place.write_text(place.read_text().replace("260", "700").replace("100", "180"))
    verdict = br.diagnose(folder)
    assert set(verdict.observations["verdict"].values) == {"rejected"}
    assert verdict.answer == "insufficient-data"
    assert "no record can be used, of 6" in verdict.said["reason"].lower()
    assert verdict.probabilities == {}
    assert answer_of(verdict.said) == "too few data"
    assert "none" not in repr(verdict)
    assert "without 6 of 6 records: high0, high1," in repr(verdict)


def test_causes_that_the_sentence_doubts_are_not_among_the_named():
    empty = xr.Dataset()
    causes = [
        {"mechanism": "drift", "shown": True, "credible_set": ["drift"]},
        {"mechanism": "crack", "shown": True, "credible_set": ["crack", "none-of-these"]},
        {"mechanism": "ageing", "shown": False, "credible_set": ["ageing", "none"]},
    ]
    for answer, expected in (("named", ("drift",)), ("ambiguous", ("drift", "crack"))):
        said = {"answer": answer, "causes": causes}
        assert br.Verdict(said, empty, empty, empty, {}).causes == expected
