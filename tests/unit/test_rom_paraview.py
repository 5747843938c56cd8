import meshio
import numpy as np
import pytest
from bladeroot.rom.full import full_joint
from bladeroot.rom.paraview import VTK_NODES, mode_shapes, points_and_cells
from structure_coarse import coarse_loaded


@pytest.fixture(scope="module")
def own():
    return coarse_loaded()


def test_vtk_numbers_corners_then_edges_then_faces_then_the_middle():
    assert sorted(map(tuple, VTK_NODES)) == [tuple(index) for index in np.ndindex(3, 3, 3)]
    middles = (VTK_NODES == 1).sum(axis=1)
    assert list(middles) == [0] * 8 + [1] * 12 + [2] * 6 + [3]
    # each edge's node is the mean of its two corners, in VTK's order of edges
    edges = [(0, 1), (1, 2), (3, 2), (0, 3), (4, 5), (5, 6), (7, 6), (4, 7)]
    edges += [(0, 4), (1, 5), (2, 6), (3, 7)]
    for node, ends in zip(VTK_NODES[8:20], edges, strict=True):
        np.testing.assert_array_equal(2 * node, VTK_NODES[list(ends)].sum(axis=0))
    faces = [(0, 4, 7, 3), (1, 2, 6, 5), (0, 1, 5, 4), (3, 7, 6, 2), (0, 3, 2, 1), (4, 5, 6, 7)]
    for node, corners in zip(VTK_NODES[20:26], faces, strict=True):
        np.testing.assert_array_equal(4 * node, VTK_NODES[list(corners)].sum(axis=0))


def test_cells_keep_their_nodes_in_space(own):
    points, cells, data = points_and_cells(own[1])
    corners = points[cells["hexahedron27"][:, :8]]
    middle = points[cells["hexahedron27"][:, 26]]
    np.testing.assert_allclose(corners.mean(axis=1), middle, atol=1e-12)
    assert all(len(values[0]) == len(corners) for values in data.values())


def test_written_and_read_again(own, tmp_path):
    points, cells, data = points_and_cells(own[1])
    shapes = mode_shapes(full_joint(*own), own[1], 12e3, 1e9, 1e9)
    drawn = meshio.Mesh(points, cells, point_data=shapes, cell_data=data)
    drawn.write(tmp_path / "modes.vtu")
    again = meshio.read(tmp_path / "modes.vtu")
    assert again.cells[0].type == "hexahedron27"  # VTK_TRIQUADRATIC_HEXAHEDRON, 29
    assert list(again.point_data) == list(shapes)
    for name, shape in shapes.items():
        np.testing.assert_array_equal(again.point_data[name], shape)


def test_shapes_of_beam_and_joint(own):
    mesh = own[1]
    shapes = mode_shapes(full_joint(*own), mesh, 0.0, 1e9, 1e9)
    beam = mesh.node_body.values == 0
    names = list(shapes)
    assert [name.split(" at ")[0] for name in names] == ["beam"] * 12 + ["joint"] * 8
    for name, shape in shapes.items():
        assert np.linalg.norm(shape, axis=1).max() == pytest.approx(1.0)
        assert name.startswith("joint") or not shape[~beam].any()
    # six rigid motions, then bending in Z, even about mid-span
    assert all(abs(float(name.split(": ")[1][:-3])) < 1.0 for name in names[:6])
    bent = shapes[names[6]][beam]
    assert (bent[:, 2] ** 2).sum() > 0.9 * (bent**2).sum()


def test_without_elements_the_nodes_are_drawn(own):
    points, cells, _ = points_and_cells(own[1].drop_vars("element_nodes"))
    assert len(cells["vertex"]) == len(points)
