"""A report of a specimen without load and structure says nothing of forces, gauges, structures."""

import re

import numpy as np
import pytest
import xarray as xr
from bladeroot.diagnosis.options import FACTS
from bladeroot.diagnosis.simulation.linear import Linear
from bladeroot.diagnosis.simulation.parametric import of_assembly
from bladeroot.figures.curves import means
from bladeroot.mechanisms.catalogue import catalogue
from bladeroot.pooling.groups import group_differences
from bladeroot.report.groups import groups_section
from bladeroot.report.page import Table
from bladeroot.report.words import CUTS, SPECTRA, gauge_sentence, words_of
from bladeroot.terms import Terms
from lap_coarse import lap_model
from pooling_bench import drawn
from report_bench import curves

# Words of one machine, the blade root's rig.
OF_THE_RIG = re.compile(
    r"\b(gauge|load cell|cylinder|bar|flanks?|axial|slots?|beam|blade|rig|tip)\b|\bkN\b|[{}]"
)
FORBIDDEN = re.compile(r"forces?\b|gauge|structure|flank|axial|kN\b", re.IGNORECASE)


def test_captions_of_a_specimen_without_a_load():
    nothing = {"load_name": "", "load_unit": ""}
    words = words_of(xr.Dataset(attrs=nothing))
    mean = curves().assign_attrs(nothing)
    said = [CUTS, SPECTRA, means(mean).caption]
    for caption in said:
        assert not FORBIDDEN.search(caption), caption
    assert (words.at_one, words.value(0.0), words.header) == ("", "–", "load")
    assert gauge_sentence({}) == []


@pytest.mark.parametrize(
    ("terms", "simulated"),
    [
        (Terms("bolt torque"), of_assembly(lap_model(), {}, {}, 0.005)),
        (Terms("speed", simulated=False), Linear(("sway", "twist"), np.array([3.0, 5.0]), True)),
        (Terms("", simulated=False), Linear(("sway", "twist"), np.array([3.0, 5.0]), False)),
    ],
)
def test_causes_and_proposals_of_another_specimen_say_no_word_of_the_rig(terms, simulated):
    judged = [one for one in catalogue() if not simulated.silent(one)]
    assert len(judged) > 10
    told = [text for one in judged for text in (one.sentence, one.splitter)]
    told += [simulated.silent(one) for one in catalogue()]
    known = {one.id for one in judged}
    told += [what for what, facts in FACTS.values() if known & set(facts)]
    for text in told:
        said = terms.say(text).replace("{size}", "3 Nm")
        assert not OF_THE_RIG.search(said), said
        if not terms.load:
            assert not re.search(r"\bforces?\b", said), said


def test_captions_name_the_load_that_there_is():
    words = words_of(xr.Dataset(attrs={"load_name": "bolt torque", "load_unit": "Nm"}))
    assert words.header == "bolt torque / Nm"
    assert words.at_one == " at one bolt torque"
    named = curves().assign_attrs(load_name="bolt torque", load_unit="Nm")
    assert "at each bolt torque" in means(named).caption
    assert means(named).colours == "bolt torque"


@pytest.mark.parametrize(
    ("description", "said"),
    [
        ({"force": {"gauge": "pressure", "piston_area_cm2": 17.9, "full_scale_bar": 700,
                    "accuracy_percent": 1, "accuracy_of": "full-scale"}},
         "The axial force is read from the actuator's pressure on 17.9 cm², full scale 700 bar, "
         "accurate to 1 % of the full scale."),
        ({"load": {"name": "bolt torque", "unit": "Nm", "gauge": "torque wrench", "full_scale": 50,
                   "accuracy_percent": 4}},
         "The bolt torque is read with a torque wrench, full scale 50 Nm, accurate to 4 % of the "
         "reading."),
        ({"load": {"name": "temperature", "unit": "C", "accuracy": 0.5}},
         "The temperature is stated, accurate to 0.5 C."),
    ],
)  # fmt: skip
def test_how_a_load_was_read_is_one_sentence(description, said):
    assert gauge_sentence(description) == [said]


def test_groups_are_shown_with_the_size_of_their_difference():
    decays = drawn([1.0, 1.0, 1.4])
    section = groups_section(group_differences(decays, [False] * len(decays)))
    first, levels = (part for part in section.parts if isinstance(part, Table))
    loss = next(row for row in first.rows if row[1] == "loss factor")
    assert re.match(r"4\d.\d+ ± [\d.]+ %", loss[2])
    assert loss[-1] == "yes"
    assert "floor 2 over floor" in loss[3]
    assert len(levels.rows) == 6
    assert groups_section(xr.Dataset()) is None
