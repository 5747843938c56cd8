"""Mode shapes of the beam: undeformed in grey, deformed and coloured by displacement."""

import numpy as np
import xarray as xr
from jaxtyping import Float, Int
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from numpy import ndarray

from bladeroot.figures.structure import ring
from bladeroot.figures.style import panels

_REACH = 0.07  # largest displacement drawn, over the beam's length


def mode_shapes(mesh: xr.Dataset, shapes: xr.Dataset) -> Figure:
    """One panel a mode: bending about Y and torsion from the side, bending about Z from above."""
    names = shapes["mode"].values.astype(str)
    rows = -(-len(names) // 2)
    drawn, axes = panels(rows, 2, 7.4, 1.35 * rows + 0.3)
    drawn.set_dpi(200)  # of the elements, which would be half a megabyte as lines
    nodes = mesh["node_position"].values[mesh["node_body"].values == 0]
    elements = mesh["element_nodes"].values[mesh["element_body"].values == 0]
    scale = _REACH * np.ptp(nodes[:, 0])
    side = _faces(nodes, elements, 1, nodes[:, 1].max())
    above = _faces(nodes, elements, 2, 0.0)
    height = 1e3 * (scale + np.abs(nodes[above, 1]).max())
    for axis, name, move, hertz in zip(
        axes.flat, names, shapes["shape"].values, shapes["frequency"].values, strict=False
    ):
        seen, faces = (1, above) if name.endswith("Fz") else (2, side)
        plane = [0, seen]
        flat = nodes[:, plane][faces]
        moved = (nodes + scale * move)[:, plane][faces]
        size = np.linalg.norm(move, axis=1)[faces].mean(axis=1)
        axis.add_collection(PolyCollection(1e3 * flat, facecolors="#dcdcdc", rasterized=True))
        shape = PolyCollection(1e3 * moved, array=size, cmap="viridis", rasterized=True)
        shape.set(edgecolors="w", linewidths=0.2, clim=(0.0, 1.0))
        axis.add_collection(shape)
        axis.set_aspect("equal")
        axis.autoscale_view()
        axis.set_ylim(-height, height)
        axis.set_title(f"{name}, {hertz:.1f} Hz ({'from above' if seen == 1 else 'side'})")
    for axis in axes.flat:
        axis.set_axis_off()
    drawn.colorbar(shape, ax=axes, shrink=0.5, aspect=30, label="displacement / largest")
    return drawn


def _faces(
    nodes: Float[ndarray, "node 3"], elements: Int[ndarray, "element 27"], axis: int, value: float
) -> Int[ndarray, "face 8"]:
    """Outlines of the elements' faces, or middle planes, where one coordinate has a value."""
    found = []
    for place in (1, 2):  # a plane between two elements belongs to the first
        grid = elements.reshape(-1, 3, 3, 3).take(place, axis=1 + axis)
        flat = np.isclose(nodes[grid][..., axis], value, atol=1e-9).all(axis=(1, 2))
        found.append(ring(grid[flat]))
    return np.concatenate(found)
