"""Of thousands of records a diagnosis fits some hundred, chosen by clamping and mode."""

from collections import Counter

import numpy as np
import pytest
from bladeroot.diagnosis.clampings import thinned
from bladeroot.diagnosis.stick_model import stick_data
from diagnosis_bench import campaign, programme
from stiffness_beam import _model


def sheet(clampings, repeats, loads=5):
    """Mode, clamping, level and time of records, the modes in turn, in another order than done."""
    at = np.arange(clampings * repeats * 2)
    mode = np.where(at % 2, "2B", "1B")
    hold = np.char.add("h", (at // (2 * repeats)).astype(str))
    level = np.array([(at // (2 * repeats) % loads).astype(str)])
    order = np.random.default_rng(3).permutation(at)
    return mode[order], hold[order], level[:, order], 60.0 * order


def test_few_records_are_all_fitted():
    mode, hold, level, time = sheet(10, 4)
    row = np.arange(0, 80, 2)
    assert thinned(row, mode, hold, level, time, 40) is row


def test_every_clamping_keeps_the_first_and_the_last_of_each_mode():
    mode, hold, level, time = sheet(20, 9)
    kept = thinned(np.arange(360), mode, hold, level, time, 160)
    assert kept.size == 160
    assert (np.diff(kept) > 0).all()
    parts = Counter(zip(mode[kept], hold[kept], strict=True))
    assert len(parts) == 40
    assert set(parts.values()) == {4}
    for one, clamping in parts:
        whole = time[(mode == one) & (hold == clamping)]
        some = time[kept][(mode[kept] == one) & (hold[kept] == clamping)]
        assert (some.min(), some.max()) == (whole.min(), whole.max())


def test_of_too_many_clampings_some_are_left_out_whole_and_evenly():
    mode, hold, level, time = sheet(500, 3)
    kept = thinned(np.arange(3000), mode, hold, level, time, 400)
    assert 300 < kept.size <= 400
    assert set(Counter(hold[kept]).values()) == {4}
    assert max(Counter(level[0][kept]).values()) <= 1.3 * min(Counter(level[0][kept]).values())
    for one in "01234":
        gaps = np.diff(np.sort(time[kept][level[0][kept] == one]))
        assert gaps.max() < 0.15 * np.ptp(time)


def test_records_without_times_are_thinned_in_the_order_of_the_sheet():
    mode, hold, level, time = sheet(30, 8)
    rng = np.random.default_rng(0)
    some = np.where(rng.random(time.size) < 0.5, np.nan, time)
    for clock in (some, np.full(time.size, np.nan)):
        kept = thinned(np.arange(480), mode, hold, level, clock, 120)
        assert kept.size == 120
        assert len(set(zip(mode[kept], hold[kept], strict=True))) == 60


def test_what_is_left_out_is_counted(monkeypatch):
    seen = campaign(_model(False), seed=1, rows=programme(cycles=1), curves=False)
    whole = stick_data(seen, ("1B", "2B"))
    monkeypatch.setattr("bladeroot.diagnosis.stick_model.MOST_RECORDS", 28)
    data = stick_data(seen, ("1B", "2B"))
    assert whole.thinned == 0
    assert data.thinned == whole.ln_f.size - data.ln_f.size > 0
    assert data.ln_f == pytest.approx(whole.ln_f[np.isin(whole.row, data.row)])
