"""Every format: what is written is read back; channels, metadata, and what each format can say."""

import netCDF4
import numpy as np
import pytest
import xarray as xr
from bladeroot.io.read import read
from hypothesis import given, settings
from hypothesis import strategies as st
from record_files import FORCE, FORMATS, RATE, TIME, WAVE, write_csv, write_tdms, write_wav


@pytest.mark.parametrize("name", FORMATS)
@settings(max_examples=8, deadline=None)
@given(
    rate=st.sampled_from([1000.0, 5120.0, 25600.0, 44100.0, 51200.0, 102400.0]),
    unit=st.sampled_from([("m/s", 1.0), ("mm/s", 1e-3), ("in/s", 0.0254)]),
    level=st.floats(1e-3, 1.0),
    seed=st.integers(0, 2**32 - 1),
    count=st.integers(64, 700),
)
def test_what_is_written_is_read_back(tmp_path_factory, name, rate, unit, level, seed, count):
    suffix, write, told = FORMATS[name]
    samples = level * np.random.default_rng(seed).standard_normal(count)
    path = tmp_path_factory.mktemp("trip") / f"record{suffix}"
    write(path, samples, rate, unit[0])
    found = read(path, **({"unit": unit[0]} if told else {}))
    assert found.quantity == "velocity"
    assert found.sampling_Hz == pytest.approx(rate, rel=1e-9)
    np.testing.assert_allclose(found.samples, unit[1] * samples, rtol=2e-11, atol=1e-14)
    assert found.notes == ()


@pytest.mark.parametrize("name", FORMATS)
def test_the_sheet_may_not_contradict_the_file(tmp_path, name):
    suffix, write, told = FORMATS[name]
    path = tmp_path / f"record{suffix}"
    write(path, WAVE, RATE)
    with pytest.raises(ValueError, match=r"sampling_Hz contradicts: 2560 .*5120 .*record"):
        read(path, sampling_Hz=2560.0, **told)
    if not told:
        with pytest.raises(ValueError, match=r"unit contradicts: 'mm/s' .*'m/s' in the file"):
            read(path, unit="mm/s")
        assert read(path, unit="m s^-1").notes == ()
        # where the file's own unit is wrong, a factor puts it right
        np.testing.assert_allclose(read(path, sensitivity="0.001").samples, 1e-3 * WAVE, atol=1e-12)


@pytest.mark.parametrize(("bits", "step"), [(8, 1e-2), (16, 2e-5), (24, 1e-7), (32, 1e-9)])
@pytest.mark.parametrize("order", ["<", ">"])
def test_wav_of_whole_numbers(tmp_path, bits, step, order):
    path = tmp_path / "a.wav"
    write_wav(path, np.stack([WAVE, FORCE], axis=1), RATE, bits=bits, order=order)
    found = read(path, channel="1", sensitivity="500 mm/s/FS")
    np.testing.assert_allclose(found.samples, 0.5 * WAVE, atol=step)
    with pytest.raises(ValueError, match="unit FS needs a sensitivity such as 125 mm/s/FS"):
        read(path, channel="1")
    with pytest.raises(ValueError, match="none of 1: channel 1, 2: channel 2"):
        read(path, sensitivity="500 mm/s/FS")


def test_wav_of_floats_has_no_unit(tmp_path):
    write_wav(tmp_path / "a.wav", WAVE, RATE, bits=-32)
    with pytest.raises(ValueError, match="expected a unit, got none from the file"):
        read(tmp_path / "a.wav")
    found = read(tmp_path / "a.wav", unit="V", sensitivity="20 mm/s/V")
    np.testing.assert_allclose(found.samples, 0.02 * WAVE, atol=1e-9)


LABVIEW = """LabVIEW Measurement\t
Separator\tTab
Decimal_Separator\t,
X_Columns\tOne
Date\t2024/02/01
Time\t12:30:00,1234
***End_of_Header***\t\t

Channels\t1\t
Samples\t400\t
Y_Unit_Label\tmm/s\t
X_Dimension\tTime\t
X0\t0,0000000000000000E+0\t
Delta_X\t{step}\t
***End_of_Header***\t\t
X_Value\tlaser\tComment
"""


@pytest.mark.parametrize("end", ["\n", "\t\n"])
def test_labview_measurement_file(tmp_path, end):
    rows = "".join(f"{t:.6f}\t{v:.8f}{end}" for t, v in zip(TIME, WAVE, strict=True))
    text = (LABVIEW + rows).replace(".", ",")
    (tmp_path / "a.lvm").write_text(text.replace("{step}", "0,000195"))
    found = read(tmp_path / "a.lvm")
    np.testing.assert_allclose(found.samples, 1e-3 * WAVE, atol=1e-11)
    assert found.sampling_Hz == RATE
    assert found.notes == ()
    (tmp_path / "b.lvm").write_text(text.replace("{step}", "0,000391"))
    with pytest.raises(ValueError, match=r"the file says 2557\.54476 Hz, its times 5120 Hz"):
        read(tmp_path / "b.lvm")


@pytest.mark.parametrize("clock", [True, False])
def test_labview_says_the_unit_of_each_channel(tmp_path, clock):
    two = {"Channels\t1": "Channels\t2", "Samples\t400": "Samples\t400\t400",
           "Label\tmm/s": "Label\tN\tmm/s", "0,0000000000000000E+0": "0,0E+0\t0,0E+0",
           "{step}": "0,0001953125\t0,0001953125", "laser": "hammer\tlaser",
           "Columns\tOne": "Columns\tOne" if clock else "Columns\tNo"}  # fmt: skip
    text = LABVIEW
    for old, new in two.items():
        text = text.replace(old, new)
    times = [f"{t:.6f}" if clock else "" for t in TIME]
    text += "".join(f"{t}\t1,0\t{v:.8f}\t\n" for t, v in zip(times, WAVE, strict=True))
    (tmp_path / "a.lvm").write_text(text.replace(".", ","))
    found = read(tmp_path / "a.lvm")
    np.testing.assert_allclose(found.samples, 1e-3 * WAVE, atol=1e-11)
    assert found.sampling_Hz == RATE
    with pytest.raises(ValueError, match="unit contradicts: 'm/s'"):
        read(tmp_path / "a.lvm", channel="laser", unit="m/s")


@pytest.mark.parametrize(("separator", "decimal"), [(",", "."), (";", ","), ("\t", ",")])
def test_a_table_in_quotation_marks(tmp_path, separator, decimal):
    lines = [["unit", "mm/s"], ["time_s", "laser"]]
    lines += [[f"{t:.9f}", f"{v:.9f}"] for t, v in zip(TIME, WAVE, strict=True)]
    lines = [separator.join(f'"{field}"' for field in line) for line in lines]
    text = "\n".join([*lines[:2], *(line.replace(".", decimal) for line in lines[2:]), ""])
    (tmp_path / "a.csv").write_text(text)
    found = read(tmp_path / "a.csv")
    np.testing.assert_allclose(found.samples, 1e-3 * WAVE, atol=1e-12)
    assert found.sampling_Hz == RATE


def test_decimal_commas_in_quotation_marks_are_no_separators(tmp_path):
    rows = "".join(f'"{k},5","1,{k}"\n' for k in range(100))
    (tmp_path / "a.csv").write_text('"time_s","velocity_m/s"\n' + rows)
    with pytest.raises(ValueError, match='no row of numbers but lines such as \'"99,5","1,99"\''):
        read(tmp_path / "a.csv")


def test_tdms_of_several_channels(tmp_path):
    from nptdms import ChannelObject, GroupObject, RootObject, TdmsWriter

    path = tmp_path / "a.tdms"
    wave = {"wf_increment": 1 / RATE, "NI_UnitDescription": "mm/s"}
    with TdmsWriter(path) as file:
        file.write_segment(
            [
                RootObject({"mode": "1B"}),
                GroupObject("run", {"force_N": 12000.0}),
                ChannelObject(
                    "run", "hammer", FORCE, {"wf_increment": 1 / RATE, "unit_string": "N"}
                ),
                ChannelObject("run", "tip", 1e3 * WAVE, wave),
                ChannelObject("run", "root", WAVE, wave),
            ]
        )
    np.testing.assert_allclose(read(path, channel="tip").samples, WAVE, atol=1e-12)
    np.testing.assert_allclose(read(path, channel="run/root").samples, 1e-3 * WAVE, atol=1e-12)
    np.testing.assert_allclose(read(path, channel="2").samples, WAVE, atol=1e-12)
    told = r"got several of 2: run/tip \[mm/s\], 3: run/root \[mm/s\];"
    with pytest.raises(ValueError, match=told):
        read(path)
    with pytest.raises(ValueError, match=r"mode contradicts: 2B in records.csv, 1B in the file"):
        read(path, channel="tip", mode="2B")
    with pytest.raises(ValueError, match=r"force_N contradicts: 16000 in records.csv, 12000 in"):
        read(path, channel="tip", force_N=16000.0)
    assert read(path, channel="tip", mode="1B", force_N=12000.0).notes == ()


def test_a_unit_in_a_channels_name_is_no_other_than_its_property(tmp_path):
    from nptdms import ChannelObject, TdmsWriter

    path = tmp_path / "a.tdms"
    units = {"laser_mm/s": "m/s", "tip [mm/s]": "mm/s", "root_mm/s": None, "ai0 (V)": "m/s"}
    with TdmsWriter(path) as file:
        for name, unit in units.items():
            known = {"wf_increment": 1 / RATE} | ({"unit_string": unit} if unit else {})
            file.write_segment([ChannelObject("run", name, WAVE, known)])
    with pytest.raises(ValueError, match=r"unit contradicts inside the file: 'm/s' of the channel"):
        read(path, channel="1")
    for number, factor in (("2", 1e-3), ("3", 1e-3), ("4", 1.0)):
        np.testing.assert_allclose(read(path, channel=number).samples, factor * WAVE, atol=1e-12)


def test_tdms_does_not_trust_an_index_file(tmp_path):
    write_tdms(tmp_path / "a.tdms", WAVE, RATE)
    (tmp_path / "a.tdms_index").write_bytes(b"TDSh" + b"\0" * 24)
    np.testing.assert_allclose(read(tmp_path / "a.tdms").samples, WAVE)


@pytest.mark.parametrize("name", ["velocity [mm/s]", "Velocity of the tip (mm/s)"])
def test_what_stands_above_a_single_column_is_its_name(tmp_path, name):
    path = tmp_path / "one.txt"
    path.write_text(name + "\n" + "\n".join(f"{np.sin(k):.9g}" for k in range(3000)))
    found = read(path, sampling_Hz=5120.0)
    assert found.quantity == "velocity"
    assert found.samples[1] == pytest.approx(1e-3 * np.sin(1.0), rel=1e-6)


def test_a_header_behind_a_comment_sign_names_the_columns(tmp_path):
    table = np.column_stack([TIME, 1e3 * WAVE])
    np.savetxt(tmp_path / "a.csv", table, delimiter=",", header="time_s,velocity_mm/s")
    np.testing.assert_allclose(read(tmp_path / "a.csv").samples, WAVE)
    np.savetxt(tmp_path / "b.csv", table, delimiter=",", header="made by hand, on a Monday")
    with pytest.raises(ValueError, match="column 1 rises in steps"):
        read(tmp_path / "b.csv", unit="mm/s")


def test_channels_as_a_second_dimension_are_told_as_none(tmp_path):
    both = np.stack([WAVE, WAVE], axis=1)
    xr.Dataset({"velocity": (("time", "channel"), both)}).to_netcdf(tmp_path / "a.nc")
    with pytest.raises(ValueError, match=r"got no vector of real numbers \(.*a\.nc\)"):
        read(tmp_path / "a.nc", channel="velocity")


def test_netcdf_attributes(tmp_path):
    with netCDF4.Dataset(tmp_path / "a.nc", "w") as file:
        file.createDimension("n", TIME.size)
        file.createVariable("laser", "f4", "n")[:] = WAVE
        file["laser"].units = "mm/s"
        file.sampling_Hz = RATE
        file.mode = "1B"
    found = read(tmp_path / "a.nc", mode="1B")
    np.testing.assert_allclose(found.samples, 1e-3 * WAVE, atol=1e-9)
    assert found.sampling_Hz == RATE
    with pytest.raises(ValueError, match=r"mode contradicts"):
        read(tmp_path / "a.nc", mode="2B")


@pytest.mark.parametrize(
    ("form", "kind", "clipped"),
    [
        ("NETCDF3_CLASSIC", "i2", -32767),
        ("NETCDF4", "i2", -32767),
        ("NETCDF4", "u2", 65535),
        ("NETCDF4", "i4", -2147483647),
    ],
)
def test_netcdf_fills_of_whole_numbers_count_where_declared(tmp_path, form, kind, clipped):
    whole = np.round(1e4 * WAVE).astype(int)
    whole[7] = clipped
    for name, fill in (("a.nc", None), ("b.nc", clipped)):
        with netCDF4.Dataset(tmp_path / name, "w", format=form) as file:
            file.sampling_Hz = RATE
            file.createDimension("n", TIME.size)
            velocity = file.createVariable("velocity", kind, "n", fill_value=fill)
            velocity.units, velocity.scale_factor = "m/s", 1e-9
            velocity.set_auto_scale(False)
            velocity[:] = whole.astype(kind)
    found = read(tmp_path / "a.nc")
    np.testing.assert_allclose(found.samples, 1e-9 * whole.astype(kind), rtol=1e-12)
    assert read(tmp_path / "b.nc").lost.tolist() == [7]


def test_netcdf_never_written_numbers_are_none(tmp_path):
    with netCDF4.Dataset(tmp_path / "a.nc", "w") as file:
        file.sampling_Hz = RATE
        file.createDimension("n", TIME.size)
        velocity = file.createVariable("velocity", "f8", "n")
        velocity.units = "m/s"
        velocity[:300] = WAVE[:300]
    found = read(tmp_path / "a.nc")
    np.testing.assert_array_equal(found.samples, WAVE[:300])
    assert "no numbers for the last 100 of 400 samples" in found.notes[0]


def test_a_slip_of_a_thousand_is_noted(tmp_path):
    write_csv(tmp_path / "a.csv", 1e3 * WAVE, RATE)
    (note,) = read(tmp_path / "a.csv").notes
    assert "the peak velocity is 4" in note
    assert "above 10 m/s: is the unit right?" in note
    write_csv(tmp_path / "b.csv", 1e9 * WAVE, RATE)
    with pytest.raises(ValueError, match="no vibration"):
        read(tmp_path / "b.csv")
    write_csv(tmp_path / "c.csv", WAVE, RATE, unit="nm/s")
    assert "below 1e-07 m/s" in read(tmp_path / "c.csv").notes[0]


def test_an_unusual_rate_is_noted_until_the_sheet_confirms_it(tmp_path):
    write_tdms(tmp_path / "a.tdms", WAVE, 5120.0371)
    (note,) = read(tmp_path / "a.tdms").notes
    assert "unusual" in note
    assert read(tmp_path / "a.tdms", sampling_Hz=5120.0371).notes == ()
    write_tdms(tmp_path / "b.tdms", WAVE, 51200 / 3)
    assert read(tmp_path / "b.tdms").notes == ()


def test_bytes_in_the_other_order_are_told(tmp_path):
    from scipy.io import savemat

    whole = np.round(2e4 * WAVE).astype(np.int16)
    savemat(tmp_path / "a.mat", {"v": whole.byteswap(), "fs": RATE})
    with pytest.raises(ValueError, match="bytes were in the other order"):
        read(tmp_path / "a.mat", unit="um/s")
