"""Contact laws: forces, areas and Jacobians against closed forms and finite differences."""

from dataclasses import replace

import numpy as np
import pytest
from bladeroot.contact.laws import closed_forms
from bladeroot.contact.laws.coulomb import coulomb
from bladeroot.contact.laws.distributed import distributed
from bladeroot.contact.laws.iwan import iwan
from bladeroot.contact.laws.jenkins import jenkins
from bladeroot.contact.laws.linear import linear
from bladeroot.contact.laws.profiles import power_profile, punch_profile
from bladeroot.contact.laws.sliders import Sliders, at_rest, load
from bladeroot.contact.punch import Punch
from slider_history import history

KN, KT, N0, MU = 3.0, 2.0, 1.5, 0.4


def one(law, *more):
    return law(np.array([KN]), np.array([KT]), *more)


def cycles(size, direction=(0.0, 1.0, 0.0), count=512):
    theta = 2.0 * np.pi * np.arange(2 * count + 1) / count
    return size * np.cos(theta)[:, None, None] * np.array(direction)


def area(motion, force, count=512):
    """Of the last loop: the integral of the force over the motion."""
    u, f = motion[-count - 1 :, 0], force[-count - 1 :, 0]
    return float((0.5 * (f[1:] + f[:-1]) * np.diff(u, axis=0)).sum())


def test_linear_contact_never_slips():
    law = one(linear)
    motion = cycles(1e6, (0.2, -1.0, 0.5))
    force, last, _ = history(law, motion, at_rest(law))
    assert np.allclose(force, motion * [KN, KT, KT])
    assert not last.any()


@pytest.mark.parametrize("ratio", [0.5, 1.2, 3.0, 20.0])
def test_area_of_a_loop_is_the_energy_of_the_closed_form(ratio):
    law = one(jenkins, np.array([N0]), MU)
    size = ratio * MU * N0 / KT
    motion = cycles(size, (0.0, 0.6, 0.8))
    force, _, _ = history(law, motion, at_rest(law))
    _, imaginary = closed_forms.equivalent_stiffness(size, KT, MU * N0)
    lost = np.pi * float(imaginary) * size**2
    assert area(motion, force) == pytest.approx(lost, rel=1e-4, abs=1e-12)


@pytest.mark.parametrize("ratio", [0.5, 1.2, 3.0, 20.0])
def test_first_harmonic_of_a_loop_is_equation_3_19(ratio):
    law = one(jenkins, np.array([N0]), MU)
    size, count = ratio * MU * N0 / KT, 4096
    motion = cycles(size, count=count)
    force, _, _ = history(law, motion, at_rest(law))
    theta = 2.0 * np.pi * np.arange(count) / count
    harmonic = 2.0 / count * np.exp(-1j * theta) @ force[count : 2 * count, 0, 1] / size
    real, imaginary = closed_forms.equivalent_stiffness(size, KT, MU * N0)
    assert harmonic.real == pytest.approx(float(real), rel=1e-3)
    assert harmonic.imag == pytest.approx(float(imaginary), rel=1e-3, abs=1e-12)


def test_a_contact_under_varying_load_lifts_off():
    law = one(coulomb, np.array([N0]), MU)
    force, tangent, _, slips = load(law, np.array([[-0.6, 0.3, 0.0]]), at_rest(law))
    assert np.allclose(force, [[-N0, 0.0, 0.0]])
    assert not tangent.any()
    assert slips.all()


def test_friction_follows_the_normal_load():
    law = one(coulomb, np.array([N0]), MU)
    force, _, _, _ = load(law, np.array([[0.1, 3.0, 4.0]]), at_rest(law))
    assert np.allclose(force, [[KN * 0.1, *(MU * (N0 + KN * 0.1) * np.array([0.6, 0.8]))]])


def random_law(rng, contacts=5, sliders=3):
    shape = (contacts, sliders)
    kn, kt, n0, mu = rng.uniform(0.5, 2.0, (4, *shape))
    return Sliders(kn, kt, n0, 0.5 * mu, True)


@pytest.mark.parametrize("seed", range(3))
def test_step_jacobian_is_the_finite_difference_in_stick_slip_and_lift_off(seed):
    rng = np.random.default_rng(seed)
    law = random_law(rng, 40)
    state = rng.normal(0.0, 0.5, at_rest(law).shape)
    motion = rng.normal(0.0, 1.5, (40, 3))
    _, tangent, _, slips = load(law, motion, state)
    assert slips.any()
    assert not slips.all()
    assert (law.preload + law.normal * motion[:, :1] < 0.0).any()
    h = 1e-6
    for axis in range(3):
        moved = h * (np.arange(3) == axis)
        up, down = (load(law, motion + sign * moved, state)[0] for sign in (1, -1))
        assert np.allclose((up - down) / (2 * h), tangent[:, :, axis], atol=1e-7)


@pytest.mark.parametrize("varies", [True, False])
def test_history_jacobian_is_the_finite_difference(varies):
    rng = np.random.default_rng(7)
    law = replace(random_law(rng), varies=varies)
    theta = 2.0 * np.pi * np.arange(128) / 64
    basis = np.stack([np.ones(128), np.cos(theta), np.sin(theta), np.cos(3 * theta)], axis=1)
    size = rng.normal(0.0, [0.3, 1.5, 1.0, 0.3], (5, 3, 4))
    columns = 12
    direct = rng.normal(size=(5, 3, 4, columns))
    seeds = np.einsum("th,cahp->tcap", basis, direct)

    def force_at(change):
        return history(law, np.einsum("th,cah->tca", basis, size + change), at_rest(law))[0]

    _, _, derivative = history(law, np.einsum("th,cah->tca", basis, size), at_rest(law), seeds)
    h = 1e-7
    for p in range(columns):
        difference = (force_at(h * direct[..., p]) - force_at(-h * direct[..., p])) / (2 * h)
        assert np.allclose(difference, derivative[..., p], atol=2e-6)


def test_a_history_is_a_chain_of_steps():
    rng = np.random.default_rng(3)
    law = random_law(rng)
    motion = rng.normal(0.0, 1.0, (20, 5, 3))
    force, last, _ = history(law, motion, at_rest(law))
    state = at_rest(law)
    for t in range(20):
        now, _, state, _ = load(law, motion[t], state)
        assert np.allclose(now, force[t])
    assert np.allclose(last, state)


def test_one_degree_of_freedom_of_section_3_4():
    f, eta = closed_forms.one_dof(np.array([1e-6, 99e-6, 1.0]), 0.7, 4.2e6, 4e6, 400.0)
    assert f[:2] == pytest.approx(544.73, abs=0.01)
    assert f[2] == pytest.approx(np.sqrt(4.2e6 / 0.7) / (2 * np.pi), rel=1e-3)
    assert not eta[:2].any()


def test_a_fixed_shape_is_one_degree_of_freedom():
    x = np.geomspace(5e-5, 1e-2, 7)
    f, eta = closed_forms.one_dof(x, 0.7, 4.2e6, 4e6, 400.0)
    root = np.sqrt(0.7)
    stick = np.sqrt(8.2e6 / 0.7) / (2 * np.pi)
    half = np.full(2, 0.5)
    same = closed_forms.fixed_shape(x * root, stick, np.full(2, 1 / root), half * 4e6, half * 400)
    assert np.allclose(same[0], f)
    assert np.allclose(same[1], eta)


def test_sliders_refuse_negative_numbers():
    with pytest.raises(ValueError, match="preload of sliders must not be negative"):
        one(jenkins, np.array([-1.0]), MU)


def monotonic(law, sizes):
    """Force of the first contact on a slow pull along Y."""
    return np.array(
        [
            load(law, np.tile([0.0, u, 0.0], (len(law.normal), 1)), at_rest(law))[0][:, 1].sum()
            for u in sizes
        ]
    )


@pytest.mark.parametrize("beta", [0.0, 0.7])
def test_iwan_follows_segalmans_integral(beta):
    chi, limit = -0.4, MU * N0
    law = one(iwan, np.array([N0]), MU, chi, beta, 200)
    most = limit * (1 + beta) / (KT * (beta + (chi + 1) / (chi + 2)))
    body = KT / (1 + beta)  # all but the peak
    u = np.geomspace(0.01, 1.5, 9) * most
    z = np.minimum(u / most, 1.0)
    slipped = body * most * (chi + 1) / (chi + 2) * z ** (chi + 2)
    rest = np.where(u < most, body * u * (1 - z ** (chi + 1)), 0.0)
    exact = slipped + rest + KT * beta / (1 + beta) * np.minimum(u, most)
    assert exact[-1] == pytest.approx(limit)
    assert np.allclose(monotonic(law, u), exact, rtol=2e-3)


def test_iwan_as_it_comes_slips_and_loses_as_segalmans_does():
    """From a ten thousandth of its last slip on; below, the loss is less than 1e-10 of that."""
    chi, limit = -0.5, MU * N0
    law = one(iwan, np.array([N0]), MU, chi)
    most = limit * (chi + 2.0) / (KT * (chi + 1.0))
    for part in (1e-4, 1e-3, 0.01, 0.1, 0.5):
        lost = area(cycles(part * most), history(law, cycles(part * most), at_rest(law))[0])
        body = KT * (chi + 1.0) * most ** -(chi + 1.0)  # density R
        exact = 4.0 * body * (part * most) ** (chi + 3.0) / ((chi + 3.0) * (chi + 2.0))
        assert lost == pytest.approx(exact, rel=0.06)


def test_iwans_loss_grows_with_its_exponent():
    chi = -0.4
    law = one(iwan, np.array([N0]), MU, chi, 0.0, 120)
    sizes = np.array([0.05, 0.1]) * MU * N0 / KT
    lost = [area(m, history(law, m, at_rest(law))[0]) for m in map(cycles, sizes)]
    assert np.log2(lost[1] / lost[0]) == pytest.approx(chi + 3.0, abs=0.02)


def flank(profile, friction=MU, strips=6):
    """A flank of three contacts of Simpson's weights that moves as one."""
    share = np.array([1, 4, 1]) / 6
    place = np.array([[0, 1], [1, 5], [5, 6]]) / 6
    return distributed(
        jenkins(KN * share, KT * share, N0 * share, friction), place, profile, strips
    )


def test_distributed_of_uniform_pressure_in_rigid_motion_is_jenkins():
    law, single = flank(power_profile(0.0)), one(jenkins, np.array([N0]), MU)
    sizes = np.linspace(0.01, 3.0, 50) * MU * N0 / KT
    assert np.allclose(monotonic(law, sizes), monotonic(single, sizes))


@pytest.mark.parametrize("exponent", [0.0, 0.5, 2.0])
def test_strips_carry_the_whole_load_and_stiffness(exponent):
    law = flank(power_profile(exponent))
    assert law.preload.sum() == pytest.approx(N0)
    assert law.normal.sum() == pytest.approx(KN)
    assert law.tangential.sum() == pytest.approx(KT)


def test_elliptic_pressure_slips_from_the_edges():
    sizes = np.linspace(0.01, 1.4, 30) * MU * N0 / KT
    fine = monotonic(flank(power_profile(0.5), strips=200), sizes)
    # Stuck where mu p(s) N0 > KT u, p = 8/pi sqrt(s(1-s)): |2s - 1| < sqrt(1 - (u'/p0)^2).
    z = np.minimum(KT * sizes / (MU * N0) / (4 / np.pi), 1.0)
    half = np.sqrt(1 - z**2)
    outside = 1 - 2 / np.pi * (half * np.sqrt(1 - half**2) + np.arcsin(half))
    exact = KT * sizes * half + MU * N0 * outside
    assert np.allclose(fine, exact, rtol=1e-3)
    assert fine[3] < 0.999 * KT * sizes[3]


def test_the_punch_profile_is_hertz_without_a_flat_and_uniform_with_a_wide_one():
    place = np.linspace(0, 1, 21)
    round_ = Punch(0.0, 2.5e-3, 26e-3, 210e9, 0.3, 0.42)
    flat = Punch(1e-1, 1e-7, 26e-3, 210e9, 0.3, 0.42)
    assert np.allclose(punch_profile(round_, 1e4)(place), power_profile(0.5)(place), atol=1e-5)
    # a rigid flat punch: 1/sqrt(s (1 - s))
    assert np.allclose(punch_profile(flat, 1e4)(place), power_profile(-0.5)(place), atol=5e-3)


@pytest.mark.parametrize(("chi", "beta"), [(-1.0, 0.0), (-0.5, -0.1)])
def test_iwan_refuses_what_is_no_population(chi, beta):
    with pytest.raises(ValueError, match="chi must be above"):
        one(iwan, np.array([N0]), MU, chi, beta)
