"""One mode of the joint as a small system around its stuck state.

While all contacts stick the joint is linear. The force that a slipping contact fails to carry acts
on it as a load; the response is a sum over the lowest modes of the stuck and of the sliding joint,
with the static flexibility of all others added, so that local slip is as soft as in the whole
joint. Mirror images of a contact move alike, so that one of each set is kept.
"""

from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray

from bladeroot.rom.assembly import find_modes
from bladeroot.rom.joint import Joint, Operator, described

_SYMMETRY_TOLERANCE = 1e-5  # relative, of motions of mirror images and of a mode's omega^2
_SLIDING_RATIO = 1e3  # of tangential stiffness, the stuck joint's to the sliding joint's
_LEAST_MASS = 1e-8  # of a combination of shapes, relative; with less they are linearly dependent
_NODE_SHARE = 0.02  # of the mode's largest motion; less is a node, 1 mm off it is as much


@dataclass(frozen=True)
class System:
    """A mode's stuck system, reduced to one contact pair of each set of mirror images.

    values: omega^2 of the kept modes, 1/s^2, the named one first. loss: material loss factors.
    shape: relative motion of each contact (normal, along Y, along slope) per modal coordinate,
    kg^-1/2. flexibility: of the modes that are not kept, m/N, for loads on all images at once.
    laser: its motion per modal coordinate, kg^-1/2; laser_flexibility: by the modes not kept, m/N.
    count: images of each contact. stiffness: normal and tangential while stuck, N/m. image: of
    every pair, its contact and the signs (normal, along Y, along slope) of its motion against it.
    """

    mode: str
    values: Float[ndarray, " mode"]
    loss: Float[ndarray, " mode"]
    shape: Float[ndarray, "contact 3 mode"]
    flexibility: Float[ndarray, "contact 3 contact 3"]
    laser: Float[ndarray, " mode"]
    laser_flexibility: Float[ndarray, "contact 3"]
    count: Float[ndarray, " contact"]
    stiffness: Float[ndarray, "contact 2"]
    pair: Int[ndarray, " contact"]
    image: Int[ndarray, " pair"]
    sign: Float[ndarray, "pair 3"]

    @cached_property
    def tangential(self) -> tuple[ndarray, ndarray, ndarray]:
        """Responses to tangential contact loads that vary with the mode's own frequency.

        Motion of the contacts by the mode's coordinate (kg^-1/2). Their motion by each load (m/N,
        row k by load k), without the mode's own. Load on the mode (kg^-1/2) and motion of the laser
        (m/N) by each load.
        """
        size = 2 * self.count.size
        shape = self.shape[:, 1:].reshape(size, -1)
        pushed = shape * np.repeat(self.count, 2)[:, None]
        others = 1.0 / (self.values[1:] - self.values[0])
        give = self.flexibility[:, 1:][..., 1:].reshape(size, size)
        give = (give + (shape[:, 1:] * others) @ pushed[:, 1:].T).T.copy()
        at_laser = self.laser_flexibility[:, 1:].ravel()
        at_laser = at_laser + pushed[:, 1:] @ (others * self.laser[1:])
        return shape[:, 0].copy(), give, np.column_stack([-pushed[:, 0], at_laser])


def system_of(
    joint: Joint,
    point: Float[ndarray, "3"],
    mode: str,
    laser_x: float = 0.0,
    loss: float = 0.0,
    odd_force: bool = True,
) -> System:
    """The system of a named mode at (ln kn, ln kt, F).

    laser_x: m, the laser's place along the beam. loss: material loss factor of every mode.
    odd_force: whether reversed motion reverses the contact forces, as it does under constant normal
    load; without it, only images that move alike are joined. Raises ValueError if the joint is not
    stable there, or would not be with sliding flanks, if the mode is not found, or if the laser is
    off the beam or at a node of the mode.
    """
    return Place(joint, point).system(mode, laser_x, loss, odd_force)


class Place:
    """The joint at one point, stuck and with sliding flanks: what its modes' systems share.

    point: (ln kn, ln kt, F).
    """

    def __init__(self, joint: Joint, point: Float[ndarray, "3"]) -> None:
        """Nothing is computed before it is asked for."""
        self.joint, self.point = joint, point

    @cached_property
    def stuck(self) -> Operator:
        """The joint with all contacts stuck."""
        return Operator(self.joint, self.point)

    @cached_property
    def sliding(self) -> Operator:
        """The joint whose flanks slide."""
        sliding = self.point - [0.0, np.log(_SLIDING_RATIO), 0.0]
        return Operator(self.joint, sliding, f"{described(self.point)} once its flanks slide")

    def system(
        self, mode: str, laser_x: float = 0.0, loss: float = 0.0, odd_force: bool = True
    ) -> System:
        """The system of a named mode, as of `system_of`."""
        home = self._home(mode) if odd_force else None
        if home is not None:
            with suppress(ValueError):  # it is then raised for the whole joint
                made = _system(self, mode, laser_x, loss, odd_force, home)
                if made:
                    return made
        return _system(self, mode, laser_x, loss, odd_force, None)

    def _home(self, mode: str) -> int | None:
        """The symmetry sector of a mode, the same at all points; None if it is in no single one."""
        known = self.joint.homes
        if mode not in known:
            whole = self.stuck.modes([mode])
            known[mode] = home = self.stuck.sector(whole.shapes[:, 0])
            try:
                own = self.stuck.within(home).modes([mode]).values
            except ValueError:
                own = np.zeros(1)
            if not np.allclose(own, whole.values, rtol=_SYMMETRY_TOLERANCE, atol=0.0):
                known[mode] = None
        return known[mode]


def _system(
    place: Place, mode: str, laser_x: float, loss: float, odd_force: bool, sector: int | None
) -> System | None:
    """The system in a sector, or in the whole joint; None if contacts load other sectors, too."""
    joint, point, stuck = place.joint, place.point, place.stuck.within(sector)
    held = stuck.holding([mode])
    master = held[:, find_modes(joint.assembly, held, [mode])[mode]]
    laser = _laser_row(joint, mode, laser_x, master)
    rows = joint.contact
    image, sign = _images(joint, rows @ master, odd_force)
    pair = np.unique(image)
    image = np.searchsorted(pair, image)
    count = np.bincount(image).astype(float)
    # loads on a contact and all its images at once
    member = (image == np.arange(len(pair))[:, None]).astype(float)
    joined = (member @ (sign[:, :, None] * rows).reshape(len(rows), -1)).reshape(3 * len(pair), -1)
    if sector is not None and not stuck.holds(joined.T):
        return None
    loose = place.sliding.within(sector).holding([mode])
    values, shapes = _kept(stuck, joined, master, np.hstack([held, loose]))
    own = rows[pair] @ shapes
    pushed = stuck.solve(joined.T)
    pushed -= shapes @ ((joined @ shapes) / values).T
    kn, kt = np.exp(point[:2])
    weight = joint.weight[pair]
    return System(
        mode=mode,
        values=values,
        loss=np.full(len(values), loss),
        shape=own,
        flexibility=(rows[pair] @ pushed).reshape(len(pair), 3, len(pair), 3),
        laser=laser @ shapes,
        laser_flexibility=(laser @ pushed).reshape(len(pair), 3),
        count=count,
        stiffness=np.stack([kn * weight, kt * weight], axis=1),
        pair=pair,
        image=image,
        sign=sign,
    )


def _kept(
    stuck: Operator, joined: ndarray, master: ndarray, shapes: ndarray
) -> tuple[Float[ndarray, " mode"], Float[ndarray, "dof mode"]]:
    """omega^2 and shapes of the joint in the span of given shapes, the master first.

    Shapes that the joined contacts take no part in are left out. The master and every stuck mode
    among the shapes come out unchanged.
    """
    moved = joined @ shapes
    scale = np.abs(moved).max()
    shapes = shapes[:, np.abs(moved).max(axis=0) > _SYMMETRY_TOLERANCE * scale]
    weight, vectors = np.linalg.eigh(stuck.project(shapes)[0])
    good = weight > _LEAST_MASS * weight[-1]
    shapes = shapes @ (vectors[:, good] / np.sqrt(weight[good]))
    values, vectors = np.linalg.eigh(stuck.project(shapes)[1])
    shapes = shapes @ vectors
    overlap = stuck.joint.mass @ master @ shapes
    place = int(np.abs(overlap).argmax())
    order = np.append(place, np.delete(np.arange(len(values)), place))
    shapes[:, place] *= np.sign(overlap[place])
    return values[order], shapes[:, order]


def _images(joint: Joint, motion: ndarray, odd_force: bool) -> tuple[ndarray, ndarray]:
    """The first image of each pair, and the signs of its motion against that image's."""
    pairs = np.arange(len(motion))
    image, sign = pairs, np.ones((len(motion), 3))
    for other, turned in joint.mirrors:
        for parity in (1.0, -1.0) if odd_force else (1.0,):
            against = parity * turned
            if (
                np.abs(motion[other] - against * motion).max()
                < _SYMMETRY_TOLERANCE * np.abs(motion).max()
            ):
                first = np.minimum(image, image[other])
                against = against[other]
                sign = np.where((first != image)[:, None], against * sign[other], sign)
                # a pair on the mirror does not move across it
                sign[(other == pairs)[:, None] & (against < 0.0)] = 0.0
                image = first
                break
    return image, sign


def _laser_row(
    joint: Joint, mode: str, x: float, shape: Float[ndarray, " dof"]
) -> Float[ndarray, " dof"]:
    """Row of the laser: across the beam in the mode's direction, between the display nodes.

    ValueError if it stands off the beam, or where the mode's shape hardly moves.
    """
    place = joint.assembly["display_position"].values[:, 0]
    order = np.argsort(place)
    place = place[order]
    if not place[0] <= x <= place[-1]:
        raise ValueError(
            f"the laser must stand on the beam, {place[0]:g} to {place[-1]:g} m, got {x:g}"
        )
    axis = 2 if mode.endswith("B") else 1
    rows = joint.assembly["display_shape"].values[order, axis]
    after = int(np.clip(np.searchsorted(place, x), 1, len(place) - 1))
    part = (x - place[after - 1]) / (place[after] - place[after - 1])
    row = (1.0 - part) * rows[after - 1] + part * rows[after]
    share = abs(row @ shape) / np.abs(rows @ shape).max()
    if not share >= _NODE_SHARE:
        raise ValueError(
            f"the laser stands at a node of {mode}: at {x:g} m it sees {100 * share:.2g} % of the "
            f"mode's largest motion along the beam, at least {100 * _NODE_SHARE:g} % are needed"
        )
    return row
