"""The flat punch with rounded edges: contact width, pressure and shear (section 6.2).

A punch with a straight part of half-width `a` and edge radius `R` is pressed on a half-plane by
`P` newton per metre. Contact reaches to the half-width `b`; under a tangential load `Q` the middle
part of half-width `c` sticks. Out of scope: tilt of the punch, dissimilar materials, finite
thickness of the bodies.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from numpy import ndarray

Array = Float[ndarray, "..."] | float  # numpy turns arrays of no dimension into floats

PARAMETERS = (
    "flat_half_width",
    "edge_radius",
    "length",
    "youngs_modulus",
    "poisson_ratio",
    "friction",
    "flank_angle",
)


@dataclass(frozen=True)
class Punch:
    """One flank as an indenter on a half-space; SI units, two bodies of one material.

    flat_half_width: a, m; zero gives the cylinder of Hertz. edge_radius: R, m. length: L, m.
    youngs_modulus: E, Pa. poisson_ratio: nu. friction: mu.
    width_law: "consistent" uses 2PR in eq. 6.5, which agrees with Hertz as a -> 0;
    "printed" uses the 4PR that the thesis prints, to show the difference.
    """

    flat_half_width: float
    edge_radius: float
    length: float
    youngs_modulus: float
    poisson_ratio: float
    friction: float
    width_law: str = "consistent"

    def __post_init__(self) -> None:
        """Refuse values that are no geometry or no material."""
        for name in ("edge_radius", "length", "youngs_modulus", "friction"):
            if not getattr(self, name) > 0.0:
                raise ValueError(f"{name} must be positive, got {getattr(self, name)}")
        if not self.flat_half_width >= 0.0:
            raise ValueError(f"flat_half_width must not be negative, got {self.flat_half_width}")
        if not -1.0 < self.poisson_ratio <= 0.5:
            raise ValueError(f"poisson_ratio must lie in (-1, 0.5], got {self.poisson_ratio}")
        if self.width_law not in ("consistent", "printed"):
            raise ValueError(f"width_law must be 'consistent' or 'printed', got {self.width_law!r}")

    @property
    def contact_modulus(self) -> float:
        """E* of two bodies of one material, Pa: 1/E* = 2 (1 - nu^2)/E (eq. 6.6)."""
        return self.youngs_modulus / (2.0 * (1.0 - self.poisson_ratio**2))


def punch_from(parameters: Mapping[str, float], width_law: str = "consistent") -> Punch:
    """The punch of a parameter table in SI units; keys as in `PARAMETERS`.

    Raises ValueError naming the keys that are missing.
    """
    missing = [name for name in PARAMETERS if name not in parameters]
    if missing:
        raise ValueError(f"contact parameters: missing {', '.join(missing)}")
    names = [name for name in PARAMETERS if name != "flank_angle"]
    return Punch(**{name: float(parameters[name]) for name in names}, width_law=width_law)


def _load_function(ratio: Array) -> Array:
    """(1 + u^2) arctan u - u, the right-hand side of eq. 6.5 with u = cot(phi_0)."""
    direct = (1.0 + ratio**2) * np.arctan(ratio) - ratio
    u2 = np.minimum(ratio, 0.1) ** 2  # the direct form cancels here; the series does not
    series = sum((-1.0) ** (k + 1) * 2.0 / ((2 * k - 1) * (2 * k + 1)) * u2**k for k in range(1, 9))
    return np.where(ratio < 0.1, ratio * series, direct)


def contact_half_width(line_load: Array, punch: Punch) -> Array:
    """Half-width b of the contact under P = `line_load` (N/m), in m (eq. 6.5).

    With s = sqrt(b^2 - a^2) and u = s/a, eq. 6.5 reads a^2 [(1 + u^2) arctan u - u] = 2PR/E*,
    which is convex in s, so Newton's method converges from any positive start. As a -> 0 it
    becomes Hertz's b^2 = 4PR/(pi E*) (appendix C). Raises ValueError for a negative load.
    """
    load = np.asarray(line_load, float)
    if not np.all(load >= 0.0):
        raise ValueError(f"line load must not be negative, got {np.min(load)} N/m")
    factor = {"consistent": 2.0, "printed": 4.0}[punch.width_law]
    target = factor * load * punch.edge_radius / punch.contact_modulus
    hertz = np.sqrt(2.0 * target / np.pi)
    a = punch.flat_half_width
    if a == 0.0:
        return hertz
    target = target / a**2
    ratio = np.cbrt(1.5 * target) + hertz / a
    for _ in range(60):
        slope = 2.0 * ratio * np.arctan(ratio)
        excess = _load_function(ratio) - target
        step = np.divide(excess, slope, out=np.zeros_like(slope), where=slope > 0.0)
        ratio = ratio - step
        if np.all(np.abs(step) <= 4e-16 * ratio):
            break
    return a * np.hypot(1.0, ratio)


def pressure(position: Array, line_load: Array, punch: Punch) -> Array:
    """Normal pressure p(x), Pa, at `position` x (m) under P = `line_load` (N/m) (eq. 6.4).

    Zero outside the contact. The two arrays broadcast. With gamma = pi/2 - phi_0 and
    psi = pi/2 - |phi| the logarithms of eq. 6.4 become two area hyperbolic tangents,
    which stay accurate for a wide flat (gamma -> 0) and at x = a, where they diverge but for a
    factor x - a. The factors sin(phi) and sin(phi_0) are exponents of whole fractions, as in
    [35]; the exponent in the printed eq. 6.4 sits on the numerator alone.
    """
    x = np.abs(np.asarray(position, float))
    load = np.asarray(line_load, float)
    a, b = punch.flat_half_width, contact_half_width(load, punch)
    edge = np.sqrt((b - a) * (b + a))
    gamma = np.arctan2(edge, a)
    inside = x < b
    x = np.where(inside, x, 0.0)
    below_one = 1.0 - 1e-16
    with np.errstate(divide="ignore", invalid="ignore"):  # no load and no flat: 0/0, set below
        t_gamma, t_psi = edge / (a + b), np.sqrt((b - x) / (b + x))
        small, large = np.minimum(t_gamma, t_psi), np.maximum(t_gamma, t_psi)
        near = np.where(x == a, 0.0, np.minimum(small / large, below_one))
        shape = (
            2.0 * gamma * np.sqrt((b - x) * (b + x))
            - 2.0 * (x + a) * np.arctanh(np.minimum(t_gamma * t_psi, below_one))
            + 2.0 * (x - a) * np.arctanh(near)
        )
        value = load * 2.0 / np.pi * shape / (b**2 * 2.0 * _sine_gap(edge, a, b))
    return np.where(inside & (load > 0.0), value, 0.0)


def _sine_gap(edge: Array, a: float, b: Array) -> Array:
    """(2 gamma - sin 2 gamma)/2 for tan(gamma) = edge/a, without cancellation."""
    if a == 0.0:
        return np.full_like(b, 0.5 * np.pi)
    return a**2 * _load_function(edge / a) / b**2


def stick_half_width(line_load: Array, shear_load: Array, punch: Punch) -> Array:
    """Half-width c of the sticking part, m, under P and Q in N/m (eq. 6.8).

    It is the contact half-width under the load P - |Q|/mu. At full sliding c = a, the value
    that the flat of a punch without tilt never loses. Raises ValueError when |Q| > mu P.
    """
    return contact_half_width(_stick_load(line_load, shear_load, punch), punch)


def shear(position: Array, line_load: Array, shear_load: Array, punch: Punch) -> Array:
    """Shear traction q(x), Pa, under a monotonic Q after P, both N/m (eqs 6.7, 6.9).

    mu p(x) of the whole contact less mu p(x) of the sticking part. Equation 6.9 prints a minus
    sign in front of q* although eq. 6.7 subtracts it already; the shear integrates to Q only with
    one of them. Raises ValueError when |Q| > mu P.
    """
    stick = _stick_load(line_load, shear_load, punch)
    full = pressure(position, line_load, punch)
    return np.sign(shear_load) * punch.friction * (full - pressure(position, stick, punch))


def _stick_load(line_load: Array, shear_load: Array, punch: Punch) -> Array:
    ratio = np.abs(np.asarray(shear_load, float)) / punch.friction
    load = np.asarray(line_load, float)
    if not np.all(ratio <= load * (1.0 + 1e-12)):
        raise ValueError("the shear load exceeds friction times the normal load")
    return np.maximum(load - ratio, 0.0)
