"""One cycle of a mode against closed forms, and against the same specimen moved in time."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from bench_curves import campaign_curves, few_dofs
from bladeroot.bench.bench import move
from bladeroot.bench.clamping import clamp
from bladeroot.bench.conditions import baseline
from bladeroot.bench.joint import parts
from bladeroot.bench.modes import StuckModes
from cycle import cycle_curves, loss_factor, slip_cycle
from rig_toy import ROW, toy_bench, toy_reduced
from scipy.signal import hilbert

STUCK = {"coefficient": np.inf}


@pytest.fixture(scope="module")
def whole():
    return parts(toy_reduced())


def clamped(whole, mode="1B", **changes):
    bench = toy_bench(friction=STUCK, specimen={"modes": 6})
    row = {**ROW, "mode": mode}
    return bench, clamp(bench, whole, row, replace(baseline(bench, row), **changes))


def curves(clamping, amplitude):
    own = float(clamping.loss_factor[clamping.number])
    frequency, rate = cycle_curves(
        clamping.modes, clamping.number, own, clamping.forces, clamping.limit, amplitude
    )
    return frequency, rate / (np.pi * frequency)


def test_one_slider_loses_what_a_jenkins_element_does():
    """Stiffness ratio and loss of an elastic slider in parallel with a spring, in closed form."""
    omega, kt, limit = 3000.0, 4e6, 40.0
    modes = StuckModes(
        omega=np.array([omega]),
        names=("1B",),
        slider_shape=np.array([[1.0], [0.0]]),
        slider_kt=np.array([kt, kt]),
        normal_shape=np.zeros((1, 1)),
        normal_kn=np.zeros(1),
        residual=np.zeros((2, 2)),
        geometric=np.ones((1, 1)),
        laser_shape=np.ones(1),
        tip_shape=np.ones(1),
        line_x=np.array([-1.0, 1.0]),
        line_shape=np.ones((2, 1)),
    )
    reach = np.array([0.5, 1.5, 4.0, 20.0]) * limit / kt
    softer, lost = slip_cycle(modes, 0, np.array([limit]), reach)
    turn = np.arccos(1 - 2 * limit / (kt * reach[1:]))
    kept = kt / np.pi * (turn - np.sin(turn) * np.cos(turn))
    energy = 4 * limit * (reach[1:] - limit / kt)
    assert (softer[0], lost[0]) == pytest.approx((0, 0), abs=1e-6 * kt)
    np.testing.assert_allclose(softer[1:], kt - kept, rtol=0.01)
    np.testing.assert_allclose(lost[1:], energy / (np.pi * reach[1:] ** 2), rtol=0.01)


def test_hardening_and_drag_of_the_first_mode(whole):
    amplitude = np.array([1e-6, 1e-5, 3e-5])
    _, hard = clamped(whole, hardening=3e6)
    frequency, loss = curves(hard, amplitude)
    own = float(hard.loss_factor[hard.number])
    np.testing.assert_allclose(
        (frequency / hard.frequency) ** 2, 1 + 0.75 * 3e6 * amplitude**2, rtol=1e-9
    )
    np.testing.assert_allclose(loss, own / np.sqrt(1 + 0.75 * 3e6 * amplitude**2), rtol=1e-9)
    _, dragged = clamped(whole, drag=50.0)
    frequency, loss = curves(dragged, amplitude)
    np.testing.assert_allclose(frequency, dragged.frequency, rtol=1e-12)
    np.testing.assert_allclose(loss - own, 50 * amplitude, rtol=1e-3)


def test_the_loss_factor_is_that_of_the_decay_s_definition():
    """Frequency and rate that rise with amplitude, and (3.11) on the decay they make."""
    amplitude = np.geomspace(1e-6, 1e-4, 2000)
    frequency, rate = 500 * (1 + 1e4 * amplitude), 10 * (1 + 1e3 * amplitude)
    omega = 2 * np.pi * frequency
    per_second = -rate * amplitude * 2 * np.pi * 500 * 1e4
    wanted = -(-2 * omega * rate + per_second) / omega**2
    found = loss_factor(frequency, rate, amplitude)
    np.testing.assert_allclose(found[1:-1], wanted[1:-1], rtol=1e-5)


@pytest.mark.parametrize(
    "changes", [{"hardening": 2e7}, {"drag": 1000.0}, {"preload": 0.02}, {"friction": 0.3}]
)
def test_a_decay_in_time_follows_the_cycle(whole, changes):
    """Frequency and damping of the stepped decay at half its amplitude."""
    bench, clamping = clamped(whole, **changes)
    motion, release = move(bench, clamping, 10.0)
    amplitude = motion.amplitude
    start = round(release * 51200)
    at = start + int(np.argmax(amplitude[start:] < 0.5 * amplitude[start]))
    half = int(51200 * 4 / clamping.frequency)
    analytic = hilbert(motion.velocity[start : start + 6 * (at - start + half)])
    near = slice(at - start - half, at - start + half)
    time = np.arange(2 * half) / 51200
    turns = np.polyfit(time, np.unwrap(np.angle(analytic[near])), 1)[0] / (2 * np.pi)
    rate = -np.polyfit(time, np.log(np.abs(analytic[near])), 1)[0]
    frequency, loss = curves(clamping, np.array([0.5 * amplitude[start]]))
    shift = frequency[0] / clamping.frequency - 1
    assert turns / clamping.frequency - 1 == pytest.approx(shift, rel=0.15, abs=3e-4)
    assert rate / (np.pi * turns) == pytest.approx(loss[0], rel=0.03)
    assert motion.energy_error < 1e-3


def test_few_dofs_have_the_frequencies_of_all(whole):
    few = few_dofs(whole)
    assert few.mass.shape[0] < whole.mass.shape[0]
    bench = toy_bench(friction=STUCK, specimen={"modes": 6})
    for mode in ("1B", "2B"):
        row = {**ROW, "mode": mode}
        true = replace(baseline(bench, row), kn=7e8, kt=3e9, slot=0.9, force=17e3)
        exact, quick = clamp(bench, whole, row, true), clamp(bench, few, row, true)
        assert quick.frequency == pytest.approx(exact.frequency, rel=2e-6)


def test_a_loose_oscillator_shifts_and_damps_where_it_is_tuned(whole):
    _, alone = clamped(whole)
    about = {"oscillator": 1e-5, "oscillator_loss": 0.02}
    own = float(alone.loss_factor[alone.number])
    _, tuned = clamped(whole, oscillator_Hz=alone.frequency, **about)
    seen = np.interp(0.0, alone.modes.line_x, alone.modes.line_shape[:, alone.number])
    assert tuned.loss_factor[tuned.number] == pytest.approx(own + 1e-5 * seen**2 / 0.02, rel=0.02)
    _, above = clamped(whole, oscillator_Hz=1.5 * alone.frequency, **about)
    assert above.frequency < alone.frequency
    _, below = clamped(whole, oscillator_Hz=0.7 * alone.frequency, **about)
    assert below.frequency > alone.frequency


def test_curves_of_a_campaign_end_at_what_the_drive_reaches(whole):
    bench = toy_bench(friction=STUCK, specimen={"modes": 6})
    rows = [{**ROW, "record": f"r{k}", "drive_A": drive} for k, drive in enumerate((1.0, 2.0))]
    sheet = pd.DataFrame(rows)
    ladder = np.geomspace(1e-8, 1e-3, 60)
    clean = [baseline(bench, row) for row in rows]
    found = campaign_curves(bench, whole, few_dofs(whole), sheet, clean, ladder)
    top = found["top"].values
    assert top[1] == pytest.approx(2 * top[0], rel=1e-6)
    motion, release = move(bench, clamp(bench, whole, rows[0]), 1.0)
    assert top[0] == pytest.approx(motion.amplitude[round(release * 51200)], rel=0.1)
    reached = np.isfinite(found["frequency"].values[0])
    np.testing.assert_array_equal(reached, ladder <= top[0])
    drag = [replace(true, drag=500.0) for true in clean]
    dragged = campaign_curves(bench, whole, few_dofs(whole), sheet, drag, ladder)
    assert (dragged["top"] < found["top"]).all()
