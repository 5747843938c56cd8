"""The shipped dovetail on a mesh so coarse that a test takes a fraction of a second."""

import copy
from pathlib import Path

import yaml
from bladeroot.fem.geometry import Structure, structure_from_mapping
from bladeroot.fem.mesh import build_mesh
from bladeroot.fem.prestress import prestress

ROOT = Path(__file__).parents[2]
DOVETAIL = yaml.safe_load((ROOT / "resources/structures/dovetail-H.yaml").read_text())
COARSE = {
    "width_elements": 1,
    "thickness_elements": 1,
    "span_element_mm": 70,
    "root_element_mm": 20,
    "jaw_elements": 1,
    "base_elements": 1,
}


def coarse_data(**changes: object) -> dict:
    """The file's content with a coarse mesh; `changes` replace top-level keys."""
    data = copy.deepcopy(DOVETAIL)
    data["mesh"] = dict(COARSE)
    data["reduction"] = {"beam_modes": 30, "slot_modes": 4}
    return data | changes


def coarse_structure(**changes: object) -> Structure:
    return structure_from_mapping(coarse_data(**changes))


def coarse_loaded(**asked: bool) -> tuple:
    """Structure, mesh (`asked` of it) and prestress, as what is made of a structure takes them."""
    structure = coarse_structure()
    mesh = build_mesh(structure, **asked)
    return structure, mesh, prestress(structure, mesh)
