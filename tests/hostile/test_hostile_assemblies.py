"""Assemblies of any bodies whose files contradict each other or nature: one line each."""

import re
import shutil

import numpy as np
import pytest
import scipy.io
import scipy.sparse as sp
import yaml
from answers import answer
from bladeroot.rom.bodies import box_of, joint_of_bodies, reduce_bodies
from bladeroot.rom.external.assembly import (
    assembly_of_matrices,
    export_assembly,
    read_assembly,
)
from bladeroot.rom.joint import exact_modes
from lap_coarse import lap_assembly, lap_data

LOAD = 1e4  # N in each bolt


def matrix(name, change):
    """Another matrix in one of the files."""

    def make(data, folder):
        path = folder / "lap" / f"{name}.mtx"
        changed = sp.coo_array(change(sp.csr_array(scipy.io.mmread(path))))
        scipy.io.mmwrite(path, changed, symmetry="symmetric", precision=17)

    return make


def table(name, change):
    """Other rows of cells in one of the tables, the header first."""

    def make(data, folder):
        path = folder / "lap" / f"{name}.csv"
        rows = [line.split(",") for line in path.read_text().splitlines()]
        path.write_text("\n".join(",".join(row) for row in change(rows)) + "\n")

    return make


def described(change):
    return lambda data, folder: change(data)


def shape(rows):
    """A mode that is known by a table; rows: motion in Z of the first half's display nodes."""

    def make(data, folder):
        nodes = data["display_nodes"]["first"]
        lines = [f"first,{nodes[k]},{z}" for k, z in enumerate(rows)]
        (folder / "shape.csv").write_text("\n".join(["body,node,z", *lines]) + "\n")
        data["modes"]["bend1"] = {"shape": "shape.csv"}

    return make


def without(one, dof=5):
    """No entry of a dof."""
    kept = sp.diags_array((np.arange(one.shape[0]) != dof).astype(float))
    return kept @ one @ kept


def exchanged(data):
    first = data["bodies"]["first"]
    first["mass"], first["stiffness"] = first["stiffness"], first["mass"]


def scaled(rows, factor):
    head, *body = rows
    return [head, *([a, *(repr(factor * float(x)) for x in xyz), *rest] for a, *xyz, rest in
                    ((row[0], *row[1:4], row[4:]) for row in body))]  # fmt: skip


CASES = {
    "a dof without stiffness": (matrix("first_stiffness", without), "body first.*dof 5 has none"),
    "no stiffness": (matrix("second_stiffness", lambda k: 0.0 * k), "body second.*singular"),
    "a negative stiffness": (matrix("first_stiffness", lambda k: -k), "positive definite"),
    "a negative mass": (matrix("first_mass", lambda m: -m), "negative entries.*first_mass.mtx"),
    "mass in grammes": (matrix("first_mass", lambda m: 1e3 * m), "first weighs .*kg/m3: units"),
    "another system of units": (described(lambda d: d.update(units="mm-N-t")), "not mm-N-t"),
    "positions in millimetres": (
        lambda d, f: [table(f"{b}_nodes", lambda rows: scaled(rows, 1e3))(d, f)
                      for b in ("first", "second")],
        "units are not m-N-kg",
    ),
    "one body in millimetres": (
        table("first_nodes", lambda rows: scaled(rows, 1e3)), "coincide within.*contact.csv"
    ),
    "a load that buckles at once": (
        matrix("first_geometric_stiffness", lambda g: -1e9 * sp.eye_array(g.shape[0])),
        "must be stable, but is not .*load of 10000",
    ),
    "mass and stiffness exchanged": (described(exchanged), "first weighs .*and stiffness exch"),
    "x and y exchanged": (
        table("first_nodes", lambda r: [r[0], *([a[0], a[2], a[1], *a[3:]] for a in r[1:])]),
        "coincide within",
    ),
    "nodes in another order": (
        table("first_nodes", lambda r: [r[0], *([a[0], *b[1:]] for a, b in
                                                zip(r[1:], r[:0:-1], strict=True))]),
        "coincide within",
    ),
    "a node twice": (table("first_nodes", lambda r: [*r[:3], r[2], *r[3:]]), "node 2 .*twice"),
    "a row of the matrix twice": (
        table("first_nodes", lambda r: [*r[:2], [*r[2][:4], *r[1][4:]], *r[3:]]), "each once"
    ),
    "a node that touches itself": (
        table("contact", lambda r: [r[0], [*r[1][:3], *r[1][1:3], *r[1][5:]], *r[2:]]),
        "a pair must have two nodes.*row 2",
    ),
    "a pair twice": (table("contact", lambda r: [*r[:3], r[2], *r[3:]]), "same pair.*row 4"),
    "a pair twice, turned round": (
        table("contact", lambda r: [*r[:3], [r[2][0], *r[2][3:5], *r[2][1:3], *r[2][5:]], *r[3:]]),
        "same pair.*row 4",
    ),
    "no pairs at all": (table("contact", lambda r: r[:1]), "expected rows below interface"),
    "a body that is not there": (
        table("contact", lambda r: [r[0], [r[1][0], "third", *r[1][2:]], *r[2:]]), "row 2"
    ),
    "loads the wrong way round": (
        described(lambda d: d.update(load_range=[30e3, 0.0])), "load_range must be .least, largest"
    ),
    "a range the wrong way round": (
        described(lambda d: d["interfaces"]["outer"].update(kn_N_per_m=[1e10, 1e8])),
        r"outer.kn_N_per_m must be .low, high., got .1e.10, 1e.08. .*lap.yaml",
    ),
    "a number that is a text": (
        described(lambda d: d["interfaces"]["outer"].update(kn_N_per_m=["1.0e7", 1e9])),
        "outer.kn_N_per_m.0: '1.0e7' is a text in YAML, a number is written as 1.0e.7",
    ),
    "tied and with a stiffness": (
        described(lambda d: d["interfaces"]["outer"].update(tied=True)),
        "interfaces.outer: .* expected: kn_N_per_m and kt_N_per_m, or tied",
    ),
    "more modes than dofs": (described(lambda d: d.update(reduction={"modes": 2000})), "2000"),
    "one point of a shape": (shape([1.0]), "moves at two places or more.*shape.csv"),
    "a shape at rest": (shape([0.0] * 5), "moves at two places or more.*shape.csv"),
    "a shape of many modes": (shape([1.0, 1.0]), "two modes of the model, numbers"),
    "a shape of no mode": (shape([1, -1, 1, -1, 1, -1, 1]), "largest MAC 0.*expected 0.7"),
}  # fmt: skip


@pytest.fixture(scope="module")
def exported(tmp_path_factory):
    folder = tmp_path_factory.mktemp("exported")
    export_assembly(lap_assembly(), lap_data() | {"description": "its own"}, folder, "lap")
    return folder


def frequencies(path):
    """From the files to named modes under load, as the stages go."""
    reduced = reduce_bodies(assembly_of_matrices(read_assembly(path)))
    point = np.append(np.log(box_of(reduced)).mean(axis=1), LOAD)
    return exact_modes(joint_of_bodies(reduced), point, ("bend1", "bend2", "bend3")).values


@pytest.mark.parametrize("case", CASES)
def test_an_assembly_that_cannot_be_is_one_line(case, exported, tmp_path):
    change, told = CASES[case]
    shutil.copytree(exported, tmp_path, dirs_exist_ok=True)
    path = tmp_path / "lap.yaml"
    data = yaml.safe_load(path.read_text())
    change(data, tmp_path)
    path.write_text(yaml.safe_dump(data))
    with pytest.raises(ValueError, match=told) as caught:
        frequencies(path)
    # of both bodies where both are wrong
    assert all(re.search(told, line) for line in str(caught.value).splitlines())


def test_a_shape_on_three_points_is_no_mode_that_moves_across_them(exported, tmp_path):
    """Of a symmetric assembly modes across move there by rounding, in any shape."""
    shutil.copytree(exported, tmp_path, dirs_exist_ok=True)
    path = tmp_path / "lap.yaml"
    data = yaml.safe_load(path.read_text())
    data["modes"] = {"bend1": data["modes"]["bend1"]}
    bend = reduce_bodies(assembly_of_matrices(read_assembly(path)))
    moved = (bend["display_shape"] @ bend["mode_shape"][0]).values
    points = (0, 2, 4)
    nodes = [data["display_nodes"]["first"][k] for k in points]
    rows = [f"first,{node},{moved[k, 2]}" for node, k in zip(nodes, points, strict=True)]
    (tmp_path / "shape.csv").write_text("\n".join(["body,node,z", *rows]) + "\n")
    data["modes"]["bend1"] = {"shape": "shape.csv"}
    path.write_text(yaml.safe_dump(data))
    reduced = reduce_bodies(assembly_of_matrices(read_assembly(path)))
    assert abs(reduced["mode_shape"] @ bend["mode_shape"][0]).values > 0.99


def test_as_it_is_the_assembly_has_its_modes(exported):
    assert len(answer(lambda: frequencies(exported / "nowhere.yaml"), "nowhere.yaml", "")) == 1
    assert np.sqrt(frequencies(exported / "lap.yaml")) / 6.2832 == pytest.approx(
        [165.7, 592.9, 1165.1], rel=1e-3
    )
