"""Readers: units, names, one clear line for everything that can be wrong."""

import netCDF4
import numpy as np
import pytest
from bladeroot.records.read import formats, read
from bladeroot.records.recording import recording, velocity

RATE = 5120.0
TIME = np.arange(2000) / RATE
WAVE = np.exp(-2 * TIME) * np.sin(2 * np.pi * 100 * TIME)


def csv(path, header="time_s,velocity_m/s", rows=None, separator=","):
    rows = zip(TIME, WAVE, strict=True) if rows is None else rows
    lines = [separator.join(f"{value:.9g}" for value in row) for row in rows]
    path.write_text("\n".join([header, *lines]))
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


def rows_with(k, time=None, value=None):
    rows = [[t, v] for t, v in zip(TIME, WAVE, strict=True)]
    rows[k] = [rows[k][0] if time is None else time, rows[k][1] if value is None else value]
    return rows


@pytest.mark.parametrize(
    ("header", "rows", "message"),
    [
        ("time_s,velocity_m/s", rows_with(7, value=np.nan), "finite number, got 'nan'.*row 9"),
        ("time_s,velocity_m/s", rows_with(7, time=5.0), "time must rise.*sample 9"),
        ("time_s,velocity_m/s", rows_with(7, time=TIME[7] + 1e-4), "time must be uniform"),
        ("time_s,speed_m/s", None, "expected one column velocity or displacement"),
        ("time_s,velocity", None, "expected a unit in the header"),
        ("time_s,velocity_m", None, None),
        ("x,velocity_m/s", None, "expected a time column"),
        ("time_s,velocity_m/s", rows_with(7)[:20], "at least 64 samples, got 20"),
        ("time_s,velocity_m/s", [], "expected a header and rows"),
    ],
)
def test_csv_faults(tmp_path, header, rows, message):
    path = csv(tmp_path / "a.csv", header, rows)
    if message is None:
        with pytest.raises(ValueError, match="quantity 'velocity' needs a unit"):
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
    with pytest.raises(ValueError, match=r"expected a variable velocity or .*, got time, speed"):
        read(netcdf(tmp_path / "a.nc", name="speed"))
    (tmp_path / "b.nc").write_text("no")
    with pytest.raises(ValueError, match="expected a NetCDF file"):
        read(tmp_path / "b.nc")
    with pytest.raises(ValueError, match="got none at"):
        read(tmp_path / "c.nc")
    with pytest.raises(ValueError, match="expected a file ending in"):
        read(tmp_path / "c.xyz")


def test_reader_files_register_themselves():
    assert {".nc", ".csv"} <= set(formats())


@pytest.mark.parametrize(
    ("quantity", "unit", "scale"),
    [("displacement", "mm", 1e-3), ("acceleration", "g", 9.80665), ("velocity", "mm/s", 1e-3)],
)
def test_every_quantity_becomes_velocity(quantity, unit, scale):
    omega, decline = 2 * np.pi * 100.0, 2.0
    signal = np.exp((1j * omega - decline) * TIME)
    order = {"displacement": 1, "velocity": 0, "acceleration": -1}[quantity]
    expected = scale * (signal * (1j * omega - decline) ** order).imag
    found = velocity(recording(signal.imag, unit, "here", sampling_Hz=RATE), 20.0)
    inside = slice(400, -400)
    assert np.abs(found - expected)[inside].max() < 3e-3 * np.abs(expected).max()


def test_acceleration_offset_leaves_no_drift():
    signal = 5.0 + np.sin(2 * np.pi * 100 * TIME)
    found = velocity(recording(signal, "m/s^2", "here", sampling_Hz=RATE), 20.0)
    assert np.abs(found[600:-600]).max() < 2.0 / (2 * np.pi * 100)
