"""Approach of two bodies and incremental stiffness of the punch (sections 6.3 and 6.4).

Forces here are those of a whole flank, newton; the line loads of `punch` are force / length.
The approach comes by quadrature of the pressure, as in the thesis; its derivative, the stiffness,
in closed form. That follows from one observation: a small step of load adds the pressure of a flat
punch as wide as the contact is at that moment, dP / (pi sqrt(b^2 - x^2)), whatever the profile, so
only b enters.
"""

from typing import Literal

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.contact.punch import Array, Punch, contact_half_width, pressure
from bladeroot.contact.quadrature import panel_rule

Kernel = Literal["finite", "slender"]


def _influence(distance: Array, punch: Punch, kernel: Kernel) -> Array:
    """The line's influence on the centre: exact for length L, or its limit L >> b."""
    if kernel == "finite":
        return np.arcsinh(punch.length / (2.0 * distance))
    return np.log(punch.length / distance)


def normal_approach(
    normal_force: Float[ndarray, " force"], punch: Punch, kernel: Kernel = "finite"
) -> Float[ndarray, " force"]:
    """Approach delta_z(N) of the two bodies, m, by quadrature (eqs 6.13, 6.14).

    2/(pi E*) int p(r) g(r) dr with g = arsinh(L/2r), which is half the logarithm of eq. 6.14.
    kernel "slender" takes its limit g = ln(L/r), the form of appendix E.
    """
    load = np.asarray(normal_force, float) / punch.length
    b = contact_half_width(load, punch)
    a = np.minimum(np.full_like(b, punch.flat_half_width), b)
    # the angle phi removes the square root at b; breaks where the integrand is logarithmic
    break_ = np.arcsin(np.divide(a, b, out=np.ones_like(b), where=b > 0.0))
    edges = np.stack([np.zeros_like(b), break_, np.full_like(b, 0.5 * np.pi)], axis=-1)
    angle, weight = panel_rule(edges)
    r = np.maximum(b[:, None] * np.sin(angle), np.finfo(float).tiny)
    p = pressure(r, load[:, None], punch)
    jacobian = b[:, None] * np.cos(angle)
    total = 2.0 * np.sum(weight * jacobian * p * _influence(r, punch, kernel), axis=-1)
    return 2.0 / (np.pi * punch.contact_modulus) * total


def _pressed_compliance(
    normal_force: Float[ndarray, " force"], punch: Punch
) -> Float[ndarray, " force"]:
    """Tangential displacement were the whole shear equal to the pressure of N (slender body)."""
    load = np.asarray(normal_force, float) / punch.length
    constant = punch.poisson_ratio / (1.0 - punch.poisson_ratio)
    normal = normal_approach(normal_force, punch, "slender")
    return normal + 2.0 / (np.pi * punch.contact_modulus) * load * constant


def tangential_displacement(
    normal_force: Float[ndarray, " force"],
    tangential_force: Float[ndarray, " force"],
    punch: Punch,
) -> Float[ndarray, " force"]:
    """Relative tangential displacement delta_x(N, T), m, by quadrature (eqs 6.7, 6.10).

    The shear is mu times the difference of two pressures, of N and of N - |T|/mu, so the integral
    of eq. 6.10 is mu times the difference of theirs. The last logarithm of eq. 6.10 is taken as
    ln(L/b), as appendix E has it: the printed ln|r/b| leaves the integration variable outside
    the integral. Raises ValueError when |T| > mu N.
    """
    force = np.asarray(normal_force, float)
    shear = np.asarray(tangential_force, float)
    stick = force - np.abs(shear) / punch.friction
    if not np.all(stick >= -1e-12 * force):
        raise ValueError("the tangential force exceeds friction times the normal force")
    moved = _pressed_compliance(force, punch) - _pressed_compliance(np.maximum(stick, 0), punch)
    return np.sign(shear) * punch.friction * moved


def normal_stiffness(
    normal_force: Float[ndarray, " force"], punch: Punch
) -> Float[ndarray, " force"]:
    """kn = (pi/2) E* L / ln(2L/b), N/m: eq. 6.15 in closed form for L >> b.

    The finite length adds b^2/(2 L^2) to the logarithm, below 0.1 % of it for b < L/15.
    """
    half_width = contact_half_width(np.asarray(normal_force, float) / punch.length, punch)
    return _flank(punch) / np.log(2.0 * punch.length / half_width)


def tangential_stiffness(
    normal_force: Float[ndarray, " force"], punch: Punch
) -> Float[ndarray, " force"]:
    """kt = (pi/2) E* L / (ln(2L/b) + nu/(1 - nu)), N/m: eq. 6.11 in closed form."""
    half_width = contact_half_width(np.asarray(normal_force, float) / punch.length, punch)
    constant = punch.poisson_ratio / (1.0 - punch.poisson_ratio)
    return _flank(punch) / (np.log(2.0 * punch.length / half_width) + constant)


def _flank(punch: Punch) -> float:
    return 0.5 * np.pi * punch.contact_modulus * punch.length


def dissipated_energy(
    normal_force: Float[ndarray, " force"],
    tangential_force: Float[ndarray, " force"],
    punch: Punch,
) -> Float[ndarray, " force"]:
    """Energy lost in a cycle between -T and T at constant N, J (appendix C).

    Unloading and reloading follow the virgin curve at twice its scale (Masing), so the loop's
    area is 8 (T delta(T)/2 - int_0^T delta dT), with delta of eq. 6.10. The length and Poisson's
    ratio drop out: only slip dissipates. At full sliding of a cylinder it is
    (pi/2) (2/pi)^2 (mu P)^2 / E* per metre.
    """
    force = np.asarray(normal_force, float)
    top = np.abs(np.asarray(tangential_force, float))
    # delta has the form (1 - T/mu N) ln(1 - T/mu N) at full sliding
    t, weight = panel_rule(np.stack([np.zeros_like(top), top], axis=-1), count=61)
    n = np.broadcast_to(force[:, None], t.shape)
    along = tangential_displacement(n.ravel(), t.ravel(), punch).reshape(t.shape)
    end = tangential_displacement(force, top, punch)
    # shear less the secant keeps the difference of two large numbers out of the sum
    secant = end[:, None] * np.divide(t, top[:, None], out=np.zeros_like(t), where=top[:, None] > 0)
    return 8.0 * np.sum(weight * (secant - along), axis=-1)
