"""The structure seen from the side: beam, pad, slots and the flanks in contact (fig. 4.2)."""

import numpy as np
import xarray as xr
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from bladeroot.figures.style import PUBLISHED, panels

_FACES = ("#c9d6e2", "#e3e0d6", "#e3e0d6")
_PAD = "#d9c08f"


def side_view(mesh: xr.Dataset) -> Figure:
    """Elements in the X-Z plane: the whole specimen above, one root joint below."""
    drawn, axes = panels(2, 1, 7.4, 5.4, height_ratios=[1, 1.25])
    nodes = 1e3 * mesh["node_position"].values
    polygons, colours = _outlines(mesh, nodes)
    flanks = nodes[mesh["pair_node"].sel(pair_side="beam").values]
    front = np.isclose(flanks[:, 1], flanks[:, 1].max())
    for axis in axes[:, 0]:
        axis.add_collection(
            PolyCollection(polygons, facecolors=colours, edgecolors="#44505c", linewidths=0.35)
        )
        axis.plot(flanks[front, 0], flanks[front, 2], ".", color=PUBLISHED, markersize=2.5)
        axis.set_aspect("equal")
        axis.set_ylabel("Z / mm")
        axis.grid(visible=False)
    whole, joint = axes[:, 0]
    low, high = nodes.min(axis=0), nodes.max(axis=0)
    whole.set_xlim(low[0] - 3, high[0] + 3)
    whole.set_ylim(low[2] - 3, high[2] + 3)
    root = flanks[flanks[:, 0] > 0]
    joint.set_xlim(root[:, 0].min() - 35, high[0] + 12)
    joint.set_ylim(-17, 17)
    joint.set_xlabel("X / mm (contact nodes in red)")
    return drawn


def _outlines(mesh: xr.Dataset, nodes: np.ndarray) -> tuple[np.ndarray, list[str]]:
    """Corner polygons of the elements that touch the plane of largest Y, and their colours."""
    elements = mesh["element_nodes"].values
    y = nodes[elements, 1]
    outer = np.isclose(y, nodes[:, 1].max())
    polygons, colours = [], []
    for index in np.flatnonzero(outer.sum(axis=1) >= 9):
        face = nodes[elements[index, outer[index]]][:, [0, 2]]
        middle = face.mean(axis=0)
        order = np.argsort(np.arctan2(*(face - middle).T[::-1]))
        ring = face[order]
        reach = np.linalg.norm(ring - middle, axis=1)
        polygons.append(ring[reach > 0.2 * reach.max()])
        body, part = int(mesh["element_body"][index]), int(mesh["element_part"][index])
        colours.append(_PAD if part else _FACES[body])
    return polygons, colours
