"""The report's diagnosis: every answer has its words, figures and tables bear what is missing."""

import numpy as np
import pytest
import xarray as xr
from bladeroot.figures import diagnosis as figures
from bladeroot.figures import residual_maps
from bladeroot.figures.chart import Chart
from bladeroot.figures.live import live
from bladeroot.figures.still import still
from bladeroot.figures.style import SIMULATED_NOTE, svg
from bladeroot.report.diagnosis import diagnosis_section
from bladeroot.report.diagnosis_tables import candidates_table, gain_table
from bladeroot.report.extended import extended_parts
from bladeroot.report.next_measurement import best_option, next_parts
from bladeroot.report.numbers import NONE
from bladeroot.report.page import Picture, Section, Table, render
from bladeroot.report.table_5_2 import exponent, table_5_2_remarks
from bladeroot.report.verdict import disagreement, in_short, plain, sentences_of, size, with_open
from bladeroot.report.words import words_of
from report_bench import POWER, SEATING, cause, found, verdict

PICTURES = [Picture(f"<svg id='{name}'/>", name) for name in ("one", "others")]


def drawn(diagnoses, simulated=False):
    return {
        "frequencies": figures.frequencies(diagnoses, simulated),
        "curves": figures.curves(diagnoses, simulated),
        "residuals": residual_maps.records(diagnoses, simulated),
        "residual_maps": residual_maps.curves(diagnoses, simulated),
    }


def page(one, said, simulated=False):
    section = diagnosis_section([one], [said], PICTURES, simulated)
    return render("t", "s", simulated, [section], "f"), section


def test_a_verdict_is_told_by_subject():
    said = sentences_of(found(), verdict(causes=[cause()]), False)
    assert said.head == "S: cause named"
    assert (
        "stick frequency of mode 1B (also in 2B): rises with the force by 0.6 %" in said.missing[0]
    )
    assert "it stiffens; exponent 0.600\u00a0±\u00a00.080" in said.because[0]
    assert said.odds == ["Probabilities: load dependent stiffness 97 %; nothing at all 3 %."]
    assert "falls, from 0.40 % to 0.10 %" in said.gain[0]
    assert said.next[0].startswith(
        "Measure next: another force, 2 h; it is expected to decide 70 % of"
    )
    assert said.box.lines == [*said.missing, *said.because, *said.odds, *said.gain, *said.next]


def test_modes_that_go_opposite_ways_are_told_apart():
    said = verdict(causes=[cause()])
    said["shortfall"][1] |= {"size": -said["shortfall"][1]["size"], "trend": "falls with the force"}
    (text,) = sentences_of(found(), said, False).missing
    assert "mode 1B: rises with the force" in text
    assert "mode 2B: falls with the force" in text


def test_a_single_rival_is_a_question_of_whether_it_acts():
    said = sentences_of(found(rivals=SEATING), verdict(causes=[cause()]), False)
    assert said.next[0].endswith("70 % of the question whether incomplete contact acts.")


@pytest.mark.parametrize("credible", [(POWER,), (POWER, SEATING), (POWER, "none-of-these", "none")])
def test_in_short_a_verdict_is_two_sentences_with_every_credible_cause(credible):
    answer = "named" if len(credible) == 1 else "ambiguous"
    missing, why = in_short(found(), verdict(answer, [cause(credible)]))
    assert "not explain the stick frequency of mode" in missing
    assert all(plain(name) in why for name in credible)
    assert ("97 %" in why) == (len(credible) == 1)


def test_an_ambiguous_answer_gives_the_measurement_that_splits():
    said = verdict("ambiguous", [cause((POWER, SEATING))])
    because = sentences_of(found(), said, False).because[0]
    assert "load dependent stiffness (70 %) or incomplete contact" in because
    assert because.endswith("To decide: twice the force.")


@pytest.mark.parametrize(
    ("after", "text"),
    [(1e-3, "falls, from"), (3.99e-3, "stays at 0.40 %"), (8e-3, "does not fall")],
)
def test_a_gain_is_said_as_it_is(after, text):
    sides = {"before": 4.01e-3, "after": after, "unit": "1"}
    said = verdict(causes=[cause(plausible=False)]) | {"gain": {"between_forces": sides}}
    spoken = sentences_of(found(), said, False)
    assert text in spoken.gain[0]
    assert "beyond what is physically plausible" in spoken.because[0]


def test_what_the_records_would_not_show_is_not_called_a_cause():
    quiet = cause((POWER, "none", SEATING), probability=0.06, shown=False)
    said = with_open(verdict("ambiguous", [quiet]) | {"shortfall": []})
    spoken = sentences_of(found(named=""), said, False)
    assert spoken.head == "S: nothing shows to be missing, some causes would not show"
    assert spoken.missing == ["The simulation explains all records within their scatter."]
    assert "Not excluded" in spoken.because[0]
    assert "load dependent stiffness or incomplete contact" in spoken.because[0]
    assert in_short(found(named=""), said) == [*spoken.missing, spoken.because[0]]


def test_what_acts_for_sure_has_its_own_probability_and_others_beside_it():
    sure = cause((POWER, SEATING, "none-of-these"), probability=0.995)
    said = verdict("insufficient-data", [sure]) | {
        "probabilities": {POWER: 0.5, f"{POWER}+none-of-these": 0.4, SEATING: 0.005, "x": 0.095}
    }
    text = "load dependent stiffness (more than 99 %), perhaps beside incomplete contact or a cause"
    assert f"Possible: {text}" in in_short(found(), said)[1]
    few = found(named="")
    few.attrs["insufficient"] = "it explains the stick data best; to decide: twice the force"
    few.attrs["insufficient_causes"] = POWER
    assert sentences_of(few, said, False).odds == [
        "Probabilities: load dependent stiffness alone 50 %; load dependent stiffness and a cause "
        "outside the catalogue 40 %; x 10 %."
    ]
    # another measurement comes next
    assert "to decide" in sentences_of(few, said, False).because[0]
    alone = few.drop_vars("decided")
    assert "to decide" not in sentences_of(alone, said, False).because[0]
    assert sentences_of(alone, said, False).next == ["Measure next: twice the force."]


def test_many_quantities_that_are_missed_are_a_line_each():
    said = verdict(causes=[cause()])
    few = [dict(said["shortfall"][0], quantity=name) for name in ("one", "two", "three")]
    missing = sentences_of(found(), said | {"shortfall": few}, False).missing
    assert [line[:5] for line in missing] == ["The s", *["\u2013 the"] * 3]


def test_measurements_that_would_bring_nothing_are_no_table():
    one = found().isel(stiffness=[])
    assert next_parts([one])
    nothing = one.assign(decided=0.0 * one["decided"], size_std=("option", [1.0, 1.0, np.nan]))
    nothing["decided"].attrs = one["decided"].attrs
    assert next_parts([nothing]) == []


def test_what_is_one_record_of_each_mode_without_a_load_is_an_event():
    names = []
    for hold, load in ((np.repeat(range(4), 2), ""), (np.repeat([0, 1], 4), ""), (None, "torque")):
        one = found().assign_attrs(load_name=load, load_unit="Nm" * bool(load))
        one = one.assign(stick_force=0.0 * one["stick_force"]) if not load else one
        if hold is not None:
            one = one.assign(stick_hold=("stick_record", hold))
        panels = residual_maps.records([one], False).panels
        names.append([p.x for p in panels if p.x.endswith("in order")])
    assert set(names[0]) == {"event, in order"}
    assert set(names[1]) == {"clamping, in order"}
    assert set(names[2]) <= {"clamping, in order"}


def test_answers_without_a_cause_say_what_they_are():
    few = found(named="", lacks="a second mode;more axial forces")
    few.attrs["insufficient"] = "load dependent stiffness explains the stick data best: why"
    few.attrs["insufficient_causes"] = "load-dependent-stiffness"
    barred = cause(credible_set=["load-dependent-stiffness", "incomplete-contact"])
    for causes, missing in (([], "cannot be said"), ([barred], "")):  # a cause is told once
        said = sentences_of(few, verdict("insufficient-data", causes), False)
        assert missing in said.missing[0]
        assert said.because[0].startswith("Load dependent stiffness explains the stick data best")
        assert "lacks a second mode; more axial forces." in said.because[1]
    unexplained = sentences_of(found(""), verdict("unexplained", reason="something smooth"), False)
    assert unexplained.because == ["No cause of the catalogue explains it."]
    nothing = verdict("nothing-missing")
    quiet = sentences_of(found(named=""), nothing, False).missing[0]
    assert quiet.startswith("The simulation explains all")
    alone = found(named="").assign_attrs(kind="none")
    assert in_short(alone, nothing) == ["Linear modes explain all records within their scatter."]


def test_a_fault_of_records_is_no_cause_of_what_is_unexplained():
    hum = cause(**{"class": "record"})
    because = sentences_of(found(), verdict("unexplained", [hum]), False).because
    assert because[0].startswith("Besides: load dependent stiffness")
    assert "No cause of the catalogue explains it" in because[-1]
    alone = verdict(causes=[hum], shortfall=[])
    assert "the records are faulty" in sentences_of(found(), alone, False).missing[0]


def test_a_level_is_worth_what_the_model_s_bias_would_hide():
    said = verdict(causes=[cause(**{"class": "level"})])
    said["gain"]["between_forces_without_bias"] = {"before": 9e-3, "after": 2e-3}
    assert "counted, falls, from 0.90 % to 0.20 %" in sentences_of(found(), said, False).gain[0]
    rows = [row[1] for row in gain_table([said], words_of(found())).rows]
    assert "stick frequency, forces left out, without the model's bias" in rows


def test_a_rival_that_was_not_judged_is_not_hidden():
    text, _ = page(found(barred="too few records"), verdict(causes=[cause()]))
    assert "incomplete contact (18.0) would explain the records about as well" in text
    assert "because: too few records" in text
    assert "Not judged" not in page(found(), verdict(causes=[cause()]))[0]


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
        "T: something is missing, cause not in the catalogue."
    )


@pytest.mark.parametrize("simulated", [True, False])
def test_simulated_is_said_in_box_and_figures(simulated):
    _, section = page(found(), verdict(causes=[cause()]), simulated)
    assert section.parts[0].head.startswith("Simulated") == simulated
    assert SIMULATED_NOTE not in svg(still(drawn([found()])["frequencies"]))
    for name, one in drawn([found()], simulated).items():
        figure = still(one) if isinstance(one, Chart) else one
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
    made = drawn([one])
    assert (made["curves"] is None) == ("curve_mode" not in one)
    assert all(live(chart) for chart in made.values() if isinstance(chart, Chart))
    text, _ = page(one, said)
    assert "nan" not in text.lower().replace("dominan", "")


def test_only_a_named_cause_has_a_simulation_with_it():
    for name, stages in ((POWER, 2), ("", 1)):
        chart = figures.frequencies([found(named=name)], False)
        lines = [one for one in chart.traces if one.line and one.panel == 0]
        assert len(lines) == stages


def test_what_decides_most_is_next_else_what_fixes_the_size_best():
    assert best_option(found()) == "another force"
    alone = found(rivals=POWER).assign(decided=("option", [np.nan] * 3))
    assert best_option(alone) == "more of the same"
    nothing = alone.assign(size_std=("option", [np.nan] * 3))
    assert best_option(nothing) == "more of the same"


def test_gain_table_has_every_part_and_the_relative_improvement():
    table = gain_table([verdict(causes=[cause()])], words_of(found()))
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
