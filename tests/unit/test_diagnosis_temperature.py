"""Frequencies that follow a thermometer, and a drift that comes and goes beside one."""

from functools import cache

import numpy as np
import pytest
from bladeroot.diagnosis.diagnose import Diagnosis, Settings, diagnose
from bladeroot.diagnosis.next_measurement import next_measurements
from bladeroot.diagnosis.thermometer import course
from bladeroot.diagnosis.verdict import verdict
from bladeroot.mechanisms.catalogue import catalogue
from diagnosis_bench import campaign, programme, simulated
from stiffness_beam import _model

RIVALS = [one for one in catalogue() if one.id in ("drift", "temperature")]


@cache
def diagnosed(follows: str, thermometer: bool = True) -> Diagnosis:
    """A campaign whose frequencies follow the weather, or a wave of their own, by 1e-4 a kelvin."""
    seen = campaign(_model(False), seed=3, scatter=0.01, rows=programme(2, 1), curves=False)
    part = seen["time"].values / seen["time"].values.max()
    weather = 3.0 * np.sin(2.0 * np.pi * 2.3 * part + 1.0) + 4.0 * part**2
    wave = 4.0 * np.sin(2.0 * np.pi * 1.6 * part)
    warm = weather if follows == "weather" else wave
    seen["stick_frequency"] = seen["stick_frequency"] * np.exp(-6e-4 * warm)
    if thermometer:
        read = 20.0 + weather + 0.1 * np.random.default_rng(0).normal(size=part.size)
        seen["temperature"] = ("record", read)
    return diagnose(seen, simulated(seen, _model(False)), Settings(), RIVALS)


def judged(follows: str, thermometer: bool = True) -> dict:
    return verdict(diagnosed(follows, thermometer))


def test_further_records_are_proposed_where_a_temperature_is_known():
    options = next_measurements(diagnosed("weather"))
    assert options.sizes["option"] > 2
    assert np.all(options["size_std"].values <= 1.0)


@pytest.mark.slow
@pytest.mark.parametrize(("follows", "name"), [("weather", "temperature"), ("wave", "drift")])
def test_the_thermometer_decides_between_temperature_and_drift(follows, name):
    (cause,) = judged(follows)["causes"]
    assert cause["mechanism"] == name
    assert cause["credible_set"] == [name]


@pytest.mark.slow
def test_without_a_thermometer_the_weather_is_something_over_time():
    """A wave and a rise, which no form of a drift has: a drift, or smooth in time."""
    said = judged("weather", thermometer=False)
    assert set(said["possible"]) == {"drift", "none-of-these"}
    assert "in time" in said["reason"]


def test_slope_and_gain_are_those_of_the_temperature():
    said = judged("weather")
    slope, _ = said["causes"][0]["parameters"]
    assert abs(slope["value"] + 6e-4) < 4.0 * slope["std"]
    sides = said["gain"]["between_temperatures"]
    assert sides["after"] < 0.5 * sides["before"]


@pytest.mark.slow
@pytest.mark.parametrize("seed", [102, 103, 106])
def test_a_thermometer_coarser_than_the_frequencies_makes_no_drift(seed):
    """A tenth of a kelvin is a hundred times what the frequencies tell of a change."""
    seen = campaign(_model(False), seed=seed, scatter=0.01, rows=programme(2, 1), curves=False)
    part = seen["time"].values / seen["time"].values.max()
    rng = np.random.default_rng(seed - 100)
    wave = rng.uniform(1.0, 4.0) * np.sin(2.0 * np.pi * rng.uniform(0.3, 2.5) * part + seed)
    weather = wave + rng.uniform(-4.0, 4.0) * part**2
    seen["stick_frequency"] = seen["stick_frequency"] * np.exp(-6e-4 * weather)
    seen["temperature"] = ("record", 20.0 + weather + 0.1 * rng.normal(size=part.size))
    said = verdict(diagnose(seen, simulated(seen, _model(False)), Settings(), RIVALS))
    assert [one["mechanism"] for one in said["causes"]] == ["temperature"]


def test_a_course_is_nearer_to_the_temperature_than_its_readings():
    time = np.repeat(np.sort(np.random.default_rng(1).uniform(0.0, 36000.0, 60)), 3)
    true = 4.0 * np.sin(time / 9000.0) + 1e-4 * time
    off = np.repeat(0.1 * np.random.default_rng(2).normal(size=60), 3)
    kelvin, covariance = course(time, 20.0 + true + off)
    miss = kelvin - (true - true.mean())
    assert miss.std() < 0.7 * off.std()
    assert np.sqrt(np.mean(miss**2 / np.diag(covariance))) < 2.0
    assert np.all(kelvin[::3] == kelvin[2::3])


@pytest.mark.parametrize("count", [1, 2, 5])
def test_a_course_of_few_readings_is_finite(count):
    kelvin, covariance = course(np.arange(count) * 600.0, 20.0 + np.arange(count))
    assert np.isfinite(kelvin).all()
    assert np.linalg.eigvalsh(covariance).min() > -1e-9
