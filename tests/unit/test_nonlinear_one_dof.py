"""Section 3.4 three ways: closed forms (3.19), harmonic balance, decays in time through FREEVIB.

With the source's own slider damping reaches 0.3: a decay crosses the hump in two cycles and no
single harmonic describes it. The same slider made fifty times weaker is described to some ppm.
"""

import numpy as np
import pytest
from bladeroot.contact.laws import closed_forms
from bladeroot.decay.freevib import freevib
from bladeroot.nonlinear.curves import mode_curve
from nonlinear_systems import MASS, SPRING, sliding_mass
from one_step import exact, newmark
from time_integration import free_decay

CONTACT = 0.02 * SPRING
X_CR = 1e-4
ZETA = 5e-4
SAMPLING = 51200.0


@pytest.fixture(scope="module", params=[(newmark, 16), (exact, 4)], ids=["newmark", "exact"])
def found(request):
    """Curves that FREEVIB reads off a decay from fifteen times the critical amplitude."""
    method, substeps = request.param
    system, law = sliding_mass(contact=CONTACT, limit=CONTACT * X_CR)
    omega = np.sqrt(system.values)
    step = method(omega, np.array([ZETA]), 1.0 / SAMPLING / substeps)
    start = np.array([15.0 * X_CR * np.sqrt(MASS)])
    v = free_decay(system, law, step, start, int(1.6 * SAMPLING) * substeps, substeps).velocity
    noise = 1e-6 * np.abs(v).max()
    v = v + noise * np.random.default_rng(0).standard_normal(v.size)
    return freevib(v, SAMPLING, omega[0] / 2 / np.pi, noise, tolerance=0.4)


def test_time_integration_through_freevib_is_the_closed_form(found):
    size = found["amplitude"].values
    f, eta = closed_forms.one_dof(size, MASS, SPRING, CONTACT, CONTACT * X_CR)
    viscous = 2 * ZETA * np.sqrt((SPRING + CONTACT) / MASS) / (2 * np.pi * f)
    eta = eta + viscous
    own = (size > 0.1 * X_CR) & (size < 14 * X_CR)
    assert own.sum() > 100
    np.testing.assert_allclose(found["frequency"].values[own], f[own], rtol=1e-4)
    np.testing.assert_allclose(
        found["loss_factor"].values[own], eta[own], rtol=2e-2, atol=0.01 * eta.max()
    )


def test_harmonic_balance_is_the_closed_form():
    ladder = X_CR * np.geomspace(0.5, 14.0, 20)
    system, law = sliding_mass(contact=CONTACT, limit=CONTACT * X_CR)
    curve = mode_curve(system, law, ladder, "harmonic-balance", (1,))
    f, eta = closed_forms.one_dof(ladder, MASS, SPRING, CONTACT, CONTACT * X_CR)
    np.testing.assert_allclose(curve.frequency, f, rtol=1e-4)
    np.testing.assert_allclose(curve.loss_factor, eta, atol=1e-2 * eta.max())


def test_stiffness_and_loss_at_twice_the_critical_amplitude():
    """At x0 = 2 X_cr theta is a right angle: k/kt = 1/2 and h/kt = 1/pi (3.19)."""
    real, imaginary = closed_forms.equivalent_stiffness(np.array([2.0]), 1.0, 1.0)
    np.testing.assert_allclose([real[0], imaginary[0]], [0.5, 1.0 / np.pi])
