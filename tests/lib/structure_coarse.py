"""The shipped dovetail on a mesh so coarse that a test takes a fraction of a second."""

import copy
from pathlib import Path

import yaml
from bladeroot.fem.geometry import Structure, structure_from_mapping

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
