"""A blind case on the small structure, by the fast tier."""

from cases import draw_case
from fast import save
from lab import Laboratory
from runs import diagnose
from score import score


def test_a_blind_case(house, tmp_path):
    structure = house.folder / "results" / "structures" / "tiny"
    case = draw_case(7100, ("loading-hysteresis",), 4.0)
    seen = Laboratory(structure / "reduced.nc").fast(case)
    save(seen, tmp_path / "observations.nc")
    verdict = diagnose(tmp_path / "observations.nc", structure / "parametric.nc")
    outcome = score(case.answer(), verdict)
    assert outcome.column == "loading-hysteresis"
