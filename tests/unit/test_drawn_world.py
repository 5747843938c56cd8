"""The drawn world's truths against independent integration, closed forms and itself."""

from dataclasses import replace

import numpy as np
import pytest
from drawn_world import campaign, draw, friction, verdicts
from drawn_world.bound import columns, missed
from drawn_world.event import ORDER
from drawn_world.flow import Flow, motion, state
from drawn_world.laws import POOL, Law, linear, logarithm
from drawn_world.product import Answer
from drawn_world.pushes import Before, fading_drive, half_sine, haversine, response
from scipy.integrate import solve_ivp

OMEGA, ALPHA = 2 * np.pi * 50.0, 1.5


def law_of(kind, seed=3, scale=2e-5):
    rng = np.random.default_rng(seed)
    shape, kinks = kind(rng, 0.004)
    return Law(kind.__name__, 2 * np.pi * 80.0, scale, shape, kinks)


def linear_law():
    shape, _ = linear(None, ALPHA / OMEGA)
    return Law("linear", OMEGA, 1.0, shape)


@pytest.mark.parametrize("kind", POOL, ids=lambda kind: kind.__name__)
def test_free_motion_solves_its_law(kind):
    law = law_of(kind)
    times = np.linspace(0.0, 1.5, 40)

    def slope(_, y):
        omega, alpha = law.rates(law.scale * np.exp(y[0]))
        return [-alpha, omega]

    options = {"rtol": 1e-12, "atol": 1e-12, "max_step": 0.01}
    exact = solve_ivp(slope, (0, 1.5), [0.0, 0.3], t_eval=times, **options).y
    z = Flow(law).free(law.scale * np.exp(0.3j), times)
    np.testing.assert_allclose(np.log(np.abs(z) / law.scale), exact[0], atol=2e-8)
    np.testing.assert_allclose(np.angle(z * np.exp(-1j * exact[1])), 0.0, atol=1e-6)


@pytest.mark.parametrize("kind", POOL, ids=lambda kind: kind.__name__)
def test_truth_is_the_inversion_of_the_decay(kind):
    """omega_n and eta of hysteretic damping for x = A exp(i phi), by differences in time."""
    law = law_of(kind)
    flow, h = Flow(law), 2e-5
    for time in (0.11, 0.37):
        z = flow.free(law.scale * (1 + 0j), time + h * np.arange(-2, 3))
        phase = np.unwrap(np.angle(z))
        size = np.abs(z)
        omega = (phase[3] - phase[1]) / (2 * h)
        bend = (phase[3] - 2 * phase[2] + phase[1]) / h**2
        falls = (size[3] - size[1]) / (2 * h) / size[2]
        curls = (size[3] - 2 * size[2] + size[1]) / h**2 / size[2]
        squared = omega**2 - curls
        frequency, loss = law.truth(size[2])
        assert frequency == pytest.approx(np.sqrt(squared) / (2 * np.pi), rel=1e-7)
        assert loss == pytest.approx(-(2 * omega * falls + bend) / squared, rel=1e-4)


def test_velocity_and_acceleration_are_the_derivatives():
    law = law_of(POOL[0])
    flow, h, parts = Flow(law), 1e-6, ((2, 0.01), (3, 0.02))
    times = 0.07 + h * np.arange(-1, 2)
    q, v, a = motion(law, flow.free(law.scale * (1 + 0j), times), parts)
    assert v[1] == pytest.approx((q[2] - q[0]) / (2 * h), rel=1e-6)
    assert a[1] == pytest.approx((v[2] - v[0]) / (2 * h), rel=1e-6)


def test_state_inverts_motion():
    law = law_of(POOL[1])
    z = 0.7 * law.scale * np.exp(2.1j)
    q, v, _ = motion(law, np.array(z))
    assert state(law, float(q), float(v)) == pytest.approx(z, rel=1e-10)


PUSHES = {
    "half sine": half_sine(0.01, 0.004),
    "haversine": haversine(0.01, 0.013),
    "fading drive": fading_drive(0.01, 0.05, 2.0 - 1.0j, 0.97 * OMEGA),
}


@pytest.mark.parametrize("name", PUSHES)
def test_two_pushes_on_a_linear_mode_against_integration(name):
    law, first = linear_law(), PUSHES[name]
    second = replace(first, start=0.08).times(-0.4)
    times = np.linspace(0.0, 0.3, 301)
    found, z = response(Flow(law), Before(0.01), [first, second], times)

    def slope(t, y):
        force = float(
            first.force(np.array(t - first.start)) + second.force(np.array(t - second.start))
        )
        return [y[1], force - 2 * ALPHA * y[1] - (OMEGA**2 + ALPHA**2) * y[0]]

    exact = solve_ivp(
        slope, (0, 0.3), [0, 0], t_eval=times, rtol=1e-10, atol=1e-14, max_step=5e-4
    ).y
    np.testing.assert_allclose(found[0], exact[0], atol=2e-5 * np.abs(exact[0]).max())
    np.testing.assert_allclose(found[1], exact[1], atol=2e-5 * np.abs(exact[1]).max())
    assert abs(z) > 0


def test_a_drive_that_stops_goes_over_smoothly():
    law, drive = linear_law(), 1.01 * OMEGA
    force = 3.0 * np.exp(0.4j)
    level = force / (OMEGA**2 + ALPHA**2 - drive**2 + 2j * ALPHA * drive)
    fade = fading_drive(0.2, 0.06, force, drive)
    found, _ = response(Flow(law), Before(0.2, level, drive), [fade], np.linspace(0.19, 0.3, 20001))
    steps = np.abs(np.diff(found, axis=1)).max(axis=1)
    assert np.all(steps < 1.1 * OMEGA * 0.11 / 20000 * np.abs(found).max(axis=1))


def one_slider(part=0.02, zeta=2e-4, onset=0.1):
    omega = np.array([OMEGA])
    element = friction.Friction(
        "jenkins", np.array([part * OMEGA**2]), np.array([part * OMEGA**2 * onset]), 1.0, np.ones(1)
    )
    return omega, np.array([zeta]), element


def test_direct_integration_without_friction_is_exact():
    omega, zeta, element = one_slider(part=0.0)
    element = replace(element, limit=np.array([1.0]))
    out = friction.integrate(
        omega, zeta, element, np.ones(1), np.zeros(1), (None, 0.0), 2000.0, 2001, 50.0
    )
    alpha, time = zeta[0] * OMEGA, np.arange(2001) / 2000.0
    turned = np.sqrt(OMEGA**2 - alpha**2)
    exact = np.exp(-alpha * time) * (np.cos(turned * time) + alpha / turned * np.sin(turned * time))
    np.testing.assert_allclose(out[0, 0], exact, atol=1e-10)


def test_backbone_of_a_slider_follows_equivalent_stiffness_and_damping():
    """To first order in the slider's share of the stiffness (3.19)."""
    part, zeta, onset = 0.004, 2e-4, 0.1
    omega, damping, element = one_slider(part, zeta, onset)
    rate = 4000.0
    out = friction.integrate(
        omega, damping, element, np.ones(1), np.zeros(1), (None, 0.0), rate, 80000, 50.0
    )
    law = friction.backbone(1 / rate, out[0, 0], 50.0, "jenkins")
    for size in (0.7, 0.4, 0.2):
        over = size / onset
        angle = np.arccos(1 - 2 / over)
        kept = (angle - 0.5 * np.sin(2 * angle)) / np.pi
        frequency, loss = law.truth(np.array(size))
        assert frequency == pytest.approx(50.0 * np.sqrt(1 + part * kept), rel=2e-5)
        assert loss == pytest.approx(2 * zeta + 4 * part / np.pi * (over - 1) / over**2, rel=0.02)


@pytest.mark.parametrize("kind", [POOL[1], POOL[6], POOL[8]], ids=lambda kind: kind.__name__)
def test_backbone_reads_a_known_law(kind):
    law = law_of(kind)
    rate = 3200.0
    z = Flow(law).free(law.scale * (2.5 + 0j), np.arange(16000) / rate)
    read = friction.backbone(1 / rate, z.real, 80.0, "read")
    for x in (0.9, 0.5, 0.25):
        for found, true in zip(
            read.truth(np.array(x * law.scale)), law.truth(x * law.scale), strict=True
        ):
            assert found == pytest.approx(true, rel=1e-3 if true < 1 else 1e-5)


def test_the_same_seed_draws_the_same_event():
    one, other = draw(1002), draw(1002)
    assert one.asked == other.asked
    assert all(
        np.array_equal(a.samples, b.samples)
        for a, b in zip(one.sensors, other.sensors, strict=True)
    )


@pytest.mark.parametrize("seed", [1000, 1003, 1010])
def test_samples_are_whole_steps_and_hold_the_modes_in_their_size(seed):
    event = draw(seed)
    for sensor in event.sensors:
        steps = np.unique(np.diff(np.unique(sensor.samples)))
        np.testing.assert_allclose(steps / steps[0], np.round(steps / steps[0]), atol=1e-3)
    for mode, sensor in event.asked:
        size = 0.3 * event.modes[mode].law.scale * event.sensors[sensor].at_modes[mode]
        frequency, loss = event.truth(mode, sensor, size)
        assert loss > 0
        near = event.truths[mode].truth(np.array(0.3 * event.modes[mode].law.scale))[0]
        assert event.expected_Hz[mode] == pytest.approx(near, rel=0.0201)
        assert np.isfinite(frequency)


@pytest.mark.parametrize("seed", [1113, 1115])
def test_a_record_is_its_true_motion_and_its_noise(seed):
    """Least squares by the modes' true motion: sizes as stated, and nothing left but the noise."""
    event = draw(seed)
    rate, one = event.sampling_Hz, event.sensors[0]
    order = ORDER[one.chain.quantity]
    first = int(np.ceil(max(event.excitation.free_s, 0.0) * rate)) + 60
    time = np.arange(first, one.samples.size) / rate - event.excitation.free_s
    columns, at = [np.ones(time.size), time], {}
    for f, *_ in one.chain.mains:
        columns += [np.cos(2 * np.pi * f * time), np.sin(2 * np.pi * f * time)]
    for k, mode in enumerate(event.modes):
        z = Flow(mode.law).free(event.free[k], time)
        at[k] = len(columns)
        columns += [motion(mode.law, z)[order], motion(mode.law, -1j * z)[order]]
        for n, _ in mode.harmonics:
            wave = mode.law.scale * (z / mode.law.scale) ** n
            columns += [wave.real, wave.imag]
    basis = np.stack(columns, axis=1)
    size = np.linalg.norm(basis, axis=0)
    found = np.linalg.lstsq(basis / size, one.samples[first:], rcond=None)[0] / size
    for k, sensor in event.asked:
        if sensor == 0:
            known = one.at_modes[k]
            assert np.hypot(*found[at[k] : at[k] + 2]) == pytest.approx(known, rel=0.02)
    left = np.diff(one.samples[first:] - basis @ found, 3)  # slow sway and flicker do not count
    assert np.std(left) / np.sqrt(20.0) == pytest.approx(one.noise, rel=0.1)


def test_the_bound_knows_how_samples_move_with_the_rates():
    """All knots of a linear mode moved together: frequency and decay rate, by differences."""
    event = draw(1113)
    event.modes = [
        replace(m, law=replace(m.law, shape=linear(None, 0.003)[0])) for m in event.modes
    ]
    event.truths = [m.law for m in event.modes]
    one, rate, step = event.sensors[0], event.sampling_Hz, 1e-4
    times = np.arange(0, 400) / rate
    rows, knots = columns(event, 0, 0, times, times[-1], one.noise)
    law, order = event.modes[0].law, ORDER[one.chain.quantity]

    def samples(omega_more=0.0, alpha_more=0.0):
        omega, alpha = law.omega + omega_more, 0.003 * law.omega + alpha_more
        z = event.free[0] * np.exp((1j * omega - alpha) * times)
        return (one.at_modes[0] * (1j * law.omega) ** order * z).real

    for shifts, own in (
        ((step, 0.0), rows[2 : 2 + knots.size]),
        ((0.0, step), rows[2 + knots.size :]),
    ):
        exact = (samples(*shifts) - samples(*(-s for s in shifts))) / (2 * step)
        np.testing.assert_allclose(own.sum(axis=0), exact, atol=1e-5 * np.abs(exact).max())


def of_one_mode(kind):
    """A free decay of one mode by a law, as an event, and what `columns` asks for besides."""
    event = draw(1113)
    law = law_of(kind)
    event.modes = [replace(event.modes[0], law=law)]
    event.truths, event.free = [law], [complex(law.scale)]
    times = np.arange(0, 4000) / event.sampling_Hz
    return event, (0, 0, times, float(times[-1]), event.sensors[0].noise)


def off(event, asked, density):
    """Largest miss of omega by the broken lines that come nearest to the law."""
    rows, knots = columns(event, *asked, density)
    law, places = event.modes[0].law, np.linspace(knots[0], knots[-1], 200)
    return np.abs(missed(law, law.scale, rows, knots, asked[2], places)[0]).max() / law.omega


def test_broken_lines_hold_a_linear_law_and_come_nearer_to_a_smooth_one_as_their_square():
    assert off(*of_one_mode(linear), 1) < 1e-9
    smooth = of_one_mode(logarithm)
    by_density = np.array([off(*smooth, density) for density in (2, 4, 8)])
    assert by_density[0] > 1e-6
    np.testing.assert_allclose(by_density[:-1] / by_density[1:], 4.0, rtol=0.4)


def answer(findings=(), curves=True, crash=""):
    return Answer("usable", list(findings), "", {"time": np.zeros(1)} if curves else {}, 0.1, crash)


def test_classes_of_records():
    assert verdicts.verdict(answer(), wrong=False) == "right"
    assert verdicts.verdict(answer(), wrong=True) == "wrong in silence"
    assert verdicts.verdict(answer(["reader"]), wrong=True) == "wrong in silence"
    assert verdicts.verdict(answer(["gap"]), wrong=True) == "wrong, told"
    assert verdicts.verdict(answer(curves=False), wrong=False) == "dropped though right"
    assert verdicts.verdict(answer(curves=False), wrong=None) == "dropped, no curve"
    assert verdicts.verdict(answer(crash="x"), wrong=None) == "crash"


def test_a_point_is_wrong_beyond_both_the_tolerance_and_its_stated_errors():
    event = draw(1113)
    mode, sensor = event.asked[0]
    size = event.modes[mode].law.scale * event.sensors[sensor].at_modes[mode]
    amplitude = size * np.geomspace(0.8, 0.2, 5)
    frequency, loss = event.truth(mode, sensor, amplitude)
    away = np.array([1e-3, 1e-3, 1e-4, 0.0, 0.0])
    lossy = np.array([0.0, 0.0, 0.0, 0.2, 0.2])
    curves = {
        "amplitude": amplitude,
        "frequency": frequency * (1 + away), "loss_factor": loss * (1 + lossy),
        "frequency_std": frequency * np.array([1e-4, 1e-3, 1e-5, 1.0, 1.0]),
        "loss_factor_std": loss * np.array([1.0, 1.0, 1.0, 0.05, 0.1]),
    }  # fmt: skip
    found = verdicts.errors(event, mode, sensor, curves)
    assert verdicts.wrong_points(found).tolist() == [True, False, False, True, False]
    told = replace(answer(), curves=curves)
    row = verdicts.score(event, mode, sensor, told, {}, None)
    assert row["class"] == "wrong in silence"
    assert row["wrong where"] == ["start", "middle"]
    assert row["frequency"]["within 3"] == pytest.approx(0.6)


def test_a_campaign_is_written_with_what_a_sheet_says(tmp_path):
    event = draw(1001)
    entries = campaign(event, tmp_path)
    assert len(entries) == len(event.asked)
    assert all(entry["raw"].is_file() for entry in entries)
    rows = (tmp_path / "records.csv").read_text().splitlines()
    assert len(rows) == len(entries) + 1
    for entry in entries:
        own = {entry["facts"]["expected_Hz"], *entry["facts"]["other_modes_Hz"]}
        assert own == set(event.expected_Hz.values())
