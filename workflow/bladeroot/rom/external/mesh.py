"""Nodes and contact pairs of a model made elsewhere: a mesh Dataset without elements."""

import numpy as np
import xarray as xr
from jaxtyping import Int
from numpy import ndarray

from bladeroot.fem.mesh import mesh_dataset
from bladeroot.rom.external.contact import MIDSPAN_TOLERANCE, contact_pairs
from bladeroot.rom.external.description import Description
from bladeroot.rom.external.nodes import BodyNodes, body_nodes


def external_mesh(description: Description) -> xr.Dataset:
    """Nodes of beam and slots in m, their equations and the contact pairs: `mesh.nc`.

    Bodies are 0 beam, 1 slot Xn, 2 slot Xp, as in a mesh; `equation_row` counts from 0 in the
    matrices that the body is part of. Raises ValueError, one line that names file and row, for
    anything wrong in a table and for contact nodes that do not coincide.
    """
    bodies = body_nodes(description)
    starts = np.cumsum([0, *(len(body.ids) for body in bodies)])
    lengths = [len(body.row) for body in bodies]
    node = np.concatenate([body.node + s for body, s in zip(bodies, starts, strict=False)])
    made = {
        "node_position": np.concatenate([body.position for body in bodies]),
        "node_id": np.concatenate([body.ids for body in bodies]),
        "node_body": np.repeat(np.arange(3), np.diff(starts)),
        "equation_body": np.repeat(np.arange(3), lengths),
        "equation_row": np.concatenate([body.row for body in bodies]),
        "equation_node": node,
        "equation_axis": np.concatenate([body.axis for body in bodies]),
        "equation_fixed": np.concatenate([body.fixed for body in bodies]).astype(np.int8),
        **contact_pairs(description, bodies, starts),
        "display_node": _display(description, bodies[0]),
    }
    text = " ".join(description.data["description"].split())
    return mesh_dataset(made, description.data["name"], text)


def _display(description: Description, beam: BodyNodes) -> Int[ndarray, " display"]:
    """Display nodes in order of x; they must have three free displacements and be symmetric."""
    where = f"{description.path}, display_nodes"
    place = beam.places()
    found = []
    for node in description.data["display_nodes"]:
        if node not in place:
            raise ValueError(f"node {node} is no node of the beam ({where})")
        if not beam.moves_freely(place[node]):
            raise ValueError(f"node {node} must be free to move along X, Y and Z ({where})")
        found.append(place[node])
    shown = np.array(found)
    shown = shown[np.argsort(beam.position[shown, 0])]
    x = beam.position[shown, 0]
    if abs(x + x[::-1]).max() > MIDSPAN_TOLERANCE * (x[-1] - x[0]):
        worst = int(np.argmax(abs(x + x[::-1])))
        raise ValueError(
            "expected nodes symmetric about mid-span, by which modes are named even or odd, got "
            f"none at x = {-1e3 * x[worst]:.4g} mm for node {beam.ids[shown[worst]]} ({where})"
        )
    return shown
