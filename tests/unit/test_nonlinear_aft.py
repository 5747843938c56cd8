"""The frequency-time kernel against the march in time and against finite differences."""

from dataclasses import replace

import numpy as np
import pytest
from bladeroot.contact.laws.sliders import Sliders, at_rest
from bladeroot.nonlinear.aft import contact_forces, cycle
from slider_history import history

SAMPLES = cycle((0, 1, 2, 3), 64)


def case(seed, varies, contacts=30, sliders=2):
    rng = np.random.default_rng(seed)
    kn, kt, n0, mu = rng.uniform(0.5, 2.0, (4, contacts, sliders))
    size = [0.2, 1.0, 0.7, 0.2, 0.1, 0.2, 0.1]
    motion = rng.normal(0.0, size, (contacts, 3, 7)) * rng.uniform(0.1, 3.0, (contacts, 1, 1))
    return Sliders(kn, kt, n0, 0.5 * mu, varies), motion


def by_time(law, motion, samples):
    path = np.einsum("th,cah->tca", samples.synthesis, motion)
    seeds = np.einsum("th,ab->tahb", samples.synthesis, np.eye(3))
    seeds = seeds.transpose(0, 1, 3, 2).reshape(-1, 1, 3, 21)
    force, _, derivative = history(law, path, at_rest(law), np.tile(seeds, (1, len(motion), 1, 1)))
    force = np.einsum("th,tca->cah", samples.analysis, force)
    jacobian = np.einsum("th,tcap->cahp", samples.analysis, derivative)
    return force, jacobian.reshape(*force.shape, 3, 7)


@pytest.mark.parametrize("fade", [0.0, 0.01])
@pytest.mark.parametrize("varies", [True, False])
def test_harmonics_are_those_of_the_march_in_time(varies, fade):
    law, motion = case(1, varies)
    samples = cycle((0, 1, 2, 3), 64, fade)
    force, jacobian, slipped = contact_forces(law, motion, samples)
    expected, derivative = by_time(law, motion, samples)
    assert np.allclose(force, expected, atol=1e-12)
    assert np.allclose(jacobian, derivative, atol=1e-10)
    assert (slipped == 0.0).any()
    assert (slipped > 0.5).any()


@pytest.mark.parametrize("varies", [True, False])
def test_jacobian_is_the_finite_difference(varies):
    law, motion = case(2, varies)
    _, jacobian, _ = contact_forces(law, motion, SAMPLES)
    h = 1e-7
    for a in range(3):
        for g in range(7):
            moved = np.zeros((3, 7))
            moved[a, g] = h
            up, down = (contact_forces(law, motion + s * moved, SAMPLES)[0] for s in (1, -1))
            assert np.allclose((up - down) / (2 * h), jacobian[..., a, g], atol=2e-6)


def test_lost_energy_is_the_area_of_the_loop():
    law, motion = case(3, True, 5, 1)
    law = replace(law, friction=0.1 * law.friction)
    fine = cycle((0, 1, 2, 3), 4096)
    force, _, _ = contact_forces(law, motion, fine)
    cosine, sine, order = slice(1, None, 2), slice(2, None, 2), np.arange(1, 4)
    work = force[..., cosine] * motion[..., sine] - force[..., sine] * motion[..., cosine]
    path = np.einsum("th,cah->tca", fine.synthesis, motion)
    waves = history(law, np.concatenate([path, path[:1]]), at_rest(law))[0][4096:]
    path = np.concatenate([path[4096:], path[:1]])
    area = (0.5 * (waves[1:] + waves[:-1]) * np.diff(path, axis=0)).sum()
    assert area > 0.0
    assert np.pi * (order * work).sum() == pytest.approx(area, rel=1e-4)


@pytest.mark.parametrize("harmonics", [(1, 1), (2, 3), (3, 1)])
def test_harmonics_must_be_ascending_and_hold_the_first(harmonics):
    with pytest.raises(ValueError, match="harmonics must be ascending"):
        cycle(harmonics)


def test_linear_contact_has_no_part_in_fading():
    law, motion = case(4, False)
    law = replace(law, friction=np.full(law.friction.shape, np.inf))
    force, _, _ = contact_forces(law, motion, cycle((0, 1, 2, 3), 64, 0.03))
    stiffness = np.stack([law.normal.sum(1), law.tangential.sum(1), law.tangential.sum(1)], axis=1)
    assert np.allclose(force, stiffness[:, :, None] * motion)
