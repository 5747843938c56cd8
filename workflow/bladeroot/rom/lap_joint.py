"""The built-in lap joint as an assembly: half beams, an interface for each group of bolts."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from bladeroot.fem.lap_joint import LapJoint, half_beam, lap_joint_of, line_nodes, patch
from bladeroot.rom.bodies import Assembly, Body
from bladeroot.rom.external.assembly import interface_of


def lap_joint_assembly(data: Mapping[str, Any], where: str) -> Assembly:
    """From a structure file of kind `lap-joint`, checked; the load is the force in each bolt, N.

    Raises ValueError for a shape that cannot be, and an interface without a bolt.
    """
    joint = lap_joint_of(data, where)
    halves = [half_beam(joint, which) for which in (0, 1)]
    bodies = tuple(
        Body(name, half.mass, half.stiffness, half.geometric, half.mesh.nodes,
             np.arange(3 * len(half.mesh.nodes)).reshape(-1, 3))
        for name, half in zip(("first", "second"), halves, strict=True)
    )  # fmt: skip
    meshes = [half.mesh for half in halves]
    interfaces = []
    for name, one in data["interfaces"].items():
        bolts = [x for x, interface in joint.bolts if interface == name]
        if not bolts:
            raise ValueError(f"interface {name} has no bolt, so no contact pairs ({where})")
        pairs = _pairs(joint, meshes, bolts)
        share = {} if "tied" in one else {"preload_share": float(len(bolts))}
        interfaces.append(interface_of(name, share | dict(one), where, *pairs))
    display = np.array([(k, n) for k in (0, 1) for n in line_nodes(joint, meshes[k], k)])
    kept = data["reduction"]["modes"]
    of_load = data.get("load_range")
    return Assembly(joint.name, bodies, tuple(interfaces), display, data["modes"], kept, of_load)


def _pairs(joint: LapJoint, meshes: list, bolts: list[float]) -> tuple[np.ndarray, ...]:
    """Bodies, coincident nodes, normals and pressed areas of the patches of some bolts."""
    nodes, areas = [], []
    for x in bolts:
        (first, share), (second, _) = (patch(joint, mesh, 0.0, x, joint.cone) for mesh in meshes)
        order = [np.lexsort(np.round(m.nodes[n, :2].T * 1e7))
                 for m, n in zip(meshes, (first, second), strict=True)]  # fmt: skip
        nodes.append(np.stack([first[order[0]], second[order[1]]], axis=1))
        areas.append(share[order[0]])
    node, area = np.concatenate(nodes), np.concatenate(areas)
    normal = np.tile([0.0, 0.0, -1.0], (len(node), 1))
    return np.tile([0, 1], (len(node), 1)), node, normal, area
