"""What a file says beside its numbers: units of numbers, contradictions, times in odd units."""

import netCDF4
import numpy as np
import pytest
from bladeroot.io.read import read
from bladeroot.io.statements import statements
from bladeroot.io.units import one_unit

RATE = 25600.0
TIME = np.arange(400) / RATE
WAVE = 0.5 * np.exp(-2 * TIME) * np.sin(2 * np.pi * 400 * TIME)


def csv(path, head, *columns, separator=","):
    rows = (separator.join(f"{one:.12g}" for one in row) for row in zip(*columns, strict=True))
    path.write_text("\n".join([head, *rows, ""]), encoding="utf-8")
    return path


def netcdf(path, units="m/s", time="s", group="", values=WAVE, **attributes):
    with netCDF4.Dataset(path, "w") as file:
        place = file.createGroup(group) if group else file
        place.createDimension("n", TIME.size)
        if time:
            place.createVariable("time", "f8", "n")[:] = TIME
            place["time"].units = time
        place.createVariable("velocity", "f8", "n")[:] = values
        if units:
            place["velocity"].units = units
        file.setncatts(attributes)
    return path


def matlab(path, **variables):
    from scipy.io import savemat

    savemat(path, variables)
    return path


def tdms(path, time=None, root=None, **properties):
    from nptdms import ChannelObject, RootObject, TdmsWriter

    clock = [] if time is None else [ChannelObject("run", "Time", time, {"unit_string": "s"})]
    wave = ChannelObject("run", "laser", WAVE, {"unit_string": "m/s", **properties})
    with TdmsWriter(path) as file:
        file.write_segment([RootObject(root or {}), *clock, wave])
    return path


@pytest.mark.parametrize(
    ("name", "value", "rate"),
    [
        ("fs", "25.6 kHz", 25600.0),
        ("fs", "25600 Hz", 25600.0),
        ("Sampling rate", "25,600", 25600.0),
        ("Sampling rate", "25.600,0", 25600.0),
        ("sampling rate [kHz]", "25.6", 25600.0),
        ("sampling rate [kHz]", "25,6", 25600.0),
        ("sampling_Hz", np.array([25600.0]), 25600.0),
        ("fs_kHz", 25.6, 25600.0),
        ("dt", 1 / 25600.0, 25600.0),
        ("dt [ms]", "0,0390625", 25600.0),
        ("wf_increment", 1 / 25600.0, 25600.0),
        ("fs", "500 mm/s", None),
        ("sampling", "continuous", None),
        ("sampling rate [kHz]", "25,600", None),
    ],
)
def test_a_rate_in_its_unit(name, value, rate):
    found = statements([(name, value)], "a")
    assert found.sampling_Hz == (rate if rate is None else pytest.approx(rate, rel=1e-12))
    assert len(found.notes) == (rate is None)


@pytest.mark.parametrize(
    ("name", "value", "force"),
    [
        ("force_N", "16 kN", 16e3),
        ("force_kN", 16, 16e3),
        ("Axial force [kN]", "16,5", 16.5e3),
        ("force_N", "16,000", 16e3),
        ("force", "16000 N", 16e3),
        ("force", "16000", None),
    ],
)
def test_a_force_in_its_unit(name, value, force):
    assert statements([(name, value)], "a").facts.get("force_N") == force


@pytest.mark.parametrize("value", ["0", "nan", "-25600", "inf"])
def test_a_rate_that_is_none(value):
    with pytest.raises(ValueError, match=r"expected a positive sampling frequency, got fs .*\(a\)"):
        statements([("fs", value)], "a")


def test_units_at_several_places():
    assert one_unit({"here": None, "there": "-"}, "a") is None
    assert one_unit({"here": "mm/s", "there": "mm s^-1"}, "a") == "mm/s"
    with pytest.raises(ValueError, match=r"unit contradicts inside the file: 'm/s' here, 'V' the"):
        one_unit({"here": "m/s", "there": "V"}, "a")


@pytest.mark.parametrize(
    ("head", "factor"),
    [("time [S],velocity_m/s", 1.0), ("time_min,velocity_m/s", 60.0), ("Time (Sec),v_m/s", 1.0),
     ("t [milliseconds],v_m/s", 1e-3)],
)  # fmt: skip
def test_times_in_other_units(tmp_path, head, factor):
    path = csv(tmp_path / "a.csv", head, TIME / factor, WAVE)
    assert read(path).sampling_Hz == pytest.approx(RATE, rel=1e-7)
    with pytest.raises(ValueError, match=r"sampling_Hz contradicts: 25000 .* 25600 in the file"):
        read(path, sampling_Hz=25000.0)


def test_a_time_in_no_known_unit(tmp_path):
    told = r"expected times in s, ms, us, ns, min or h, got 'ticks' in 'time.*\)$"
    with pytest.raises(ValueError, match=told):
        read(csv(tmp_path / "a.csv", "time [ticks],v_m/s", TIME, WAVE), sampling_Hz=25000.0)
    with pytest.raises(ValueError, match=told):
        read(netcdf(tmp_path / "a.nc", time="ticks"), sampling_Hz=25000.0)
    warm = csv(tmp_path / "b.csv", "t [°C],v_m/s", 20.0 + TIME, WAVE)
    assert read(warm, sampling_Hz=RATE).sampling_Hz == RATE


@pytest.mark.parametrize(
    ("write", "told"),
    [
        (lambda at: csv(at / "a.csv", "fs: 51200\ntime_s,v_m/s", TIME, WAVE), "51200 Hz, its tim"),
        (lambda at: csv(at / "a.csv", "time_s,t_ms,v_m/s", TIME, TIME, WAVE), "span of the times"),
        (lambda at: csv(at / "a.csv", "# unit: mm/s\ntime_s,velocity_m/s", TIME, WAVE),
         "unit contradicts inside the file: 'm/s' in the column, 'mm/s' above the table"),
        (lambda at: matlab(at / "a.mat", v=WAVE, unit="m/s", fs=RATE, dt=1 / 51200),
         "sampling_Hz contradicts inside the file: 25600 from fs 25600.0, 51200 from dt 1.95"),
        (lambda at: matlab(at / "a.mat", v=WAVE, unit="m/s", fs=RATE, sampling_rate=51200.0),
         "sampling_Hz contradicts inside the file"),
        (lambda at: matlab(at / "a.mat", v=WAVE, unit="m/s", t=TIME, dt=1 / 51200), "51200 Hz,"),
        (lambda at: tdms(at / "a.tdms", 2.0 * TIME, wf_increment=1 / RATE), "25600 Hz, its times"),
        (lambda at: netcdf(at / "a.nc", sampling_Hz=RATE, dt=1 / 51200.0), "contradicts inside"),
        (lambda at: netcdf(at / "a.nc", force_N="16 kN"), "force_N contradicts: 12000 .* 16000 in"),
        (lambda at: netcdf(at / "a.nc", force_kN=16.0), "force_N contradicts: 12000 .* 16000 in"),
        (lambda at: netcdf(at / "a.nc", force_N=12000, force_kN=16.0), "contradicts inside the"),
    ],
)  # fmt: skip
def test_contradictions_inside_a_file(tmp_path, write, told):
    with pytest.raises(ValueError, match=told) as caught:
        read(write(tmp_path), force_N=12000.0)
    assert "\n" not in str(caught.value)


def test_the_mode_of_the_instrument_is_no_mode_of_the_blade(tmp_path):
    path = tdms(tmp_path / "a.tdms", wf_increment=1 / RATE, root={"mode": "continuous"})
    assert "'continuous' is no name like 1B" in read(path, mode="1B").notes[0]
    path = tdms(tmp_path / "b.tdms", wf_increment=1 / RATE, root={"mode": "2B"})
    with pytest.raises(ValueError, match=r"mode contradicts: 1B in .*, 2B in the file"):
        read(path, mode="1B")


def test_of_a_list_of_units_the_one_of_motion_is_taken(tmp_path):
    path = matlab(tmp_path / "a.mat", v=WAVE, fs=RATE, unit=["s", "mm/s"])
    np.testing.assert_allclose(read(path).samples, 1e-3 * WAVE)
    path = matlab(tmp_path / "b.mat", v=WAVE, fs=RATE, unit=["m/s", "mm/s"])
    with pytest.raises(ValueError, match=r"expected a unit .*got 'm/s; mm/s'"):
        read(path)
    found = read(path, unit="mm/s")
    np.testing.assert_allclose(found.samples, 1e-3 * WAVE)
    assert "unit 'm/s; mm/s' is not known; mm/s as stated is taken" in found.notes[0]


def test_netcdf_without_a_unit_is_the_sheets_to_decide(tmp_path):
    path = netcdf(tmp_path / "a.nc", units=None)
    with pytest.raises(ValueError, match="expected a unit, got none from the file"):
        read(path)
    np.testing.assert_allclose(read(path, unit="mm/s").samples, 1e-3 * WAVE)


def test_netcdf_groups(tmp_path):
    path = netcdf(tmp_path / "a.nc", group="run")
    assert read(path).sampling_Hz == pytest.approx(RATE, rel=1e-9)
    path = netcdf(tmp_path / "b.nc", group="run", time=None, sampling_Hz=RATE)
    found = read(path, channel="velocity")
    np.testing.assert_allclose(found.samples, WAVE)
    assert found.sampling_Hz == RATE


@pytest.mark.parametrize(
    "head",
    ["fs: 25.6 kHz", "Sampling rate: 25,600", "sampling rate [kHz]: 25.6", "dt;0,0390625;ms"],
)
def test_rates_above_a_table(tmp_path, head):
    found = read(csv(tmp_path / "a.csv", f"{head}\nvelocity_m/s", WAVE))
    assert found.sampling_Hz == pytest.approx(RATE, rel=1e-12)


@pytest.mark.parametrize(
    "word", ["unit: mm/s", "Units: mm/s", "Einheit;mm/s", "Y Unit: mm/s", "Y_Unit_Label\tmm/s\t"]
)
def test_a_unit_above_the_table(tmp_path, word):
    path = csv(tmp_path / "a.csv", f"{word}\ntime_s,laser", TIME, WAVE)
    np.testing.assert_allclose(read(path).samples, 1e-3 * WAVE, atol=1e-12)
    with pytest.raises(ValueError, match=r"unit contradicts: 'm/s' stated, 'mm/s' in the file"):
        read(path, unit="m/s")
    path = csv(tmp_path / "b.csv", f"{word}\ntime_s,velocity_m/s", TIME, WAVE)
    with pytest.raises(ValueError, match=r"'m/s' in the column, 'mm/s' above the table \("):
        read(path)
    path = csv(tmp_path / "c.csv", "Units: SI\ntime_s,velocity_m/s", TIME, WAVE)
    np.testing.assert_allclose(read(path).samples, WAVE, atol=1e-12)


def test_units_below_the_names(tmp_path):
    head = "Time,Velocity,Force\ns,mm/s,kN"
    found = read(csv(tmp_path / "a.csv", head, TIME, WAVE, 12.0 + 0.0 * TIME))
    np.testing.assert_allclose(found.samples, 1e-3 * WAVE, atol=1e-12)
    assert found.sampling_Hz == pytest.approx(RATE, rel=1e-7)


@pytest.mark.parametrize("value", [25.6, "51,2", "12.8"])
def test_a_rate_that_may_be_in_kilohertz_needs_its_unit(tmp_path, value):
    found = statements([("fs", value)], "a")
    assert found.sampling_Hz is None
    assert "may be in Hz or in kHz" in found.notes[0]
    assert statements([("fs", f"{value} Hz")], "a").sampling_Hz < 60.0
    with pytest.raises(ValueError, match=r"expected a sampling frequency; fs .* kHz .*a\.mat"):
        read(matlab(tmp_path / "a.mat", v=WAVE, unit="m/s", fs=value))
    sure = read(matlab(tmp_path / "a.mat", v=WAVE, unit="m/s", fs=value), sampling_Hz=RATE)
    assert sure.sampling_Hz == RATE


@pytest.mark.parametrize("step", [3.9e-5, 3.91e-5, "0.0000391", 3.90625e-5])
def test_a_step_of_few_digits_agrees_with_the_rate(tmp_path, step):
    for order in ({"fs": RATE, "dt": step}, {"dt": step, "fs": RATE}):
        assert read(matlab(tmp_path / "a.mat", v=WAVE, unit="m/s", **order)).sampling_Hz == RATE
    alone = matlab(tmp_path / "b.mat", v=WAVE, unit="m/s", dt=step)
    assert read(alone, sampling_Hz=RATE).sampling_Hz == RATE
    timed = matlab(tmp_path / "c.mat", v=WAVE, unit="m/s", dt=step, t=TIME)
    assert read(timed).sampling_Hz == RATE


@pytest.mark.parametrize(
    ("head", "taken", "low", "high", "true"),
    [
        ("delta t\t0.000039", "25641.0256", "25316.5", "25974", 25600.0),
        ("dt: 39 us", "25641.0256", "25316.5", "25974", 25600.0),
        ("dt: 0.039 ms", "25641.0256", "25316.5", "25974", 25600.0),
        ("dt: 0.00002", "50000", "40000", "66666.7", 51200.0),
        ("dt: 0.0000195", "51282.0513", "51150.9", "51413.9", 51200.0),
        ("fs: 51 kHz", "51000", "50504.9", "51505", 51200.0),
    ],
)
def test_a_rounded_step_is_told_and_the_sheet_settles_it(tmp_path, head, taken, low, high, true):
    path = csv(tmp_path / "a.csv", f"{head}\nvelocity_m/s", WAVE)
    (note,) = read(path).notes
    assert f"open between {low} and {high} Hz, {taken} Hz is taken; sampling_Hz settles" in note
    found = read(path, sampling_Hz=true)
    assert found.sampling_Hz == true
    assert found.notes == (f"sampling_Hz {true:g} as stated is taken, not {taken} Hz",)
    with pytest.raises(ValueError, match=f"sampling_Hz contradicts: 12800 stated, {taken} in the"):
        read(path, sampling_Hz=12800.0)
    # times tell more than digits
    timed = csv(tmp_path / "b.csv", f"{head}\ntime_s,v_m/s", TIME * RATE / true, WAVE)
    assert read(timed).sampling_Hz == true
    assert read(timed).notes == ()


@pytest.mark.parametrize(
    "head", ["fs: 50 kHz", "fs: 25.6 kHz", "fs: 22.05 kHz", "fs: 5120", "dt: 0.0000390625"]
)
def test_a_round_rate_of_few_digits_is_meant_as_it_stands(tmp_path, head):
    path = csv(tmp_path / "a.csv", f"{head}\nvelocity_m/s", WAVE)
    found = read(path)
    assert found.notes == ()
    with pytest.raises(ValueError, match="sampling_Hz contradicts"):
        read(path, sampling_Hz=found.sampling_Hz * 1.001)


@pytest.mark.parametrize(("step", "rate"), [(2e-5, 50000.0), (1e-4, 10000.0), (3.2e-5, 31250.0)])
def test_a_number_is_exact_where_its_frequency_is_round(tmp_path, step, rate):
    path = tdms(tmp_path / "a.tdms", wf_increment=step)
    assert read(path).sampling_Hz == pytest.approx(rate, rel=1e-12)
    assert read(path).notes == ()
    other = 1.01 * rate
    with pytest.raises(ValueError, match=f"sampling_Hz contradicts: {other:g} .* {rate:g} in the"):
        read(path, sampling_Hz=other)
    path = tdms(tmp_path / "b.tdms", np.arange(TIME.size) / other, wf_increment=step)
    with pytest.raises(ValueError, match=f"the file says {rate:g} Hz, its times {other:g}"):
        read(path)


def test_a_number_of_few_digits_and_an_odd_frequency_is_a_rounded_step(tmp_path):
    path = matlab(tmp_path / "a.mat", v=WAVE, unit="m/s", dt=3.9e-5)
    assert "open between 25316.5 and 25974 Hz" in read(path).notes[0]
    assert read(path, sampling_Hz=RATE).sampling_Hz == RATE


def test_two_rounded_statements_agree_as_far_as_both_tell(tmp_path):
    path = csv(tmp_path / "a.csv", "dt: 39 us\nfs: 26.0 kHz\nvelocity_m/s", WAVE)
    assert read(path).sampling_Hz == 26000.0
    path = csv(tmp_path / "b.csv", "dt: 39 us\nfs: 26.1 kHz\nvelocity_m/s", WAVE)
    with pytest.raises(ValueError, match="sampling_Hz contradicts inside the file: 26100 from fs"):
        read(path)


def test_a_step_of_many_digits_must_agree(tmp_path):
    path = matlab(tmp_path / "a.mat", v=WAVE, unit="m/s", fs=RATE, dt=3.915e-5)
    with pytest.raises(ValueError, match="sampling_Hz contradicts inside the file: 25600 from fs"):
        read(path)
