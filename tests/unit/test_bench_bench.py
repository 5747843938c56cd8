"""Whole records of the virtual test bench on a small beam in two slots."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr
import yaml
from bladeroot.bench.bench import move, simulate
from bladeroot.bench.chance import generator
from bladeroot.bench.clamping import clamp
from bladeroot.bench.conditions import true_force
from bladeroot.bench.joint import parts
from bladeroot.bench.sensor import read_velocity
from bladeroot.bench.stepping import Drive
from bladeroot.bench.tip import Course, tip_force
from bladeroot.schema import check
from programme import programme
from rig_toy import ROW, toy_bench, toy_reduced

RESOURCES = Path(__file__).parents[2] / "resources"


@pytest.fixture(scope="module")
def reduced():
    return parts(toy_reduced())


@pytest.fixture(scope="module")
def record(reduced):
    return simulate(toy_bench(), reduced, ROW)


def test_a_record_repeats_bit_for_bit(reduced, record):
    raw, truth = simulate(toy_bench(), reduced, dict(ROW))
    xr.testing.assert_identical(raw, record[0])
    xr.testing.assert_identical(truth, record[1])


def test_a_record_does_not_depend_on_the_programme(reduced, record):
    bench = toy_bench(programme={"pressure_bar": [1], "record_interval_s": 1})
    xr.testing.assert_identical(simulate(bench, reduced, ROW)[0], record[0])


def test_two_records_of_a_hold_share_the_clamping_but_not_the_noise(reduced, record):
    raw, truth = simulate(toy_bench(), reduced, {**ROW, "record": "r002"})
    assert float(truth.kt) == float(record[1].kt)
    assert float(truth.frequency) == float(record[1].frequency)
    difference = (raw.velocity - record[0].velocity).values
    assert 8e-6 < difference.std() < 2e-5


def test_holds_and_seeds_scatter(reduced, record):
    other_hold = clamp(toy_bench(), reduced, {**ROW, "hold": "h02"})
    other_seed = clamp(toy_bench(seed=8), reduced, ROW)
    for other in (other_hold, other_seed):
        assert 0 < abs(np.log(other.conditions.kt / float(record[1].kt))) < 0.3
        assert other.conditions.force != float(record[1].force)


def test_the_same_hold_serves_both_modes(reduced):
    first = clamp(toy_bench(), reduced, ROW)
    second = clamp(toy_bench(), reduced, {**ROW, "mode": "2B"})
    assert (first.conditions.kn, first.conditions.kt, first.conditions.force) == (
        second.conditions.kn,
        second.conditions.kt,
        second.conditions.force,
    )
    assert second.frequency > 2 * first.frequency


def test_force_behind_a_reading():
    bench = toy_bench()
    by_pressure = true_force(bench, {"pressure_bar": 20}, 0.0)
    assert by_pressure == pytest.approx(1.006 * 20 * 179)
    assert true_force(bench, {"force_N": 3580.0}, 0.0) == pytest.approx(by_pressure)
    assert true_force(bench, {"pressure_bar": 20}, 0.5) == pytest.approx(1.006 * 20.5 * 179)
    with pytest.raises(ValueError, match="must be positive"):
        true_force(bench, {"pressure_bar": 0}, -0.5)


def test_a_mode_that_is_not_kept_is_refused(reduced):
    bench = toy_bench(specimen={"modes": 1})
    with pytest.raises(ValueError, match="mode 2B is not among"):
        clamp(bench, reduced, {**ROW, "mode": "2B"})


def test_course_of_a_record(record):
    """Quiet, driven, then a free decay to a thousandth, then the tip comes back."""
    raw, truth = record
    time, v = raw.time.values, np.abs(raw.velocity.values)
    release = float(truth.release_time)
    rate = float(truth.loss_factor) * np.pi * float(truth.frequency)
    back = release + 8 / rate
    start = v[(time > release) & (time < release + 0.004)].max()
    assert v[time < 0.009].max() < 1e-2 * start
    assert v[(time > back - 0.02) & (time < back - 0.001)].max() < 1e-3 * start + 5e-5
    assert v[time > back].max() > 10 * v[(time > back - 0.02) & (time < back)].max()


def test_every_record_slips_only_above_its_onset(reduced):
    """The onset is the linear estimate: no friction work below it, some above."""
    bench = toy_bench()
    clamping = clamp(bench, reduced, ROW)
    quiet, release = move(bench, clamping, 0.05)
    loud, _ = move(bench, clamping, 10.0)
    at = round(release * 51200)
    assert quiet.amplitude[:at].max() < 0.5 * clamping.onset
    assert loud.amplitude[at] > 1.5 * clamping.onset
    assert loud.work_friction > 0.01 * loud.work_in
    assert loud.overshoot < 1e-6
    for motion in (quiet, loud):
        assert motion.energy_error < 1e-3


def test_without_slip_the_decay_has_the_stuck_frequency(reduced):
    """One mode kept and no slip: what remains of the decay is one damped sine, to a millionth."""
    bench = toy_bench(specimen={"modes": 1}, friction={"coefficient": 1e6})
    clamping = clamp(bench, reduced, ROW)
    motion, release = move(bench, clamping, 10.0)
    assert motion.work_friction == 0
    tail = motion.velocity[round(release * 51200) + 1 :][:3000]
    a, b = np.linalg.lstsq(np.column_stack([tail[1:-1], -tail[:-2]]), tail[2:], rcond=None)[0]
    root = np.log(complex(a / 2, np.sqrt(b - (a / 2) ** 2))) * 51200
    complex_stiffness = -(root**2)
    frequency = np.sqrt(complex_stiffness.real) / (2 * np.pi)
    loss_factor = abs(complex_stiffness.imag) / complex_stiffness.real
    assert frequency == pytest.approx(clamping.frequency, rel=1e-7)
    assert loss_factor == pytest.approx(clamping.loss_factor[0], rel=1e-6)


def test_the_residual_stands_for_the_modes_left_out(reduced):
    """Ten modes and the residual slip like fifty modes do."""

    def work(modes):
        bench = toy_bench(specimen={"modes": modes}, damping={"reclamping_scatter": 0})
        return move(bench, clamp(bench, reduced, ROW), 10.0)[0].work_friction

    assert work(10) == pytest.approx(work(50), rel=0.01)


def test_raw_file_is_sixteen_bits_and_loses_nothing(record, tmp_path):
    raw, _ = record
    raw.to_netcdf(tmp_path / "r001.nc")
    stored = xr.load_dataset(tmp_path / "r001.nc", mask_and_scale=False)
    assert stored.velocity.dtype == np.int16
    read = xr.load_dataset(tmp_path / "r001.nc")
    np.testing.assert_allclose(read.velocity, raw.velocity, atol=1e-9)
    np.testing.assert_allclose(read.time, raw.time, rtol=1e-6, atol=1e-12)
    assert "SIMULATED" in read.attrs["title"]


def test_sensor_noise_steps_and_range():
    chance = np.random.default_rng(1)
    seen, step = read_velocity(np.zeros(200_000), 51200.0, 1e-5, 0.0, 0.1, 0.1, chance)
    assert seen.std() == pytest.approx(1e-5, rel=0.02)
    np.testing.assert_allclose(seen / step, np.round(seen / step), atol=1e-6)
    loud, _ = read_velocity(np.linspace(-1, 1, 100), 51200.0, 0.0, 0.0, 0.1, 0.1, chance)
    assert loud.max() == pytest.approx(0.1)
    assert loud.min() == pytest.approx(-0.1)
    slow, _ = read_velocity(np.zeros(51200 * 20), 51200.0, 0.0, 1e-3, 0.1, 0.1, chance)
    assert slow.max() == pytest.approx(1e-3, rel=0.02)


def test_the_tip_lets_go_at_one_instant():
    course = Course(quiet=0.01, push=0.02, drive=0.05, decay=0.1, back=0.03)
    drive, release = tip_force(course, 5.0, 2.0, 3.0, 0, 1e-5)
    assert isinstance(drive, Drive)
    assert release == 8000
    assert (drive.push[release - 1], drive.push[release]) == (5.0, 0.0)
    assert drive.sine[release - 1] == 2.0
    assert not drive.push[release : release + 10_000].any()
    assert not drive.sine[release:].any()
    assert drive.push[-1] == 5.0
    with pytest.raises(ValueError, match="preload above its sine"):
        tip_force(course, 1.0, 2.0, 3.0, 0, 1e-5)


def test_random_numbers_belong_to_names():
    draw = generator(7, "hold", "h01").standard_normal(4)
    np.testing.assert_array_equal(draw, generator(7, "hold", "h01").standard_normal(4))
    for other in ((7, "hold", "h02"), (7, "record", "h01"), (8, "hold", "h01"), (7, "holdh01")):
        assert not np.array_equal(draw, generator(*other).standard_normal(4))
    # The same on every machine and in every process.
    assert generator(7, "hold", "h01").integers(10**9) == 542142378


def test_programme_goes_up_then_down_with_both_modes_in_a_hold():
    sheet = programme(toy_bench())
    assert list(sheet["pressure_bar"].drop_duplicates()) == [10, 134]
    assert list(sheet.groupby("hold")["direction"].first()) == ["up", "up", "down", "down"]
    assert (sheet.groupby("hold")["mode"].nunique() == 2).all()
    assert sheet["record"].is_unique
    assert sheet["time_s"].is_monotonic_increasing
    low = sheet[(sheet["pressure_bar"] == 10) & (sheet["mode"] == "1B")]
    assert list(low["drive_A"]) == [2.2, 3.1] * 2


def test_the_shipped_campaign_is_the_programme_of_the_shipped_bench():
    path = RESOURCES / "bench" / "rig.yaml"
    bench = yaml.safe_load(path.read_text())
    check(bench, "bench", str(path))
    shipped = pd.read_csv(RESOURCES / "campaigns" / "rig" / "records.csv")
    pd.testing.assert_frame_equal(shipped, programme(bench))


def test_the_schema_names_a_wrong_key():
    with pytest.raises(ValueError, match="friction"):
        check(toy_bench(friction={"edge": 0.1}), "bench", "here")
