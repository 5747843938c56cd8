"""Readers: units, names, one clear line for everything that can be wrong."""

import netCDF4
import numpy as np
import pytest
from bladeroot.io.read import formats, read
from bladeroot.io.recording import part, recording
from bladeroot.signal.recording import velocity

RATE = 5120.0
TIME = np.arange(2000) / RATE
WAVE = np.exp(-2 * TIME) * np.sin(2 * np.pi * 100 * TIME)


def csv(path, header="time_s,velocity_m/s", rows=None, separator=","):
    rows = zip(TIME, WAVE, strict=True) if rows is None else rows
    lines = [separator.join(f"{value:.9g}" for value in row) for row in rows]
    path.write_text("\n".join([header, *lines, ""]), encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("header", "factor"),
    [
        ("time_s,velocity_m/s", 1.0),
        ("time_s,velocity_mm/s", 1e-3),
        ("t,velocity [um/s]", 1e-6),
        ("time [s],velocity (µm/s)", 1e-6),
    ],
)
def test_csv_units(tmp_path, header, factor):
    found = read(csv(tmp_path / "a.csv", header))
    assert found.quantity == "velocity"
    assert found.sampling_Hz == pytest.approx(RATE, rel=1e-6)
    np.testing.assert_allclose(found.samples, factor * WAVE, atol=1e-8 * factor)


def test_csv_unit_as_argument_and_separator(tmp_path):
    path = csv(tmp_path / "a.csv", "time;velocity", separator=";")
    np.testing.assert_allclose(read(path, unit="mm/s").samples, 1e-3 * WAVE, atol=1e-11)


@pytest.mark.parametrize(
    "header",
    [
        "t / s,v / (mm/s)", "t/s,v / mm/s", "Zeit in s,v in mm/s", "Seconds,v (mm/s)",
        '"Time (s)","velocity, tip (mm/s)"', "x-axis [s],1 [mm/s]",
    ],
)  # fmt: skip
def test_headers_as_standards_and_instruments_write_them(tmp_path, header):
    found = read(csv(tmp_path / "a.csv", header))
    np.testing.assert_allclose(found.samples, 1e-3 * WAVE, atol=1e-11)
    assert found.sampling_Hz == pytest.approx(RATE, rel=1e-6)


def test_times_of_too_few_digits_need_the_frequency_and_agree_with_it(tmp_path):
    rows = [[round(t, 4), v] for t, v in zip(TIME, WAVE, strict=True)]
    path = csv(tmp_path / "a.csv", "time_s,v_mm/s", rows)
    with pytest.raises(ValueError, match="too few digits, or a row twice"):
        read(path)
    assert read(path, sampling_Hz=RATE).sampling_Hz == RATE
    with pytest.raises(ValueError, match="too few digits"):
        read(path, sampling_Hz=1.02 * RATE)
    rows[200:] = [[t + 0.001, v] for t, v in rows[200:]]
    with pytest.raises(ValueError, match="time must be uniform"):
        read(csv(tmp_path / "gap.csv", "time_s,v_mm/s", rows), sampling_Hz=RATE)


def test_a_channel_is_called_as_messages_list_it(tmp_path):
    path = csv(tmp_path / "a.csv", "time_s;weg;kraft", [[t, v, v] for t, v in rows_with(0)], ";")
    path.write_text(path.read_text().replace("kraft\n", "kraft\ns;mm;N\n", 1))
    assert read(path, channel="weg [mm]").quantity == "displacement"


def rows_with(k, time=None, value=None):
    rows = [[t, v] for t, v in zip(TIME, WAVE, strict=True)]
    rows[k] = [rows[k][0] if time is None else time, rows[k][1] if value is None else value]
    return rows


@pytest.mark.parametrize(
    ("header", "rows", "message"),
    [
        ("time_s,velocity_m/s", rows_with(7, time=np.nan), "finite number, got 'nan'.*row 9"),
        ("time_s,velocity_m/s", rows_with(7, time=5.0), "time must rise.*sample 9"),
        ("time_s,velocity_m/s", rows_with(7, time=TIME[7] + 1e-4), "time must be uniform"),
        ("time_s,velocity", None, "expected a unit, got none from the file"),
        ("time_s,velocity_mm", None, "is called velocity, its unit mm is one of displacement"),
        ("time_s,velocity_m", None, None),
        ("x,velocity_m/s", None, "expected a time column or a positive sampling_Hz"),
        ("a,b", None, r"got none of 1: a, 2: b; channel names one"),
        ("time_s,b_m/s,c_mm/s", [(t, w, w) for t, w in zip(TIME, WAVE, strict=True)],
         r"got several of 2: b_m/s, 3: c_mm/s; channel"),
        ("time_s,velocity_m/s", rows_with(7)[:20], "at least 64 samples, got 20"),
        ("time_s,velocity_m/s", [], "expected a header and rows"),
    ],
)  # fmt: skip
def test_csv_faults(tmp_path, header, rows, message):
    path = csv(tmp_path / "a.csv", header, rows)
    if message is None:
        with pytest.raises(ValueError, match="expected one channel of velocity, got none"):
            read(path, quantity="velocity")
        return
    with pytest.raises(ValueError, match=message) as caught:
        read(path)
    assert "a.csv" in str(caught.value)
    assert "\n" not in str(caught.value)


def netcdf(path, name="velocity", packed=True, units="m/s"):
    with netCDF4.Dataset(path, "w") as file:
        file.createDimension("time", TIME.size)
        file.createVariable("time", "f8", "time")[:] = TIME
        variable = file.createVariable(name, "i2" if packed else "f8", "time")
        if packed:
            variable.scale_factor = 1.0 / 32000
        variable.units = units
        variable[:] = WAVE
    return path


@pytest.mark.parametrize("packed", [True, False])
def test_netcdf(tmp_path, packed):
    found = read(netcdf(tmp_path / "a.nc", packed=packed))
    np.testing.assert_allclose(found.samples, WAVE, atol=2e-5)
    assert found.sampling_Hz == pytest.approx(RATE)


def test_netcdf_faults(tmp_path):
    with pytest.raises(
        ValueError, match=r"expected channel .*got none of 1: time, 2: speed \[knot\]"
    ):
        read(netcdf(tmp_path / "a.nc", name="speed", units="knot"), channel="velocity")
    (tmp_path / "b.nc").write_text("no")
    with pytest.raises(ValueError, match="expected a NetCDF file"):
        read(tmp_path / "b.nc")
    with pytest.raises(ValueError, match="got none at"):
        read(tmp_path / "c.nc")
    with pytest.raises(ValueError, match="expected a file ending in"):
        read(tmp_path / "c.xyz")


TABLE = [f"{t:.9g}|{w:.9g}" for t, w in zip(TIME, WAVE, strict=True)]


@pytest.mark.parametrize(
    ("head", "separator", "decimal", "encoding", "end"),
    [
        (["time_s|velocity_m/s"], ",", ".", "utf-8", "\n"),
        (["time_s|velocity (m/s)"], ";", ",", "utf-8-sig", "\r\n"),
        (["Zeit [s]|Velocity [m/s]"], "\t", ",", "cp1252", "\r\n"),
        (["time_s|velocity_m/s"], "\t", ".", "utf-16", "\n"),
        (["time_s|velocity_m/s"], ",", ".", "utf-16-le", "\r\n"),
        (["time_s|velocity_m/s"], ",", ".", "utf-8", "\r"),
        (["t v"], " ", ".", "utf-8", "\n"),
        (["# an export", "# mode: 1B", "time_s|velocity_m/s"], ",", ".", "utf-8", "\n"),
        (["Scanning head: 3µ", "Rate;1", "Time|Velocity", "[ s ]|[ m/s ]"], "\t", ".", "cp1252",
         "\n"),
        (["time_s|velocity_m/s|"], ",", ".", "utf-8", "\n"),
    ],
)  # fmt: skip
def test_csv_as_labs_write_it(tmp_path, head, separator, decimal, encoding, end):
    lines = head + [line.replace(".", decimal) for line in TABLE]
    text = end.join([*lines, ""]).replace("|", separator)
    (tmp_path / "a.txt").write_bytes(text.encode(encoding))
    told = {"unit": "m/s", "channel": "v"} if head == ["t v"] else {}
    found = read(tmp_path / "a.txt", **told)
    assert found.sampling_Hz == RATE
    np.testing.assert_allclose(found.samples, WAVE, atol=1e-8)


def test_csv_without_time(tmp_path):
    lines = [f"{value:.9g}" for value in WAVE]
    (tmp_path / "a.csv").write_text("\n".join(["velocity_m/s", *lines, ""]))
    assert read(tmp_path / "a.csv", sampling_Hz=RATE).sampling_Hz == RATE
    (tmp_path / "b.csv").write_text("\n".join(["# fs: 5120", "velocity_m/s", *lines, ""]))
    assert read(tmp_path / "b.csv").sampling_Hz == RATE


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("\n0.0009765625,", "\n0.0009765625,1,", "expected 2 fields, got 3 .*row 7"),
        ("\n0.0009765625,", "\n0.0009765625;", "expected 2 fields, got 1 .*row 7"),
        ("\n0.0009765625,", "\n0.0009765625,_", "expected a finite number.*, got '_.*row 7"),
        ("\n0.0009765625,", '\n"0.0009765625",', "expected a finite number, got '\"0.*row 7"),
        ("\n0.0009765625,", "\n0.0009765625,off ", "mark of a lost .*, got 'off 0.*row 7"),
        (
            "\n0.0009765625,",
            "\nNaN,",
            "expected a finite number, got 'NaN'.*row 7, column 'time_s'",
        ),
        ("time_s,", "\0", "zero bytes"),
    ],
)
def test_csv_damage_is_named_by_its_row(tmp_path, old, new, told):
    path = csv(tmp_path / "a.csv")
    path.write_text(path.read_text().replace(old, new))
    with pytest.raises(ValueError, match=told):
        read(path)


def marked(folder, mark, at, separator=",", decimal="."):
    """A file with a mark in the place of some samples."""
    lines = [f"{t:.9g}{separator}{v:.9g}" for t, v in zip(TIME, WAVE, strict=True)]
    for k in at:
        lines[k] = f"{TIME[k]:.9g}{separator}{mark}"
    path = folder / "a.csv"
    text = "\n".join([f"time_s{separator}velocity_m/s", *lines, ""])
    path.write_text(text.replace(".", decimal))
    return path


OVERLOADS = ("OVR", "OVL", "Overload", "over range", "inf", "-Inf")


@pytest.mark.parametrize("mark", ["NaN", "", "---", "#N/A", "-nan", "#NUM!", '"n/a"', *OVERLOADS])
@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_a_mark_in_the_place_of_a_number_is_a_lost_sample(tmp_path, mark, separator):
    at = [0, 7, 8, 20, TIME.size - 1]
    decimal = "." if separator == "," else ","
    found = read(marked(tmp_path, mark, at, separator, decimal))
    assert found.lost.tolist() == at[:-1]
    assert found.over.tolist() == (at[:-1] if mark in OVERLOADS else [])
    assert "no numbers for the last 1 of" in " ".join(found.notes)
    np.testing.assert_allclose(found.samples[1:], WAVE[1:-1], rtol=1e-3, atol=1e-3)


@pytest.mark.parametrize(("row", "got"), [("0.1 0.2 0.3", 3), ("0.1", 1)])
def test_a_row_of_another_length_between_blanks_is_told(tmp_path, row, got):
    path = marked(tmp_path, "NaN", [7], " ")
    lines = path.read_text().split("\n")
    lines[20] = row
    path.write_text("\n".join(lines))
    with pytest.raises(ValueError, match=f"expected 2 fields, got {got} .*row 21"):
        read(path)


def test_a_single_column_may_begin_over_the_range(tmp_path):
    (tmp_path / "a.csv").write_text(
        "\n".join(["velocity_m/s", "OVR", *map(repr, WAVE.tolist()), ""])
    )
    found = read(tmp_path / "a.csv", sampling_Hz=RATE)
    assert (found.over.tolist(), found.samples.size) == ([0], WAVE.size + 1)


def test_a_column_of_marks_is_no_motion(tmp_path):
    with pytest.raises(
        ValueError, match=r"90% of the samples.*, got none for .*\(0 over .*sample 2 "
    ):
        read(marked(tmp_path, "---", range(1, TIME.size - 1)))


def test_a_part_of_a_record_has_its_own_lost_samples(tmp_path):
    whole = read(marked(tmp_path, "OVL", [7, 100, 101]))
    found = part(whole, 50 / RATE, None, "a")
    assert (found.lost.tolist(), found.over.tolist()) == ([50, 51], [50, 51])


def test_lost_samples_are_filled_in_the_digitisers_steps(tmp_path):
    whole = np.round(1e3 * WAVE)
    coarse = np.where(np.arange(WAVE.size) % 30 == 5, np.nan, whole)
    found = recording(coarse, "mm/s", "a", sampling_Hz=RATE)
    assert set(np.unique(np.round(1e3 * found.samples, 9))) <= set(np.arange(-2000.0, 2000.0))
    np.testing.assert_allclose(1e3 * found.samples, whole, atol=3.0)


def test_a_last_line_without_its_end_is_cut_off(tmp_path):
    path = csv(tmp_path / "a.csv")
    path.write_text(path.read_text()[:-4])
    np.testing.assert_allclose(read(path).samples, WAVE[:-1], atol=1e-8)


@pytest.mark.parametrize(
    ("row", "told"),
    [
        ("2024-02-01 12:00:00.063125,{}", "no row of numbers but lines such as '2024-02-01 12"),
        ("0.10429687,{}D-06", r"no row of numbers but lines such as '0\.10429687,1\.5D-06'"),
    ],
)
def test_the_head_ends_with_a_whole_line(tmp_path, row, told):
    line = row.format("1.5") + "\n"
    # wherever the head is cut, what is left of a line is no row
    for shift in range(0, len(line), 3):
        head = "x" * shift + "\ntime_s,velocity_m/s\n"
        (tmp_path / "a.csv").write_text(head + 4000 * line)
        with pytest.raises(ValueError, match=told):
            read(tmp_path / "a.csv")


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-be"])
@pytest.mark.parametrize("header", ["", "velocity_m/s\n"])
def test_a_mark_at_the_start_is_no_number(tmp_path, encoding, header):
    text = header + "".join(f"{value:.9g}\n" for value in WAVE)
    (tmp_path / "a.csv").write_text(text, encoding=encoding)
    found = read(tmp_path / "a.csv", unit="m/s", sampling_Hz=RATE)
    np.testing.assert_allclose(found.samples, WAVE, atol=1e-8)


def test_one_bad_time_does_not_move_the_frequency():
    time = TIME.copy()
    time[-1] += 0.09 / RATE
    found = recording(WAVE, "m/s", "here", time)
    assert found.sampling_Hz == pytest.approx(RATE, rel=5e-7)


def test_reader_files_register_themselves():
    assert {".nc", ".csv", ".tdms", ".mat", ".uff", ".wav"} <= set(formats())


@pytest.mark.parametrize(
    ("quantity", "unit", "scale"),
    [("displacement", "mm", 1e-3), ("acceleration", "g", 9.80665), ("velocity", "mm/s", 1e-3)],
)
def test_every_quantity_becomes_velocity(quantity, unit, scale):
    omega, decline = 2 * np.pi * 100.0, 2.0
    signal = np.exp((1j * omega - decline) * TIME)
    order = {"displacement": 1, "velocity": 0, "acceleration": -1}[quantity]
    expected = scale * (signal * (1j * omega - decline) ** order).imag
    found = velocity(recording(signal.imag, unit, "here", sampling_Hz=RATE), 100.0)
    inside = slice(400, -400)
    # the slope of many samples is exact for a wave that does not decay; of this the phase is off
    least = 3e-4 if quantity == "displacement" else 3e-5
    assert np.abs(found - expected)[inside].max() < least * np.abs(expected).max()


@pytest.mark.parametrize("a_cycle", [2.6, 3.3, 5.0, 8.7, 20.0, 60.0, 300.0])
@pytest.mark.parametrize("expected_Hz", [90.0, 100.0, 112.0])
@pytest.mark.parametrize(("quantity", "unit"), [("displacement", "m"), ("acceleration", "m/s^2")])
def test_neither_few_samples_a_cycle_nor_many_lower_the_amplitude(
    quantity, unit, expected_Hz, a_cycle
):
    omega = 2 * np.pi * 100.0
    turn = np.exp(1j * omega * np.arange(4000) / (100.0 * a_cycle))
    order = {"displacement": 0, "acceleration": 2}[quantity]
    motion = recording((turn * (1j * omega) ** order).real, unit, "here", sampling_Hz=100 * a_cycle)
    missed = velocity(motion, expected_Hz) - (turn * 1j * omega).real
    assert np.abs(missed[200:-200]).max() < 3e-4 * omega


@pytest.mark.parametrize("a_cycle", [60.0, 300.0])
def test_the_noise_of_many_samples_a_cycle_is_not_differentiated(a_cycle):
    omega = 2 * np.pi * 100.0
    wave = np.cos(2 * np.pi * np.arange(9000) / a_cycle)
    noise = 1e-3 * np.random.default_rng(2).standard_normal(wave.size)
    still, noisy = (
        velocity(recording(one, "m", "here", sampling_Hz=100 * a_cycle), 100.0)
        for one in (wave, wave + noise)
    )
    assert np.std(noisy - still) < omega * np.std(noise)


@pytest.mark.parametrize("unit", ["m", "m/s^2"])
@pytest.mark.parametrize("expected_Hz", [1e-3, 0.6 * RATE, 79 * RATE, 1e4 * RATE])
def test_a_mode_that_the_samples_cannot_show_is_no_fault_of_the_conversion(unit, expected_Hz):
    motion = recording(np.sin(0.7 * np.arange(3000)), unit, "here", sampling_Hz=RATE)
    assert np.isfinite(velocity(motion, expected_Hz)).all()


def test_acceleration_that_begins_in_the_decay_is_right_from_its_start():
    rate = -6.0 + 2j * np.pi * 100.0
    signal = np.exp(rate * TIME + 2j)
    motion = recording((rate * signal).real, "m/s^2", "here", sampling_Hz=RATE)
    missed = velocity(motion, 100.0) - signal.real
    # a constant harms no curve; what remains of a cycle would
    missed -= missed[:100].mean()
    assert np.abs(missed[5:100]).max() < 2e-3


@pytest.mark.parametrize("a_cycle", [3.3, 5.4, 6.236, 9.7])
def test_few_samples_a_cycle_of_acceleration_are_right_at_both_ends(a_cycle):
    turn = np.exp(2j * np.pi * np.arange(1600) / a_cycle)
    motion = recording((1j * turn).real, "m/s^2", "here", sampling_Hz=a_cycle / 2 / np.pi)
    found, few = velocity(motion, 1.0 / 2 / np.pi), int(4 * a_cycle)
    columns = np.stack([turn.real, turn.imag, np.ones(1600), np.arange(1600.0)], axis=1)
    middle, *ends = (
        np.hypot(*np.linalg.lstsq(columns[part], found[part], rcond=None)[0][:2])
        for part in (slice(600, 1000), slice(4, few), slice(-few, -4))
    )
    assert np.abs(np.array(ends) / middle - 1.0).max() < 5e-4


def test_acceleration_offset_leaves_no_drift():
    signal = 5.0 + np.sin(2 * np.pi * 100 * TIME)
    found = velocity(recording(signal, "m/s^2", "here", sampling_Hz=RATE), 100.0)
    assert np.abs(found[600:-600]).max() < 2.0 / (2 * np.pi * 100)


@pytest.mark.parametrize(
    ("value", "told"),
    [
        (lambda k: f"{1000.5 + k:,}", r"without signs between their thousands, got '1,000\.5'.* 2"),
        (lambda k: f"1.{100 + k},5", r"without signs between their thousands, got '1\.100,5'"),
        (lambda k: f"{10**6 + k:,}", r"between their thousands, got '1,000,000'"),
        (lambda k: f"{1000 + k:,}", r"got '1,000', whose comma may be that or a decimal one"),
        (lambda k: f"{990 + k:,}", r"got '1,000', whose comma may be .*, row 12\)"),
        (lambda k: f"1,{k}5" if k % 2 else "0.5", r"expected one decimal sign, got '1,15' and '0"),
    ],
)
def test_commas_between_thousands_are_no_decimal_commas(tmp_path, value, told):
    rows = "".join(f"{value(k)};1\n" for k in range(70))
    (tmp_path / "a.csv").write_text("velocity_m/s;count\n" + rows)
    with pytest.raises(ValueError, match=told):
        read(tmp_path / "a.csv", sampling_Hz=1000.0)


def test_three_decimals_behind_a_comma_are_read_where_one_number_shows_it(tmp_path):
    values = np.round(2.5 * np.sin(np.arange(70)), 3)
    rows = "".join(f"{value:.3f};1\n".replace(".", ",") for value in values)
    (tmp_path / "a.csv").write_text("velocity_mm/s;count\n" + rows)
    found = read(tmp_path / "a.csv", sampling_Hz=1000.0)
    np.testing.assert_allclose(found.samples, 1e-3 * values)
