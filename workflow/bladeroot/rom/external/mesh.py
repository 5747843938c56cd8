"""Nodes and contact pairs of a model made elsewhere: a mesh Dataset without elements."""

import numpy as np
import xarray as xr

from bladeroot.fem.mesh import FLANKS
from bladeroot.rom.external.contact import SYMMETRY, contact_pairs
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
    variables = {
        "node_position": (
            ("node", "axis"),
            np.concatenate([body.position for body in bodies]),
            {"units": "m", "long_name": "node position"},
        ),
        "node_id": (
            "node",
            np.concatenate([body.ids for body in bodies]),
            {"units": "1", "long_name": "number of the node in its table"},
        ),
        "node_body": (
            "node",
            np.repeat(np.arange(3), np.diff(starts)),
            {"units": "1", "long_name": "0: beam, 1: slot Xn, 2: slot Xp"},
        ),
        "equation_body": (
            "equation",
            np.repeat(np.arange(3), lengths),
            {"units": "1", "long_name": "body that an equation belongs to"},
        ),
        "equation_row": (
            "equation",
            np.concatenate([body.row for body in bodies]),
            {"units": "1", "long_name": "row of the matrices, from 0"},
        ),
        "equation_node": ("equation", node, {"units": "1", "long_name": "node of an equation"}),
        "equation_axis": (
            "equation",
            np.concatenate([body.axis for body in bodies]),
            {"units": "1", "long_name": "0 to 2: displacement along X, Y, Z; 3 to 5: rotation"},
        ),
        "equation_fixed": (
            "equation",
            np.concatenate([body.fixed for body in bodies]).astype(np.int8),
            {"units": "1", "long_name": "1 where it is held at zero"},
        ),
        **contact_pairs(description, bodies, starts),
        **_display(description, bodies[0]),
    }
    return xr.Dataset(
        variables,
        coords={"axis": list("XYZ"), "flank": list(FLANKS), "pair_side": ["beam", "slot"]},
        attrs={
            "structure": description.data["name"],
            "description": " ".join(description.data["description"].split()),
            "with_pad": 0,
        },
    )


def _display(description: Description, beam: BodyNodes) -> dict[str, tuple]:
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
    if abs(x + x[::-1]).max() > SYMMETRY * (x[-1] - x[0]):
        worst = int(np.argmax(abs(x + x[::-1])))
        raise ValueError(
            "expected nodes symmetric about mid-span, by which modes are named even or odd, got "
            f"none at x = {-1e3 * x[worst]:.4g} mm for node {beam.ids[shown[worst]]} ({where})"
        )
    return {
        "display_node": (
            "display",
            shown,
            {"units": "1", "long_name": "nodes along the beam that show its modes"},
        )
    }
