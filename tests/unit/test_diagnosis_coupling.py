"""What the other modes of one motion may do to a curve is an error of it."""

import numpy as np
import pytest
import xarray as xr
from bladeroot.diagnosis.observations import coupling

# no rung lies at an end of a curve
LADDER = np.geomspace(1.1e-8, 0.9e-4, 57)


def decay(rate, largest, law, start=0.0):
    time = np.linspace(0.0, 4.0, 200)
    amplitude = largest * np.exp(-rate * time)
    change = law(amplitude)
    return xr.Dataset(
        {
            "time": ("point", time),
            "amplitude": ("point", amplitude),
            "frequency": ("point", 100.0 * np.exp(change)),
            "loss_factor": ("point", 2e-3 + change),
        },
        attrs={"start_s": start},
    )


def rows(events=("a", "a"), sensors=("s", "s")):
    facts = {"event": list(events), "sensor": list(sensors), "mode": ["m1", "m2"]}
    return {name: np.array(values) for name, values in facts.items()}


def softening(amplitude):
    return -1e-3 * (amplitude / 1e-4) ** 2


def none(amplitude):
    return np.zeros_like(amplitude)


def test_a_small_mode_may_change_by_what_the_large_one_does_to_itself():
    pair = [decay(1.0, 1e-4, softening), decay(2.0, 1e-5, none)]
    made = coupling(pair, rows(), LADDER)["frequency_coupling"]
    assert not made[0].any()
    reached = (pair[1]["amplitude"].values.min() < LADDER) & (LADDER < 1e-5)
    # A1 = 1e-4 (A2 / 1e-5)^(1/2)
    large = 1e-4 * np.sqrt(LADDER[reached] / 1e-5)
    expected = 1e-3 * (large / 1e-4) ** 2 * large / (large + LADDER[reached])
    assert made[1, reached] == pytest.approx(expected, rel=0.02, abs=5e-6)
    assert not made[1, ~reached].any()


def test_loss_is_shared_as_frequency_is():
    made = coupling([decay(1.0, 1e-4, softening), decay(2.0, 1e-5, none)], rows(), LADDER)
    assert made["loss_factor_coupling"] == pytest.approx(made["frequency_coupling"], abs=1e-6)


@pytest.mark.parametrize(
    ("events", "sensors"), [(("", ""), "ss"), (("a", "b"), "ss"), ("aa", "st")]
)
def test_other_motions_and_other_places_are_not_counted(events, sensors):
    pair = [decay(1.0, 1e-4, softening), decay(2.0, 1e-5, none)]
    assert not coupling(pair, rows(events, sensors), LADDER)["frequency_coupling"].any()


def test_a_mode_that_has_died_does_nothing():
    early = decay(1.0, 1e-4, softening)
    late = decay(2.0, 1e-5, none, start=10.0)
    assert not coupling([early, late], rows(), LADDER)["frequency_coupling"].any()


def test_a_record_without_a_curve_has_none():
    assert not coupling([decay(1.0, 1e-4, softening), None], rows(), LADDER)[
        "frequency_coupling"
    ].any()
