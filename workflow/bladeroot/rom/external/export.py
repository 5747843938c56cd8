"""The built-in dovetail's full matrices as files of kind `matrices`, for other programs to read."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import scipy.sparse as sp
import xarray as xr
import yaml
from scipy.io import mmwrite

from bladeroot.fem import elasticity
from bladeroot.fem.geometry import Structure
from bladeroot.fem.mesh import FLANKS, base_nodes, body_mesh
from bladeroot.fem.prestress import materials_of
from bladeroot.rom.external.description import BODIES
from bladeroot.rom.external.equations import LABELS
from bladeroot.rom.reduction import beam_model, contact_dofs, force_stiffness

FORMS = ("mtx", "hb")


@dataclass(frozen=True)
class _Given:
    """One body's matrices, the dofs that they keep and its fixed nodes (from 1)."""

    matrices: dict[str, sp.csr_array]
    nodes: np.ndarray
    fixed: np.ndarray


def export_matrices(
    structure: Structure,
    mesh: xr.Dataset,
    prestress: xr.Dataset,
    folder: Path,
    name: str,
    form: str,
) -> None:
    """Write `<name>.yaml` and a folder `<name>` of the files that it names, in m, N and kg.

    `form` is `mtx`, Matrix Market with all degrees of freedom and the slots' fixed nodes beside
    them; or `hb`, Harwell-Boeing as HBMAT of ANSYS leaves them: fixed degrees of freedom are gone
    and a mapping file says what is left. ValueError for another form.
    """
    if form not in FORMS:
        raise ValueError(f"form must be one of {', '.join(FORMS)}, got {form!r}")
    inner = folder / name
    inner.mkdir(parents=True, exist_ok=True)
    listed = {}
    for body, given in zip(BODIES, _bodies(structure, mesh, prestress), strict=True):
        files = {"nodes": f"{body}_nodes.csv"}
        write_table(
            inner / files["nodes"],
            ("node", "x", "y", "z"),
            ((k, *map(repr, row)) for k, row in enumerate(given.nodes.tolist(), 1)),
        )
        kept = np.arange(3 * len(given.nodes))
        if form == "hb":
            kept = np.setdiff1d(kept, contact_dofs(given.fixed - 1))
            files["mapping"] = f"{body}.mapping"
            _mapping(inner / files["mapping"], kept)
        elif len(given.fixed):
            files["fixed"] = f"{body}_fixed.csv"
            write_table(inner / files["fixed"], ("node",), ((node,) for node in given.fixed))
        for kind, matrix in given.matrices.items():
            files[kind] = f"{body}_{kind}.{form}"
            write_matrix(
                inner / files[kind], sp.csr_array(matrix[kept][:, kept]), f"{name} {body} {kind}"
            )
        listed[body] = {key: f"{name}/{file}" for key, file in files.items()}
    _contact(inner / "contact.csv", mesh)
    description = {
        "name": name,
        "kind": "matrices",
        "description": f"{structure.description} (matrices of {structure.name})",
        "units": "m-N-kg",
        "beam": listed["beam"],
        "slots": {side: listed[side] for side in BODIES[1:]},
        "contact": f"{name}/contact.csv",
        "display_nodes": (mesh.display_node.values + 1).tolist(),
        "reduction": {"beam_modes": structure.beam_modes, "slot_modes": structure.slot_modes},
    }
    text = yaml.safe_dump(description, sort_keys=False, allow_unicode=True)
    (folder / f"{name}.yaml").write_text(text, encoding="utf-8")


def _bodies(structure: Structure, mesh: xr.Dataset, prestress: xr.Dataset) -> Iterable[_Given]:
    model = beam_model(structure, mesh, prestress)
    matrices = {
        "mass": elasticity.per_axis(model.mass),
        "stiffness": model.stiffness,
        "geometric_stiffness": force_stiffness(model),
    }
    yield _Given(matrices, model.mesh.nodes, np.zeros(0, dtype=np.int64))
    for which in (1, 2):
        slot, _ = body_mesh(mesh, which)
        rule, materials = elasticity.quadrature(slot), materials_of(structure, mesh, which)
        matrices = {
            "mass": elasticity.per_axis(elasticity.mass(slot, rule, materials)),
            "stiffness": elasticity.stiffness(slot, rule, materials),
        }
        yield _Given(matrices, slot.nodes, base_nodes(slot) + 1)


def write_table(path: Path, header: Iterable[str], rows: Iterable[Iterable]) -> None:
    """A table of any cells."""
    lines = [",".join(header), *(",".join(map(str, row)) for row in rows)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def _contact(path: Path, mesh: xr.Dataset) -> None:
    """Contact pairs by the nodes' numbers, which count from 1 in each body."""
    first = [int(np.argmax(mesh.node_body.values == which)) for which in range(3)]
    normal = mesh.flank_frame.values[:, 0]
    rows = (
        (
            FLANKS[flank],
            one + 1,
            other - first[1 + flank // 2] + 1,
            repr(area),
            *map(repr, normal[flank].tolist()),
        )
        for flank, (one, other), area in zip(
            mesh.pair_flank.values.tolist(),
            mesh.pair_node.values.tolist(),
            mesh.pair_weight.values.tolist(),
            strict=True,
        )
    )
    write_table(path, ("flank", "beam_node", "slot_node", "area", "nx", "ny", "nz"), rows)


def _mapping(path: Path, kept: np.ndarray) -> None:
    """Equation, node and direction, in the columns of HBMAT's mapping file."""
    lines = [f"{'Matrix Eqn':>14}{'Node':>14}{'DOF':>10}"]
    lines += [
        f"{equation:>14}{dof // 3 + 1:>14}{LABELS[dof % 3]:>10}"
        for equation, dof in enumerate(kept.tolist(), 1)
    ]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def write_matrix(path: Path, matrix: sp.csr_array, title: str) -> None:
    """Matrix Market or Harwell-Boeing text, by the ending."""
    if path.suffix == ".mtx":
        mmwrite(path, sp.coo_array(matrix), comment=title, precision=17, symmetry="symmetric")
    else:
        _write_harwell_boeing(path, matrix, title)


def _write_harwell_boeing(path: Path, matrix: sp.csr_array, title: str) -> None:
    """The lower triangle by columns (RSA), digits enough to read back the same numbers."""
    lower = sp.csc_array(sp.tril(matrix))
    lower.sort_indices()
    parts = [
        _lines(lower.indptr + 1, 8, "{:10d}"),
        _lines(lower.indices + 1, 8, "{:10d}"),
        _lines(lower.data, 3, "{:26.17E}"),
    ]
    counts = [len(part) for part in parts]
    size = lower.shape[0]
    head = [
        f"{title[:72]:<72}{'bladert':<8}",
        "".join(f"{count:14d}" for count in (sum(counts), *counts, 0)),
        f"{'RSA':<14}" + "".join(f"{count:14d}" for count in (size, size, lower.nnz, 0)),
        f"{'(8I10)':<16}{'(8I10)':<16}{'(3E26.17)':<20}",
    ]
    lines = [line for part in (head, *parts) for line in part]
    path.write_text("\n".join(lines) + "\n", encoding="ascii", errors="replace")


def _lines(values: np.ndarray, a_line: int, form: str) -> list[str]:
    fields = [form.format(value) for value in values.tolist()]
    return ["".join(fields[k : k + a_line]) for k in range(0, len(fields), a_line)]
