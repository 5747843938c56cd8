"""The shipped lap joint, on a coarse mesh and as it is, for tests."""

from functools import cache

import xarray as xr
from bladeroot.rom.bodies import Assembly, reduce_bodies
from bladeroot.rom.lap_joint import lap_joint_assembly
from bladeroot.rom.whole import parametric_structure
from bladeroot.schema import read_yaml
from bladeroot.shipped_files import structure_file

COARSE = {"span_element_mm": 60, "overlap_elements": 6, "width_elements": 1,
          "thickness_elements": 1}  # fmt: skip


def lap_data() -> dict:
    """Its file's content with a coarse mesh."""
    data = read_yaml(structure_file("lap-joint"), "assembly")
    return data | {"mesh": COARSE, "reduction": {"modes": 8}}


@cache
def lap_assembly() -> Assembly:
    """Bodies and interfaces."""
    return lap_joint_assembly(lap_data(), "lap-joint.yaml")


@cache
def lap_reduced() -> xr.Dataset:
    """`reduced.nc`."""
    return reduce_bodies(lap_assembly())


@cache
def lap_model() -> xr.Dataset:
    """`parametric.nc`."""
    return parametric_structure(lap_reduced(), {"force_kN": (0.0, 30.0)})


def lap_shipped() -> tuple[xr.Dataset, xr.Dataset]:
    """`reduced.nc` and `parametric.nc` of the shipped mesh, some seconds' work."""
    data = read_yaml(structure_file("lap-joint"), "assembly")
    reduced = reduce_bodies(lap_joint_assembly(data, "lap-joint.yaml"))
    return reduced, parametric_structure(reduced, {"force_kN": (0.0, 30.0)})
