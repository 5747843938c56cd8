"""Every format: what is written is read back; channels, metadata, and what each format can say."""

import netCDF4
import numpy as np
import pytest
import xarray as xr
from bladeroot.io.read import read
from hypothesis import given, settings
from hypothesis import strategies as st
from record_files import (
    FORMATS,
    write_csv,
    write_matlab_73,
    write_tdms,
    write_universal,
    write_universal_by_hand,
    write_wav,
)

RATE = 5120.0
TIME = np.arange(400) / RATE
WAVE = 0.5 * np.exp(-2 * TIME) * np.sin(2 * np.pi * 100 * TIME)
FORCE = np.cos(2 * np.pi * 50 * TIME)


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


CELLS = np.empty((2, 3), object)
CELLS[:] = [[TIME[:, None], WAVE[:, None], 7.0], [TIME[:, None], 2 * WAVE[:, None], 8.0]]


@pytest.mark.parametrize(
    ("variables", "told", "factor"),
    [
        ({"t": TIME, "velocity": WAVE}, {"unit": "m/s"}, 1.0),
        ({"time": TIME, "v": WAVE}, {"unit": "mm/s"}, 1e-3),
        ({"data": np.stack([TIME, WAVE], axis=1)}, {"unit": "m/s"}, 1.0),
        ({"data": np.stack([TIME, WAVE, FORCE])}, {"unit": "m/s", "channel": "data(2,:)"}, 1.0),
        ({"data": np.stack([WAVE, FORCE], 1), "Fs": RATE}, {"unit": "m/s", "channel": "1"}, 1.0),
        ({"run": {"laser": WAVE, "dt": 1 / RATE, "units": "mm/s"}}, {}, 1e-3),
        ({"a": {"y": WAVE, "fs": RATE}, "b": {"y": FORCE, "fs": 7.0}},
         {"unit": "m/s", "channel": "a.y"}, 1.0),
        ({"xData": CELLS}, {"unit": "m/s", "channel": "xData{2,2}"}, 2.0),
        ({"v": np.round(1e4 * WAVE).astype(np.int16), "fs": RATE},
         {"unit": "m/s", "sensitivity": "1e-4"}, 1.0),
    ],
)  # fmt: skip
def test_matlab_conventions(tmp_path, variables, told, factor):
    from scipy.io import savemat

    savemat(tmp_path / "a.mat", variables, oned_as="column")
    found = read(tmp_path / "a.mat", **told)
    assert found.sampling_Hz == pytest.approx(RATE, rel=1e-12)
    np.testing.assert_allclose(found.samples, factor * WAVE, atol=6e-5 * factor)


def test_matlab_says_what_was_found(tmp_path):
    from scipy.io import savemat

    savemat(tmp_path / "a.mat", {"p": WAVE, "q": FORCE, "note": "hello"})
    with pytest.raises(ValueError, match=r"got none of 1: p, 2: q; channel names"):
        read(tmp_path / "a.mat", unit="m/s")
    with pytest.raises(ValueError, match="expected a time column or a positive sampling_Hz"):
        read(tmp_path / "a.mat", unit="m/s", channel="p")


def test_matlab_73_cells_and_structs(tmp_path):
    import h5py

    path = tmp_path / "a.mat"
    write_matlab_73(path, FORCE, RATE, "V")
    with h5py.File(path, "a") as file:
        refs = file.create_group("#refs#")
        cell = file.create_dataset("runs", (2, 1), h5py.ref_dtype)
        for k, part in enumerate((TIME, WAVE)):
            refs[f"r{k}"] = part[None, :]
            cell[k, 0] = refs[f"r{k}"].ref
        file["s/laser"] = 2.0 * WAVE[None, :]
    np.testing.assert_allclose(read(path, channel="runs{1,2}", sensitivity="1 m/s/V").samples, WAVE)
    found = read(path, channel="s.laser", sensitivity="1 m/s/V")
    np.testing.assert_allclose(found.samples, 2 * WAVE)


def siemens(step=1 / RATE, unit="mm/s", time="s"):
    """A signal as Siemens Testlab writes it."""
    x_values = {"start_value": 0.5, "increment": step, "quantity": {"label": time}}
    return {"x_values": x_values, "y_values": {"values": WAVE, "quantity": {"label": unit}}}


def test_matlab_structs_of_x_and_y_values(tmp_path):
    from scipy.io import savemat

    path = tmp_path / "a.mat"
    savemat(path, {"first": siemens(), "second": siemens(unit="m/s", time="ms", step=1e3 / RATE)})
    found = read(path, channel="first.y_values.values")
    np.testing.assert_allclose(found.samples, 1e-3 * WAVE)
    assert found.sampling_Hz == RATE
    assert found.start_s == 0.5
    with pytest.raises(ValueError, match=r"sampling_Hz contradicts: 2560 in .*, 5120 in the file"):
        read(path, channel="first.y_values.values", sampling_Hz=2560.0)
    with pytest.raises(ValueError, match=r"unit contradicts: 'm/s' in .*, 'mm/s' in the file"):
        read(path, channel="first.y_values.values", unit="m/s")
    other = read(path, channel="second.y_values.values")
    np.testing.assert_allclose(other.samples, WAVE)
    assert other.sampling_Hz == pytest.approx(RATE, rel=1e-12)
    assert other.start_s == 0.5e-3
    savemat(tmp_path / "b.mat", {"spectrum": siemens(time="Hz")})
    with pytest.raises(
        ValueError, match=r"x_values\.increment \[Hz\] .*its unit 'hz' is not known"
    ):
        read(tmp_path / "b.mat")


def test_matlab_73_arrays_of_structs(tmp_path):
    import h5py

    path = tmp_path / "a.mat"
    fields = {"laser": (WAVE, 2.0 * WAVE), "fs": (RATE, 2.0 * RATE)}
    with h5py.File(path, "w", userblock_size=512) as file:
        for field, values in fields.items():
            array = file.create_dataset(f"runs/{field}", (2, 1), h5py.ref_dtype)
            for k, value in enumerate(values):
                file[f"#refs#/{field}{k}"] = np.atleast_2d(value)
                array[k, 0] = file[f"#refs#/{field}{k}"].ref
    for k in (1, 2):
        found = read(path, channel=f"runs(1,{k}).laser", unit="m/s")
        np.testing.assert_allclose(found.samples, k * WAVE)
        assert found.sampling_Hz == k * RATE


def test_matlab_objects_are_told(tmp_path, monkeypatch):
    import h5py
    import scipy.io
    from scipy.io.matlab import MatlabOpaque

    told = r"got objects that only MATLAB reads: ts; their times and data can be saved as variables"
    with h5py.File(tmp_path / "a.mat", "w", userblock_size=512) as file:
        file["ts"] = np.array([[0xDD000000, 2, 1, 1, 1, 1]], "u4")
        file["ts"].attrs["MATLAB_object_decode"] = np.int32(3)
    with pytest.raises(ValueError, match=told):
        read(tmp_path / "a.mat")
    with h5py.File(tmp_path / "a.mat", "a") as file:
        file["velocity"] = WAVE[None, :]
    np.testing.assert_allclose(read(tmp_path / "a.mat", unit="m/s", sampling_Hz=RATE).samples, WAVE)
    with pytest.raises(ValueError, match=told):
        read(tmp_path / "a.mat", channel="ts")
    row = np.array([(b"ts", b"MCOS", b"timeseries", np.zeros((6, 1), "u4"))],
                   [(field, object) for field in ("s0", "s1", "s2", "arr")])  # fmt: skip
    monkeypatch.setattr(scipy.io, "loadmat", lambda *_, **__: {"None": MatlabOpaque(row)})
    (tmp_path / "b.mat").write_bytes(b"MATLAB 5.0 MAT-file")
    with pytest.raises(ValueError, match=told):
        read(tmp_path / "b.mat")


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


def test_matlab_73_empty_arrays_are_no_channels(tmp_path):
    import h5py

    path = tmp_path / "a.mat"
    write_matlab_73(path, WAVE, RATE, "m/s")
    with h5py.File(path, "a") as file:
        notes = file.create_dataset("notes", data=np.zeros(2, np.uint64))
        notes.attrs["MATLAB_class"], notes.attrs["MATLAB_empty"] = np.bytes_("double"), np.uint8(1)
    np.testing.assert_allclose(read(path).samples, WAVE)


@pytest.mark.parametrize("double", [True, False])
@pytest.mark.parametrize("count", [400, 397])
def test_universal_file_of_text(tmp_path, double, count):
    write_universal(tmp_path / "a.uff", WAVE[:count], RATE, double=double)
    found = read(tmp_path / "a.uff", channel="12:+Z")
    np.testing.assert_allclose(found.samples, WAVE[:count], atol=1e-5 * WAVE.max())
    assert found.sampling_Hz == RATE  # 1.95312e-04 in the file, 2.6 ppm off


@settings(max_examples=40, deadline=None)
@given(
    order=st.sampled_from("<>"),
    double=st.booleans(),
    even=st.booleans(),
    rate=st.sampled_from([1000.0, 5120.0, 25600.0, 51200.0]),
    count=st.integers(64, 700),
    seed=st.integers(0, 2**32 - 1),
)
def test_universal_file_of_either_byte_order(
    tmp_path_factory, order, double, even, rate, count, seed
):
    path = tmp_path_factory.mktemp("order") / "a.uff"
    samples = 0.1 * np.random.default_rng(seed).standard_normal(count)
    write_universal_by_hand(path, samples, rate, order, double, even)
    found = read(path)
    np.testing.assert_allclose(found.samples, samples, rtol=0 if double else 1e-7)
    assert found.sampling_Hz == pytest.approx(rate, rel=1e-12)
    assert found.notes == ()
    data, own, other = path.read_bytes(), *((1, 2) if order == "<" else (2, 1))
    for flag, told in ((3, "byte order 1 or 2"), (other, "no vibration|finite|must rise|uniform")):
        path.write_bytes(data.replace(b"58b     %d" % own, b"58b     %d" % flag))
        with pytest.raises(ValueError, match=told):
            read(path)


def test_universal_file_of_an_odd_rate_says_so(tmp_path):
    write_universal(tmp_path / "a.uff", WAVE, 5120.37)
    (note,) = read(tmp_path / "a.uff").notes
    assert "unusual" in note
    found = read(tmp_path / "a.uff", sampling_Hz=5120.37)
    assert found.sampling_Hz == 5120.37
    assert "sampling_Hz 5120.37 of records.csv is taken" in found.notes[0]


@pytest.mark.parametrize(
    ("increment", "stated", "taken", "notes"),
    [
        ("3.9062E-05", None, 25600.0, 0),
        ("2.27E-05", None, 44000.0, 1),
        ("2.27E-05", 44100.0, 44100.0, 1),
        ("0.0001", None, 10000.0, 0),
    ],
)
def test_universal_increment_of_few_digits(tmp_path, increment, stated, taken, notes):
    write_universal(tmp_path / "a.uff", WAVE, 25600.0)
    text = (tmp_path / "a.uff").read_text()
    written = f"{1 / 25600.0:13.5e}"
    assert text.count(written) == 1
    (tmp_path / "a.uff").write_text(text.replace(written, f"{increment:>13}"))
    found = read(tmp_path / "a.uff", sampling_Hz=stated)
    assert found.sampling_Hz == taken
    assert len(found.notes) == notes
    if increment == "0.0001":
        with pytest.raises(ValueError, match="sampling_Hz contradicts: 16000"):
            read(tmp_path / "a.uff", sampling_Hz=16000.0)


def test_universal_file_of_several_functions(tmp_path):
    write_universal(tmp_path / "a.uff", WAVE, RATE)
    write_universal(tmp_path / "b.uff", 3 * WAVE, RATE)
    both = (tmp_path / "a.uff").read_bytes() + (tmp_path / "b.uff").read_bytes()
    (tmp_path / "c.uff").write_bytes(both)
    with pytest.raises(ValueError, match=r"got several of 1: 12:\+Z \[m/s\], 2: 12:\+Z \[m/s\]"):
        read(tmp_path / "c.uff")
    np.testing.assert_allclose(read(tmp_path / "c.uff", channel="2").samples, 3 * WAVE, atol=1e-11)


def test_universal_units_of_data_set_164(tmp_path):
    write_universal(tmp_path / "a.uff", WAVE, RATE, unit="NONE")
    with pytest.raises(ValueError, match="expected a unit"):
        read(tmp_path / "a.uff")
    units = "    -1\n   164\n         5mm (milli-newton)           2\n"
    factors = "".join(f"{factor:25.17e}" for factor in (1e3, 1e3, 1.0)) + "\n"
    text = units + factors + f"{273.15:25.17e}\n    -1\n"
    (tmp_path / "b.uff").write_bytes(text.encode() + (tmp_path / "a.uff").read_bytes())
    np.testing.assert_allclose(read(tmp_path / "b.uff").samples, 1e-3 * WAVE, atol=1e-14)


def test_universal_type_contradicts(tmp_path):
    write_universal(tmp_path / "a.uff", WAVE, RATE)
    with pytest.raises(ValueError, match=r"quantity contradicts: acceleration .*velocity in the f"):
        read(tmp_path / "a.uff", quantity="acceleration", channel="1")


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
