"""Fillets: arcs that touch both edges of a corner, in the outline and in the mesh."""

from itertools import pairwise

import numpy as np
import pytest
from bladeroot.fem import elasticity
from bladeroot.fem.geometry import profile_edges, structure_from_mapping
from bladeroot.fem.mesh import beam_mesh, build_mesh, slot_mesh
from bladeroot.fem.outline import Edge, cut, outline
from hypothesis import given
from hypothesis import strategies as st
from structure_coarse import coarse_data

CORNER = [(0.0, 5.0), (10.0, 5.0), (20.0, 12.0), (24.0, 3.0), (30.0, 3.0)]


def cut_off(profile, point, radius):
    """Area between a corner and its arc: twice the triangle to the centre, less the sector."""
    corner = np.array(profile[point])
    back, forth = (np.subtract(profile[point + k], corner) for k in (-1, 1))
    half = 0.5 * np.arccos(back @ forth / np.hypot(*back) / np.hypot(*forth))
    return radius**2 * (1.0 / np.tan(half) - (np.pi / 2 - half))


@given(
    left=st.floats(-1.3, 1.3), bend=st.floats(0.1, 1.2) | st.floats(-1.2, -0.1),
    radius=st.floats(0.05, 5.0),
)  # fmt: skip
def test_an_arc_touches_both_edges(left, bend, radius):
    right = np.clip(left + bend, -1.4, 1.4)
    profile = [(0.0, 0.0), (20 * np.cos(left), 20 * np.sin(left))]
    profile.append((profile[1][0] + 20 * np.cos(right), profile[1][1] + 20 * np.sin(right)))
    arc = outline(profile, {1: radius})[1]
    points = arc.at(np.linspace(0, 1, 9))
    np.testing.assert_allclose(np.hypot(*(points - arc.centre).T), radius, rtol=1e-9)
    assert abs(arc.turn) == pytest.approx(abs(right - left), rel=1e-6)
    step = 1e-6
    for end, angle in (
        (arc.at(np.array([0, step])), left),
        (arc.at(np.array([1 - step, 1])), right),
    ):
        direction = np.diff(end, axis=0)[0]
        assert np.arctan2(*direction[::-1]) == pytest.approx(angle, abs=1e-4)
    assert np.all(np.diff(points[:, 0]) > 0)


def test_edges_follow_one_another_and_may_be_used_up():
    edges = outline(CORNER, {1: 4.0, 2: 1.0, 3: 2.0})
    assert [edge.centre is None for edge in edges] == [True, False] * 3 + [True]
    assert all(one.end == other.start for one, other in pairwise(edges))
    square = [(0.0, 0.0), (1.0, 0.0), (2.0, 1.0), (3.0, 1.0)]
    fits = 1.0 / np.tan(np.pi / 8) * np.sqrt(2) / 2  # two of these take the whole middle edge
    met = outline(square, {1: fits * np.tan(np.pi / 8) ** 2 * (1 + np.sqrt(2)), 2: 0.1})
    assert all(one.end == other.start for one, other in pairwise(met))


def test_a_straight_line_has_no_corner():
    with pytest.raises(ValueError, match="got point 1 on a straight line"):
        outline([(0.0, 0.0), (1.0, 1.0), (2.0, 2.0)], {1: 0.1})


def test_a_cut_arc_is_the_same_arc():
    edges = outline(CORNER, {3: 2.0})
    arc = next(edge for edge in edges if edge.centre)
    at = 0.5 * (arc.start[0] + arc.end[0])
    before, after = cut(edges, at)
    assert len(before) + len(after) == len(edges) + 1
    for part in (before[-1], after[0]):
        assert np.hypot(*(part.at(np.array([0.5]))[0] - arc.centre)) == pytest.approx(2.0)
    assert before[-1].turn + after[0].turn == pytest.approx(arc.turn)
    assert cut(edges, arc.end[0])[1][0] == edges[edges.index(arc) + 1]


def test_an_arc_of_many_elements_has_none_over_45_degrees():
    assert Edge((-1.0, 0.0), (1.0, 0.0), (0.0, 0.0)).elements(9.0) == 4
    assert Edge((-1.0, 0.0), (1.0, 0.0)).elements(0.7) == 3


FILLETS = {1: 8.0, 2: 1.2, 3: 1.0, 4: 0.4}


def filleted(size=20, fillets=FILLETS, **slot):
    """The shipped dovetail with a wider throat and rounded corners."""
    data = coarse_data()
    profile = [list(point) for point in data["beam"]["profile_mm"]]
    profile[4][0] += 1.2
    data["beam"] |= {
        "profile_mm": profile,
        "fillets": [{"point": p, "radius_mm": r} for p, r in fillets.items()],
    }
    data["mesh"]["root_element_mm"] = size
    data["slot"] |= slot
    return structure_from_mapping(data)


@pytest.mark.parametrize("fillet", FILLETS.items())
def test_a_fillet_adds_or_takes_the_area_of_the_closed_form(fillet):
    point, radius = fillet
    profile = np.array(filleted(fillets={}).profile)
    slopes = np.diff(profile[:, 1]) / np.diff(profile[:, 0])
    adds = 1 if slopes[point] > slopes[point - 1] else -1
    exact = 4 * adds * cut_off(1e3 * profile, point, radius) * 1e-6
    arc = next(edge for edge in profile_edges(filleted(fillets={point: radius})) if edge.centre)

    def error(elements):
        size = 1e3 * (arc.end[0] - arc.start[0]) / elements
        sharp, rounded = (
            elasticity.quadrature(beam_mesh(filleted(size, chosen), False)).volumes.sum()
            for chosen in ({}, {point: radius})
        )
        return abs((rounded - sharp) / 0.026 / exact - 1)

    errors = np.array([error(count) for count in (4, 8)])
    assert errors[0] < 1e-3
    assert np.log2(errors[0] / errors[1]) > 3.7  # a quadratic edge: fourth order in area


def test_filleted_bodies_are_sound_and_still_meet_on_the_flanks():
    structure = filleted(size=2, lip_mm=3.0)
    for body in (beam_mesh(structure, True), slot_mesh(structure, "Xp")):
        assert elasticity.quadrature(body).volumes.min() > 0
    mesh = build_mesh(structure)
    beam, slot = (mesh.node_position.values[mesh.pair_node.values[:, k]] for k in range(2))
    np.testing.assert_allclose(beam, slot, atol=1e-9)
