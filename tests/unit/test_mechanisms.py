"""Every mechanism of the catalogue: its statement is whole, its derivatives are right."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from bladeroot.mechanisms import added_mass
from bladeroot.mechanisms.catalogue import catalogue
from bladeroot.mechanisms.drift import MECHANISM as DRIFT
from bladeroot.mechanisms.mechanism import Mechanism, Parameter, Points, Records, StickEffect
from bladeroot.mechanisms.per_mode import modes_of, of_modes
from bladeroot.mechanisms.probe import probe
from bladeroot.terms import DOVETAIL
from scipy.integrate import quad
from scipy.stats import norm

FIXED = {
    "joint-slip": "amplitude", "normal-load-variation": "amplitude",
    "geometric-hardening": "amplitude", "quadratic-drag": "amplitude",
    "cubic-softening": "amplitude", "force-dependent-damping": "force-law",
    "damping-drift": "time", "ageing": "time", "crack": "time", "gauge-friction": "direction",
    "load-dependent-stiffness": "force-law", "incomplete-contact": "force-law",
    "force-gain": "force-law", "force-offset": "level", "added-mass": "level",
    "modulus-density": "level", "rig-compliance": "level", "drift": "time",
    "force-relaxation": "time", "loading-hysteresis": "direction", "clipping": "record",
    "shaker-recontact": "record", "mode-beating": "record", "mains-hum": "record",
}  # fmt: skip
RECORDS = Records(
    mode=np.array([0, 1, 0, 1]),
    force=np.array([1790.0, 5370.0, 11993.0, 23986.0]),
    sign=np.array([1.0, 1.0, -1.0, 0.0]),
    time=np.array([0.0, 400.0, 900.0, 2000.0]),
    since=np.array([0.0, 180.0, 360.0, 540.0]),
    span=2000.0,
    hold_span=540.0,
    temperature=np.array([-3.0, 0.0, 1.0, 2.0]),
)
POINTS = Points(
    mode=np.array([0, 0, 0, 1, 1, 1]),
    force=np.array([2e3, 2e3, 8e3, 2e3, 8e3, 8e3]),
    amplitude=np.array([3e-7, 2e-6, 2e-5, 1e-6, 3e-6, 1e-5]),
    loss=np.full(6, 4e-3),
)


EVERY = [form for one in catalogue() for form in one.every_form]


def of_kind(hook):
    return [one for one in EVERY if getattr(one, hook) is not None]


def named(one):
    return f"{one.id} {one.form}".strip()


def usual(mechanism):
    """Values off the prior's mean, so that nothing is zero by chance."""
    coordinates = mechanism.start + 0.3 * mechanism.std
    return mechanism.values(coordinates)[0]


def numerical(function, values, k):
    step = 1e-5 * max(abs(values[k]), 1e-9)
    up, down = values.copy(), values.copy()
    up[k], down[k] = values[k] + step, values[k] - step
    return (function(up) - function(down)) / (2.0 * step)


def test_the_fixed_ids_are_there_with_their_classes():
    found = {one.id: one.kind for one in catalogue()}
    assert {name: found.get(name) for name in FIXED} == FIXED


@pytest.mark.parametrize("mechanism", EVERY, ids=named)
def test_a_mechanism_states_all_that_a_reader_asks(mechanism):
    assert mechanism.sentence
    assert mechanism.splitter
    assert "{" not in DOVETAIL.say(mechanism.sentence + mechanism.splitter)
    for p in mechanism.parameters:
        assert p.unit
        assert p.source
        assert p.std > 0.0
        assert p.low <= p.mean <= p.high


@pytest.mark.parametrize("mechanism", of_kind("stick"), ids=named)
def test_derivatives_of_stick_effects(mechanism):
    values = usual(mechanism)
    effect = mechanism.stick(RECORDS, values)
    assert set(effect.slopes) == set(effect.changes) <= {"ln_kn", "ln_kt", "force", "ln_f"}
    for name in effect.changes:
        for k in range(values.size):
            slope = numerical(lambda v, n=name: mechanism.stick(RECORDS, v).changes[n], values, k)
            scale = np.abs(effect.changes[name]).max() / abs(values[k]) + 1e-12
            assert effect.slopes[name][:, k] == pytest.approx(slope, rel=1e-5, abs=1e-6 * scale)


@pytest.mark.parametrize("mechanism", of_kind("curve"), ids=named)
def test_derivatives_of_curve_effects(mechanism):
    values = usual(mechanism)
    effect = mechanism.curve(POINTS, values)
    for name in ("ln_f", "loss"):
        for k in range(values.size):
            slope = numerical(lambda v, n=name: getattr(mechanism.curve(POINTS, v), n), values, k)
            given = getattr(effect, f"{name}_slope")[:, k]
            scale = np.abs(getattr(effect, name)).max() / abs(values[k]) + 1e-30
            assert given == pytest.approx(slope, rel=2e-3, abs=1e-3 * scale)


@pytest.mark.parametrize(
    "mechanism", [one for one in EVERY if any(p.ratio for p in one.parameters)], ids=named
)
def test_a_third_mode_has_ratios_of_its_own(mechanism):
    """The second mode's law with other numbers; one and two modes keep theirs; slopes follow."""
    whole = of_modes(mechanism, 3)
    plain = [p.name for p in mechanism.parameters]
    own = [p.name for p in mechanism.parameters if p.ratio]
    assert [p.name for p in whole.parameters] == [*plain, *(f"{name}_3" for name in own)]
    assert of_modes(mechanism, 2).parameters == mechanism.parameters
    assert modes_of(mechanism, {p.name for p in whole.parameters}) == 3
    values = np.concatenate([usual(mechanism), 1.7 * np.ones(len(own))])
    third = usual(mechanism)
    third[[plain.index(name) for name in own]] = 1.7
    given = POINTS if mechanism.curve else RECORDS
    wide = replace(given, mode=np.where(given.mode == 1, 2, 0))

    def law(one, rows, at):
        if one.stick is not None:
            effect = one.stick(rows, at)
            return effect.changes["ln_f"], effect.slopes["ln_f"]
        if one.curve is None:
            return one.damping(rows, at)
        effect = one.curve(rows, at)
        return np.stack([effect.ln_f, effect.loss]), np.stack(
            [effect.ln_f_slope, effect.loss_slope]
        )

    made, slope = law(whole, wide, values)
    np.testing.assert_allclose(made, law(mechanism, given, third)[0], rtol=1e-12)
    usually = law(mechanism, given, usual(mechanism))[0]
    np.testing.assert_allclose(law(whole, given, values)[0], usually, rtol=1e-12)
    for k in range(values.size):
        by_difference = numerical(lambda v: law(whole, wide, v)[0], values, k)
        scale = np.abs(made).max() / abs(values[k]) + 1e-30
        assert slope[..., k] == pytest.approx(by_difference, rel=2e-3, abs=1e-3 * scale)


def test_slip_begins_at_a_threshold_that_grows_with_the_force():
    slip = next(one for one in catalogue() if one.id == "joint-slip")
    values = np.array([0.02, 1.0, 1e-9, 0.5, 1.0, 1e-6])
    threshold = values[2] * 8e3
    around = np.array([0.5, 0.99, 1.01, 2.0]) * threshold
    one = np.ones(4)
    points = Points(np.zeros(4, int), 8e3 * one, around, 4e-3 * one)
    effect = slip.curve(points, values)
    assert np.all(effect.loss[:2] == 0.0)
    assert np.all(effect.ln_f[2:] < 0.0)
    # A slider's greatest loss, 1/pi of its stiffness, is at twice the threshold (eq. 3.19), where
    # it has lost half of it; both are counted over the stiffness that is left.
    left = 1.0 - 0.5 * 0.02
    assert effect.loss[3] == pytest.approx((0.02 / np.pi + 4e-3) / left - 4e-3, rel=1e-6)
    assert effect.ln_f[3] == pytest.approx(0.5 * np.log(left), rel=1e-6)


SLIDERS = [one for one in EVERY if any(p.name == "threshold" for p in one.parameters)]


@pytest.mark.parametrize("law", SLIDERS, ids=named)
def test_no_slider_of_a_sum_is_seen_by_itself(law):
    """A kink of the loss at each slider would be a false maximum of a fit of the threshold."""
    amplitude = np.exp(np.arange(-18.0, -9.0, 0.02))
    one = np.ones(amplitude.size)
    points = Points(np.zeros(one.size, int), 12e3 * one, amplitude, 3e-3 * one)
    effect = law.curve(points, law.values(law.start)[0])
    threshold = [p.name for p in law.parameters].index("threshold")
    for slope in (effect.loss_slope[:, threshold], effect.ln_f_slope[:, threshold]):
        assert np.abs(np.diff(slope)).max() < 0.25 * np.ptp(slope)


def test_a_steep_density_of_thresholds_is_smooth_too():
    """Segalman's power of -0.8: what is lost grows as the amplitude to 0.2."""
    iwan = next(one for one in EVERY if one.form == "Iwan")
    amplitude = np.exp(np.arange(-18.0, -12.0, 0.02))
    one = np.ones(amplitude.size)
    points = Points(np.zeros(one.size, int), 12e3 * one, amplitude, 3e-3 * one)
    lost = -iwan.curve(points, np.array([1e-3, 1.0, 1e-9, 0.5, 1.0, -0.8, 0.0])).ln_f
    power = np.diff(np.log(lost)) / 0.02
    np.testing.assert_allclose(power, 0.2, atol=4e-3)


@pytest.mark.parametrize("below", [0.5, 1.5, 2.5])
def test_slip_of_uneven_pressure_begins_smoothly(below):
    """Where the first edges slip, the loss is the integral over the thresholds."""
    share, threshold, spread = 0.02, 1e-9, 0.4
    slip = next(one for one in catalogue() if one.id == "joint-slip")
    z = -below * spread
    one = np.ones(1)
    points = Points(np.zeros(1, int), 8e3 * one, threshold * 8e3 * np.exp(z) * one, 4e-3 * one)
    effect = slip.curve(points, np.array([share, 1.0, threshold, 0.5, 1.0, spread]))

    def loss(t):
        ratio = np.exp(z - spread * t)
        return norm.pdf(t) * 4.0 / np.pi * (ratio - 1.0) / ratio**2 if ratio > 1.0 else 0.0

    lost = -np.expm1(2.0 * effect.ln_f[0])
    exact = share * quad(loss, -12.0, z / spread, epsabs=0.0, epsrel=1e-9)[0]
    assert effect.loss[0] == pytest.approx((exact + 4e-3) / (1.0 - lost) - 4e-3, rel=0.02)


def law_of_form(name, form):
    return next(one for one in catalogue() if one.id == name).of_form(form)


def masing(backbone, amplitude):
    """First-harmonic stiffness and loss of Masing's loop about a backbone of unit stiffness."""
    angle = np.linspace(0.0, np.pi, 4001)
    x = amplitude * np.cos(angle)
    force = backbone(amplitude) - 2.0 * backbone(0.5 * (amplitude - x))
    weights = [np.cos(angle), -np.sin(angle)]
    return tuple(2.0 / np.pi / amplitude * np.trapezoid(force * w, angle) for w in weights)


@pytest.mark.parametrize("ratio", [0.01, 0.1, 0.5, 0.9, 3.0])
@pytest.mark.parametrize(
    ("form", "shape", "backbone"),
    [
        ("Cattaneo-Mindlin", [0.5], lambda x: 2 / 3 * (1 - np.maximum(1 - x, 0) ** 1.5)),
        ("Iwan", [0.0, 1e-9], lambda x: np.where(x < 1, x - 0.5 * x**2, 0.5)),
    ],
)
def test_slip_laws_are_masings_loops_about_their_backbones(form, shape, backbone, ratio):
    """Mindlin's sphere under a tangential force, Iwan's even density of thresholds."""
    share, force = 1e-3, 12e3
    at = np.array([ratio * 1e-9 * force])
    points = Points(np.zeros(1, int), np.full(1, force), at, np.zeros(1))
    effect = law_of_form("joint-slip", form).curve(
        points, np.array([share, 1.0, 1e-9, 1.0, 1.0, *shape])
    )
    stiffness, loss = masing(backbone, ratio)
    left = np.exp(2.0 * effect.ln_f[0])
    assert (1.0 - left) / share == pytest.approx(1.0 - stiffness, rel=0.02, abs=1e-4)
    assert effect.loss[0] * left / share == pytest.approx(abs(loss), rel=0.03)


def test_a_zero_that_creeps_comes_to_rest_and_without_time_is_a_constant():
    (one,) = (one for one in catalogue() if one.id == "force-offset")
    law = one.of_form("creeping").stick
    values = np.array([2000.0, -0.2, 0.3])
    off = law(RECORDS, values).changes["force"]
    assert off[0] == pytest.approx(1600.0)
    assert (np.diff(off) > 0.0).all()
    assert (np.diff(off)[1:] / np.diff(RECORDS.time)[1:] < np.diff(off)[0] / 400.0).all()
    still = replace(RECORDS, time=np.zeros(4), span=0.0)
    assert law(still, values).changes["force"] == pytest.approx(1600.0)


@pytest.mark.parametrize("form", ["steady", "ever faster"])
def test_a_crack_lowers_each_mode_by_its_own_part(form):
    """With every clamping, and by as much from the first to the last in either form."""
    (one,) = (one for one in catalogue() if one.id == "crack")
    none = np.zeros(12)
    rows = Records(
        np.repeat([0, 1], 6), none, none, np.tile(np.arange(6.0), 2), none, span=5.0, hold_span=0.0
    )
    ln_f = one.of_form(form).stick(rows, np.array([4e-3, 0.5])).changes["ln_f"].reshape(2, 6)
    assert (np.diff(ln_f, axis=1) < 0.0).all()
    assert ln_f[:, 0] - ln_f[:, -1] == pytest.approx([4e-3, 2e-3])


def test_contact_that_ages_with_time_gains_as_much_in_each_decade_after_a_rest():
    (family,) = (one for one in catalogue() if one.id == "ageing")
    at = replace(RECORDS, time=np.array([0.0, 9.0, 99.0, 999.0]), span=999.0)
    change = family.of_form("kn and kt, with time").stick(at, np.array([0.3, 1.0 / 999.0])).changes
    assert np.diff(change["ln_kn"]) == pytest.approx([0.1, 0.1, 0.1])
    assert (change["ln_kt"] == change["ln_kn"]).all()
    still = replace(RECORDS, time=np.zeros(4), span=0.0)
    alone = family.of_form("kt, with time").stick(still, np.array([0.3, 0.1])).changes
    assert set(alone) == {"ln_kt"}
    assert np.ptp(alone["ln_kt"]) == 0.0


def test_a_relaxation_from_the_setting_has_lost_some_at_the_first_record():
    (family,) = (one for one in catalogue() if one.id == "force-relaxation")
    at = replace(RECORDS, since=np.array([0.0, 540.0, 0.0, 540.0]), force=np.full(4, 1e4))
    law = family.of_form("logarithmic, from the setting").stick
    lost = -law(at, np.array([0.02, 1e-3, 60.0])).changes["force"]
    assert lost[:2] == pytest.approx([200.0 * np.log10(6e4), 200.0 * np.log10(6e5)], rel=1e-3)


def test_forms_of_a_load_law_have_one_slope_and_one_seating_force():
    """The first parameter means the same in every form."""
    at = replace(RECORDS, force=np.array([11990.0, 12010.0, 3e3, 4e3]))
    for form, power in (("power", ()), ("layer in series with the bulk", (0.7,))):
        law = law_of_form("load-dependent-stiffness", form)
        change = law.stick(at, np.array([0.4, 0.0, *power]))
        ln_k = change.changes["ln_kn"]
        slope = (ln_k[1] - ln_k[0]) / np.log(12010.0 / 11990.0)
        assert slope == pytest.approx(0.4, rel=1e-3)
    for form, bent in (("exponential", 0.0), ("logistic", 0.0), ("threshold", 0.15)):
        one = law_of_form("incomplete-contact", form)
        share = np.exp(one.stick(at, np.array([4e3, 1.0])).changes["ln_kn"][3])
        assert share == pytest.approx(1.0 - np.exp(-1.0), rel=1e-6 + bent)


def test_forms_of_a_relaxation_lose_the_same_a_decade_at_ten_minutes():
    """Of the time since the clamping: the first record is one time constant, or two minutes, later.

    The parameters but the first are the priors' means.
    """
    (family,) = (one for one in catalogue() if one.id == "force-relaxation")
    for one in family.every_form:
        values = np.array([0.02, *one.values(one.start)[0][1:]])
        since = 600.0 * np.exp([-1e-4, 1e-4, -1e-4, 1e-4]) - 120.0
        at = replace(RECORDS, since=since, force=np.full(4, 1e4))
        change = one.stick(at, values).changes["force"]
        assert (change[0] - change[1]) / 2e-4 == pytest.approx(1e4 * 0.02 / np.log(10.0), rel=1e-3)


def test_forms_of_a_gauge_have_one_gain_at_12_kn():
    (family,) = (one for one in catalogue() if one.id == "force-gain")
    at = replace(RECORDS, force=np.full(4, 12e3))
    for one in family.every_form:
        values = np.array([0.1, *one.values(one.start)[0][1:]])
        assert one.stick(at, values).changes["force"] == pytest.approx(1200.0), one.form


def test_a_share_is_bounded_by_what_the_simulation_has():
    slip = law_of_form("joint-slip", "Iwan")
    tied = slip.tied({"tangential": (0.02, 0.04)}, {"tangential": 0.0})
    share, ratio = tied.parameters[:2]
    assert share.value(50.0) == pytest.approx(share.high) == pytest.approx(1.5 * 0.02)
    assert ratio.mean == pytest.approx(2.0)
    wide = slip.tied({"tangential": (0.02, 0.04)}, {"tangential": 1.0}).parameters[0]
    assert wide.high == pytest.approx(0.03 * np.exp(2.0))
    assert slip.tied({}, {}).parameters == slip.parameters
    third = of_modes(slip, 3).tied({"tangential": (0.02, 0.04, 0.01)}, {"tangential": 0.0})
    ratios = {p.name: p.mean for p in third.parameters if p.ratio and p.tie}
    assert ratios == pytest.approx({"share_ratio": 2.0, "share_ratio_3": 0.5})


def test_a_users_file_joins_and_may_replace(tmp_path):
    text = (
        "from dataclasses import replace\n"
        "from bladeroot.mechanisms.force_gain import MECHANISM as GAIN\n"
        "MECHANISM = replace(GAIN, id='{}')\n"
    )
    (tmp_path / "own.py").write_text(text.format("wrong-piston"))
    (tmp_path / "other.py").write_text(text.format("force-gain"))
    ids = [one.id for one in catalogue(tmp_path)]
    assert ids == sorted({*(one.id for one in catalogue()), "wrong-piston"})


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("X = 1\n", "expected MECHANISM"),
        ("1 / 0\n", "ZeroDivisionError"),
        ("x = (\n", "expected Python"),
    ],
)
def test_a_users_bad_file_is_one_line(tmp_path, content, message):
    (tmp_path / "own.py").write_text(content)
    with pytest.raises(ValueError, match=message) as error:
        catalogue(tmp_path)
    assert "own.py" in str(error.value)


def test_a_missing_folder_is_named(tmp_path):
    with pytest.raises(ValueError, match="folder of mechanisms not found"):
        catalogue(tmp_path / "none")


@pytest.mark.parametrize(
    ("law", "message"),
    [
        ("{'ln_freq': 0.0 * r.force}, {'ln_freq': 0.0 * r.force[:, None]}", "must both be of"),
        pytest.param(
            "{'ln_f': 0.0 * r.force}, {'ln_f': 0.0 * r.force}",
            r"expected shape \(4, 1\)",
            marks=pytest.mark.wrong_shape,
        ),
        ("{'ln_f': np.nan * r.force}, {'ln_f': 0.0 * r.force[:, None]}", "expected finite"),
        ("{'ln_f': v * r.force}, {'ln_f': -3.0 * r.force[:, None]}", "must be 2e.04 .*got -6e.04"),
        ("{'ln_f': v * r.force}, {'ln_f': 1.2 * r.force[:, None]}", "derivative of ln_f by p"),
        ("{'ln_f': np.where(v < 0.2, v, np.nan) * r.force}, {'ln_f': r.force[:, None]}", "finite"),
        ("{'ln_f': r.humidity}, {}", "AttributeError"),
    ],
)
def test_a_users_bad_law_is_told_before_any_fit(tmp_path, law, message):
    (tmp_path / "own.py").write_text(
        "import numpy as np\n"
        "from bladeroot.mechanisms.mechanism import Mechanism, Parameter, StickEffect\n"
        "SIZE = Parameter('p', '1', 0.1, 1.0, 0.0, 9.0, 'guess')\n"
        "MECHANISM = Mechanism('own', 'force-law', 'a law', (SIZE,), 'none',\n"
        f"                      stick=lambda r, v: StickEffect({law}))\n"
    )
    with pytest.raises(ValueError, match=message) as error:
        catalogue(tmp_path)
    assert "law of own: hook stick" in str(error.value)
    assert "own.py" in str(error.value)


@pytest.mark.parametrize(
    ("hook", "law", "message"),
    [
        ("structure", "None", "expected a Change and a list of its derivatives, got None"),
        (
            "structure",
            "(Change(v * r.beam, v * r.beam), [Change(r.beam, -r.beam)])",
            "of mass by p",
        ),
        ("structure", "(Change(v * r.beam, v * r.beam), [])", r"expected shape \(4, 4, 1\)"),
        pytest.param(
            "structure",
            "(Change(v * r.beam[0], v * r.beam), [])",
            r"stiffness: expected shape \(4,",
            marks=pytest.mark.wrong_shape,
        ),
        ("damping", "None", "expected the change and its derivatives, got None"),
        ("damping", "(v * r.force, 2.0 * r.force[:, None])", "derivative of ln_loss by p"),
        ("curve", "None", "expected an effect with ln_f, got None"),
    ],
)
def test_every_hook_is_tried(tmp_path, hook, law, message):
    (tmp_path / "own.py").write_text(
        "from bladeroot.mechanisms.mechanism import Mechanism, Parameter\n"
        "from bladeroot.rom.sensitivity import Change\n"
        "SIZE = Parameter('p', '1', 0.1, 1.0, 0.0, 9.0, 'guess')\n"
        "MECHANISM = Mechanism('own', 'level', 'a law', (SIZE,), 'none',\n"
        f"                      {hook}=lambda r, v: {law})\n"
    )
    with pytest.raises(ValueError, match=message) as error:
        catalogue(tmp_path)
    assert f"law of own: hook {hook}" in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("mechanism", EVERY, ids=named)
def test_what_is_shipped_passes_the_trial_of_a_users_law(mechanism):
    probe(mechanism)


def test_a_law_with_a_kink_or_a_limit_passes_the_trial():
    """At zero one side has another slope; below it the root is not defined."""
    size = Parameter("p", "1", 0.0, 1.0, 0.0, 9.0, "guess")

    def root(records, values):
        x = np.sqrt(1e-4 + values[0]) * records.force
        return StickEffect({"ln_f": x}, {"ln_f": (0.5 * x / (1e-4 + values[0]))[:, None]})

    def kink(records, values):
        x = np.where(values[0] > 0.0, records.force, 0.0)
        return StickEffect({"ln_f": values[0] * x}, {"ln_f": x[:, None]})

    for prior, law in ((size, root), (replace(size, low=-9.0), kink)):
        probe(Mechanism("own", "level", "a law", (prior,), "none", stick=law))


@pytest.mark.parametrize(
    ("numbers", "log", "message"),
    [
        ((0.0, -0.01, -1.0, 1.0), False, "c: std must be positive, got -0.01"),
        ((0.0, 0.0, -1.0, 1.0), False, "std must be positive"),
        ((0.0, np.nan, -1.0, 1.0), False, "std must be positive"),
        ((0.0, 0.01, 1.0, -1.0), False, "expected low <= mean <= high"),
        ((2.0, 0.01, -1.0, 1.0), False, "expected low <= mean <= high"),
        ((np.nan, 0.01, -1.0, 1.0), False, "expected low <= mean <= high"),
        ((0.0, 0.01, -1.0, 1.0), True, "mean must be positive with log"),
    ],
)
def test_a_prior_that_is_none_is_refused(numbers, log, message):
    with pytest.raises(ValueError, match=message):
        Parameter("c", "1", *numbers, "guess", log=log)


def test_a_mechanism_without_parameters_is_refused():
    one = next(one for one in catalogue() if one.id == "drift")
    with pytest.raises(ValueError, match="at least one parameter"):
        replace(one, parameters=())


def test_a_law_of_an_unknown_variable_is_refused():
    one = next(one for one in catalogue() if one.id == "drift")
    with pytest.raises(ValueError, match="over must be of"):
        replace(one, over=("humidity",))


@pytest.mark.wrong_shape  # of a structure only what is asked for
def test_a_mass_sits_on_the_display_line_wherever_its_coordinates_begin():
    along = np.linspace(-0.2, 0.2, 9)
    rows = np.random.default_rng(0).standard_normal((9, 3, 4))
    made = [
        added_mass.structure(
            SimpleNamespace(display_x=along + begin, display=rows, beam=np.zeros((4, 4))),
            np.array([0.02, 0.01]),
        )[0]
        for begin in (0.0, 0.26)
    ]
    np.testing.assert_allclose(made[0].mass, made[1].mass, rtol=1e-9)


def test_a_gauges_lag_is_one_at_the_turning_point_and_the_other_way_far_below():
    """Dahl's law: from the loading branch over to the unloading one, by half after ln 2 widths."""
    width = 0.1
    part = np.array([1.0, 1.0, 1.0 - width * np.log(2.0), 0.0])
    sign = np.array([1.0, -1.0, -1.0, -1.0])
    rows = replace(RECORDS, force=2e3 + 1e4 * part, sign=sign)
    form = law_of_form("gauge-friction", "turning over")
    lag = form.stick(rows, np.array([0.08, width])).changes["force"] / (0.08 * rows.force)
    np.testing.assert_allclose(lag, [-1.0, -1.0, 0.0, 1.0], atol=1e-4)


def test_a_drift_of_the_modulus_leaves_out_what_the_load_holds():
    """A mode of stiffness k and of g times the load: f^2 in proportion to k (1 + 2c) + g F."""
    force, k, g, change = np.array([0.0, 2e3, 2e4]), 1e6, 20.0, 2e-3
    none = np.zeros(3)
    records = Records(np.zeros(3, int), force, none, np.full(3, 9.0), none, 9.0, 1.0, none)
    by_load = 0.5 * g / (k + g * force)
    for held, loads in ((1.0, 1.0), (0.0, 1.0 + 2.0 * 0.5 * change)):
        effect = DRIFT.stick(records, np.array([change, held]))
        told = effect.changes["ln_f"] + by_load * effect.changes["force"]
        stiffer = k * (1.0 + change) + g * force * loads  # half of the change: none half-way
        true = 0.5 * np.log(stiffer / (k + g * force))
        np.testing.assert_allclose(told, true, rtol=3.0 * change)
