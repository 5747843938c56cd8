"""The benchmarks' truths: closed forms, independent integration, and scores of known errors."""

import json
from pathlib import Path

import bench_top
import bound
import decay_cost
import decays
import numpy as np
import one_dof
import peers
import pytest
import real_like
import scores
import whole_run
from decay_bench import slider
from scipy.integrate import solve_ivp
from synthetic import SAMPLING_HZ, Case, Law, draw, draw_law, move

KINDS = ("kink", "coulomb", "gradual")


def law(kind="coulomb"):
    return Law(250.0, 2e-3, 0.01, 0.2, kind, 1.7, 4e-3, 0.7)


def case(kind="coulomb", noise=1e-3):
    return Case(np.zeros(102400), noise, 1.0, law(kind), move(law(kind)), 2.0, 0.0)


@pytest.mark.parametrize("kind", KINDS)
def test_motion_solves_its_equations(kind):
    motion = move(law(kind))

    def rates(_, state):
        alpha, omega, *_ = law(kind).rates(np.exp(state[0]))
        return [float(alpha), float(omega)]

    at = np.linspace(0.0, motion.onset_s, 40)  # no integrator steps over the kink unharmed
    solved = solve_ivp(rates, (0.0, at[-1]), [0.0, 0.0], "DOP853", at, rtol=1e-12, max_step=4e-3)
    level, phase = motion.at(at)
    assert np.abs(level - solved.y[0]).max() < 1e-9
    assert np.abs(phase - solved.y[1]).max() < 1e-6


@pytest.mark.parametrize("kind", KINDS)
def test_truth_satisfies_the_equation_of_motion(kind):
    """Y'' + omega_n^2 (1 + i eta) Y = 0 for Y = A exp(i phi), by differences of A and phi."""
    x = np.array([0.1, 0.3, 0.6, 0.9])
    frequency, loss = law(kind).truth(x)
    motion, h = move(law(kind)), 1e-4
    time = motion.time_of(x) + h * np.arange(-2, 3)[:, None]
    level, phase = motion.at(time)
    y = np.exp(level - level[2] + 1j * (phase - phase[2]))
    bend = (-y[0] + 16 * y[1] - 30 * y[2] + 16 * y[3] - y[4]) / (12 * h**2)
    square = (2 * np.pi * frequency) ** 2 * (1 + 1j * loss)
    # the differences' own error, omega^4 h^4 / 90, is that of a plain cosine
    lam = 2 * np.pi * frequency * 1j
    own = sum(
        c * np.exp(k * h * lam) for c, k in zip((-1, 16, -30, 16, -1), range(-2, 3), strict=True)
    )
    error = (bend / square) / (own / (12 * h**2) / lam**2) + 1.0
    assert np.abs(error.real).max() < 1e-6
    assert np.abs(error.imag).max() < 1e-6


@pytest.mark.parametrize("kind", KINDS)
def test_amplitude_slopes_are_derivatives(kind):
    x, e = np.array([0.1, 0.25, 0.6, 1.0]), 1e-6
    ahead, behind = law(kind).rates(x * np.exp(e)), law(kind).rates(x * np.exp(-e))
    for k in range(2):
        slope = (ahead[k] - behind[k]) / (2 * e)
        assert law(kind).rates(x)[k + 2] == pytest.approx(slope, rel=1e-6, abs=1e-6)


def test_softening_and_plateau_are_as_drawn():
    for seed in range(20):
        drawn = draw_law(np.random.default_rng(seed))
        omega = drawn.rates(np.array([0.5 * drawn.onset, drawn.onset, 1.0]))[1]
        assert omega[0] == omega[1] == 2 * np.pi * drawn.frequency_Hz
        assert omega[2] / omega[0] == pytest.approx(1.0 - drawn.softening)
        assert 0.002 <= drawn.softening <= 0.02
        assert np.exp(move(drawn).at(np.array(4.0))[0]) < 0.02


def test_noise_is_that_far_below_the_starting_rms():
    seeds = np.random.SeedSequence(5).spawn(3)
    one, two = (draw(seeds[0], seed, 40.0) for seed in seeds[1:])
    speed = one.start_m * abs(complex(*(rate.item() for rate in one.law.rates(np.array(1.0))[:2])))
    assert one.noise == pytest.approx(0.01 * speed / np.sqrt(2.0))
    assert np.std(one.velocity - two.velocity) == pytest.approx(np.sqrt(2.0) * one.noise, rel=0.01)


def test_bound_of_a_long_decay_has_a_closed_form():
    """var(omega) = var(alpha) = 16 sigma^2 a^3 / (V^2 f_s) once the record holds the decay."""
    found = bound.decaying_sinusoid(0.3, -4.0, 2 * np.pi * 250.0, 1e-3, SAMPLING_HZ, 102400)
    expected = 4.0 * 1e-3 * np.sqrt(4.0**3 / SAMPLING_HZ) / 0.3
    assert found == pytest.approx((expected, expected), rel=2e-3)


def test_least_squares_reaches_the_bound():
    rng = np.random.default_rng(1)
    count, omega, alpha, noise = 3072, 2 * np.pi * 251.0, -10.0, 0.01
    time = np.arange(count) / SAMPLING_HZ
    wave = np.exp(alpha * time) * np.cos(omega * time)
    found = []
    for _ in range(60):
        ((_, single),) = peers.ring_down_fit(wave + noise * rng.standard_normal(count))
        found.append(single)
    alpha_std, omega_std = bound.decaying_sinusoid(1.0, alpha, omega, noise, SAMPLING_HZ, count)
    frequency, loss = np.std(found, axis=0)
    assert frequency == pytest.approx(omega_std / (2 * np.pi), rel=0.3)
    assert loss == pytest.approx(2 * alpha_std / omega, rel=0.3)


def test_slider_agrees_with_another_integration():
    velocity, stuck_s = one_dof.record(100e-4)
    other = slider()
    count = min(velocity.size, other.size)
    assert np.abs(velocity[:count] - other[:count]).max() < 1e-12 * np.abs(other).max()
    assert 0.05 < stuck_s < 0.06


def test_true_curve_scores_zero_and_holes_count():
    known = case()
    time = np.linspace(0.0, 4.0, 2000)
    x = np.exp(known.motion.at(time)[0])
    frequency, loss = known.law.truth(x)
    errors = scores.curve_errors(known, (time, x, frequency * (1 + 5e-6), loss * 0.99))
    whole = scores.in_short(errors)
    assert whole["frequency"] == pytest.approx(5.0, rel=0.05)
    assert whole["loss"] == pytest.approx(1.0, rel=0.05)
    assert whole["reach"] == 1.0
    hole = np.where((x > 0.1) & (x < 0.2), np.nan, frequency)
    holed = scores.curve_errors(known, (time, x, hole, loss))
    short = scores.in_short(holed)
    reach = short["reach"]
    assert short["met"] == reach  # all that is there is good, what is missing is not
    same = scores.in_short(errors, np.isfinite(holed.frequency))
    assert same["frequency"] == pytest.approx(5.0, rel=0.05)
    assert same["reach"] == 1.0
    assert reach == pytest.approx(1.0 - np.log(2.0) / np.log(0.95 / 0.02), abs=0.02)


def test_hilbert_of_a_plain_decay():
    time = np.arange(51200) / SAMPLING_HZ
    place = np.exp(-2.0 * time) * np.cos(2 * np.pi * 250.0 * time)
    _, size, frequency, loss = (part[50:-150] for part in peers.differentiate(place, 61))
    assert frequency == pytest.approx(250.0, rel=1e-6)
    assert loss == pytest.approx(4.0 / (2 * np.pi * 250.0), rel=2e-2)
    assert size[0] == pytest.approx(np.exp(-2.0 * 50.5 * peers.CYCLE / SAMPLING_HZ), rel=1e-3)


def test_peers_get_their_best_setting():
    records = [
        {"a": {"frequency": 3.0, "stick": 1.0}, "b": {"frequency": 1.0, "stick": 9.0}},
        {"a": {"frequency": 5.0, "stick": 1.0}, "b": {"frequency": 2.0, "stick": 7.0}},
    ]
    setting, medians = decays.best_setting(records)
    assert (setting, medians["stick"]) == ("b", 8.0)
    assert decays.best_setting([{}, {}])[1]["stick"] == np.inf


def test_the_bench_top_s_motion_and_truth_are_those_of_its_laws():
    rng, time = np.random.default_rng(3), np.linspace(0.0, 0.5, 4001)
    for _ in range(6):
        mode = bench_top.drawn_mode(rng, 40.0, 1e-6)
        x, v, a = (
            mode.motion(3e-6, time, 0.4, q) for q in ("displacement", "velocity", "acceleration")
        )
        for value, slope in ((x, v), (v, a)):
            np.testing.assert_allclose(
                np.gradient(value, time)[2:-2], slope[2:-2], atol=3e-4 * np.abs(slope).max()
            )
    plain = bench_top.Mode(lambda a: 250.0 + 0.0 * a, lambda a: 2.0 + 0.0 * a)
    frequency, loss = plain.truth(np.array([1e-6, 1e-3]))
    square = 250.0**2 - 2.0**2
    np.testing.assert_allclose(frequency, np.sqrt(square) / (2.0 * np.pi))
    np.testing.assert_allclose(loss, 2.0 * 250.0 * 2.0 / square)


@pytest.mark.parametrize("module", [decay_cost, real_like, whole_run])
def test_the_page_holds_the_table_of_the_kept_numbers(module):
    kept = Path(module.__file__).with_suffix(".json")
    assert module.paged(json.loads(kept.read_text())) == module.PAGE.read_text()
