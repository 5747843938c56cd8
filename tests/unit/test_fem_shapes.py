import numpy as np
import pytest
from bladeroot.fem.mesh import build_mesh
from bladeroot.fem.shapes import beam_shapes
from bladeroot.figures.shapes import mode_shapes
from bladeroot.figures.structure import side_view
from bladeroot.figures.style import svg
from matplotlib.collections import PolyCollection
from structure_coarse import coarse_structure


@pytest.fixture(scope="module")
def drawn():
    structure = coarse_structure()
    mesh = build_mesh(structure)
    return structure, mesh, beam_shapes(structure, mesh)


def area(polygons):
    x, y = np.moveaxis(np.asarray(polygons), -1, 0)
    return abs((x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1)).sum(axis=1)) / 2


def test_shapes_are_named_ascending_and_of_size_one(drawn):
    _, _, shapes = drawn
    assert set(shapes["mode"].values) == {"1Fy", "2Fy", "3Fy", "1Fz", "2Fz", "1T"}
    assert (np.diff(shapes["frequency"]) > 0).all()
    size = np.linalg.norm(shapes["shape"], axis=2)
    np.testing.assert_allclose(size.max(axis=1), 1.0)


def test_side_view_covers_the_profile_without_a_gap(drawn):
    """The drawn faces have the profile's, the pad's and the slots' area."""
    structure, mesh, _ = drawn
    collection = next(
        c for c in side_view(mesh).axes[0].collections if isinstance(c, PolyCollection)
    )
    polygons = [path.vertices[:8] for path in collection.get_paths()]
    beam = (
        mesh["element_body"].values[
            np.isclose(
                mesh["node_position"].values[mesh["element_nodes"].values[:, 3 + 3]][:, 1],
                structure.width / 2,
            )
        ]
        == 0
    )
    x, h = np.array(structure.profile).T
    expected = 4 * np.trapezoid(h, x) + structure.pad.length * structure.pad.thickness
    assert area(polygons)[beam].sum() == pytest.approx(1e6 * expected)


def test_each_mode_has_a_panel_and_the_same_drawing_every_time(drawn):
    _, mesh, shapes = drawn
    figure = mode_shapes(mesh, shapes)
    titles = [axis.get_title() for axis in figure.axes]
    for name, hertz in zip(shapes["mode"].values, shapes["frequency"].values, strict=True):
        assert any(title.startswith(f"{name}, {hertz:.1f} Hz") for title in titles)
    assert svg(mode_shapes(mesh, shapes)) == svg(mode_shapes(mesh, shapes))
