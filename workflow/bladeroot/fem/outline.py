"""The half-profile as straight edges and arcs: corners rounded by their fillets."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Float
from numpy import ndarray

MM = 1.0e-3
_LEAST_CUT = 1e-6  # m; cuts nearer to an edge's end are none
_LEAST_HALF_TURN = 1e-3  # rad; a point of less is on a straight line and bears no fillet

Point = tuple[float, float]


@dataclass(frozen=True)
class Edge:
    """From `start` to `end` (x, half-height), x growing; about `centre` if it is an arc."""

    start: Point
    end: Point
    centre: Point | None = None

    def at(self, share: Float[ndarray, " point"]) -> Float[ndarray, "point 2"]:
        """Points at shares 0 to 1 of the edge's length."""
        start, end = np.array(self.start), np.array(self.end)
        share = share[:, None]
        if self.centre is None:
            return (1.0 - share) * start + share * end
        angle = share * self.turn
        from_centre = start - self.centre
        across = np.array([-from_centre[1], from_centre[0]])
        points = self.centre + np.cos(angle) * from_centre + np.sin(angle) * across
        return np.where(share == 1.0, end, points)  # neighbours share this node to the last bit

    @property
    def turn(self) -> float:
        """Angle of the arc (rad), positive counter-clockwise; 0 for a straight edge."""
        if self.centre is None:
            return 0.0
        (ax, az), (bx, bz) = np.array([self.start, self.end]) - self.centre
        return float(np.arctan2(ax * bz - az * bx, ax * bx + az * bz))

    def elements(self, size: float) -> int:
        """How many elements no longer than `size` along X; on an arc, none over 45 degrees."""
        along = np.ceil((self.end[0] - self.start[0]) / size - 1e-9)
        return int(max(1, along, np.ceil(abs(self.turn) / (np.pi / 4) - 1e-9)))


def outline(profile: Sequence[Point], fillets: Mapping[int, float]) -> list[Edge]:
    """Edges of a profile whose corners are rounded by radii (m), by the number of their point.

    Raises ValueError for a fillet at an end of the profile, where there is no corner, or longer
    than the edges it lies between; two fillets share the edge between them.
    """
    arcs = {point: _arc(profile, point, radius) for point, radius in sorted(fillets.items())}
    edges = []
    for k, (one, other) in enumerate(pairwise(profile)):
        start = arcs[k].end if k in arcs else one
        end = arcs[k + 1].start if k + 1 in arcs else other
        if start[0] > end[0] + 1e-9:
            near = [n for n in (k, k + 1) if n in arcs]
            radii = " and ".join(f"{fillets[n] / MM:g} mm at point {n}" for n in near)
            needed = sum(np.hypot(*np.subtract(profile[n], arcs[n].start)) for n in near)
            raise ValueError(
                f"fillets must fit between points {k} and {k + 1}, which lie "
                f"{np.hypot(*np.subtract(other, one)) / MM:.2f} mm apart: {radii} "
                f"need {needed / MM:.2f} mm"
            )
        if end[0] - start[0] > _LEAST_CUT:
            edges.append(Edge(start, end))
        if k + 1 in arcs:
            edges.append(arcs[k + 1])
    return _joined(edges)


def _arc(profile: Sequence[Point], point: int, radius: float) -> Edge:
    """The arc of a radius that touches both edges at a point of the profile."""
    if not 0 < point < len(profile) - 1:
        raise ValueError(
            f"a fillet must be at a point between the profile's ends (1..{len(profile) - 2}), "
            f"got {point}"
        )
    corner = np.array(profile[point])
    back, forth = (np.array(profile[point + step]) - corner for step in (-1, 1))
    back, forth = back / np.hypot(*back), forth / np.hypot(*forth)
    half = 0.5 * np.arccos(np.clip(back @ forth, -1.0, 1.0))
    if np.pi / 2 - half < _LEAST_HALF_TURN:
        raise ValueError(f"a fillet must be at a corner, got point {point} on a straight line")
    reach, middle = radius / np.tan(half), (back + forth) / np.hypot(*(back + forth))
    start, end, centre = (
        corner + reach * back, corner + reach * forth, corner + radius / np.sin(half) * middle
    )  # fmt: skip
    return Edge(*((float(x), float(z)) for x, z in (start, end, centre)))


def _joined(edges: list[Edge]) -> list[Edge]:
    """Edges that begin where the last one ends: an edge that its fillets use up leaves no gap."""
    whole = edges[:1]
    for edge in edges[1:]:
        whole.append(Edge(whole[-1].end, edge.end, edge.centre))
    return whole


def cut(edges: Sequence[Edge], x: float) -> tuple[list[Edge], list[Edge]]:
    """Edges before and after a position along X; the edge that lies across it in two."""
    before, after = [], []
    for edge in edges:
        if edge.end[0] <= x + _LEAST_CUT:
            before.append(edge)
        elif edge.start[0] >= x - _LEAST_CUT:
            after.append(edge)
        else:
            at = (x, _height(edge, x))
            before.append(Edge(edge.start, at, edge.centre))
            after.append(Edge(at, edge.end, edge.centre))
    return before, after


def _height(edge: Edge, x: float) -> float:
    if edge.centre is None:
        return float(np.interp(x, *zip(edge.start, edge.end, strict=True)))
    (cx, cz), (sx, sz) = edge.centre, edge.start
    # the arc bulges away from its centre: down where it turns counter-clockwise
    return float(cz - np.sign(edge.turn) * np.sqrt(np.hypot(sx - cx, sz - cz) ** 2 - (x - cx) ** 2))
