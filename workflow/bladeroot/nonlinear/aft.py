"""Alternating frequency-time: harmonics of the motion in, harmonics of the contact force out.

Motion is x(theta) = x_0 + sum of x_c cos(h theta) + x_s sin(h theta); coefficients are ordered
mean, cosine and sine of each harmonic. Sliders are marched from rest until they repeat themselves.
The Jacobian is exact for the sampled cycles and couples a contact's coefficients only among
themselves.

In a free decay the motion fades, x(theta) exp(-zeta theta), and friction remembers the larger
cycle before: its loss is higher than the periodic one's by a part of the order of the loss factor.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import no_type_check

import numpy as np
from jaxtyping import Float
from numba import njit
from numpy import ndarray

from bladeroot.contact.laws.sliders import Sliders, parts, slide

TIMES = 128


@dataclass(frozen=True)
class Cycle:
    """A march: coefficients to samples, samples to coefficients, and both in turn.

    The samples before `first` only lead to the steady state.
    """

    harmonics: tuple[int, ...]
    first: int
    synthesis: Float[ndarray, "time coefficient"]
    analysis: Float[ndarray, "time coefficient"]
    product: Float[ndarray, "time coefficient coefficient"]


def cycle(harmonics: Sequence[int], times: int = TIMES, fade: float = 0.0) -> Cycle:
    """Samples of the given harmonics, ascending; 0 is the mean. ValueError if too few times.

    Without fading the second of two cycles is analysed. With it (fade: zeta of the decay), the
    second and third of three, weighted like a triangle about the moment between them, at which the
    coefficients hold: so the amplitude's trend in force over motion cancels.
    """
    if list(harmonics) != sorted(set(harmonics)) or min(harmonics) < 0 or 1 not in harmonics:
        raise ValueError(f"harmonics must be ascending, with 1 among them, got {list(harmonics)}")
    if times < 4 * max(harmonics):
        raise ValueError(f"{times} times a cycle are too few for harmonic {max(harmonics)}")
    theta = 2.0 * np.pi * np.arange((2 if fade == 0.0 else 3) * times) / times
    columns = [np.cos(h * theta) if trig else np.sin(h * theta) for h, trig in layout(harmonics)]
    basis = np.stack(columns, axis=1)
    weight = np.where(theta < 2.0 * np.pi, 0.0, 1.0)
    envelope = np.ones(len(theta))
    if fade != 0.0:
        after = theta - 4.0 * np.pi
        weight *= 1.0 - np.abs(after) / (2.0 * np.pi)
        envelope = np.exp(-fade * after)
    synthesis = envelope[:, None] * basis
    analysis = (weight / envelope)[:, None] * basis / (basis[:times] ** 2).sum(axis=0)
    product = analysis[:, :, None] * synthesis[:, None, :]
    return Cycle(tuple(harmonics), times, synthesis, analysis, product)


def layout(harmonics: Sequence[int]) -> list[tuple[int, int]]:
    """Harmonic and 1 for cosine, 0 for sine, of each coefficient; the mean is (0, 1)."""
    return [(h, trig) for h in harmonics for trig in ((1, 0) if h else (1,))]


def contact_forces(
    sliders: Sliders, coefficients: Float[ndarray, "contact 3 coefficient"], samples: Cycle
) -> tuple[
    Float[ndarray, "contact 3 coefficient"],
    Float[ndarray, "contact 3 coefficient 3 coefficient"],
    Float[ndarray, "contact slider"],
]:
    """Force coefficients (N), their derivative by the motion's (N/m), and the share of slip.

    coefficients: of each contact's normal and tangential motion, m. The last is the part of the
    cycle in which each slider slips.
    """
    return _contact_forces(
        *parts(sliders),
        np.ascontiguousarray(coefficients),
        samples.first,
        samples.synthesis,
        samples.analysis,
        samples.product,
    )


@njit(cache=True, error_model="numpy", fastmath=True)
@no_type_check
def _contact_forces(kn, kt, n0, mu, varies, coefficients, first, synthesis, analysis, product):
    contacts, sliders = kn.shape
    times, size = synthesis.shape
    force = np.zeros((contacts, 3, size))
    jacobian = np.zeros((contacts, 3, size, 3, size))
    slipped = np.zeros((contacts, sliders))
    motion = np.zeros((times, 3))
    wave = np.zeros((times, 3))
    slope_t = np.zeros(times)
    moved = np.zeros((2, 3 * size))  # derivative of the friction point by all coefficients
    turned = np.zeros(3 * size)
    wait = np.zeros(size)  # analysis summed over the present stick
    stuck = np.zeros((size, size))
    bent = np.zeros((3, size, size))  # slip's own part: e1 e1, e1 e2, e2 e2
    steep = np.zeros((2, size, size))
    for c in range(contacts):
        for t in range(times):
            for a in range(3):
                x = 0.0
                for h in range(size):
                    x += synthesis[t, h] * coefficients[c, a, h]
                motion[t, a] = x
                wave[t, a] = 0.0
            slope_t[t] = 0.0
        tangent = jacobian[c].reshape(3, size, 3 * size)
        for s in range(sliders):
            k = kt[c, s]
            w1, w2 = 0.0, 0.0
            moved[:] = 0.0
            stuck[:] = 0.0
            bent[:] = 0.0
            steep[:] = 0.0
            wait[:] = 0.0
            count, rested = 0, False
            for t in range(times):
                counts = t >= first
                un, u1, u2 = motion[t, 0], motion[t, 1], motion[t, 2]
                normal, slope, limit, steeper, length, e1, e2, slips = slide(
                    kn[c, s], k, n0[c, s], mu[c, s], varies, un, u1, u2, w1, w2
                )
                if counts:
                    wave[t, 0] += normal
                    slope_t[t] += slope
                if not slips:
                    if counts:
                        rested = True
                        wave[t, 1] += k * e1
                        wave[t, 2] += k * e2
                        for h in range(size):
                            wait[h] += analysis[t, h]
                            for g in range(size):
                                stuck[h, g] += product[t, h, g]
                    continue
                if counts:
                    if rested:
                        _settle(tangent, wait, moved, k)
                        rested = False
                    count += 1
                    wave[t, 1] += limit * e1
                    wave[t, 2] += limit * e2
                turn = limit / length
                # stretch across the slip, by all coefficients but the direct ones of motion
                for p in range(3 * size):
                    turned[p] = turn * (e1 * moved[1, p] - e2 * moved[0, p])
                if counts:
                    for h in range(size):
                        q = analysis[t, h]
                        for g in range(size):
                            b = product[t, h, g] * turn
                            bent[0, h, g] += b * e1 * e1
                            bent[1, h, g] += b * e1 * e2
                            bent[2, h, g] += b * e2 * e2
                        if varies:
                            for g in range(size):
                                b = product[t, h, g] * steeper
                                steep[0, h, g] += b * e1
                                steep[1, h, g] += b * e2
                        q1, q2 = q * e1, q * e2
                        for p in range(3 * size):
                            tangent[1, h, p] += q2 * turned[p]
                            tangent[2, h, p] -= q1 * turned[p]
                c1, c2 = e1 / k, e2 / k
                for p in range(3 * size):
                    moved[0, p] = -c2 * turned[p]
                    moved[1, p] = c1 * turned[p]
                r = turn / k
                for g in range(size):
                    b = synthesis[t, g]
                    moved[0, g] -= steeper * c1 * b
                    moved[1, g] -= steeper * c2 * b
                    moved[0, size + g] += b * (1.0 - r * e2 * e2)
                    moved[0, 2 * size + g] += b * r * e1 * e2
                    moved[1, size + g] += b * r * e1 * e2
                    moved[1, 2 * size + g] += b * (1.0 - r * e1 * e1)
                w1, w2 = u1 - limit * e1 / k, u2 - limit * e2 / k
            _settle(tangent, wait, moved, k)
            slipped[c, s] = count / (times - first)
            for h in range(size):
                for g in range(size):
                    tangent[1, h, size + g] += k * stuck[h, g] + bent[2, h, g]
                    tangent[2, h, 2 * size + g] += k * stuck[h, g] + bent[0, h, g]
                    tangent[1, h, 2 * size + g] -= bent[1, h, g]
                    tangent[2, h, size + g] -= bent[1, h, g]
                    tangent[1, h, g] += steep[0, h, g]
                    tangent[2, h, g] += steep[1, h, g]
        for t in range(first, times):
            for h in range(size):
                for a in range(3):
                    force[c, a, h] += analysis[t, h] * wave[t, a]
                for g in range(size):
                    tangent[0, h, g] += slope_t[t] * product[t, h, g]
    return force, jacobian, slipped


@njit(cache=True, error_model="numpy", fastmath=True)
@no_type_check
def _settle(tangent, wait, moved, k):
    """Book the friction point's derivative over the stick that ends, and begin anew."""
    size = len(wait)
    for h in range(size):
        q = k * wait[h]
        for p in range(3 * size):
            tangent[1, h, p] -= q * moved[0, p]
            tangent[2, h, p] -= q * moved[1, p]
        wait[h] = 0.0
