"""A model made elsewhere is the same model: matrices out and in again, and what is refused."""

import shutil

import numpy as np
import pytest
import scipy.io
import scipy.linalg
import scipy.sparse as sp
import yaml
from bladeroot.rom.assembly import assemble
from bladeroot.rom.external.bodies import load_bodies
from bladeroot.rom.external.checks import external_checks
from bladeroot.rom.external.description import matrix_files_of, read_description, tables_of
from bladeroot.rom.external.export import export_matrices
from bladeroot.rom.external.full import full_joint_of
from bladeroot.rom.external.mesh import external_mesh
from bladeroot.rom.external.reduction import reduce_matrices
from bladeroot.rom.file import check_structure
from bladeroot.rom.full import full_frequencies, full_joint
from bladeroot.rom.reduction import reduce_structure
from dense_joint import contact_matrices
from structure_coarse import coarse_loaded

FORCE = 12e3


@pytest.fixture(scope="module")
def own():
    return coarse_loaded()


@pytest.fixture(scope="module")
def reference(own):
    return lowest(reduce_structure(*own))


@pytest.fixture(scope="module")
def exported(own, tmp_path_factory):
    folder = tmp_path_factory.mktemp("exported")
    for form in ("mtx", "hb"):
        export_matrices(*own, folder, form, form)
    return folder


@pytest.fixture
def lab(exported, tmp_path):
    """A folder of one's own with the Matrix Market files, to be changed."""
    shutil.copytree(exported / "mtx", tmp_path / "mtx")
    shutil.copy(exported / "mtx.yaml", tmp_path)
    return Lab(tmp_path)


class Lab:
    """The structure file as a dictionary, and its matrices."""

    def __init__(self, folder):
        self.folder, self.path = folder, folder / "mtx.yaml"

    def describe(self, change):
        data = yaml.safe_load(self.path.read_text())
        change(data)
        self.path.write_text(yaml.safe_dump(data, sort_keys=False))

    def matrix(self, name):
        return sp.csr_array(scipy.io.mmread(self.folder / "mtx" / name))

    def write(self, name, matrix, symmetry="symmetric"):
        file = self.folder / "mtx" / name
        scipy.io.mmwrite(file, sp.coo_array(matrix), precision=17, symmetry=symmetry)

    def edit(self, name, old, new):
        file = self.folder / "mtx" / name
        text = file.read_text()
        assert old in text
        file.write_text(text.replace(old, new, 1))

    def reduced(self):
        description = read_description(self.path)
        return reduce_matrices(description, external_mesh(description))

    def refused(self):
        with pytest.raises(ValueError, match=r"expected|must") as caught:
            self.reduced()
        assert "\n" not in str(caught.value)
        return str(caught.value)


def lowest(reduced, force=FORCE):
    """Ten lowest frequencies, from the inverse problem: the stiffest dofs do not spoil them."""
    joint = assemble(reduced, force)
    normal, tangential = contact_matrices(joint)
    stiffness = joint.stiffness.values + 1.4e9 * normal + 2.1e9 * tangential
    inverse = scipy.linalg.eigh(joint.mass.values, stiffness, eigvals_only=True)
    return 1.0 / np.sqrt(inverse[::-1][:10]) / (2 * np.pi)


@pytest.mark.parametrize("form", ["mtx", "hb"])
def test_out_and_in_again_gives_the_same_frequencies(exported, reference, form):
    description = read_description(exported / f"{form}.yaml")
    reduced = reduce_matrices(description, external_mesh(description))
    np.testing.assert_allclose(lowest(reduced), reference, rtol=1e-9)


def test_the_joint_with_all_dofs_is_the_same(own, exported):
    description = read_description(exported / "hb.yaml")
    mesh = external_mesh(description)
    full = full_joint_of(load_bodies(description, mesh), mesh)
    asked = (1.4e9, 2.1e9, [0.0, FORCE], ["1B", "2B"])
    expected = full_frequencies(full_joint(*own), *asked)
    np.testing.assert_allclose(full_frequencies(full, *asked), expected, rtol=1e-9)


def test_units_are_converted_once(lab, reference):
    """The same model in mm, N and t."""
    for body in ("beam", "Xn", "Xp"):
        lab.write(f"{body}_mass.mtx", 1e-3 * lab.matrix(f"{body}_mass.mtx"))
        lab.write(f"{body}_stiffness.mtx", 1e-3 * lab.matrix(f"{body}_stiffness.mtx"))
        rescale(lab.folder / "mtx" / f"{body}_nodes.csv", {"x": 1e3, "y": 1e3, "z": 1e3})
    name = "beam_geometric_stiffness.mtx"
    lab.write(name, 1e-3 * lab.matrix(name))
    rescale(lab.folder / "mtx" / "contact.csv", {"area": 1e6})
    lab.describe(lambda data: data.update(units="mm-N-t"))
    np.testing.assert_allclose(lowest(lab.reduced()), reference, rtol=1e-9)


def rescale(file, factors):
    header, *rows = [line.split(",") for line in file.read_text().splitlines()]
    for row in rows:
        for name, factor in factors.items():
            row[header.index(name)] = repr(factor * float(row[header.index(name)]))
    file.write_text("\n".join(",".join(row) for row in [header, *rows]) + "\n")


def test_stiffness_at_forces_instead_of_its_change(lab, reference):
    zero, slope = lab.matrix("beam_stiffness.mtx"), lab.matrix("beam_geometric_stiffness.mtx")
    forces = (6e3, 12e3, 24e3)
    for force in forces:
        lab.write(f"K{force:g}.mtx", zero + force * slope)

    def change(data):
        del data["beam"]["stiffness"], data["beam"]["geometric_stiffness"]
        data["beam"]["stiffness_at"] = [
            {"force_N": force, "stiffness": f"mtx/K{force:g}.mtx"} for force in forces
        ]

    lab.describe(change)
    np.testing.assert_allclose(lowest(lab.reduced()), reference, rtol=1e-7)
    lab.write("K24000.mtx", zero + 40e3 * slope)
    assert "changes linearly with force" in lab.refused()


def test_one_slot_mirrored(lab, reference):
    """The slot at Xp alone: pairs at Xn name its nodes, which lie mirrored there."""
    nodes = np.loadtxt(lab.folder / "mtx" / "Xp_nodes.csv", delimiter=",", skiprows=1)
    other = np.loadtxt(lab.folder / "mtx" / "Xn_nodes.csv", delimiter=",", skiprows=1)
    image = {
        int(k): 1 + int(np.argmin(np.linalg.norm(nodes[:, 1:] * [-1, 1, 1] - x, axis=1)))
        for k, *x in other
    }
    header, *rows = (lab.folder / "mtx" / "contact.csv").read_text().splitlines()
    cells = [row.split(",") for row in rows]
    for row in cells:
        row[2] = str(image[int(row[2])]) if row[0].startswith("Xn") else row[2]
    text = "\n".join([header, *(",".join(row) for row in cells)])
    (lab.folder / "mtx" / "contact.csv").write_text(text + "\n")
    lab.describe(lambda data: data["slots"].pop("Xn"))
    np.testing.assert_allclose(lowest(lab.reduced()), reference, rtol=1e-9)


@pytest.fixture
def whole(lab):
    """All bodies in one set of matrices, their nodes numbered on."""
    bodies = ("beam", "Xn", "Xp")
    parts = {
        kind: [lab.matrix(f"{body}_{kind}.mtx") for body in bodies]
        for kind in ("mass", "stiffness")
    }
    slope = lab.matrix("beam_geometric_stiffness.mtx")
    parts["geometric_stiffness"] = [slope, *(sp.csr_array(p.shape) for p in parts["mass"][1:])]
    for kind, blocks in parts.items():
        lab.write(f"all_{kind}.mtx", sp.block_diag(blocks))
    rows, fixed, first, start = ["node,x,y,z,body"], ["node"], {}, 0
    for body in bodies:
        lines = (lab.folder / "mtx" / f"{body}_nodes.csv").read_text().splitlines()[1:]
        first[body] = start
        rows += [f"{k},{line.split(',', 1)[1]},{body}" for k, line in enumerate(lines, start + 1)]
        held = lab.folder / "mtx" / f"{body}_fixed.csv"
        if held.exists():
            fixed += [str(start + int(node)) for node in held.read_text().splitlines()[1:]]
        start += len(lines)
    (lab.folder / "mtx" / "all_nodes.csv").write_text("\n".join(rows) + "\n")
    (lab.folder / "mtx" / "all_fixed.csv").write_text("\n".join(fixed) + "\n")
    header, *pairs = (lab.folder / "mtx" / "contact.csv").read_text().splitlines()
    cells = [pair.split(",") for pair in pairs]
    for row in cells:
        row[2] = str(int(row[2]) + first[row[0][:2]])
    text = "\n".join([header, *(",".join(row) for row in cells)])
    (lab.folder / "mtx" / "contact.csv").write_text(text + "\n")

    def change(data):
        del data["beam"], data["slots"]
        keys = {"nodes": "csv", "fixed": "csv", **dict.fromkeys(parts, "mtx")}
        data["whole"] = {key: f"mtx/all_{key}.{ending}" for key, ending in keys.items()}

    lab.describe(change)
    return lab


def test_one_file_of_the_whole_assembly(whole, reference):
    np.testing.assert_allclose(lowest(whole.reduced()), reference, rtol=1e-9)


def test_contact_springs_in_the_whole_assembly_are_refused(whole):
    stiffness = sp.lil_array(whole.matrix("all_stiffness.mtx"))
    stiffness[0, -1] = stiffness[-1, 0] = -1e6
    whole.write("all_stiffness.mtx", stiffness)
    text = whole.refused()
    assert "expected no contact springs" in text
    assert "between beam and Xp" in text


def test_equations_by_columns_of_the_node_table(lab, reference):
    """A renumbered beam: the columns say where each node's rows went."""
    size = lab.matrix("beam_mass.mtx").shape[0]
    order = np.random.default_rng(1).permutation(size)
    for kind in ("mass", "stiffness", "geometric_stiffness"):
        name = f"beam_{kind}.mtx"
        lab.write(name, lab.matrix(name)[order][:, order])
    place = np.argsort(order).reshape(-1, 3) + 1
    file = lab.folder / "mtx" / "beam_nodes.csv"
    header, *rows = file.read_text().splitlines()
    lines = [f"{header},dof_x,dof_y,dof_z"]
    lines += [f"{row},{a},{b},{c}" for row, (a, b, c) in zip(rows, place, strict=True)]
    file.write_text("\n".join(lines) + "\n")
    np.testing.assert_allclose(lowest(lab.reduced()), reference, rtol=1e-9)


def test_all_files_are_named_for_the_workflow(exported):
    description = read_description(exported / "hb.yaml")
    named = {path.name for path in [*tables_of(description), *matrix_files_of(description)]}
    assert named == {path.name for path in (exported / "hb").iterdir()}
    assert check_structure(exported / "hb.yaml") == "hb"


# What is told before any matrix is read, from the structure file and its tables.
@pytest.mark.parametrize(
    ("file", "old", "new", "told"),
    [
        ("contact.csv", "Xp-top", "Xp-upper", "flank must be one of"),
        ("contact.csv", "Xn-bottom,", "Xn-bottom,9999", "is no node of beam"),
        ("contact.csv", "0.7071", "-0.7071", "expected one normal for flank"),
        ("contact.csv", "beam_node", "node", "expected columns flank, beam_node"),
        ("beam_nodes.csv", "1,", "1,nan,", "expected 4 cells, got 5"),
        ("beam_nodes.csv", "\n2,", "\n1,", "node 1 stands in the table twice"),
        ("beam_nodes.csv", "\n2,-0", "\n2,x", "x must be a finite number"),
        ("Xp_fixed.csv", "node\n", "node\n99999\n", "node 99999 is not in"),
    ],
)
def test_a_fault_in_a_table_is_one_line_at_the_start(lab, file, old, new, told):
    lab.edit(file, old, new)
    with pytest.raises(ValueError, match=file) as caught:
        check_structure(lab.path)
    assert told in str(caught.value)
    assert "\n" not in str(caught.value)


def test_contact_nodes_that_do_not_coincide(lab):
    nodes = lab.folder / "mtx" / "Xp_nodes.csv"
    rescale(nodes, {"y": 1.01})
    with pytest.raises(
        ValueError, match=r"contact nodes that coincide within 0\.001 mm, got 0\.13"
    ):
        check_structure(lab.path)
    lab.describe(lambda data: data.update(contact_tolerance_mm=0.2))
    assert check_structure(lab.path) == "mtx"


def test_normals_that_point_into_the_beam(lab):
    rescale(lab.folder / "mtx" / "contact.csv", {"nx": -1.0, "nz": -1.0})
    with pytest.raises(ValueError, match="to point out of the beam, to mid-span and down"):
        check_structure(lab.path)


def test_an_origin_that_is_not_at_mid_span(lab):
    for body in ("beam", "Xn", "Xp"):
        file = lab.folder / "mtx" / f"{body}_nodes.csv"
        header, *rows = [line.split(",") for line in file.read_text().splitlines()]
        text = [",".join([row[0], repr(float(row[1]) + 0.05), *row[2:]]) for row in rows]
        file.write_text("\n".join([",".join(header), *text]) + "\n")
    with pytest.raises(ValueError, match="origin at mid-span, got flanks Xn around x = -"):
        check_structure(lab.path)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda d: d.update(units="mm-N-kg"), "units: "),
        (lambda d: d["beam"].pop("geometric_stiffness"), "stiffness and geometric_stiffness, or"),
        (lambda d: d.pop("slots"), "expected beam and slots, or whole, got beam"),
        (lambda d: d["beam"].update(mass="mtx/none.mtx"), "expected a matrix file, got none at"),
        (lambda d: d["beam"].update(nodes="mtx/none.csv"), "got none at"),
        (lambda d: d["beam"].update(mapping="mtx/b.map"), "expected a mapping ending in"),
        (lambda d: d["display_nodes"].pop(), "symmetric about mid-span"),
        (lambda d: d["display_nodes"].append(99999), "node 99999 is no node of the beam"),
    ],
)
def test_a_fault_in_the_structure_file_is_one_line(lab, change, told):
    lab.describe(change)
    with pytest.raises(ValueError, match=r"mtx\.yaml|none|b\.map") as caught:
        check_structure(lab.path)
    assert told in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("             2             1        UY", "", "equations 1, 2, 3, ... each once"),
        ("        UY\n", "      TEMP\n", "expected equation, node and one of UX"),
        (
            "             1             1        UX",
            "             1          9999        UX",
            "9999",
        ),
        ("             1        UY", "             1        UX", "one equation for each node"),
    ],
)
def test_a_mapping_of_the_wrong_shape_is_one_line(exported, tmp_path, old, new, told):
    shutil.copytree(exported / "hb", tmp_path / "hb")
    shutil.copy(exported / "hb.yaml", tmp_path)
    file = tmp_path / "hb" / "beam.mapping"
    text = file.read_text()
    assert old in text
    file.write_text(text.replace(old, new, 1))
    with pytest.raises(ValueError, match=r"beam\.mapping") as caught:
        check_structure(tmp_path / "hb.yaml")
    assert told in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_mapping_shorter_than_the_matrix(exported, tmp_path):
    shutil.copytree(exported / "hb", tmp_path / "hb")
    shutil.copy(exported / "hb.yaml", tmp_path)
    file = tmp_path / "hb" / "Xn.mapping"
    file.write_text("\n".join(file.read_text().splitlines()[:-1]) + "\n")
    description = read_description(tmp_path / "hb.yaml")
    with pytest.raises(ValueError, match=r"expected \d+ rows, as hb/Xn\.mapping says, got \d+"):
        load_bodies(description, external_mesh(description))


# What only the matrices tell.
def test_matrices_of_different_size(lab):
    lab.write("beam_mass.mtx", lab.matrix("beam_mass.mtx")[:-3, :-3])
    assert "expected matrices of one size, got" in lab.refused()


def test_a_mass_that_is_not_positive_definite(lab):
    mass = sp.lil_array(lab.matrix("beam_mass.mtx"))
    mass[4, 4] = 0.0
    lab.write("beam_mass.mtx", mass)
    text = lab.refused()
    assert "expected a positive definite mass, got 0 on the diagonal in row 5 (node 2)" in text
    assert "beam_mass.mtx" in text
    mass[4, 4] = 1e-9
    lab.write("beam_mass.mtx", mass)
    assert "expected a positive definite mass, got" in lab.refused()


def test_a_slot_that_is_not_held(lab):
    lab.describe(lambda data: data["slots"]["Xp"].pop("fixed"))
    text = lab.refused()
    assert "expected a slot that is held" in text
    assert "Xp" in text


def test_a_stiffness_that_is_singular_inside(lab):
    stiffness = sp.lil_array(lab.matrix("beam_stiffness.mtx"))
    stiffness[:, 1] = stiffness[1, :] = 0.0
    lab.write("beam_stiffness.mtx", sp.csr_array(stiffness))
    assert "contact nodes held: expected a stiffness that holds all" in lab.refused()


def test_a_mode_that_cannot_be_found(exported, monkeypatch):
    monkeypatch.setattr("bladeroot.rom.external.reduction.MODES", ("1B", "98B"))
    description = read_description(exported / "mtx.yaml")
    with pytest.raises(ValueError, match=r"no mode 98B among the lowest \d+: .*mtx\.yaml"):
        reduce_matrices(description, external_mesh(description))


def test_checks_tell_that_matrices_and_positions_do_not_belong_together(lab):
    """Y and Z exchanged in the equations of each node."""
    file = lab.folder / "mtx" / "beam_nodes.csv"
    header, *rows = file.read_text().splitlines()
    numbers = np.arange(3 * len(rows)).reshape(-1, 3)[:, [0, 2, 1]] + 1
    lines = [f"{header},dof_x,dof_y,dof_z"]
    lines += [f"{row},{a},{b},{c}" for row, (a, b, c) in zip(rows, numbers, strict=True)]
    file.write_text("\n".join(lines) + "\n")
    description = read_description(lab.path)
    checks = external_checks(description, external_mesh(description))
    assert "rigid motion of the free beam" in checks["check"].values[checks.within.values == 0]


def test_checks_hold_for_what_is_right(exported):
    description = read_description(exported / "hb.yaml")
    checks = external_checks(description, external_mesh(description))
    assert checks.within.all()
    assert checks.attrs["structure"] == "hb"
    loads = checks.residual[checks["check"] == "rigid rotation under the load of 1 N"]
    assert abs(loads).max() < 1e-9


def test_checks_tell_a_load_of_another_size(lab):
    name = "beam_geometric_stiffness.mtx"
    lab.write(name, 1e3 * lab.matrix(name))
    description = read_description(lab.path)
    checks = external_checks(description, external_mesh(description))
    failed = set(checks["check"].values[checks.within.values == 0])
    assert failed == {"rigid rotation under the load of 1 N"}
