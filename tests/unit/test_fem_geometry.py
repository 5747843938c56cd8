from itertools import pairwise

import pytest
import yaml
from bladeroot.fem.geometry import jaw_inner_face, structure_from_mapping
from bladeroot.rom.file import load_structure
from structure_coarse import DOVETAIL, ROOT, coarse_data


def test_lengths_and_moduli_arrive_in_si_units():
    structure = structure_from_mapping(DOVETAIL)
    assert structure.width == pytest.approx(0.026)
    assert structure.profile[0] == (0.0, pytest.approx(0.005))
    assert structure.material.young == pytest.approx(200.3e9)
    assert structure.slot.material == structure.material


@pytest.mark.parametrize("name", ["dovetail-H", "dovetail-HB", "dovetail-tables"])
def test_shipped_structures_are_valid_and_carry_their_own_name(name):
    assert load_structure(ROOT / f"resources/structures/{name}.yaml").name == name


def _written(folder, data):
    path = folder / "mine.yaml"
    path.write_text(yaml.safe_dump(data))
    return path


def test_wrong_type_names_file_and_key(tmp_path):
    data = coarse_data()
    data["beam"] = data["beam"] | {"width_mm": "26 mm"}
    with pytest.raises(ValueError, match=r"beam\.width_mm: '26 mm' is not of type.*mine\.yaml"):
        load_structure(_written(tmp_path, data))


def test_unknown_key_is_refused(tmp_path):
    with pytest.raises(ValueError, match="colour"):
        load_structure(_written(tmp_path, coarse_data(colour="red")))


def test_missing_section_is_named(tmp_path):
    data = coarse_data()
    del data["slot"]
    with pytest.raises(ValueError, match="'slot' is a required property"):
        load_structure(_written(tmp_path, data))


def test_loaded_case_without_a_pad_is_refused():
    data = coarse_data()
    del data["pad"]
    with pytest.raises(ValueError, match="no pad"):
        structure_from_mapping(data)


def _beam(**changes):
    return {"beam": DOVETAIL["beam"] | changes}


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (_beam(profile_mm=[[1, 5], *DOVETAIL["beam"]["profile_mm"][1:]]), "start at x = 0"),
        (_beam(profile_mm=[*DOVETAIL["beam"]["profile_mm"], [150, 5]]), "x must grow"),
        (_beam(flank_points=[5, 7]), "two neighbouring points"),
        (_beam(flank_points=[2, 3]), "half-height must grow"),
        ({"slot": DOVETAIL["slot"] | {"lip_mm": 9}}, "room for 3.37 mm, got 9.00"),
        ({"pad": DOVETAIL["pad"] | {"length_mm": 300}}, "straight span"),
    ],
)
def test_impossible_shapes_are_refused(changes, message):
    data = coarse_data(**changes)
    with pytest.raises(ValueError, match=message):
        structure_from_mapping(data)


def test_jaw_follows_the_beam_up_to_the_flank_and_then_leaves_it():
    structure = structure_from_mapping(DOVETAIL)
    face = jaw_inner_face(structure)
    first, last = structure.flank
    ends = [(edge.start, edge.end) for edge in face]
    assert (structure.profile[first], structure.profile[last]) in ends
    assert face[0].start[0] == pytest.approx(structure.profile[first][0] - structure.slot.lip)
    assert all(one.end == other.start for one, other in pairwise(face))
    tip_x, tip_h = structure.profile[-1]
    assert face[-1].end[0] > tip_x
    assert face[-1].end[1] > tip_h


@pytest.mark.parametrize(
    ("fillets", "message"),
    [
        ([(3, 3.0)], r"between points 3 and 4, which lie 0\.51 mm apart: 3 mm at point 3 need"),
        ([(3, 0.25), (4, 1.0)], "0.25 mm at point 3 and 1 mm at point 4 need"),
        ([(8, 0.5)], r"between the profile's ends \(1..7\), got 8"),
        ([(5, 0.5)], r"the flank's ends \(\[5, 6\]\) must stay corners, got a fillet at point 5"),
        ([(2, 0.5), (2, 0.3)], "point 2 must have one fillet, got two"),
    ],
)
def test_fillets_that_do_not_fit_are_refused(fillets, message):
    data = coarse_data(**_beam(fillets=[{"point": p, "radius_mm": r} for p, r in fillets]))
    with pytest.raises(ValueError, match=rf"structure file, beam/fillets: .*{message}"):
        structure_from_mapping(data)
