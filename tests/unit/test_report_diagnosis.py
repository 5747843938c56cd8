"""The report's diagnosis: every answer has its words, figures and tables bear what is missing."""

import numpy as np
import pytest
import xarray as xr
from bladeroot.figures import diagnosis as figures
from bladeroot.figures import residual_maps
from bladeroot.figures.style import SIMULATED_NOTE, svg
from bladeroot.report.diagnosis import diagnosis_section
from bladeroot.report.diagnosis_tables import candidates_table, gain_table
from bladeroot.report.extended import extended_parts
from bladeroot.report.next_measurement import best_option
from bladeroot.report.numbers import NONE
from bladeroot.report.page import Picture, Section, Table, render
from bladeroot.report.table_5_2 import exponent, table_5_2_remarks
from bladeroot.report.verdict import disagreement, plain, size, verdict_box, with_open

PICTURES = ("ranking", "frequencies", "curves", "residuals", "residual_maps", "law")
POWER, SEATING = "load-dependent-stiffness", "incomplete-contact"


def cause(credible=(POWER,), **more):
    return {
        "mechanism": credible[0], "class": "force-law", "credible_set": list(credible),
        "parameters": [{"name": "exponent", "value": 0.6, "std": 0.08, "unit": "1"}],
        "plausible": True, "splitter": "twice the force", "log_evidence": 20.0,
        "form": "power", "probability": 0.97 if len(credible) == 1 else 0.7, "sizes": [], **more,
    }  # fmt: skip


def verdict(answer="named", causes=(), **more):
    trend = "rises with the force by {} % more than simulated"
    missing = answer not in ("nothing-missing", "insufficient-data")
    sides = {"before": 4e-3, "after": 1e-3, "unit": "1"}
    gain = {"between_forces": {**sides, "by_mode": {"1B": sides}},
            "log_score": {"before": 10.0, "after": 31.0}}  # fmt: skip
    return {
        "structure": "S", "answer": answer, "causes": list(causes), "records": {},
        "probabilities": {POWER: 0.97, "none": 0.03} if causes else {"none": 0.995, POWER: 0.005},
        "shortfall": [
            {"quantity": "stick frequency", "mode": mode, "trend": trend.format(number),
             "explained": bool(causes)}
            for mode, number in (("1B", 0.6), ("2B", 0.4))
        ] if missing else [],
        "gain": gain if causes else {}, "reason": "why", **more,
    }  # fmt: skip


def found(named=POWER, barred="", lacks="", holds=True, curves=True, rivals=f"{POWER};{SEATING}"):
    """A diagnosis of eight records in two modes, with two candidates and a smooth one."""
    n, rng = 8, np.random.default_rng(1)
    force = np.repeat([4e3, 8e3, 12e3, 20e3], 2)
    left = np.stack([np.linspace(-12, 12, n), rng.standard_normal(n)])
    made = xr.Dataset(
        {
            "class": ("candidate", ["force-law", "force-law", "smooth"]),
            "channel": ("candidate", ["stick"] * 3),
            "log_evidence": ("candidate", [20.0, 18.0, 5.0]),
            "is_named": ("candidate", np.array([int(bool(named)), 0, 0], dtype=np.int8)),
            "barred": ("candidate", ["", barred, "no mechanism"]),
            "sentence": ("candidate", ["it stiffens", "it seats", "any"]),
            "stick_mode": ("stick_record", ["1B", "2B"] * 4),
            "stick_force": ("stick_record", force),
            "stick_time": ("stick_record", np.arange(n) * 600.0 if holds else np.zeros(n)),
            "stick_direction": ("stick_record", np.repeat([1.0, -1.0], 4) * holds),
            "stick_hold": ("stick_record", np.arange(n) // 2 if holds else np.arange(n)),
            "stick_frequency": ("stick_record", 500.0 + force / 1e3),
            "stick_simulated": (("stage", "stick_record"), 500.0 + np.stack([force, force]) / 1e3),
            "stick_residual": (("stage", "stick_record"), 1e-3 * left),
            "stick_residual_scaled": (("stage", "stick_record"), left),
            "law_k": (("stage", "stiffness", "law_force"), np.full((2, 2, 3), 1e9)),
            "law_ln_std": (("stage", "stiffness", "law_force"), np.full((2, 2, 3), 0.3)),
            "law_correlation": (("stage", "law_force"), np.full((2, 3), -0.9)),
            "decided": ("option", [0.0, 0.2, 0.7], {"rivals": rivals}),
            "hours": ("option", [np.nan, 2.0, 2.0]),
            "size_std": ("option", [1.0, 0.8, 0.9]),
            "expected_ln_std": (("option", "stiffness"), [[0.5, 0.6], [0.4, 0.5], [0.45, 0.5]]),
        },
        coords={
            "candidate": [POWER, SEATING, "smooth in force"], "stage": ["before", "after"],
            "stick_record": [f"r{k}" for k in range(n)], "mode": ["1B", "2B"],
            "law_force": [4e3, 12e3, 20e3], "stiffness": ["kn", "kt"],
            "option": ["as measured", "more of the same", "another force"],
        },
        attrs={"structure": "S", "named": named, "lacks": lacks},
    )  # fmt: skip
    if curves:
        made = made.merge(_curves())
    return made


def _curves():
    amplitude = np.tile(np.logspace(-8, -5, 6), 4)
    mode, force = np.repeat(["1B", "2B"], 12), np.tile(np.repeat([4e3, 20e3], 6), 2)
    entries = {"curve_mode": ("point", mode), "curve_force": ("point", force),
               "curve_amplitude": ("point", amplitude)}  # fmt: skip
    for name in ("curve_frequency", "curve_loss"):
        entries[name] = ("point", 100.0 * amplitude)
        entries[f"{name}_std"] = ("point", np.full(24, 1e-5))
        entries[f"{name}_simulated"] = (("stage", "point"), np.zeros((2, 24)))
    return xr.Dataset(entries)


def drawn(diagnoses, verdicts, simulated=False):
    return {
        "ranking": figures.ranking(diagnoses, verdicts, simulated),
        "frequencies": figures.frequencies(diagnoses, simulated),
        "curves": figures.curves(diagnoses, simulated),
        "residuals": residual_maps.records(diagnoses, simulated),
        "residual_maps": residual_maps.curves(diagnoses, simulated),
        "law": figures.law(diagnoses, simulated),
    }


def page(one, said, simulated=False):
    pictures = {f"diagnosis_{name}": f"<svg id='{name}'/>" for name in PICTURES}
    section = diagnosis_section([one], [said], pictures, simulated)
    return render("t", "s", simulated, [section], "f"), section


def test_the_box_says_what_is_missing_why_what_it_is_worth_and_what_next():
    box = verdict_box(found(), verdict(causes=[cause()]), False)
    assert box.head == "S: cause named"
    assert box.lines[0] == (
        "Missing: the stick frequency rises with the force by 0.6 % (1B) and 0.4 % (2B) more than "
        "simulated."
    )
    assert box.lines[1].startswith("Cause: load dependent stiffness (a law of the force), it ")
    assert "exponent 0.600\u00a0±\u00a00.080" in box.lines[1]
    assert box.lines[2] == "Probabilities: load dependent stiffness 97 %; nothing at all 3 %."
    assert "falls, from 0.40 % to 0.10 %" in box.lines[3]
    assert box.lines[4].startswith(
        "Measure next: another force, 2 h; it is expected to decide 70 % of"
    )


def test_an_ambiguous_answer_gives_the_measurement_that_splits():
    said = verdict("ambiguous", [cause((POWER, SEATING))])
    text = " ".join(verdict_box(found(), said, False).lines)
    assert "load dependent stiffness or incomplete contact" in text
    assert "do not tell which. To decide: twice the force" in text
    assert "load dependent stiffness with a probability of 70 %" in text


def test_what_the_records_would_not_show_is_not_called_a_cause():
    quiet = cause((POWER, "none", SEATING), probability=0.06)
    said = with_open(verdict("ambiguous", [quiet]) | {"shortfall": []})
    box = verdict_box(found(named=""), said, False)
    assert box.head == "S: nothing shows to be missing, some causes would not show"
    assert box.lines[0] == "The simulation explains all records within their scatter."
    text = " ".join(box.lines)
    assert "Not excluded" in text
    assert "load dependent stiffness or incomplete contact" in text
    assert "Cause:" not in text


def test_what_is_no_mechanism_stands_in_words():
    said = verdict("ambiguous", [cause((POWER, "none-of-these", "none"))])
    text = " ".join(verdict_box(found(), said, False).lines)
    assert "load dependent stiffness, something of no catalogue or nothing at all" in text


def test_an_error_that_stays_is_not_said_to_fall():
    sides = {"before": 4.01e-3, "after": 3.99e-3, "unit": "1"}
    said = verdict(causes=[cause()]) | {"gain": {"between_forces": sides}}
    text = " ".join(verdict_box(found(), said, False).lines)
    assert "stays at 0.40 %" in text
    assert "falls, from" not in text


def test_what_is_barred_and_explains_best_is_said():
    one = found(named="", lacks="records")
    one.attrs["insufficient"] = "force-gain explains the stick data best and is not named: why"
    text = " ".join(verdict_box(one, verdict("insufficient-data"), False).lines)
    assert "force-gain explains the stick data best and is not named: why." in text


def test_other_answers_say_what_they_are():
    few = found(named="", lacks="a second mode;more axial forces")
    text = " ".join(verdict_box(few, verdict("insufficient-data"), False).lines)
    assert "cannot be said" in text
    assert "lacks a second mode; more axial forces." in text
    said = verdict("unexplained", reason="something smooth in force")
    assert "No cause of the catalogue explains it" in verdict_box(found(""), said, False).lines[1]
    lines = verdict_box(found(named=""), verdict("nothing-missing"), False).lines
    assert lines[0] == "The simulation explains all records within their scatter."


def test_an_implausible_size_and_a_gain_that_is_none_are_said():
    said = verdict(causes=[cause(plausible=False)])
    said["gain"]["between_forces"] = {"before": 1e-3, "after": 2e-3}
    text = " ".join(verdict_box(found(), said, False).lines)
    assert "beyond what is physically plausible" in text
    assert "does not fall" in text


def test_a_fault_of_records_is_no_cause_of_what_is_unexplained():
    hum = cause(**{"class": "record"})
    text = " ".join(verdict_box(found(), verdict("unexplained", [hum]), False).lines)
    assert "Besides: load dependent stiffness" in text
    assert "Cause:" not in text
    assert "No cause of the catalogue explains it" in text


def test_a_level_is_worth_what_the_model_s_bias_would_hide():
    said = verdict(causes=[cause(**{"class": "level"})])
    said["gain"]["between_forces_without_bias"] = {"before": 9e-3, "after": 2e-3}
    text = " ".join(verdict_box(found(), said, False).lines)
    assert "what is the same at all forces counted, falls, from 0.90 % to 0.20 %" in text
    told = [row[1] for row in gain_table([said]).rows]
    assert "stick frequency, a force left out, without the model's bias" in told


def test_a_rival_that_was_not_judged_is_not_hidden():
    text, _ = page(found(barred="too few records"), verdict(causes=[cause()]))
    assert "incomplete contact (18.0) would explain the records about as well" in text
    assert "because: too few records" in text
    said = verdict(causes=[cause()], reason="x. With the records below 12 kN: named, drift +- 1")
    text, _ = page(found(), said)
    assert "Not judged" not in text
    assert "S: With the records below 12 kN: named, drift ± 1." in text


def test_what_shows_more_than_the_cause_says_why_it_is_not_named():
    why = "beyond its limits, by its error, or less beside the other causes"
    told = [row[-1] for row in candidates_table([found()]).rows]
    assert told == [NONE, NONE, "no mechanism"]
    ahead = found().assign(log_evidence=("candidate", [20.0, 51.0, 90.0]))
    assert [row[-1] for row in candidates_table([ahead]).rows] == [NONE, why, "no mechanism"]
    elsewhere = ahead.assign(channel=("candidate", ["stick", "curves", "stick"]))
    assert [row[-1] for row in candidates_table([elsewhere]).rows] == [NONE, NONE, "no mechanism"]


def test_structures_that_disagree_are_in_the_box():
    one, other = verdict(causes=[cause()]), verdict("unexplained", structure="T")
    assert disagreement([one, one]) == []
    assert disagreement([one, other])[0].endswith(
        "T, something is missing, cause not in the catalogue."
    )


@pytest.mark.parametrize("simulated", [True, False])
def test_simulated_is_said_in_box_and_figures(simulated):
    _, section = page(found(), verdict(causes=[cause()]), simulated)
    assert section.parts[0].head.startswith("Simulated") == simulated
    for name, figure in drawn([found()], [verdict(causes=[cause()])], simulated).items():
        note = figure._suptitle.get_text() if figure._suptitle else ""
        assert (note == SIMULATED_NOTE) == simulated, name


@pytest.mark.parametrize(
    "one",
    [
        found(),
        found(named="", curves=False),
        found(holds=False, curves=False),
        found()[["class", "channel", "log_evidence", "is_named", "barred", "sentence"]],
    ],
)
def test_figures_and_page_bear_what_a_campaign_lacks(one):
    said = verdict(causes=[cause()]) if one.attrs["named"] else verdict("nothing-missing")
    for figure in drawn([one], [said]).values():
        assert svg(figure).lstrip().startswith("<?xml")
    text, section = page(one, said)
    shown = {part.svg for part in section.parts if isinstance(part, Picture)}
    assert ("<svg id='curves'/>" in shown) == ("curve_mode" in one)
    assert "nan" not in text.lower().replace("dominan", "")


def test_the_same_figure_has_the_same_bytes():
    first, second = (svg(figures.ranking([found()], [verdict()], False)) for _ in range(2))
    assert first == second


def test_what_decides_most_is_next_else_what_fixes_the_size_best():
    assert best_option(found()) == "another force"
    alone = found(rivals=POWER).assign(decided=("option", [np.nan] * 3))
    assert best_option(alone) == "more of the same"
    nothing = alone.assign(size_std=("option", [np.nan] * 3))
    assert best_option(nothing) == "more of the same"


def test_gain_table_has_every_part_and_the_relative_improvement():
    table = gain_table([verdict(causes=[cause()])])
    assert [row[-1] for row in table.rows] == ["75 %", "75 %", "+21.0"]


@pytest.mark.parametrize(
    ("p", "expected"),
    [
        ({"value": 1.0126e-9, "std": 1.3e-11, "unit": "m/N"}, "1.013 ± 0.013 µm/kN"),
        ({"value": -1234.0, "std": 260.0, "unit": "N"}, "-1.23 ± 0.26 kN"),
        ({"value": 0.0123, "std": 0.004, "unit": "kg"}, "12.3 ± 4.0 g"),
        ({"value": 3e6, "std": 2e5, "unit": "1/m^2"}, "3\u202f000\u202f000 ± 200\u202f000 1/m^2"),
    ],
)
def test_sizes_are_in_handy_units(p, expected):
    assert size(p).replace("\u00a0", " ") == expected


def test_exponents_of_table_and_theory_stand_beside_the_causes():
    force = np.array([12e3, 16e3, 22e3])
    assert exponent(force, 3.0 * force**0.47) == pytest.approx(0.47)
    stiffness = xr.Dataset(
        {f"published_{k}_total": ("force", force**0.6) for k in ("kn", "kt")}, {"force": force}
    )
    theory = xr.Dataset(
        {f"{k}_theory": (("friction_state", "force"), [force**0.05] * 2) for k in ("kn", "kt")},
        {"force": force},
    )
    assert table_5_2_remarks([verdict()], stiffness, theory) == []
    text = table_5_2_remarks([verdict(causes=[cause()])], stiffness, theory)[0]
    assert "exponents 0.60 and 0.60" in text
    assert "0.60 ± 0.08 with S" in text
    assert "smooth flanks do not explain it" in text
    near = cause()
    near["parameters"][0]["value"] = 0.15
    text = table_5_2_remarks([verdict(causes=[near])], stiffness, theory)[0]
    assert "does not exclude smooth contact" in text


def test_extended_inference_stands_beside_the_plain_one():
    quantiles = [0.025, 0.16, 0.5, 0.84, 0.975]
    plain = xr.Dataset(
        {
            "reference_quantile": (("stiffness", "quantile"), np.full((2, 5), 1e9)),
            "ln_std": (("force", "stiffness"), [[0.3, 0.4]]),
            "posterior_mean": ("parameter", [0.001, 0.5]),
            "level_misfit": ("level", [1e-3, -1e-3]),
            "log_evidence": ("law", [10.0]),
        },
        {"stiffness": ["kn", "kt"], "quantile": quantiles, "force": [12e3], "law": ["one power"],
         "parameter": ["bias_1B", "exponent"]},
        {"structure": "S", "law": "one power", "reference_force_N": 12e3},
    )  # fmt: skip
    extended = plain.assign_attrs(extended_by="drift", extension_left_out="drift")
    assert extended_parts([plain], []) == []
    parts = extended_parts([plain], [extended])
    assert isinstance(parts[0], Table)
    assert len(parts[0].rows) == 2
    assert "names drift, which" in parts[1]
    assert render("t", "s", False, [Section("x", parts)], "f")


def test_words_lose_their_hyphens_and_numbers_keep_their_signs():
    assert plain("force-gain (gain -0.36, 1e-05)") == "force gain (gain -0.36, 1e-05)"
