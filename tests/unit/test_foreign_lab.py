"""The foreign laboratory's physics in closed form, its seal, its score; it stands apart."""

import ast
import inspect
import json
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import scipy.integrate
import scipy.linalg
import xarray as xr
from bladeroot import artifacts
from foreign import tabled
from foreign_lab import (
    case,
    curves,
    design,
    effect,
    further,
    jointed_beam,
    motion,
    run,
    score,
    specimen,
)
from foreign_lab.frame import Frame, Section, matrices
from foreign_lab.laws import (
    _sliders,
    added_mass,
    force_relaxation,
    incomplete_contact,
    load_dependent_stiffness,
    normal_load_variation,
)

LAB = Path(effect.__file__).parent
STEEL = Section(20e-3, 10e-3, 2.1e11, 7800.0)


def straight(elements, length, section=STEEL):
    frame = Frame()
    nodes = [frame.node(x, 0.0, 0.0) for x in np.linspace(0, length, elements + 1)]
    for first, last in pairwise(nodes):
        frame.member(first, last, section, 1.0)
    return frame


def lowest_bending(frame, held, tension=0.0):
    """Lowest angular frequency in the X-Z plane with dofs held."""
    k, m, g = matrices(frame)
    plane = [6 * n + d for n in range(len(frame.nodes)) for d in (2, 4)]
    free = [dof for dof in plane if dof not in held]
    pick = np.ix_(free, free)
    values = scipy.linalg.eigh(k[pick] + tension * g[pick], m[pick], eigvals_only=True)
    return np.sqrt(values[0])


def test_a_clamped_beam_and_one_under_tension_have_the_analytic_frequencies():
    length, last = 0.8, 12
    stiff, line = 2.1e11 * 20e-3 * 10e-3**3 / 12, 7800 * 2e-4
    ends = {0: (2, 4), last: (2, 4)}
    held = [6 * n + d for n, dofs in ends.items() for d in dofs]
    expected = 4.730041**2 / length**2 * np.sqrt(stiff / line)
    assert lowest_bending(straight(last, length), held) == pytest.approx(expected, rel=2e-3)
    supported = [2, 6 * last + 2]
    plain = lowest_bending(straight(last, length), supported)
    pulled = lowest_bending(straight(last, length), supported, 5e3)
    ratio = np.sqrt(1 + 5e3 * length**2 / (np.pi**2 * stiff))
    assert pulled / plain == pytest.approx(ratio, rel=1e-4)


@pytest.fixture(scope="module")
def told():
    return replace(jointed_beam.draw_geometry(np.random.default_rng(3)), elements=4)


def test_the_free_beam_moves_rigidly_without_strain_and_has_its_mass(told):
    frame = jointed_beam.build(told).beam
    k, m, _ = matrices(frame)
    place = np.array(frame.nodes)
    for axis in range(3):
        move, turn = np.zeros((len(place), 6)), np.zeros((len(place), 6))
        move[:, axis] = 1.0
        turn[:, 3 + axis] = 1.0
        turn[:, :3] = np.cross(np.eye(3)[axis], place)
        for rigid in (move.ravel(), turn.ravel()):
            assert np.abs(k @ rigid).max() < 1e-9 * np.abs(k).max() * np.abs(rigid).max()
        heavy = sum(
            s.width * s.depth * s.density * np.linalg.norm(place[b] - place[a])
            for a, b, s, _ in frame.members
        )
        assert move.ravel() @ m @ move.ravel() == pytest.approx(heavy, rel=1e-12)


@pytest.fixture(scope="module")
def system(told):
    return specimen.FrameSystem(told, {"1B": 0.0, "2B": -0.2, "3B": 0.0})


@pytest.fixture(scope="module")
def made(system, told):
    """A specimen without the analyst's errors, nominal contact 1 and 1.5 GN/m."""
    point = np.log([1.0e9, 1.5e9])
    laser = {mode: float(system.laser_x[mode]) for mode in specimen.MODES}
    return specimen.Specimen("own", specimen._surfaces(system, *point), *point, laser, told)


def test_slopes_of_the_surface_are_the_contacts_parts_of_the_energy(system, made):
    point = (made.ln_kn + 0.7, made.ln_kt - 0.9, 9e3)
    normal, tangential, frequency = system.parts(*point)
    for k, surface in enumerate(made.surfaces.values()):
        found = specimen.shares(surface, *point)
        np.testing.assert_allclose(found, (normal[k], tangential[k]), rtol=2e-2)
        assert np.exp(surface.ln_frequency(*point)) == pytest.approx(frequency[k], rel=3e-5)


def stepped_loop(thresholds, u):
    """Energy of a steady cycle, each slider pushed along in small steps."""
    path = np.tile(u * np.cos(np.linspace(0, 2 * np.pi, 4001)), 2)
    force, energy = np.zeros(len(thresholds)), 0.0
    for k in range(1, len(path)):
        before, step = force, path[k] - path[k - 1]
        force = np.clip(force + step, -thresholds, thresholds)
        energy += step * (before + force).mean() / 2 * (k > 4000)
    return energy


@pytest.mark.parametrize(
    ("form", "shape"),
    [
        ("power", {"rest": 0.3, "power": 1.7}),
        ("iwan", {"rest": 0.0, "chi": -0.5, "last": 0.2}),
        ("mindlin", {"rest": 0.0}),
        ("dahl", {"rest": 0.0}),
        ("lognormal", {"rest": 0.2, "spread": 0.8}),
        ("two-patches", {"rest": 0.0, "edge": 0.3}),
    ],
)
def test_the_loss_of_sliders_is_the_area_of_their_loop(form, shape):
    thresholds = _sliders.quantiles(_sliders.INVERSE[form](shape))
    for u in (0.2, 1.3):
        area = stepped_loop(thresholds, u)
        assert _sliders.loop(thresholds, u)[1] * u**2 == pytest.approx(area, rel=5e-3)


def test_slip_laws_have_their_closed_forms():
    u = 0.4
    # Segalman: D = 4 R u^(chi + 3) / ((chi + 2)(chi + 3)), R = (1 + chi) times the sliding part
    chi, last = -0.5, 0.25
    _, energy, _ = _sliders.respond("iwan", {"rest": 0.0, "chi": chi, "last": last}, np.array([u]))
    expected = 4 * (1 + chi) * (1 - last) * u ** (chi + 3) / ((chi + 2) * (chi + 3))
    assert energy[0] * u**2 == pytest.approx(expected, rel=5e-3)
    # Mindlin: q = 1 - (1 - u)^(3/2) of stiffness 3/2 at rest, and Masing's rules
    q = 1 - (1 - u) ** 1.5
    area = u - 0.4 * (1 - (1 - u) ** 2.5)
    _, energy, _ = _sliders.respond("mindlin", {"rest": 0.0}, np.array([u]))
    assert 1.5 * energy[0] * u**2 == pytest.approx(8 * area - 4 * q * u, rel=5e-3)
    # one slider: stiffness in phase and third harmonic of its parallelogram
    one = np.ones(1)
    angle = np.arccos(1 - 2 / 2.0)
    inphase, energy, third = _sliders.loop(one, 2.0)
    assert inphase == pytest.approx((angle - np.sin(2 * angle) / 2) / np.pi, rel=1e-3)
    assert energy == pytest.approx(4 * 1.0 * (2.0 - 1.0) / 4.0)
    assert _sliders.loop(one, 0.9)[1:] == pytest.approx((0.0, 0.0), abs=1e-12)
    assert third > 0.05


def test_stiffness_of_opening_flanks_is_the_forces_first_harmonic():
    theta = np.linspace(0, 2 * np.pi, 20001)[:-1]
    for u in (0.5, 1.5, 20.0):
        x = u * np.cos(theta)
        inphase = 2 * (np.maximum(x, -1.0) * np.cos(theta)).mean() / u
        assert normal_load_variation.left("at-once", np.array([u]))[0] == pytest.approx(inphase)
        pressure = np.exp(x - u)  # its mean stays, so the mean gap moves
        rough = 2 * (pressure * np.cos(theta)).mean() / pressure.mean() / u
        assert normal_load_variation.left("rough", np.array([u]))[0] == pytest.approx(rough)


@pytest.mark.parametrize("form", sorted(load_dependent_stiffness.FORMS))
def test_every_law_over_load_has_its_slope_at_the_middle(form):
    shape = load_dependent_stiffness.FORMS[form](np.random.default_rng(1))
    step = 1e-5
    ends = load_dependent_stiffness.ln_stiffness(form, shape, 0.25, np.exp([-step, step]))
    assert np.diff(ends)[0] / (2 * step) == pytest.approx(0.25, rel=1e-4)


def test_a_rough_layer_and_a_bulk_are_compliances_in_series():
    """1/k = 1/bulk + 1/(c F): with the layer a quarter of the compliance at the middle."""
    load = np.array([0.2, 1.0, 3.0])
    found = load_dependent_stiffness.ln_stiffness("layer-and-bulk", {"layer": 1.0}, 0.25, load)
    np.testing.assert_allclose(np.exp(found), 1 / (0.75 + 0.25 / load))


@pytest.mark.parametrize("form", sorted(incomplete_contact.FORMS))
def test_every_seating_has_its_part_at_its_size_and_grows(form):
    shape = incomplete_contact.FORMS[form](np.random.default_rng(1))
    part = incomplete_contact.seated(form, shape, 4e3, np.linspace(500, 4e4, 80))
    at_size = incomplete_contact.seated(form, shape, 4e3, np.array([4e3]))[0]
    assert at_size == pytest.approx(1 - 1 / np.e)
    assert (np.diff(part) >= 0).all()
    assert part[-1] > 0.97


@pytest.mark.parametrize("form", sorted(force_relaxation.FORMS))
def test_every_relaxation_loses_its_size_a_decade_at_ten_minutes(form):
    shape = force_relaxation.FORMS[form](np.random.default_rng(1))
    ends = force_relaxation.lost(form, shape, 600 * 10 ** np.array([-1e-4, 1e-4]))
    assert np.diff(ends)[0] / 2e-4 == pytest.approx(1.0, rel=1e-3)


def test_shapes_of_a_clamped_beam_end_clamped_and_are_orthogonal():
    x = np.linspace(-0.5, 0.5, 4001)
    first, third = (added_mass.clamped(n, x) for n in (1, 3))
    assert abs(first[0]) < 1e-5
    assert abs(np.gradient(first, x)[0]) < 0.05 * abs(first).max()
    assert abs((first * third).mean()) < 2e-3 * (first**2).mean()


class Row:
    """A record with a joint of its own: what `motion` asks of one."""

    omega, start = 2 * np.pi * 400, 1e-5

    def at(self, name):
        return getattr(self, name)


def law(**hooks):
    return effect.Effect(SimpleNamespace(ID="own", SIZES=(1, 1), **hooks), "own", 1.0, {})


def test_a_linear_decay_is_exponential_and_one_with_drag_has_its_closed_form():
    t, row, loss, drag = np.linspace(0, 1, 20001), Row(), 4e-3, 1e-2
    plain = motion.free_decay(row, loss, [], t, 0.3)
    rate = loss * row.omega / 2
    envelope = row.start * row.omega * np.exp(-rate * t)
    np.testing.assert_allclose(
        plain, -envelope * np.sin(row.omega * t + 0.3), atol=1e-8 * envelope[0]
    )
    air = law(curve=lambda one, record, x: {"eta": drag * x / record.start})
    dragged = motion.free_decay(row, loss, [air], t, 0.3)
    part = drag / loss * -np.expm1(-rate * t)
    np.testing.assert_allclose(dragged, plain / (1 + part), atol=2e-6 * envelope[0])


def test_a_softening_decay_follows_the_slow_flow():
    row, loss = Row(), 3e-3
    soft = law(curve=lambda one, record, x: {"ln_f": -0.01 * (x / record.start) ** 2})
    t = np.linspace(0, 0.5, 5001)
    found = motion.free_decay(row, loss, [soft], t, 0.0)

    def flow(_, state):
        omega = row.omega * np.exp(-0.01 * np.exp(2 * state[0]))
        return [-0.5 * loss * omega, omega]

    exact = scipy.integrate.solve_ivp(flow, (0, 0.5), [0, 0], t_eval=t, rtol=1e-10, atol=1e-10).y
    omega = row.omega * np.exp(-0.01 * np.exp(2 * exact[0]))
    expected = -row.start * np.exp(exact[0]) * omega * np.sin(exact[1])
    np.testing.assert_allclose(found, expected, atol=2e-4 * row.start * row.omega)


@pytest.fixture
def drawn(made, monkeypatch):
    monkeypatch.setattr(case, "specimen", lambda *_: made)

    def draw(seed=5, **asked):
        return case.draw_case(seed, Path(), Path(), **asked)

    return draw


def test_every_form_of_every_law_gives_finite_records(drawn):
    """Of stuck and sliding joints alike; sizes at their ends."""
    pool = effect.pool(spare=True)
    assert set(pool) - set(effect.pool()) == {"temperature"}
    assert len(pool) >= 29
    base = drawn(kind="null")
    for name, module in pool.items():
        assert len(module.FORMS) >= 3, name
        for form, shape in module.FORMS.items():
            one = effect.Effect(module, form, module.SIZES[1], shape(np.random.default_rng(2)))
            for change in (one.call("stick", base.sheet) or {}).values():
                assert np.isfinite(change).all(), (name, form)
            row = case.Record(base.sheet, 0)
            digits, step = motion.raw_record(np.random.default_rng(1), row, base.bench, [one])
            assert 0 < step < 1, (name, form)
            assert np.abs(digits.astype(int)).max() > 3000, (name, form)


@pytest.mark.parametrize("form", ["power", "iwan", "mindlin", "dahl"])
def test_slip_softens_and_damps_more_with_amplitude_and_less_with_load(drawn, form):
    base = drawn(kind="null")
    module = effect.pool()["joint-slip"]
    shape = module.FORMS[form](np.random.default_rng(4)) | {"rest": 0.0}
    one = effect.Effect(module, form, 2e-3, shape)
    order = np.argsort(base.sheet.reading[base.sheet.mode == "1B"])
    rows = np.flatnonzero(base.sheet.mode == "1B")[order]
    x = np.median(base.sheet.start) * np.array([0.1, 0.3, 1.0])
    low, high = (module.curve(one, case.Record(base.sheet, k), x) for k in (rows[0], rows[-1]))
    assert (np.diff(low["ln_f"]) <= 0).all()
    assert low["ln_f"][-1] < high["ln_f"][-1] <= 0
    assert (high["eta"] >= 0).all()
    assert high["odd"][-1] > 0


def test_neither_sheet_nor_sizes_of_files_tell_what_is_hidden(drawn, tmp_path, monkeypatch):
    monkeypatch.setattr(design, "LEAST", 6)
    monkeypatch.setattr(design, "MOST", 9)
    texts = []
    for k, asked in enumerate(({"kind": "null"}, {"effect": "clipping"}, {"effect": "joint-slip"})):
        folder = tmp_path / f"{k}" / "c"
        case.write_campaign(drawn(**asked), folder)
        sizes = [path.stat().st_size for path in sorted((folder / "raw").iterdir())]
        texts.append(((folder / "records.csv").read_text(), sizes))
    assert texts[0] == texts[1] == texts[2]
    assert 6 <= len(texts[0][1]) <= 9


def test_a_truth_that_was_changed_after_sealing_is_refused(drawn, tmp_path):
    path = tmp_path / "truth.json"
    case.seal(drawn(effect="drift"), path)
    assert case.opened(path)["effects"][0]["id"] == "drift"
    path.write_text(path.read_text().replace("drift", "drag"))
    with pytest.raises(ValueError, match="not what was sealed"):
        case.opened(path)


def test_singles_are_drawn_over_all_ids_within_their_sizes(drawn):
    found = [drawn(seed, kind="single").effects[0] for seed in range(70)]
    assert len({one.id for one in found}) >= 15
    for one in found:
        low, high = one.law.SIZES
        assert low <= abs(one.size) <= high * (1 + 1e-12)


@pytest.mark.parametrize(
    "kind", ["another load", "both directions", "kept clamping", "larger amplitude", "all again"]
)
def test_further_records_are_of_the_same_specimen_and_leave_the_others(drawn, kind):
    before = drawn(effect="force-gain")
    count = len(before.sheet.mode)
    after = further.with_records(before, kind, 9e3, 4, np.random.default_rng(1))
    assert len(after.sheet.mode) > count
    fresh = np.unique(after.sheet.hold[count:]).size
    assert fresh == (np.unique(before.sheet.hold).size if kind == "all again" else 4)
    assert after.sheet.hold[count:].min() > before.sheet.hold.max()
    assert after.sheet.time[count:].min() > before.sheet.time.max()
    for name, values in before.sheet.state.items():
        np.testing.assert_array_equal(after.sheet.state[name][:count], values)
    old, new = (curves.observations(one) for one in (before, after))
    xr.testing.assert_equal(old.drop_attrs(), new.isel(record=slice(count)).drop_attrs())
    off = after.sheet.state["bias"][count:] - before.sheet.state["bias"][0]
    assert (off[after.sheet.mode[count:] == before.sheet.mode[0]] == 0.0).all()
    if kind != "all again":
        mode = after.sheet.mode[-1]
        usual = 2.0 if kind == "larger amplitude" else 1.0
        assert after.sheet.start[-1] == pytest.approx(usual * before.sheet.usual_start(mode))


def test_a_law_keeps_its_scale_where_further_records_go_beyond_the_campaign(drawn):
    """As a gauge with a bend at a part of its full load; of effects that a loop is drawn with."""
    before = drawn(effect="force-gain")
    after = further.with_records(before, "another load", 3e4, 2, np.random.default_rng(1))
    for one in (law for law in effect.pool().values() if not getattr(law, "OUTSIDE", False)):
        for form, shape in one.FORMS.items():
            made = effect.Effect(one, form, one.SIZES[0], shape(np.random.default_rng(2)))
            parts = [made.call("stick", here) or {} for here in (before.sheet, after.sheet)]
            for name, values in parts[0].items():
                np.testing.assert_allclose(parts[1][name][: len(values)], values, atol=1e-12)


def test_tests_beside_the_campaign_find_what_is_hidden_and_nothing_else(drawn):
    rng = np.random.default_rng(2)
    everything = "load cell, weighing, free-free, rig stiffness, pressure film"
    heavy = drawn(effect="added-mass")
    found = {one["measurement"]: one for one in further.facts(heavy, everything, rng)}
    assert abs(found["weighing"]["value"] - heavy.effects[0].size) < 5e-3
    assert abs(found["free-free"]["value"]) < 1e-2
    assert abs(found["pressure film"]["value"]) < 2e3
    off = drawn(effect="force-offset")
    (zero,) = (
        one for one in further.facts(off, "load cell", rng) if one["measurement"].endswith("zero")
    )
    assert abs(zero["value"]) > 500.0


def verdict(answer, *sets, **more):
    causes = [{"mechanism": one[0], "credible_set": list(one), "parameters": []} for one in sets]
    return {"answer": answer, "causes": causes, **more}


def hidden(*ids, kind="single", outside=False, kin=()):
    each = {"form": "own", "outside": outside, "kin": list(kin), "measures": {}, "size": 1.0}
    effects = [{"id": one, **each} for one in ids]
    return {"kind": kind, "effects": effects, "seed": 1}


@pytest.mark.parametrize(
    ("truth", "answer", "expected"),
    [
        (hidden("drift"), verdict("named", ["drift"]), "right, certain"),
        (hidden("drift"), verdict("named", ["clipping"]), "wrong, certain"),
        (hidden("drift", "clipping"), verdict("named", ["drift"]), "part right, certain"),
        (hidden("drift"), verdict("named", ["drift"], ["clipping"]), "wrong, certain"),
        (hidden("drift"), verdict("ambiguous", ["x", "drift"]), "ambiguous with truth"),
        (hidden("drift"), verdict("ambiguous", ["x", "y"]), "ambiguous without truth"),
        (hidden(kind="null"), verdict("nothing-missing"), "nothing missing"),
        (hidden(kind="null"), verdict("named", ["drift"]), "wrong, certain"),
        (hidden("wear", outside=True, kin=["age"]), verdict("named", ["age"]), "kin, certain"),
        (hidden("drift"), verdict("insufficient-data"), "insufficient"),
        (hidden("drift"), verdict("unexplained"), "unexplained"),
    ],
)
def test_outcomes(truth, answer, expected):
    assert score.outcome(truth, answer) == expected


def test_the_log_score_takes_stated_probabilities_and_a_name_at_its_word():
    truth = hidden("joint-slip", "drift", kind="pair")
    stated = verdict("ambiguous", probabilities={"drift+joint-slip": 0.6, "none": 0.1})
    assert score.log_score(truth, stated) == pytest.approx(np.log(0.6))
    assert score.log_score(truth, verdict("named", ["drift"])) == pytest.approx(np.log(1e-3))
    both = verdict("named", ["drift"], ["joint-slip"])
    assert score.log_score(truth, both) == pytest.approx(np.log(score.STATED))
    rows = [score.row(truth, both), score.row(hidden("drift"), verdict("unexplained"))]
    assert "| pair | 1 of 1 | 1 of 1 | 2.0 |" in score.report(rows)
    assert "| drift | 1 | " in score.report(rows)


def test_a_size_counts_in_its_stated_standard_deviations():
    truth = hidden("force-gain")
    truth["effects"][0] |= {"size": 0.2, "measures": {"gain": 0.17}}
    answer = verdict("named", ["force-gain"])
    answer["causes"][0]["parameters"] = [
        {"name": "gain", "value": 0.2, "std": 0.01},
        {"name": "other", "value": 5.0, "std": 1.0},
    ]
    [(name, off)] = score.sizes(truth, answer)
    assert (name, off) == ("force-gain", pytest.approx(3.0))


def imported(path):
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            yield from (one.name for one in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield node.module or ""
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield from (node.value,) if node.value.startswith("bladeroot") else ()


def test_only_the_runner_knows_the_product():
    for path in LAB.rglob("*.py"):
        used = [name for name in imported(path) if name.split(".")[0] == "bladeroot"]
        assert not used or path.name == "run.py", (path, used)


def test_a_case_says_the_same_twice(drawn):
    first, again = (json.dumps(case.truth(drawn(9, kind="pair"))) for _ in range(2))
    assert first == again
    assert replace(drawn(9, kind="null"), kind="null").effects == ()


def test_a_table_goes_between_its_marks_again_and_again():
    page = "before\n<!-- t -->\nold\n<!-- end of t -->\nafter\n"
    made = score.with_table(page, "t", "new")
    assert made == "before\n<!-- t -->\n\nnew\n<!-- end of t -->\nafter\n"
    assert score.with_table(made, "t", "new") == made
    with pytest.raises(ValueError, match="expected the marks"):
        score.with_table("nothing", "t", "new")


def test_the_pages_hold_the_tables_of_the_kept_results():
    assert {path: path.read_text() for path in tabled()} == tabled()


def test_stated_causes_are_those_that_the_verdict_shows():
    truth = {"effects": [{"id": "drift", "kin": ["ageing"]}]}
    shown = {"mechanism": "ageing", "probability": 0.7, "class": "time"}
    other = {"mechanism": "joint-slip", "probability": 0.2, "class": "amplitude"}
    fault = {"mechanism": "clipping", "probability": 0.99, "class": "record"}
    said = {"answer": "ambiguous", "causes": [shown, other, fault]}
    assert score.stated_causes(truth, said) == [(0.7, True), (0.2, False)]
    assert score.stated_causes(truth, said | {"answer": "nothing-missing"}) == []


def test_artifacts_in_memory_are_asked_for_as_files_are(tmp_path):
    asked = {name: inspect.signature(getattr(artifacts, name)) for name in ("load", "save")}
    with run.in_memory(False) as shelf:
        for name, own in asked.items():
            held = inspect.signature(getattr(artifacts, name))
            assert list(held.parameters) == list(own.parameters)
        whole = xr.Dataset({"kept": 1.0, "left_out": 2.0}, attrs={"campaign": "a", "simulated": 1})
        artifacts.save(whole, tmp_path / "a.nc")
        assert list(artifacts.load(tmp_path / "a.nc", {"left_out"})) == ["kept"]
    assert list(shelf) == [tmp_path / "a.nc"]


def test_the_stages_scripts_take_what_the_laboratory_gives_them(monkeypatch, tmp_path):
    given, stage = {}, run.stage

    def bound(name):
        signature = inspect.signature(stage(name))

        def bind(*args, **options):
            given[name] = signature.bind(*args, **options).arguments

        return bind

    monkeypatch.setattr(run, "stage", bound)
    run._analyse(run.ROOT / "resources" / "campaigns" / "rig", tmp_path)
    assert list(given) == ["ringdown", "integrity", "stick"]
    assert given["stick"]["output"] == tmp_path / "stick.nc"
