"""The structure seen from the side: beam, pad, slots and the flanks in contact (fig. 4.2)."""

import numpy as np
import xarray as xr
from jaxtyping import Int
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from numpy import ndarray

from bladeroot.figures.style import PUBLISHED, panels

_FACES = ("#c9d6e2", "#e3e0d6", "#e3e0d6")
_DOTS = ("#5b7fa3", "#a39c84", "#a39c84")
_PAD = "#d9c08f"


def side_view(mesh: xr.Dataset) -> Figure:
    """Elements in the X-Z plane, or nodes alone: the specimen above, one root joint below."""
    drawn, axes = panels(2, 1, 7.4, 5.4, height_ratios=[1, 1.25])
    nodes = 1e3 * mesh["node_position"].values
    flanks = nodes[mesh["pair_node"].sel(pair_side="beam").values]
    front = np.isclose(flanks[:, 1], flanks[:, 1].max())
    for axis in axes[:, 0]:
        _draw_bodies(axis, mesh, nodes)
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


def _draw_bodies(axis: Axes, mesh: xr.Dataset, nodes: np.ndarray) -> None:
    if "element_nodes" in mesh:
        polygons, colours = _outlines(mesh, nodes)
        axis.add_collection(
            PolyCollection(polygons, facecolors=colours, edgecolors="#44505c", linewidths=0.35)
        )
        return
    for body, colour in enumerate(_DOTS):
        mine = nodes[mesh["node_body"].values == body]
        axis.plot(mine[:, 0], mine[:, 2], ".", color=colour, markersize=1.5, rasterized=True)


def _outlines(mesh: xr.Dataset, nodes: np.ndarray) -> tuple[np.ndarray, list[str]]:
    """Outlines of the element faces in the plane of largest Y, and their colours."""
    front = mesh["element_nodes"].values.reshape(-1, 3, 3, 3)[:, :, 2]
    shown = np.flatnonzero(np.isclose(nodes[front][..., 1], nodes[:, 1].max()).all(axis=(1, 2)))
    bodies, parts = mesh["element_body"].values[shown], mesh["element_part"].values[shown]
    colours = [_PAD if part else _FACES[body] for body, part in zip(bodies, parts, strict=True)]
    return nodes[ring(front[shown])][..., [0, 2]], colours


def ring(faces: Int[ndarray, "face 3 3"]) -> Int[ndarray, "face 8"]:
    """The eight nodes around each nine-node face."""
    i, k = np.array([(0, 0), (1, 0), (2, 0), (2, 1), (2, 2), (1, 2), (0, 2), (0, 1)]).T
    return faces[:, i, k]
