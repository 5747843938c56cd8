"""Any bodies with any interfaces: closed forms, the full matrices, files out and in, bad input."""

import shutil
from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg
import scipy.sparse as sp
import yaml
from bladeroot.diagnosis.simulation.parametric import of_assembly
from bladeroot.fem import elasticity
from bladeroot.fem.lap_joint import half_beam, lap_joint_of, patch
from bladeroot.fem.linear import lowest_eigenpairs
from bladeroot.rom.bodies import (
    Assembly,
    Body,
    Interface,
    box_of,
    joint_of_bodies,
    reduce_bodies,
    telling_of_floating,
)
from bladeroot.rom.external.assembly import export_assembly
from bladeroot.rom.file import check_structure
from bladeroot.rom.joint import exact_modes, stiffness_at
from bladeroot.rom.lap_joint import lap_joint_assembly
from bladeroot.rom.parametric import ln_frequencies, solved_of
from bladeroot.rom.whole import assembly as assembly_of_file
from bladeroot.rom.whole import parametric_structure, reduced_structure
from hypothesis import given, settings
from hypothesis import strategies as st
from lap_coarse import lap_assembly, lap_data, lap_model, lap_reduced

MODES = ("bend1", "bend2", "bend3")
BOX = (1e5, 1e7)


def chain(masses, first, held=False):
    """Points along X, joined by springs of 1e7 N/m in all directions."""
    count = len(masses)
    laplace = 2.0 * np.eye(count) - np.eye(count, k=1) - np.eye(count, k=-1)
    laplace[0, 0] = 2.0 if held else 1.0
    laplace[-1, -1] = 1.0
    nodes = np.zeros((count, 3))
    nodes[:, 0] = first + np.arange(count)
    stiffness = sp.csr_array(np.kron(1e7 * laplace, np.eye(3)))
    mass = sp.csr_array(np.kron(np.diag(masses), np.eye(3)))
    dof = np.arange(3 * count).reshape(-1, 3)
    return Body(f"b{first}", mass, stiffness, None, nodes, dof)


def three_bodies(far=(BOX, BOX), kt=2e6, order=2):
    """A held chain and two free ones, an interface between each two; the last tied or not."""
    bodies = (chain([1.0] * 5, 0, held=True), chain([2.0] * 5, 10), chain([3.0] * 5, 20))
    normal, area = np.array([[1.0, 0.0, 0.0]]), np.ones(1)

    def between(name, a, b, kn, kt):
        return Interface(name, np.array([[a, b]]), np.array([[4, 0]]), normal, area, kn, kt)

    interfaces = (between("near", 0, 1, BOX, kt), between("far", 1, 2, *far))
    shown = np.array([(b, n) for b in range(3) for n in range(5)])
    return Assembly("chains", bodies, interfaces, shown, {"any": {"order": order}}, 2)


def full(assembly, k, load=0.0):
    """Mass and stiffness of all bodies with springs k, (kn, kt) by interface, unreduced."""
    bodies = assembly.bodies
    starts = np.cumsum([0, *(body.mass.shape[0] for body in bodies)])
    mass = sp.block_diag([body.mass for body in bodies], format="csr")
    parts = [b.stiffness if b.geometric is None else b.stiffness + load * b.geometric
             for b in bodies]  # fmt: skip
    whole = sp.block_diag(parts, format="lil")
    for one, (kn, kt) in zip(assembly.interfaces, k, strict=True):
        share = one.area / one.area.sum()
        for body, node, n, part in zip(one.body, one.node, one.normal, share, strict=True):
            first, second = (starts[b] + bodies[b].dof[m] for b, m in zip(body, node, strict=True))
            spring = part * (kt * np.eye(3) + (kn - kt) * np.outer(n, n))
            for rows, columns, sign in ((first, first, 1), (second, second, 1),
                                        (first, second, -1), (second, first, -1)):  # fmt: skip
                whole[np.ix_(rows, columns)] = whole[np.ix_(rows, columns)] + sign * spring
    return mass, sp.csr_array(whole)


@settings(max_examples=10, deadline=None)
@given(k=st.lists(st.floats(np.log(1e5), np.log(1e7)), min_size=3, max_size=3),
       order=st.integers(1, 5))  # fmt: skip
def test_frequencies_are_those_of_the_unreduced_bodies(k, order):
    # eight of nine or twelve fixed-interface modes are kept
    assembly = replace(three_bodies(order=order), kept=8)
    reduced = reduce_bodies(assembly)
    joint = joint_of_bodies(reduced)
    assert joint.parameters == ("kn near", "kn far", "kt far")
    # in the middle of the box, where the mode is known by its order
    middle = np.log(box_of(reduced)).mean(axis=1)
    kn, kn_far, kt_far = np.exp(middle)
    mass, stiffness = full(assembly, [(kn, 2e6), (kn_far, kt_far)])
    values = scipy.linalg.eigh(stiffness.toarray(), mass.toarray(), eigvals_only=True)
    found = exact_modes(joint, np.append(middle, 0.0), ["any"])
    assert found.values[0] == pytest.approx(values[order - 1], rel=1e-3)
    # anywhere else all frequencies
    kn, kn_far, kt_far = np.exp(k)
    mass, stiffness = full(assembly, [(kn, 2e6), (kn_far, kt_far)])
    values = scipy.linalg.eigh(stiffness.toarray(), mass.toarray(), eigvals_only=True)
    point = np.append(k, 0.0)
    own = scipy.linalg.eigh(stiffness_at(joint, point), joint.mass, eigvals_only=True)
    np.testing.assert_allclose(own[:6], values[:6], rtol=1e-3)


def test_bodies_that_contact_alone_holds_are_named_with_a_mode_that_is_not_found():
    with pytest.raises(ValueError, match=r"number 99 of .*Contact alone holds b10, b20"):
        reduce_bodies(three_bodies(order=99))
    free = replace(three_bodies(order=99), bodies=tuple(chain([1.0] * 5, k) for k in (0, 10, 20)))
    with pytest.raises(ValueError, match=r"number 99 of \d+ modes \(chains\)$"):
        reduce_bodies(free)
    held = reduce_bodies(three_bodies())
    with (
        pytest.raises(ValueError, match=r"^narrow the box\. Contact alone holds b10, b20"),
        telling_of_floating(held),
    ):
        raise ValueError("narrow the box")


def test_a_tied_interface_is_the_limit_of_a_stiff_one():
    stiff = joint_of_bodies(reduce_bodies(three_bodies(far=(1e13, 1e13))))
    tied = joint_of_bodies(reduce_bodies(three_bodies(far=(None, None))))
    assert tied.parameters == stiff.parameters == ("kn near",)
    point = np.array([np.log(1e6), 0.0])
    one, other = (exact_modes(joint, point, ["any"]).values for joint in (tied, stiff))
    np.testing.assert_allclose(one, other, rtol=1e-3)


def test_a_bolt_and_its_beam_store_nothing_in_a_rigid_motion():
    joint = lap_joint_of(lap_data(), "here")
    for which in (0, 1):
        half = half_beam(joint, which)
        rigid = elasticity.rigid_modes(half.mesh.nodes)
        scale = np.einsum("di,d,di->i", rigid, abs(half.geometric).sum(axis=1), rigid)
        for matrix in (half.geometric, half.stiffness):
            energy = np.einsum("di,di->i", rigid, matrix @ rigid)
            assert abs(energy).max() < 1e-8 * max(abs(matrix).max(), scale.max())
        assert half.mass.sum() / 3 == pytest.approx(
            7850 * (0.36 + 0.0) * 0.025 * 0.025 + 0.5 * 3 * 0.03, rel=1e-9
        )


def test_the_bolts_force_acts_along_its_axis():
    joint = lap_joint_of(lap_data(), "here")
    mesh = half_beam(joint, 0).mesh
    for x, _ in joint.bolts:
        nodes, share = patch(joint, mesh, 0.0, x, joint.cone)
        assert share.sum() == pytest.approx(1.0)
        np.testing.assert_allclose(share @ mesh.nodes[nodes, :2], [x, 0.0], atol=1e-12)


def test_the_parametric_model_is_the_full_lap_joint_within_what_reduction_leaves():
    assembly, model = lap_assembly(), lap_model()
    solved = solved_of(model)
    assert float(model["error_bound"].max()) < 1e-5
    assert float(abs(model["check_error"]).max()) < 1e-5
    rng = np.random.default_rng(5)
    for _ in range(2):
        point = rng.uniform(solved.low, solved.high)
        point[-1] = 8e3
        k = np.exp(point[:-1]).reshape(2, 2)
        mass, stiffness = full(assembly, k, load=8e3)
        values, _ = lowest_eigenpairs(stiffness, mass, 14, shift=-1e4)
        every = np.sqrt(np.maximum(values, 0.0)) / (2.0 * np.pi)
        own = np.exp(ln_frequencies(solved, point[None])[0][0])
        apart = abs(every[:, None] / own - 1.0).min(axis=0)
        assert (apart < 1e-3).all(), apart  # 8 modes of each half beam are kept


def test_a_point_that_is_none_has_no_frequency_and_spoils_no_other():
    """A search's step may go where a law has no value."""
    model = lap_model()
    solved, point = solved_of(model), model["box"].values.mean(axis=0)
    points = np.stack([point] * 3)
    points[0, 1], points[1, -1] = np.nan, np.inf
    value, slope = ln_frequencies(solved, points)
    assert not np.isfinite(value[:2]).any()
    np.testing.assert_allclose(value[2], ln_frequencies(solved, point[None])[0][0], rtol=1e-12)
    assert np.isfinite(slope[2]).all()


def test_slopes_are_those_of_differences():
    solved, h = solved_of(lap_model()), 1e-4
    point = 0.5 * (solved.low + solved.high)
    _, slope = ln_frequencies(solved, point[None])
    steps = np.diag([h, h, h, h, 100.0])
    up, down = (ln_frequencies(solved, point + sign * steps)[0] for sign in (1, -1))
    numeric = (up - down).T / (2.0 * np.diag(steps))
    np.testing.assert_allclose(slope[0], numeric, rtol=1e-4, atol=1e-10)


def test_an_assembly_that_no_load_stiffens_serves_any_load_in_any_unit():
    model = parametric_structure(reduce_bodies(three_bodies()), {"force_kN": (0.0, 30.0)})
    low, high = of_assembly(model, {}, {}, 0.005).load_range
    assert (low < -1e6, high > 1e6) == (True, True)
    solved = solved_of(model)
    points = np.tile(0.5 * (solved.low + solved.high), (2, 1))
    points[:, -1] = 0.0, 6e4  # a speed in 1/min
    value, slope = ln_frequencies(solved, points)
    np.testing.assert_allclose(value[0], value[1], atol=1e-12)
    assert not slope[:, :, -1].any()
    stiffened = parametric_structure(lap_reduced(), {"force_kN": (0.0, 30.0)})
    assert of_assembly(stiffened, {}, {}, 0.005).load_range == (0.0, 30e3)


@pytest.fixture(scope="module")
def exported(tmp_path_factory):
    folder = tmp_path_factory.mktemp("exported")
    export_assembly(lap_assembly(), lap_data(), folder, "own-lap")
    return folder / "own-lap.yaml"


def test_files_out_and_in_again_are_the_same_structure(exported):
    assert check_structure(exported, MODES) == "own-lap"
    back = reduced_structure(exported)
    for name in ("mass", "stiffness", "geometric_stiffness", "weight", "kn_box"):
        scale = abs(lap_reduced()[name].values).max()
        np.testing.assert_allclose(back[name], lap_reduced()[name], atol=1e-9 * scale)
    model = parametric_structure(back, {"force_kN": (0.0, 30.0)})
    points = np.random.default_rng(2).uniform(*model["box"].values, (20, 5))
    ours, theirs = (ln_frequencies(solved_of(one), points)[0] for one in (lap_model(), model))
    np.testing.assert_allclose(ours, theirs, atol=1e-5)


def test_modes_are_known_by_a_measured_shape(exported):
    reduced = lap_reduced()
    moved = np.einsum("daq,mq->mda", reduced["display_shape"].values, reduced["mode_shape"].values)
    assembly = assembly_of_file(exported)
    first = sum(assembly.display[:, 0] == 0)
    keys = [("first", n + 1) for n in assembly.display[:first, 1]]
    keys += [("second", n + 1) for n in assembly.display[first:, 1]]
    data = yaml.safe_load(exported.read_text())

    def described(name, shape, noise):
        z = shape[::4, 2] + noise
        rows = [f"{b},{n},{value!r}" for (b, n), value in zip(keys[::4], z.tolist(), strict=True)]
        (exported.parent / f"{name}.csv").write_text("\n".join(["body,node,z", *rows]) + "\n")
        data["modes"] = {"hum": {"shape": f"{name}.csv"}}
        data["name"] = name
        path = exported.parent / f"{name}.yaml"
        path.write_text(yaml.safe_dump(data))
        return path

    noise = 0.1 * abs(moved[1]).max() * np.random.default_rng(1).standard_normal(len(keys[::4]))
    made = reduced_structure(described("shaped", moved[1], noise))
    again = made["mode_shape"].values[0] @ made["mass"].values @ reduced["mode_shape"].values[1]
    assert again**2 == pytest.approx(1.0, abs=1e-6)
    with pytest.raises(ValueError, match=r"agrees with the shape of mode hum: largest MAC 0\.\d+"):
        reduced_structure(described("noise", 0.0 * moved[1], noise))


def _changed(**new):
    def change(data, folder):
        data.update(new)

    return change


def _unknown_interface(data, folder):
    table = folder / "own-lap/contact.csv"
    table.write_text(table.read_text().replace("\nmiddle,", "\nother,", 1))


def _no_pairs(data, folder):
    data["interfaces"]["third"] = {"kn_N_per_m": 1e9, "kt_N_per_m": 1e9}


def _apart(data, folder):
    table = folder / "own-lap/contact.csv"
    lines = table.read_text().splitlines()
    cells = lines[1].split(",")
    cells[2] = lines[2].split(",")[2]
    table.write_text("\n".join([lines[0], ",".join(cells), *lines[2:]]) + "\n")


def _range(data, folder):
    data["interfaces"]["outer"]["kn_N_per_m"] = [1e9, 1e8]


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (_unknown_interface, r"interface must be one of .*, got 'other' \(.*, row \d+\)"),
        (_no_pairs, r"interface third has no contact pairs \(.*contact\.csv\)"),
        (_apart, r"expected contact nodes that coincide within 0\.001 mm, got .*, row 2\)"),
        (_range, r"interfaces\.outer\.kn_N_per_m must be \[low, high\]"),
        (_changed(display_nodes={"third": [1]}), "display_nodes: third is not among bodies"),
        (_changed(display_nodes={"first": [999999]}), "node 999999 is not among those of body"),
        (_changed(modes={"bend1": {"order": 1}}), "knows bend1, not bend2, bend3"),
    ],
)
def test_bad_input_is_one_line(exported, tmp_path, change, told):
    shutil.copytree(exported.parent, tmp_path, dirs_exist_ok=True)
    data = yaml.safe_load(exported.read_text())
    change(data, tmp_path)
    path = tmp_path / "own-lap.yaml"
    path.write_text(yaml.safe_dump(data))
    with pytest.raises(ValueError, match=told) as caught:
        check_structure(path, MODES)
    assert "\n" not in str(caught.value)


def test_what_cannot_be_reduced_is_told():
    with pytest.raises(ValueError, match=r"modes a and b are one mode of the model"):
        reduce_bodies(replace(three_bodies(), modes={"a": {"order": 1}, "b": {"order": 1}}))
    loose = replace(three_bodies(), interfaces=three_bodies().interfaces[:1])
    with pytest.raises(ValueError, match="body b20 has no contact pairs"):
        reduce_bodies(loose)
    stretch = {"bend1": {"parity": "even", "axis": "X", "number": 2}}
    with pytest.raises(ValueError, match="mode bend1: only 0 of the lowest"):
        reduce_bodies(replace(lap_assembly(), modes=stretch))
    data = lap_data()
    data["interfaces"] = data["interfaces"] | {"spare": {"tied": True}}
    with pytest.raises(ValueError, match="interface spare has no bolt"):
        lap_joint_assembly(data, "lap-joint.yaml")
