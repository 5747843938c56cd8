"""The laboratory of the guards: effects are drawn apart from benches, the score counts right."""

import numpy as np
import pandas as pd
import pytest
from bladeroot.bench.joint import parts
from cases import draw_bench, draw_case, draw_sheet
from fast import LADDER
from lab import Laboratory
from rig_toy import toy_reduced
from score import score


@pytest.fixture(scope="module")
def lab(tmp_path_factory):
    path = tmp_path_factory.mktemp("lab") / "reduced.nc"
    toy_reduced().to_netcdf(path)
    return Laboratory(path)


def small_sheet(seed):
    return draw_sheet(seed, pressures=(20, 67), cycles=1)


def cause(mechanism, kind, *others, value=1.0, std=0.1):
    return {
        "mechanism": mechanism,
        "class": kind,
        "credible_set": [mechanism, *others],
        "parameters": {"size": {"value": value, "std": std}},
    }


def verdict(answer, *causes):
    return {"answer": answer, "causes": list(causes)}


def test_a_sheet_is_what_the_issue_asks_for():
    sheet = draw_sheet(1)
    assert len(sheet) == 112
    assert sheet["pressure_bar"].nunique() == 7
    assert (sheet.groupby(["hold", "mode"]).size() == 2).all()
    assert sheet.groupby("hold").ngroups == 28
    assert list(sheet.groupby("hold")["direction"].first().iloc[[0, 7, 14, 21]]) == [
        "up",
        "down",
        "up",
        "down",
    ]


def test_a_seed_and_the_effect_are_drawn_apart():
    """The same entropy with another effect has the same bench and the same sheet."""
    one, two = draw_case(5, ("drift",)), draw_case(5, ())
    assert one.seed == two.seed
    assert draw_bench(one.seed) == draw_bench(two.seed)
    pd.testing.assert_frame_equal(draw_sheet(one.seed), draw_sheet(two.seed))
    assert draw_case(6, ()).seed != one.seed


def test_observations_of_a_null_scatter_as_they_say(lab):
    case = draw_case(8, ())
    seen = lab.fast(case, small_sheet(case.seed))
    for name in ("frequency", "loss_factor"):
        mean = seen[f"stick_{name}"]
        error = (seen[name] - mean) / seen[f"{name}_std"]
        assert 0.5 < float(np.sqrt((error**2).mean())) < 3
    assert set(seen["mode"].values) == {"1B", "2B"}
    assert seen.sizes["amplitude"] == LADDER.size
    assert (seen["plateau_reached"] == 1).all()
    assert (seen["findings"] == "").all()


def test_paired_cases_differ_by_the_effect_alone(lab):
    null, drag = draw_case(8, ()), draw_case(8, ("quadratic-drag",), 1.0)
    sheet = small_sheet(null.seed)
    before, after = lab.fast(null, sheet), lab.fast(drag, sheet)
    rise = (after["loss_factor"] - before["loss_factor"]) / (50 * before["amplitude"])
    # At high amplitude the errors are small and the same draws stand in both.
    top = rise.where(before["mode"] == "1B").sel(amplitude=slice(2e-6, 5e-6))
    assert float(top.mean()) == pytest.approx(1, abs=0.1)
    same = before["stick_frequency"] / after["stick_frequency"] - 1
    assert float(np.abs(same).max()) < 5e-6


def test_a_name_a_class_and_a_wrong_name_are_told_apart():
    answer = {"effects": [["drift", 0.004]]}
    right = score(answer, verdict("named", cause("drift", "time", value=0.0045)))
    assert (right.named, right.classed, right.wrong, right.parameter) == (1, 1, False, 1)
    off = score(answer, verdict("named", cause("drift", "time", value=0.01, std=1e-4)))
    assert off.parameter == 0
    family = score(answer, verdict("ambiguous", cause("force-relaxation", "time", "drift")))
    assert (family.named, family.classed, family.wrong) == (0, 1, False)
    assert family.column == "class:time"
    sibling = score(answer, verdict("named", cause("force-relaxation", "time")))
    assert (sibling.named, sibling.wrong) == (0, True)
    for silent in ("nothing-missing", "unexplained", "insufficient-data"):
        none = score(answer, verdict(silent))
        assert (none.column, none.named, none.wrong) == (silent, 0, False)
    invented = score({"effects": []}, verdict("named", cause("drift", "time")))
    assert invented.wrong
    pair = {"effects": [["drift", 0.004], ["joint-slip", 0.002]]}
    both = verdict("named", cause("joint-slip", "amplitude"), cause("drift", "time", value=0.004))
    assert score(pair, both).named == 2
    one = score(pair, verdict("named", cause("added-mass", "level"), cause("drift", "time")))
    assert (one.named, one.wrong) == (1, True)


def test_the_specimen_is_the_bench_s_own(lab):
    assert lab.whole.mass.shape == parts(toy_reduced()).mass.shape
    assert lab.few.mass.shape[0] < lab.whole.mass.shape[0]
