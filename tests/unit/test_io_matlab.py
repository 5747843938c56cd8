"""MATLAB files: the forms in which laboratories keep signals in them."""

import numpy as np
import pytest
from bladeroot.io.read import read
from record_files import FORCE, RATE, TIME, WAVE, write_matlab_73

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
    with pytest.raises(ValueError, match=r"sampling_Hz contradicts: 2560 stated, 5120 in the file"):
        read(path, channel="first.y_values.values", sampling_Hz=2560.0)
    with pytest.raises(ValueError, match=r"unit contradicts: 'm/s' stated, 'mm/s' in the file"):
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


def test_matlab_73_empty_arrays_are_no_channels(tmp_path):
    import h5py

    path = tmp_path / "a.mat"
    write_matlab_73(path, WAVE, RATE, "m/s")
    with h5py.File(path, "a") as file:
        notes = file.create_dataset("notes", data=np.zeros(2, np.uint64))
        notes.attrs["MATLAB_class"], notes.attrs["MATLAB_empty"] = np.bytes_("double"), np.uint8(1)
    np.testing.assert_allclose(read(path).samples, WAVE)
