"""Raw cases: sealed, run by the whole workflow as a user would, then opened and scored."""

import pytest
from cases import PRESSURES, draw_case, draw_sheet
from lab import Laboratory
from matrix import run_case
from runs import structures

pytestmark = [pytest.mark.slow, pytest.mark.suite]
SEED = 7700
CYCLES = 1  # half of a matrix's records
# bar; slip shows within records, a hysteresis in repeats: neither needs more forces
FOUR, FIVE = (10, 30, 67, 134), (10, 24, 45, 85, 134)


@pytest.fixture(scope="module")
def blind_house(tmp_path_factory):
    return tmp_path_factory.mktemp("house")


@pytest.fixture(scope="module")
def parametric(blind_house):
    return structures(blind_house) / "parametric.nc"


@pytest.mark.parametrize(
    ("number", "names", "pressures"),
    [
        (2, ("joint-slip",), FOUR),
        (0, (), PRESSURES),
        (1, ("loading-hysteresis",), FIVE),
    ],
)
def test_a_raw_case_is_answered(blind_house, parametric, number, names, pressures):
    lab = Laboratory(parametric.with_name("reduced.nc"))
    case = draw_case(SEED + number, names, 3.0)
    sheet = draw_sheet(case.seed, pressures, CYCLES)
    outcome = run_case(lab, parametric, blind_house, "raw", (number, case), sheet)
    assert not outcome["wrong"]
    if names:
        assert outcome["classed"] == 1
    else:
        assert outcome["column"] == "nothing-missing"
