import numpy as np
import pytest
from bladeroot.fem import elasticity
from bladeroot.fem.geometry import flank_ends, structure_from_mapping
from bladeroot.fem.mesh import (
    base_nodes,
    beam_mesh,
    block,
    build_mesh,
    flank_frames,
    flank_nodes,
    flank_weights,
    slot_mesh,
)
from bladeroot.fem.outline import Edge
from structure_coarse import coarse_data, coarse_structure


def profile_area(points):
    x, h = np.array(points).T
    return 4 * np.trapezoid(h, x)


def test_volume_is_the_profile_area_times_the_width():
    structure = coarse_structure()
    volume = elasticity.quadrature(beam_mesh(structure, with_pad=False)).volumes.sum()
    assert volume == pytest.approx(profile_area(structure.profile) * structure.width)
    with_pad = elasticity.quadrature(beam_mesh(structure, with_pad=True)).volumes.sum()
    pad = structure.pad
    assert with_pad - volume == pytest.approx(pad.length * pad.thickness * structure.width)


@pytest.mark.parametrize("width", [1, 2, 5])
def test_weights_sum_to_the_flank_area_and_integrate_quadratics(width):
    structure = coarse_structure(
        mesh={
            "width_elements": width,
            "thickness_elements": 1,
            "span_element_mm": 70,
            "root_element_mm": 20,
            "jaw_elements": 1,
            "base_elements": 1,
        }
    )
    (x0, z0), (x1, z1) = flank_ends(structure)
    length = np.hypot(x1 - x0, z1 - z0)
    weights = flank_weights(structure)
    assert weights.sum() == pytest.approx(length * structure.width)
    mesh = beam_mesh(structure, with_pad=False)
    y = mesh.nodes[flank_nodes(structure, mesh, 3), 1]
    assert weights @ y**2 == pytest.approx(length * structure.width**3 / 12)


def test_full_mesh_has_33_nodes_a_flank():
    structure = coarse_structure(
        mesh={
            "width_elements": 5,
            "thickness_elements": 1,
            "span_element_mm": 70,
            "root_element_mm": 20,
            "jaw_elements": 1,
            "base_elements": 1,
        }
    )
    assert len(flank_nodes(structure, beam_mesh(structure, with_pad=False), 0)) == 33


def test_contact_nodes_of_slots_coincide_with_the_beams():
    structure = coarse_structure()
    mesh = build_mesh(structure)
    beam, slot = (mesh.node_position.values[mesh.pair_node.values[:, k]] for k in range(2))
    np.testing.assert_allclose(beam, slot, atol=1e-9)
    assert not np.isin(mesh.pair_node.values[:, 0], mesh.pair_node.values[:, 1]).any()
    assert (np.sign(beam[:, 0]) == np.repeat([-1, -1, 1, 1], len(beam) // 4)).all()
    assert (np.sign(beam[:, 2]) == np.repeat([-1, 1, -1, 1], len(beam) // 4)).all()


def test_flanks_are_mirror_images_node_by_node():
    structure = coarse_structure()
    mesh = beam_mesh(structure, with_pad=True)
    first = mesh.nodes[flank_nodes(structure, mesh, 0)]
    for flank, sign in ((1, [1, 1, -1]), (2, [-1, 1, 1]), (3, [-1, 1, -1])):
        np.testing.assert_allclose(mesh.nodes[flank_nodes(structure, mesh, flank)], first * sign)


def test_frames_are_right_handed_and_lie_in_the_flank():
    structure = coarse_structure()
    mesh = beam_mesh(structure, with_pad=False)
    for flank, frame in enumerate(flank_frames(structure)):
        np.testing.assert_allclose(frame @ frame.T, np.eye(3), atol=1e-15)
        np.testing.assert_allclose(np.cross(frame[0], frame[1]), frame[2], atol=1e-15)
        points = mesh.nodes[flank_nodes(structure, mesh, flank)]
        np.testing.assert_allclose((points - points[0]) @ frame[0], 0.0, atol=1e-9)
        # Out of the beam: away from mid-height, towards mid-span, at 45 degrees here.
        outwards = [-np.sign(points[0, 0]), 0, np.sign(points[0, 2])]
        np.testing.assert_allclose(frame[0], np.array(outwards) / np.sqrt(2), atol=1e-3)


def test_slot_is_sound_and_held_at_its_far_face_only():
    structure = coarse_structure()
    mesh = slot_mesh(structure, "Xp")
    assert elasticity.quadrature(mesh).volumes.min() > 0
    held = mesh.nodes[base_nodes(mesh)]
    assert np.ptp(held[:, 0]) < 1e-9
    assert held[0, 0] == mesh.nodes[:, 0].max()


def test_unknown_side_is_refused():
    with pytest.raises(ValueError, match="Xn"):
        slot_mesh(coarse_structure(), "left")


@pytest.mark.parametrize(
    ("low", "high"),
    [
        (((0.0, 1.0), (1.0, 1.0)), ((0.0, 0.0), (1.0, 0.0))),  # upper edge below the lower one
        (((1.0, 0.0), (0.0, 0.0)), ((1.0, 1.0), (0.0, 1.0))),  # right to left
        (((0.0, 0.0), (1.0, 0.0)), ((0.0, 1.0), (0.2, 0.2))),  # a corner pushed in
        (((0.0, 0.0), (1.0, 0.0)), ((1.0, 1.0), (0.0, 1.0))),  # edges that cross
        (((0.0, 0.0), (0.0, 0.0)), ((0.0, 1.0), (1.0, 1.0))),  # an edge without length
    ],
)
def test_a_block_turned_inside_out_is_refused(low, high):
    with pytest.raises(ValueError, match=r"^expected a block .* inside out at \(.*\) mm$"):
        block(Edge(*low), Edge(*high), (1, 1))


def test_a_geometry_whose_mesh_is_turned_inside_out_is_named():
    """A tip that tapers below the flank leaves no room for the pocket's ceiling above it."""
    data = coarse_data()
    data["beam"]["profile_mm"][-2:] = [[157.58, 7.0], [161.33, 7.0]]
    structure = structure_from_mapping(data)
    with pytest.raises(ValueError, match=r"^structure dovetail-H: expected a block .* mm$"):
        build_mesh(structure)
