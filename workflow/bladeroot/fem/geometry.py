"""From a structure file to a frozen description in SI units.

Frame: X along the beam, Y across its width, Z through its thickness, origin at mid-span. The file
gives lengths in mm and moduli in GPa, with the unit in each key; they are converted here, once.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from bladeroot.fem.outline import MM, Edge, Point, cut, outline

GPA = 1.0e9


@dataclass(frozen=True)
class Material:
    """Isotropic linear elasticity: Young's modulus (Pa), density (kg/m^3), Poisson's ratio."""

    young: float
    density: float
    poisson: float


@dataclass(frozen=True)
class Pad:
    """A block glued to the beam's lower face at mid-span (m), as wide as the beam."""

    length: float
    thickness: float
    material: Material


@dataclass(frozen=True)
class Slot:
    """One slot: an upper and a lower jaw on a base block that is fixed at its far end (m).

    `lip` is how far the jaw reaches along X into the throat, inwards of the contact;
    `clearance` the gap between the beam's tip and the pocket; `jaw_depth` the jaw's thickness
    outwards of the pocket; `base_depth` the length of the base block along X.
    """

    lip: float
    clearance: float
    jaw_depth: float
    base_depth: float
    material: Material


@dataclass(frozen=True)
class MeshDensity:
    """Numbers of elements, and the longest element (m) on the span and towards the root."""

    width: int
    thickness: int
    span_size: float
    root_size: float
    jaw: int
    base: int


@dataclass(frozen=True)
class Structure:
    """A beam with two dovetail ends and the slots that hold them.

    `profile` is the half-profile of the beam at positive x: points (x, half-height) from mid-span
    to the tip, mirrored in X and Z; `fillets` are numbers of its corners that are rounded, and
    their radii. `flank` names the two profile points that bound the contact.
    `with_pad` says whether the joint's assembly carries the pad.
    """

    name: str
    description: str
    material: Material
    profile: tuple[Point, ...]
    fillets: tuple[tuple[int, float], ...]
    flank: tuple[int, int]
    width: float
    pad: Pad | None
    slot: Slot
    density: MeshDensity
    beam_modes: int
    slot_modes: int
    with_pad: bool


def structure_from_mapping(data: Mapping[str, Any], where: str = "structure file") -> Structure:
    """Convert a structure file's content, checked against its schema, to SI units.

    `where` is the file's name for the messages. Raises ValueError, one line, naming the key, what
    was expected and what came, for a shape that cannot be.
    """
    profile = tuple((x * MM, h * MM) for x, h in data["beam"]["profile_mm"])
    flank = tuple(data["beam"]["flank_points"])
    _check_profile(data["beam"], where)
    steel = _material(data["material"])
    pad = data.get("pad")
    if pad is None and data["loaded_case"] == "with-pad":
        raise ValueError(f"{where}: loaded_case is 'with-pad' but the file has no pad")
    slot, mesh = data["slot"], data["mesh"]
    structure = Structure(
        name=data["name"],
        description=" ".join(data["description"].split()),
        material=steel,
        profile=profile,
        fillets=_fillets(data["beam"], where),
        flank=flank,
        width=data["beam"]["width_mm"] * MM,
        pad=None
        if pad is None
        else Pad(pad["length_mm"] * MM, pad["thickness_mm"] * MM, _material(pad["material"])),
        slot=Slot(
            lip=slot["lip_mm"] * MM,
            clearance=slot["clearance_mm"] * MM,
            jaw_depth=slot["jaw_depth_mm"] * MM,
            base_depth=slot["base_depth_mm"] * MM,
            material=_material(slot["material"]) if "material" in slot else steel,
        ),
        density=MeshDensity(
            width=mesh["width_elements"],
            thickness=mesh["thickness_elements"],
            span_size=mesh["span_element_mm"] * MM,
            root_size=mesh["root_element_mm"] * MM,
            jaw=mesh["jaw_elements"],
            base=mesh["base_elements"],
        ),
        beam_modes=data["reduction"]["beam_modes"],
        slot_modes=data["reduction"]["slot_modes"],
        with_pad=data["loaded_case"] == "with-pad",
    )
    _check_room(structure, where)
    return structure


def _material(data: Mapping[str, Any]) -> Material:
    return Material(
        float(data["young_modulus_GPa"]) * GPA,
        float(data["density_kg_m3"]),
        float(data["poisson_ratio"]),
    )


def _check_profile(beam: Mapping[str, Any], where: str) -> None:
    points = beam["profile_mm"]
    if points[0][0] != 0:
        raise ValueError(f"{where}, beam/profile_mm: must start at x = 0, got {points[0][0]}")
    for k, (one, other) in enumerate(pairwise(points)):
        if other[0] <= one[0]:
            raise ValueError(
                f"{where}, beam/profile_mm: x must grow from point to point, "
                f"got {one[0]} then {other[0]} (points {k} and {k + 1})"
            )
    first, last = beam["flank_points"]
    if last != first + 1 or last > len(points) - 2:
        raise ValueError(
            f"{where}, beam/flank_points: expected two neighbouring points before the tip's edge "
            f"(0..{len(points) - 2}), got {[first, last]}"
        )
    if points[last][1] <= points[first][1]:
        raise ValueError(
            f"{where}, beam/flank_points: the half-height must grow along the flank, "
            f"got {points[first][1]} then {points[last][1]}"
        )


def _fillets(beam: Mapping[str, Any], where: str) -> tuple[tuple[int, float], ...]:
    """Corners and radii (m); no corner twice, none at an end of the flank."""
    found: dict[int, float] = {}
    for one in beam.get("fillets", []):
        point = one["point"]
        if point in found:
            raise ValueError(f"{where}, beam/fillets: point {point} must have one fillet, got two")
        if point in beam["flank_points"]:
            raise ValueError(
                f"{where}, beam/fillets: the flank's ends ({beam['flank_points']}) must stay "
                f"corners, got a fillet at point {point}"
            )
        found[point] = one["radius_mm"] * MM
    return tuple(found.items())


def _check_room(structure: Structure, where: str) -> None:
    """Fillets must fit their edges, the lip the throat, the pocket the tip, the pad the span."""
    try:
        span = profile_edges(structure)[0]
    except ValueError as error:
        raise ValueError(f"{where}, beam/fillets: {error}") from None
    profile, flank = structure.profile, structure.flank[0]
    throat = flank
    while throat > 1 and profile[throat - 1][1] <= profile[throat][1]:
        throat -= 1
    room = profile[flank][0] - profile[throat][0]
    if structure.slot.lip > room + 1e-9:
        raise ValueError(
            f"{where}, slot/lip_mm: the throat leaves room for {room / MM:.2f} mm, "
            f"got {structure.slot.lip / MM:.2f}"
        )
    pocket = jaw_inner_face(structure)[-1]
    if pocket.end[0] <= pocket.start[0]:
        raise ValueError(
            f"{where}, slot/clearance_mm: the pocket's corner would lie behind its end, "
            f"at x = {pocket.start[0] / MM:.2f} mm of {pocket.end[0] / MM:.2f}"
        )
    if structure.pad is not None and structure.pad.length / 2 >= span.end[0]:
        raise ValueError(
            f"{where}, pad/length_mm: the pad must sit on the straight span, got "
            f"{structure.pad.length / MM:.2f} mm on 2 x {span.end[0] / MM:.2f} mm"
        )


def flank_ends(structure: Structure) -> tuple[tuple[float, float], tuple[float, float]]:
    """The flank's inner and outer end (x, half-height) in m, at positive x."""
    return structure.profile[structure.flank[0]], structure.profile[structure.flank[1]]


def profile_edges(structure: Structure) -> list[Edge]:
    """The half-profile at positive x, fillets as arcs, from mid-span to the tip."""
    return outline(structure.profile, dict(structure.fillets))


def jaw_inner_face(structure: Structure) -> list[Edge]:
    """The jaw's inner face at positive x and z, from the lip to the pocket's end.

    It follows the beam's own profile from the lip to the flank (without touching it in the model:
    contact is on the flank alone), then leaves it along the flank's line up to the pocket.
    """
    slot = structure.slot
    inner, outer = flank_ends(structure)
    (x0, z0), (x1, z1) = inner, outer
    tip_x, tip_h = structure.profile[-1]
    throat = cut(cut(profile_edges(structure), x0)[0], x0 - slot.lip)[1]
    ceiling = tip_h + slot.clearance
    slope = (x1 - x0) / (z1 - z0)
    leave = (x1 + slope * (ceiling - z1), ceiling)
    end = (tip_x + slot.clearance, ceiling)
    return [*throat, Edge(inner, outer), Edge(outer, leave), Edge(leave, end)]
