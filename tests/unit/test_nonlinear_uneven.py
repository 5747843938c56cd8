"""Uneven pressure, fast curves and loops, and curves against decays integrated in time."""

from dataclasses import replace

import numpy as np
import pytest
from bladeroot.contact.laws import closed_forms
from bladeroot.contact.laws.coulomb import coulomb
from bladeroot.contact.laws.jenkins import jenkins
from bladeroot.decay.freevib import freevib
from bladeroot.nonlinear.curves import mode_curve
from bladeroot.nonlinear.fast_loading import softening_curve, softening_curves
from bladeroot.nonlinear.harmonic_balance import nonlinear_mode
from bladeroot.nonlinear.pictures import pictures
from bladeroot.nonlinear.shortfall import ONSET_FALL, crossing, onset_table, partial_contact
from bladeroot.nonlinear.system import system_of
from bladeroot.nonlinear.uneven import Uneven, relative_pressure, uneven_sliders
from hypothesis import given, settings
from hypothesis import strategies as st
from nonlinear_systems import LIMIT, MASS, SPRING, TANGENTIAL, coarse_joint, one_dof
from one_step import exact, hysteretic
from time_integration import free_decay

POINT = np.array([np.log(0.6e9), np.log(0.9e9), 4e3])
LAW = Uneven(friction=0.4, edge=0.06, exponent=0.7, spread=0.4)


@pytest.fixture(scope="module")
def coarse():
    joint = coarse_joint()
    return joint, system_of(joint, POINT, "1B", 0.0, 0.004)


@settings(deadline=None, max_examples=20)
@given(st.floats(1e-3, 1.0), st.floats(0.1, 2.0))
def test_pressure_has_the_flanks_mean_and_falls_to_the_edges(edge, exponent):
    joint = coarse_joint()
    pressure = relative_pressure(joint, Uneven(edge=edge, exponent=exponent))
    flank, share = joint.assembly["flank"].values, joint.assembly["weight"].values
    np.testing.assert_allclose(np.bincount(flank, share * pressure), 1.0)
    distance = joint.edge_distance
    assert distance.max() == pytest.approx(1.0)
    first = flank == 0
    assert np.all(np.diff(pressure[first][np.argsort(distance[first], kind="stable")]) <= 1e-9)


def test_unevenness_keeps_load_and_stiffness(coarse):
    joint, system = coarse
    rough, smooth = (
        uneven_sliders(joint, system, 4e3, Uneven(spread=spread)) for spread in (0.4, 0.0)
    )
    np.testing.assert_allclose(rough.tangential.sum(axis=1), system.stiffness[:, 1])
    loads = [system.count @ one.preload.sum(axis=1) for one in (rough, smooth)]
    assert loads[0] == pytest.approx(loads[1])
    assert np.std(np.log(rough.preload / smooth.preload)) == pytest.approx(0.4, rel=0.2)
    assert smooth.preload.std(axis=1).max() < 1e-12 * smooth.preload.max()


def test_fast_curve_of_one_slider_is_the_closed_form():
    amplitudes = LIMIT / TANGENTIAL * np.geomspace(0.5, 20.0, 25)
    slider = jenkins(np.array([1e6]), np.array([TANGENTIAL]), np.array([LIMIT]), 1.0)
    (fall, rise), _ = softening_curve(one_dof(), slider, amplitudes)
    f, eta = closed_forms.one_dof(amplitudes, MASS, SPRING, TANGENTIAL, LIMIT)
    stick = np.sqrt((SPRING + TANGENTIAL) / MASS) / (2.0 * np.pi)
    np.testing.assert_allclose(fall, f / stick - 1.0, atol=3e-3)
    np.testing.assert_allclose(rise, eta, atol=1e-2 * eta.max())


def test_fast_curve_is_the_quasi_static_one(coarse):
    joint, system = coarse
    sliders = uneven_sliders(joint, system, 4e3, LAW)
    amplitudes = np.geomspace(3e-6, 1e-4, 12)
    (fall, rise), _ = softening_curve(system, sliders, amplitudes)
    curve = mode_curve(system, sliders, amplitudes)
    stick = np.sqrt(system.values[0]) / (2.0 * np.pi)
    np.testing.assert_allclose(fall, curve.frequency / stick - 1.0, atol=2e-3 * np.abs(fall).max())
    friction = curve.loss_factor - 0.004 * (stick / curve.frequency) ** 2
    np.testing.assert_allclose(rise, friction, atol=2e-2 * rise.max())


def test_a_system_in_its_own_sector_is_that_of_the_whole_joint(coarse):
    joint, system = replace(coarse[0]), coarse[1]
    joint.homes["1B"] = None
    whole, amplitudes = system_of(joint, POINT, "1B", 0.0, 0.004), np.geomspace(3e-6, 1e-4, 8)
    assert coarse[0].homes["1B"] is not None
    assert system.values[0] == pytest.approx(whole.values[0], rel=1e-9)
    np.testing.assert_array_equal(system.count, whole.count)
    many = [uneven_sliders(joint, system, force, LAW) for force in (4e3, 6e3)]
    (one, other), _ = softening_curves(system, many, amplitudes)
    np.testing.assert_allclose(
        one, softening_curve(whole, many[0], amplitudes)[0], atol=1e-3 * np.abs(one).max()
    )
    np.testing.assert_allclose(
        one, softening_curve(system, many[0], amplitudes)[0], rtol=1e-9, atol=1e-12
    )
    assert np.abs(other).max() < np.abs(one).max()


def test_curve_depends_on_amplitude_over_friction_times_force(coarse):
    joint, system = coarse
    amplitudes = np.geomspace(3e-6, 1e-4, 8)
    one, _ = softening_curve(system, uneven_sliders(joint, system, 4e3, LAW), amplitudes)
    other, _ = softening_curve(system, uneven_sliders(joint, system, 6e3, LAW), 1.5 * amplitudes)
    np.testing.assert_allclose(other, one, atol=1e-4 * np.abs(one).max())


def test_a_varying_normal_load_has_no_fast_curve():
    one = np.ones(1)
    with pytest.raises(ValueError, match="constant normal load"):
        softening_curve(one_dof(), coulomb(one, one, one, 0.3), np.array([1.0]))


def test_a_laser_that_moves_back_while_the_mode_rises_has_no_fast_curve():
    """Amplitudes at the laser then have two states each."""
    back = replace(one_dof(), laser_flexibility=np.array([[0.0, -2.0 / TANGENTIAL, 0.0]]))
    slider = jenkins(np.array([1e6]), np.array([TANGENTIAL]), np.array([LIMIT]), 1.0)
    with pytest.raises(RuntimeError, match="does not rise with that of 1B"):
        softening_curve(back, slider, LIMIT / TANGENTIAL * np.geomspace(0.5, 20.0, 25))


def test_loops_have_the_area_of_the_loss_factor(coarse):
    joint, system = coarse
    sliders, size = uneven_sliders(joint, system, 4e3, LAW), 3e-5
    shown = pictures(joint, system, sliders, [size, size / 3])
    (_, rise), _ = softening_curve(system, sliders, np.array([size]))
    x, f = shown["loop_motion"].values[0], shown["loop_force"].values[0]
    area = abs(np.sum(0.5 * (f + np.roll(f, -1)) * (np.roll(x, -1) - x)))
    (fall, _), _ = softening_curve(system, sliders, np.array([size]))
    stiffness = system.values[0] * (1.0 + fall[0]) ** 2 / system.laser[0] ** 2
    assert area == pytest.approx(np.pi * rise[0] * stiffness * size**2, rel=0.03)
    assert np.all(shown["slip"].values[1] <= shown["slip"].values[0] + 1e-12)


def test_partial_contact_bears_the_whole_load():
    profile = partial_contact(lambda place: place, 0.8, 0.02)
    np.testing.assert_allclose(profile(np.array([0.0, 0.1, 0.5, 1.0])), [0.0, 0.002, 0.5, 1.0])
    with pytest.raises(ValueError, match="share"):
        partial_contact(profile, 0.0, 0.02)


def test_less_pressure_at_the_edges_lets_slip_begin_earlier():
    table = onset_table(coarse_joint(), POINT)
    assert np.all(np.diff(table["onset"].values) < 0.0)
    assert np.all(table["onset"].values >= 0.99 * table["first_slip"].values)
    assert np.all(np.diff(table["partial_onset"].values, axis=1) < 0.0)
    assert table["onset"].values[0] > 20.0 * table["partial_onset"].values[-1, -1]
    assert 0.0 < ONSET_FALL < 1e-3
    assert table.attrs["reason"] == ""


def test_a_fall_that_is_not_reached_has_no_onset():
    ladder = np.array([1.0, 10.0, 100.0])
    assert crossing(ladder, np.array([0.0, 1.0, 3.0]), 2.0) == pytest.approx(10.0**1.5)
    assert np.isnan(crossing(ladder, np.array([0.0, 0.5, 1.0]), 2.0))
    assert crossing(ladder, np.array([3.0, 4.0, 5.0]), 2.0) == 1.0


@pytest.mark.parametrize(
    ("point", "laser_x", "reason"),
    [
        ((1e9, 1e13, 4e3), 0.0, "did not settle under first loading to"),
        ((2e9, 2e9, 1e7), 0.0, "once its flanks slide"),
        ((2e9, 2e9, 4e3), 1.0, "must stand on the beam"),
    ],
)
def test_where_nothing_can_be_simulated_the_onsets_are_a_reason(point, laser_x, reason):
    table = onset_table(coarse_joint(), np.array([*np.log(point[:2]), point[2]]), laser_x=laser_x)
    assert reason in table.attrs["reason"]
    assert not table.data_vars


@pytest.mark.slow
@pytest.mark.parametrize(("force", "k", "highest"), [(4e3, 0.7e9, 4e-4), (24e3, 3e9, 1.6e-3)])
def test_harmonic_balance_is_what_freevib_reads_off_a_decay(force, k, highest):
    """100 ppm and 2 %, to where slip has doubled the damping (coarse structure)."""
    joint = coarse_joint()
    system = system_of(joint, np.array([np.log(k), np.log(k), force]), "1B", 0.0, 0.004)
    sliders = uneven_sliders(joint, system, force, LAW)
    ladder = np.geomspace(highest / 150, highest, 60)
    curve = mode_curve(system, sliders, ladder, "harmonic-balance", (1, 3, 5, 7))
    state = nonlinear_mode(system, sliders, ladder[-3:-1] / abs(system.laser[0]), (1, 3))
    omega, zeta = hysteretic(np.sqrt(system.values), system.loss)
    fs = 51200.0
    # In a step beyond half a period a load moves a mode further than at rest: no state is found.
    substeps = 1 + int(omega.max() / (np.pi * fs))
    steps = int(fs * 5.0 / (0.002 * omega[0])) * substeps
    decay = free_decay(
        system, sliders, exact(omega, zeta, 1 / fs / substeps),
        state.solutions[-1].modal[:, 0::2].sum(axis=1), steps, substeps,
    )  # fmt: skip
    velocity = decay.velocity[int(0.004 * fs) :]
    noise = 1e-6 * np.abs(velocity).max()
    velocity = velocity + noise * np.random.default_rng(0).standard_normal(velocity.size)
    found = freevib(velocity, fs, omega[0] / 2 / np.pi, noise)
    size = found["amplitude"].values
    f, eta = (
        np.interp(np.log(size), np.log(ladder), c) for c in (curve.frequency, curve.loss_factor)
    )
    own = (size > ladder[0]) & (eta < 2 * 0.004)
    assert own.sum() > 30
    assert eta[own].max() > 1.8 * 0.004
    np.testing.assert_allclose(found["frequency"].values[own], f[own], rtol=1e-4)
    np.testing.assert_allclose(found["loss_factor"].values[own], eta[own], rtol=2e-2)
