"""The laboratory itself: nothing tells the effect, the seal holds, the score counts right."""

import json

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from bladeroot.bench.joint import parts
from cases import catalogue, draw_bench, draw_case, draw_sheet, outsiders
from fast import LADDER
from findings import seen_in
from lab import Laboratory
from matrix import planned, planned_power
from rig_toy import toy_reduced
from score import left_over, score, share
from seal import open_seal, seal
from tables import matrix_page
from tuning import conditions_of, effect

GAIN = {
    "gain": {
        "between_forces": {"before": 2e-3, "after": 1.5e-3},
        "between_forces_without_bias": {"before": 1e-2, "after": 1e-3},
        "within_records": {"loss_factor": {"before": 1e-3, "after": 1e-4}},
    }
}


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


def test_sizes_lie_between_the_bound_and_five_times_it():
    for name in (*catalogue(), *outsiders()):
        drawn = np.array([draw_case(k, (name,)).effects[0][1] for k in range(40)])
        relative = np.abs(drawn) / effect(name).BOUND
        assert relative.min() >= 1
        assert relative.max() <= 5
        assert relative.max() > 2 * relative.min()
        assert (drawn < 0).any() == effect(name).SIGNED


def test_a_seal_holds(tmp_path):
    answer = draw_case(5, ("drift",)).answer()
    shown = seal(answer, tmp_path / "here")
    assert shown != seal(answer, tmp_path / "there")  # the salt: equal answers look different
    assert open_seal(tmp_path / "here", shown)["effects"][0][0] == "drift"
    sealed = json.loads((tmp_path / "here" / "answer.json").read_text())
    sealed["answer"]["effects"] = []
    (tmp_path / "here" / "answer.json").write_text(json.dumps(sealed))
    with pytest.raises(ValueError, match="not the one"):
        open_seal(tmp_path / "here", shown)


def test_files_are_alike_whatever_is_hidden(lab, tmp_path):
    """Names, sizes, times and sheet are the same with and without an effect; samples differ."""
    folders = []
    for names in ((), ("clipping", "joint-slip")):
        case = draw_case(5, names, 2.0)
        folders.append(tmp_path / ("-".join(names) or "nothing"))
        lab.raw(case, folders[-1], small_sheet(case.seed).iloc[:2])
    clean, *others = folders
    for other in others:
        assert [p.name for p in sorted(clean.iterdir())] == [
            p.name for p in sorted(other.iterdir())
        ]
        changed = 0
        for path in sorted(clean.iterdir()):
            same = other / path.name
            assert path.stat().st_size == same.stat().st_size
            assert path.stat().st_mtime == same.stat().st_mtime
            if path.suffix == ".nc":
                one, two = xr.load_dataset(path), xr.load_dataset(same)
                assert one.sizes == two.sizes
                assert one.attrs == two.attrs
                assert (
                    one.velocity.encoding["scale_factor"] == two.velocity.encoding["scale_factor"]
                )
                changed += not one.velocity.equals(two.velocity)
            else:
                assert path.read_bytes() == same.read_bytes()
        assert changed


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


def test_findings_come_from_the_library():
    library = pd.DataFrame(
        [
            {"fault": "", "size": 0.0, "mode": m, "findings": "", "verdict": "usable"}
            for m in ("1B", "2B")
        ]
        + [
            {"fault": "mains-hum", "size": s, "mode": m, "findings": f, "verdict": "usable"}
            for m in ("1B", "2B")
            for s, f in ((0.5, ""), (1.0, "mains-hum"))
        ]
    )
    sheet = small_sheet(1)
    chance = np.random.default_rng(0)
    bench = draw_bench(1)
    for relative, text in ((0.4, ""), (1.2, "mains-hum")):
        hidden = [("mains-hum", relative * effect("mains-hum").BOUND)]
        seen = seen_in(library, sheet, conditions_of(bench, sheet, hidden), chance)
        assert {found for found, _ in seen.values()} == {text}
    seen = seen_in(library, sheet, conditions_of(bench, sheet, []), chance)
    assert {found for found, _ in seen.values()} == {""}


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
    assert (score(pair, both).named, score(pair, both).dominant) == (2, True)
    one = score(pair, verdict("named", cause("added-mass", "level"), cause("drift", "time")))
    assert (one.named, one.wrong, one.dominant) == (1, True, False)


def test_what_is_left_of_the_error():
    left = left_over(GAIN)
    assert (left["between_forces"], left["damping_curves"]) == pytest.approx((0.75, 0.1))
    assert left["between_forces_without_bias"] == pytest.approx(0.1)
    assert np.isnan(left_over({"gain": {}})["between_forces"])


def test_exact_bounds():
    assert share(0, 149)[2] == pytest.approx(0.0245, abs=2e-4)
    assert share(10, 10)[1] == pytest.approx(0.6915, abs=1e-4)
    assert share(0, 0)[1:] == (0.0, 1.0)


def test_a_plan_repeats_and_hides_everything():
    plan = planned(200, 3)
    assert plan == planned(200, 3)
    assert plan != planned(200, 4)
    singles = [case.effects[0][0] for case in plan if len(case.effects) == 1]
    assert set(singles) == {*catalogue(), *outsiders()}
    assert sum(not case.effects for case in plan) == 40
    assert sum(len(case.effects) == 2 for case in plan) == 20
    assert len({case.seed for case in plan}) == len(plan)
    power = planned_power(2, 3)
    assert len(power) == 10 * len(catalogue())
    for case, size in power:
        ((name, drawn),) = case.effects
        assert abs(drawn) == pytest.approx(size * effect(name).BOUND)


def test_the_page_counts_what_was_scored():
    rows = []
    for hidden, said in (
        ("drift", verdict("named", cause("drift", "time", value=0.004))),
        ("nothing", verdict("nothing-missing")),
        ("nothing", verdict("named", cause("drift", "time"))),
        ("spell", verdict("unexplained")),
        ("added-mass", verdict("named", cause("added-mass", "level", value=0.004)) | GAIN),
        ("rig-compliance", verdict("nothing-missing")),
        ("rig-compliance", verdict("nothing-missing")),
    ):
        answer = {"effects": [] if hidden == "nothing" else [[hidden, 0.004]]}
        outcome = score(answer, said)
        rows.append(
            {
                "hidden": hidden,
                "relative_size": None,
                "bench_s": 1.0,
                "verdict_s": 2.0,
                "split": len(rows) % 2 if hidden == "rig-compliance" else np.nan,
                "split_between_forces": 0.9,
                "split_k": 0.2,
                "k_before": 0.3,
                "k_after": 0.1,
                "k_away": 1.2,
            }
            | left_over(said)
            | vars(outcome)
        )
    page = matrix_page(pd.DataFrame(rows), {"seed": 1}, "fast")
    assert "| name on a null | 1 of 2 | 50.0% | 1.3% to 98.7% | at most 2 % |" in page
    assert "| wrong name, all cases | 1 of 7 |" in page
    assert "| `drift` | time | 1 | 1 | 100% |" in page
    assert "| effect of no catalogue flagged | 1 of 1 |" in page
    assert "| error of kn, kt halved, level effects | 1 of 1 |" in page
    assert "| error between forces halved, level effects | 0 of 1 |" in page
    assert "| the same, bias not spared, level effects | 1 of 1 |" in page
    assert "| level pair named with its splitter | 1 of 2 |" in page
    assert "| error between forces then halved, bias not spared | 0 of 2 |" in page
    assert "| error of kn, kt then halved | 2 of 2 |" in page


def test_the_specimen_is_the_bench_s_own(lab):
    assert lab.whole.mass.shape == parts(toy_reduced()).mass.shape
    assert lab.few.mass.shape[0] < lab.whole.mass.shape[0]
