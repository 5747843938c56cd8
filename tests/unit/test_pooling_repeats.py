"""Which record is not like its repeats, and that clampings may scatter."""

import numpy as np
import pytest
import xarray as xr
from bladeroot.pooling.repeats import unlike_repeats

FORCES = (4e3, 8e3, 12e3, 16e3)
NO_CURVE = xr.Dataset({"frequency": ("point", np.zeros(0))})
WRONG = 25000 / 25600  # of two sampling rates


def plateau(frequency, force, hold, mode="2B"):
    made = {"stick_frequency": frequency, "verdict": "plateau"}
    return xr.Dataset(made, attrs={"mode": mode, "force_N": force, "hold": hold})


def campaign(clampings=2, records=2, scatter=1e-3, seed=1):
    """Plateaus of repeats that agree to some ppm in clampings that do not."""
    rng = np.random.default_rng(seed)
    return [
        plateau(1400.0 * (force / 12e3) ** 0.05 * np.exp(shift + 5e-6 * rng.standard_normal()),
                force, f"h{clamping}-{force}")
        for force in FORCES
        for clamping, shift in enumerate(scatter * rng.standard_normal(clampings))
        for _ in range(records)
    ]  # fmt: skip


def found(plateaus, decays=None):
    return unlike_repeats(decays or [NO_CURVE] * len(plateaus), plateaus)


def slow(plateaus, *wrong):
    for k in wrong:
        plateaus[k]["stick_frequency"] *= WRONG
    return plateaus


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("scatter", [1e-6, 1e-3])
def test_clampings_scatter_and_none_is_named(scatter, seed):
    assert found(campaign(3, scatter=scatter, seed=seed)) == []


@pytest.mark.parametrize("scatter", [1e-6, 1e-3, 4e-3])
def test_of_two_repeats_the_one_that_the_other_clamping_contradicts_is_named(scatter):
    ((record, apart, allowed),) = found(slow(campaign(scatter=scatter), 8))
    assert record == 8
    assert apart == pytest.approx(WRONG - 1, abs=2 * scatter + 1e-4)
    assert allowed == 0.01


def test_without_another_clamping_both_are_named():
    names = [record for record, _, _ in found(slow(campaign(1), 4))]
    assert names == [4, 5]


def test_a_whole_clamping_is_named_where_others_agree():
    plateaus = slow(campaign(3, scatter=5e-4), 12, 13)
    assert [record for record, _, _ in found(plateaus)] == [12, 13]


def test_records_without_a_hold_are_clampings_of_their_own():
    plateaus = slow(campaign(4, 1, 5e-4), 6)
    assert [record for record, _, _ in found(plateaus)] == [6]


def test_without_a_plateau_the_curves_are_compared():
    """Where they overlap: a softer start of one that reaches further is no fault."""
    plateaus, decays = [], []
    for k in range(4):
        amplitude = np.geomspace(1e-6, 1e-4 if k else 1e-5, 50)
        frequency = 500.0 * (1 - 2e-2 * np.log(amplitude / 1e-6))
        frequency *= WRONG if k == 2 else 1 + 1e-5 * k
        curve = {"amplitude": ("point", amplitude), "frequency": ("point", frequency)}
        decays.append(xr.Dataset(curve))
        plateaus.append(plateau(np.nan, 8e3, "h"))
    ((record, apart, _),) = found(plateaus, decays)
    assert record == 2
    assert apart == pytest.approx(WRONG - 1, abs=1e-4)
    plateaus[2]["verdict"] = xr.DataArray("rejected: it")
    assert found(plateaus, decays) == []


def test_modes_and_forces_are_not_compared():
    plateaus = [plateau(1400.0 + 100 * k, 4e3 + 1e3 * k, "h") for k in range(4)]
    assert found([*plateaus, plateau(500.0, 4e3, "h", "1B")]) == []
