import copy

import numpy as np
import pytest
from bladeroot.fem.geometry import structure_from_mapping
from bladeroot.reproduction.parameters import parameters_of, values_in, with_values
from bladeroot.schema import read_yaml
from structure_coarse import DOVETAIL, ROOT

CALIBRATIONS = sorted((ROOT / "resources/structures/calibration").glob("*.yaml"))


def entry(**changes):
    return {
        "name": "neck",
        "prior_mean": 4.0,
        "prior_std": 0.5,
        "moves": {"beam.profile_mm.3.1": 1, "beam.profile_mm.4.1": 1},
    } | changes


@pytest.mark.parametrize("path", CALIBRATIONS, ids=lambda path: path.stem)
def test_shipped_calibrations_start_at_their_structure(path):
    asked = read_yaml(path, "calibration")
    data = read_yaml(ROOT / f"resources/structures/{path.stem}.yaml", "structure")
    parameters = parameters_of(asked["parameters"], data)
    values = values_in(data, parameters)
    assert asked["structure"] == path.stem
    assert with_values(data, parameters, values) == structure_from_mapping(data)
    wide = [one.prior_std for one in parameters]
    assert np.all(np.abs(values - [one.prior_mean for one in parameters]) < 3 * np.array(wide))


def test_each_parameter_takes_its_value_whatever_the_others():
    rng = np.random.default_rng(3)
    asked = read_yaml(CALIBRATIONS[0], "calibration")
    parameters = parameters_of(asked["parameters"], DOVETAIL)
    std = np.array([one.prior_std for one in parameters])
    values = values_in(DOVETAIL, parameters) + 0.2 * std * rng.standard_normal(len(std))
    structure = with_values(DOVETAIL, parameters, values)
    by_name = dict(zip([one.name for one in parameters], values, strict=True))
    profile = np.array(structure.profile) * 1e3
    assert profile[5, 0] == pytest.approx(by_name["flank's distance from mid-span"])
    assert profile[8, 0] - profile[5, 0] == pytest.approx(by_name["root's length, flank to tip"])
    assert profile[5, 0] - profile[3, 0] == pytest.approx(
        by_name["neck's length, shoulder to flank"]
    )
    assert structure.material.young == pytest.approx(by_name["Young's modulus"] * 1e9)


def test_the_file_is_left_as_it_is():
    before = copy.deepcopy(DOVETAIL)
    parameters = parameters_of([entry()], DOVETAIL)
    with_values(DOVETAIL, parameters, np.array([4.5]))
    assert before == DOVETAIL


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"moves": {"beam.profile_mm.30.1": 1}}, "no beam.profile_mm.30.1"),
        ({"moves": {"beam.profile_mm": 1}}, "expected a number at beam.profile_mm"),
        ({"moves": {"mesh.width_elements": 1}}, "no length, modulus or density"),
        ({"measures": {"pad.length_mm": 1}}, "neck moves neck by 0 .* expected 1"),
    ],
)
def test_what_is_no_parameter_is_refused(changes, message):
    with pytest.raises(ValueError, match=message):
        parameters_of([entry(**changes)], DOVETAIL)


def test_a_parameter_that_another_moves_is_refused():
    both = {"beam.profile_mm.2.1": 1, "beam.profile_mm.3.1": 1}
    entries = [entry(), entry(name="both", moves=both)]
    with pytest.raises(ValueError, match="both moves neck by 1 of its own change, expected 0"):
        parameters_of(entries, DOVETAIL)
