"""Curves of frequency and damping against closed forms and linear limits, and one another."""

from dataclasses import replace

import numpy as np
import pytest
from bladeroot.contact.laws import closed_forms
from bladeroot.contact.laws.jenkins import jenkins
from bladeroot.contact.laws.sliders import Sliders, at_rest
from bladeroot.nonlinear import continuation, harmonic_balance, quasi_static
from bladeroot.nonlinear.aft import cycle
from bladeroot.nonlinear.curves import METHODS, first_slip, mode_curve
from bladeroot.nonlinear.flanks import (
    FlankContact,
    elastic_preload,
    even_preload,
    flank_sliders,
    width_places,
)
from bladeroot.nonlinear.harmonic_balance import fall, nonlinear_mode
from bladeroot.nonlinear.system import system_of
from bladeroot.rom.joint import exact_modes
from nonlinear_systems import LIMIT, MASS, SPRING, TANGENTIAL, coarse_joint, one_dof
from slider_history import history

POINT = np.array([np.log(2e9), np.log(2e9), 12e3])
SLIDER = jenkins(np.array([1e6]), np.array([TANGENTIAL]), np.array([LIMIT]), 1.0)
AMPLITUDES = LIMIT / TANGENTIAL * np.geomspace(0.3, 30.0, 25)


@pytest.fixture
def any_harmonics(monkeypatch):
    """The first harmonic alone, whatever the next ones would change."""
    monkeypatch.setattr(harmonic_balance, "TRUNCATION_LIMITS", (np.inf, np.inf))


def first_harmonic_only(system, sliders, amplitudes, method):
    return mode_curve(system, sliders, amplitudes, method, (1,), decaying=False)


@pytest.mark.parametrize(
    ("method", "tolerance"), list(zip(METHODS, (5e-5, 1e-4, 1e-12), strict=True))
)
def test_one_slider_is_the_closed_form(method, tolerance, any_harmonics):
    curve = first_harmonic_only(one_dof(), SLIDER, AMPLITUDES, method)
    f, eta = closed_forms.one_dof(AMPLITUDES, MASS, SPRING, TANGENTIAL, LIMIT)
    assert np.abs(curve.frequency / f - 1.0).max() < tolerance
    assert np.abs(curve.loss_factor - eta).max() < 20.0 * tolerance * eta.max()
    assert curve.reason == ""


def test_material_damping_adds_to_frictions(any_harmonics):
    bare, damped = (
        mode_curve(one_dof(loss), SLIDER, AMPLITUDES, "harmonic-balance", (1,), False)
        for loss in (0.0, 0.01)
    )
    share = one_dof().values[0] / (2 * np.pi * bare.frequency) ** 2
    assert np.allclose(damped.loss_factor - bare.loss_factor, 0.01 * share, rtol=1e-6)


@pytest.fixture(scope="module", params=["1B", "2B"])
def stuck(request):
    mode = request.param
    return system_of(coarse_joint(), POINT, mode, 0.0 if mode == "1B" else -0.07)


def test_images_share_a_contact_and_give_back_the_whole_mode(stuck):
    joint = coarse_joint()
    assert stuck.count.sum() == len(joint.gap) > 2 * len(stuck.count)
    motion = stuck.sign * stuck.shape[stuck.image, :, 0]
    kn, kt = np.exp(POINT[:2])
    weight = joint.assembly["weight"].values[:, None]
    shape = exact_modes(joint, POINT, [stuck.mode]).shapes[:, 0]
    energy = kn * (joint.gap @ shape) @ (joint.gap @ shape)
    assert (kn * weight[:, 0] * motion[:, 0] ** 2).sum() == pytest.approx(energy, rel=1e-8)
    energy = kt * (joint.slip @ shape) @ (joint.slip @ shape)
    assert (kt * weight * motion[:, 1:] ** 2).sum() == pytest.approx(energy, rel=1e-8)


def test_flexibility_is_that_of_the_whole_joint(stuck):
    """Modes and residual together are the static answer to loads on a contact and its images."""
    flexibility = stuck.flexibility + np.einsum(
        "cam,ebm,e,m->caeb", stuck.shape, stuck.shape, stuck.count, 1.0 / stuck.values
    )
    work = flexibility.reshape(3 * len(stuck.count), -1) * np.repeat(stuck.count, 3)[:, None]
    assert np.allclose(work, work.T, atol=1e-9 * np.abs(work).max())
    assert np.linalg.eigvalsh(work).min() > -1e-9 * np.abs(work).max()


def test_without_slip_the_frequency_is_the_linear_one(stuck):
    sliders = flank_sliders(coarse_joint(), stuck, POINT, FlankContact("linear"))
    springs = [one.sum(axis=1) for one in (sliders.normal, sliders.tangential)]
    assert np.allclose(np.transpose(springs), stuck.stiffness)
    exact = np.sqrt(exact_modes(coarse_joint(), POINT, [stuck.mode]).values[0]) / (2 * np.pi)
    for method in ("harmonic-balance", "quasi-static"):
        curve = mode_curve(stuck, sliders, np.array([1e-6, 1e-3]), method, (1, 3))
        assert np.allclose(curve.frequency, exact, rtol=1e-9)
        assert np.allclose(curve.loss_factor, 0.0, atol=1e-9)
        assert not curve.slip.any()


def test_when_all_slips_the_frequency_is_that_without_tangential_stiffness(stuck):
    loose = np.array([POINT[0], POINT[1] - np.log(1e6), POINT[2]])
    exact = np.sqrt(exact_modes(coarse_joint(), loose, [stuck.mode]).values[0]) / (2 * np.pi)
    sliders = flank_sliders(coarse_joint(), stuck, POINT, FlankContact("jenkins", 1e-4))
    curve = mode_curve(stuck, sliders, np.geomspace(1e-6, 1e-3, 12), "quasi-static")
    assert curve.frequency[-1] == pytest.approx(exact, rel=1e-4)
    assert curve.loss_factor[-1] < 0.1 * curve.loss_factor.max()
    assert np.allclose(curve.slip[-1], 1.0)


def test_quasi_static_loading_agrees_with_harmonic_balance_in_partial_slip(stuck):
    contact = FlankContact("jenkins", 0.42, 2.0, strips=4)
    sliders = flank_sliders(coarse_joint(), stuck, POINT, contact)
    first = first_slip(stuck, sliders)
    amplitudes = first * np.array([0.5, 2.0, 5.0, 10.0])
    one, two = (
        mode_curve(stuck, sliders, amplitudes, method, (1, 3), False)
        for method in ("quasi-static", "harmonic-balance")
    )
    assert not one.slip[0].any()
    assert one.slip[-1].any()
    assert 1.0 - one.frequency[-1] / one.frequency[0] > 1e-4
    assert np.abs(one.frequency / two.frequency - 1.0).max() < 5e-5
    assert np.allclose(one.loss_factor, two.loss_factor, rtol=0.03, atol=1e-7)


def test_slip_begins_where_the_stuck_motion_says(stuck):
    sliders = flank_sliders(coarse_joint(), stuck, POINT, FlankContact("jenkins"))
    amplitudes = first_slip(stuck, sliders) * np.array([0.995, 1.02])
    curve = mode_curve(stuck, sliders, amplitudes, "harmonic-balance", (1,))
    assert not curve.slip[0].any()
    assert curve.slip[1].any()


def test_preload_carries_the_axial_force():
    joint = coarse_joint()
    normal_x = np.abs(joint.assembly["frame"].values[:, 0, 0])
    for load in (even_preload(joint, 12e3), elastic_preload(joint, POINT)):
        assert (load * normal_x).sum() == pytest.approx(2 * 12e3)
        assert (load > 0.0).all()


def test_places_cover_the_width():
    joint = coarse_joint()
    place = width_places(joint)
    weight = joint.assembly["weight"].values
    assert place.min() == pytest.approx(0.0)
    assert place.max() == pytest.approx(1.0)
    # lines of pairs: their widths, weighted, add up to each line's share
    assert (weight / (place[:, 1] - place[:, 0])).min() > 0.0
    assert np.unique(np.round(place[:, 1] - place[:, 0], 9)).tolist() == pytest.approx(
        [1 / 6, 2 / 3]
    )


@pytest.mark.parametrize("method", ["quasi-static", "fixed-shape"])
def test_all_but_harmonic_balance_refuse_varying_normal_load(stuck, method):
    sliders = flank_sliders(coarse_joint(), stuck, POINT, FlankContact("coulomb"))
    with pytest.raises(ValueError, match="constant normal load"):
        mode_curve(stuck, sliders, np.array([1e-6]), method)


def test_flanks_that_slide_are_not_damped_as_if_they_stuck(stuck):
    """Almost without friction what is left is material loss of the loose joint alone."""
    system = replace(stuck, loss=np.full(len(stuck.values), 1e-3))
    sliders = flank_sliders(coarse_joint(), system, POINT, FlankContact("jenkins", 1e-6))
    amplitudes = np.geomspace(1e-5, 1e-4, 3)
    lossy, loaded = (
        mode_curve(system, sliders, amplitudes, method)
        for method in ("harmonic-balance", "quasi-static")
    )
    bare = mode_curve(stuck, sliders, amplitudes, "harmonic-balance")
    stick = np.sqrt(system.values[0]) / (2.0 * np.pi)
    alone = lossy.loss_factor - bare.loss_factor  # material's, without the little by friction
    np.testing.assert_allclose(alone, 1e-3 * (stick / lossy.frequency) ** 2, rtol=0.05)
    np.testing.assert_allclose(lossy.loss_factor[-1], loaded.loss_factor[-1], rtol=0.05)
    np.testing.assert_allclose(lossy.frequency, bare.frequency, rtol=1e-5)


def test_too_few_harmonics_end_the_curve_and_say_so():
    few, many = (
        mode_curve(one_dof(), SLIDER, AMPLITUDES, "harmonic-balance", harmonics, False)
        for harmonics in ((1,), tuple(range(1, 12, 2)))
    )
    known = np.isfinite(few.frequency)
    assert 0 < known.sum() < AMPLITUDES.size
    assert known[: known.sum()].all()
    assert "harmonics to 1 do not suffice: the next ones change the frequency by" in few.reason
    assert (np.isfinite(many.frequency).all(), many.reason) == (True, "")


def test_a_decay_that_its_own_damping_does_not_agree_with_is_no_solution(stuck, monkeypatch):
    sliders = flank_sliders(coarse_joint(), stuck, POINT, FlankContact("jenkins", 0.05, 2.0))
    amplitudes = np.array([1e-6, 1e-4])
    monkeypatch.setattr(harmonic_balance, "_FADE_TOLERANCE", -1.0)
    curve = mode_curve(stuck, sliders, amplitudes, "harmonic-balance")
    assert np.isnan(curve.frequency).all()
    assert "did not converge" in curve.reason


@pytest.mark.parametrize("stuck", ["1B"], indirect=True)  # 2B takes six times as long
def test_a_curve_that_ends_early_says_why_and_where(stuck, monkeypatch):
    """One number, that of the last amplitude with a value, by either method."""
    sliders = flank_sliders(coarse_joint(), stuck, POINT, FlankContact("jenkins", 0.05, 2.0))
    amplitudes = np.array([1e-6, 1e-5, 1e-4])
    monkeypatch.setattr(harmonic_balance, "TRUNCATION_LIMITS", (np.inf, np.inf))
    for method in ("harmonic-balance", "quasi-static"):
        whole = mode_curve(stuck, sliders, amplitudes, method)
        assert (np.isfinite(whole.frequency).all(), whole.reason) == (True, "")
    honest = continuation.follow

    def ends(solve, targets, start, measure, close=1e-4):
        def cut(amplitude, guess, across=None):
            too_far = amplitude * abs(stuck.laser[0]) > 2e-5
            return None if too_far else solve(amplitude, guess, across)

        return honest(cut, targets, start, measure, close)

    for room, method in ((harmonic_balance, "harmonic-balance"), (quasi_static, "quasi-static")):
        monkeypatch.setattr(room, "follow", ends)
        curve = mode_curve(stuck, sliders, amplitudes, method)
        assert np.isfinite(curve.frequency).tolist() == [True, True, False]
        assert curve.reason == (
            "no further solution could be followed; the curve holds to 10 um at the laser"
        )


def test_a_laser_at_a_node_of_the_mode_is_refused():
    joint = coarse_joint()
    with pytest.raises(ValueError, match=r"at a node of 2B: at 0\.0001 m it sees 0\.\d+ %"):
        system_of(joint, POINT, "2B", 1e-4)
    with pytest.raises(ValueError, match="must stand on the beam"):
        system_of(joint, POINT, "2B", 1.0)
    assert system_of(joint, POINT, "2B", 2e-3).laser[0] != 0.0


def test_a_joint_that_cannot_slide_is_named_by_its_own_stiffness():
    """Tension holds it while it sticks; the sliding joint behind the kept modes is not stable."""
    with pytest.raises(ValueError, match=r"2e\+09 N/m and a load of 1e\+07 once its flanks slide"):
        system_of(coarse_joint(), np.array([*POINT[:2], 1e7]), "1B")


def contact_loops(sliders, motion, times):
    """Closed loops of motion and force of every contact, the first sample again at last."""
    samples = np.einsum("th,cah->tca", cycle((1,), times).synthesis, motion)
    twice = np.concatenate([samples, samples[:1]])
    force, _, _ = history(sliders, twice, at_rest(sliders))
    return twice[times:], force[times:]


def test_area_of_the_loops_is_what_the_loss_factor_says(stuck):
    """The decay's work on the modes equals what the contacts take."""
    contact = FlankContact("jenkins", 0.1, 1.0, strips=4)
    sliders = flank_sliders(coarse_joint(), stuck, POINT, contact)
    amplitudes = first_slip(stuck, sliders) * np.array([0.9, 3.0])
    solution = nonlinear_mode(stuck, sliders, amplitudes, (1,), 256, False).solutions[-1]
    motion, force = contact_loops(sliders, solution.motion, 256)
    area = (0.5 * (force[1:] + force[:-1]) * np.diff(motion, axis=0)).sum(axis=(0, 2))
    assert area.min() > -1e-12 * area.max()
    # pi decay q^2, with the decay 2 zeta omega^2 and q^2 of all modes
    given = np.pi * solution.decay * (solution.modal**2).sum()
    assert (stuck.count * area).sum() == pytest.approx(given, rel=1e-3)


def test_the_turning_phase_of_the_laser_is_in_the_frequency(stuck):
    """Against the difference of the phase between two amplitudes, in steady vibration."""
    contact = FlankContact("jenkins", 0.1, 1.0, strips=4)
    sliders = flank_sliders(coarse_joint(), stuck, POINT, contact)
    amplitudes = first_slip(stuck, sliders) * np.array([1.0, 7.96, 8.0, 8.04])
    _, low, here, high = nonlinear_mode(stuck, sliders, amplitudes, (1, 3), 128, False).solutions
    phasor = [one.laser[0] - 1j * one.laser[1] for one in (low, high)]
    turn = np.angle(phasor[1] / phasor[0]) / (high.amplitude - low.amplitude) * fall(here, 0)
    curve = mode_curve(stuck, sliders, amplitudes, "harmonic-balance", (1, 3), False)
    seen = 2.0 * np.pi * curve.frequency[2] / np.sqrt(here.value) - 1.0
    assert abs(turn) > 1e-8
    assert seen == pytest.approx(turn, rel=0.05)


def test_a_loss_that_no_record_shows_is_judged_by_what_one_does(stuck, monkeypatch):
    """At first slip the loss factor is rounding: a multiple of it says nothing."""
    sliders = flank_sliders(coarse_joint(), stuck, POINT, FlankContact("jenkins", 0.1, 1.0))
    amplitudes = first_slip(stuck, sliders) * np.array([0.5, 1.0 + 1e-9])
    value = stuck.values[0]
    for change, whole in ((0.9, True), (1.1, False), (np.nan, False)):
        step = (0.0, change * harmonic_balance.MEASURABLE_LOSS * value)
        monkeypatch.setattr(harmonic_balance, "first_step", lambda *_, step=step: step)
        curve = mode_curve(stuck, sliders, amplitudes, "harmonic-balance", (1, 3), False)
        assert np.isfinite(curve.frequency).all() == whole
        assert ("do not suffice" in curve.reason) != whole


@pytest.mark.parametrize("seed", [1, 2])
def test_fading_is_what_a_decay_integrated_in_time_loses(seed):
    """One mass and a smooth population of sliders, from peak to peak, against the curve."""
    rng = np.random.default_rng(seed)
    limits = LIMIT * np.sort(rng.uniform(0.02, 2.0, 60)) / 60
    stiffness = np.full(60, TANGENTIAL / 60)
    sliders = Sliders(np.full((1, 60), 1.0), stiffness[None], limits[None], np.ones((1, 60)), False)
    system, step = one_dof(), 2e-7
    x, v, peaks, times = 1e-4, 0.0, [], []
    a = -(SPRING * x + np.minimum(stiffness * x, limits).sum()) / MASS
    place = x - np.minimum(stiffness * x, limits) / stiffness
    for index in range(50000):
        v_half = v + 0.5 * step * a
        x += step * v_half
        force = np.clip(stiffness * (x - place), -limits, limits)
        place = x - force / stiffness
        a = -(SPRING * x + force.sum()) / MASS
        new = v_half + 0.5 * step * a
        if v > 0.0 >= new:
            part = v / (v - new)
            peaks.append(x)
            times.append((index + part) * step)
        v = new
    peaks, times = np.array(peaks), np.array(times)
    middle = np.sqrt(peaks[1:] * peaks[:-1])
    decrement = np.log(peaks[:-1] / peaks[1:]) / np.pi
    amplitudes = np.geomspace(middle.min(), middle.max(), 12)

    def lost(decaying):
        """Loss factor of the decrement: with the frequency's own change the action falls."""
        curve = mode_curve(system, sliders, amplitudes, "harmonic-balance", (1, 3), decaying)
        slope = np.gradient(np.log(curve.frequency), np.log(amplitudes))
        eta = 2.0 * curve.damping_ratio / (1.0 + 0.5 * slope)
        return [np.interp(middle, amplitudes, part) for part in (eta, curve.frequency)]

    fading, frequency = lost(True)
    steady, _ = lost(False)
    assert np.abs(decrement / fading - 1.0).mean() < 0.006
    assert (decrement / steady - 1.0).mean() > 0.02
    assert np.abs(frequency * np.diff(times) - 1.0).max() < 1e-3
