"""The benchmark that changes one's own records tells what hangs on the change, and nothing else."""

import numpy as np
import pytest
from decay_bench import ring_down
from same_again import CHANGES, compared, curves, records, tried

SHEET = "record,file,mode\nr1,r1.csv,a\n"
TEXT = "title: one record\nmodes:\n  a: {expected_Hz: 233.0}\n"


@pytest.fixture(scope="module")
def campaign(tmp_path_factory):
    folder = tmp_path_factory.mktemp("own")
    velocity = ring_down(noise_db=60.0, bits=16)[0][::8]
    time = np.arange(velocity.size) * 8.6 / 25600.0  # so that no multiple of the mains is the mode
    rows = "\n".join(f"{t:.9g},{v:.9g}" for t, v in zip(time, velocity, strict=True))
    (folder / "r1.csv").write_text(f"time (s),velocity (m/s)\n{rows}\n")
    (folder / "records.csv").write_text(SHEET)
    (folder / "campaign.yaml").write_text(TEXT)
    return folder


def test_a_clean_record_gives_its_curve_again(campaign):
    rows = tried([campaign], list(CHANGES))
    assert {row.curves for row in rows.values()} == {1}
    assert not any(row.lost for row in rows.values())
    assert not [off for row in rows.values() for off in row.off if off[1] > 0.03]


def test_a_curve_that_moved_is_told(campaign):
    ((_, recording, known),) = records(campaign)
    before = curves(recording, known)
    assert compared(before, before) == (0.0, 0.0)
    half = before.sizes["point"] // 2
    moved = before["frequency"].copy()
    moved[:half] *= 1.0 + 1e-3
    share, worst = compared(before, before.assign(frequency=moved))
    assert share == pytest.approx(0.5, abs=0.15)
    assert worst > 3.0


def test_what_is_lost_is_told(campaign, monkeypatch):
    monkeypatch.setitem(CHANGES, "noise alone", lambda x, rate, mode_Hz, rng: (
        rng.standard_normal(x.size), rate
    ))  # fmt: skip
    rows = tried([campaign], ["noise alone"])
    assert rows["noise alone"].lost
