"""Alternating frequency-time: harmonics of the motion in, harmonics of the contact force out.

Motion is x(theta) = x_0 + sum of x_c cos(h theta) + x_s sin(h theta); coefficients are ordered
mean, cosine and sine of each harmonic. Sliders are marched from rest until their cycle repeats.
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
from numpy import ndarray

from bladeroot.compiled import njit
from bladeroot.contact.laws.sliders import Sliders, parts, slide

CYCLE_SAMPLES = 128  # times in a cycle at which motion and contact force are sampled


@dataclass(frozen=True)
class Cycle:
    """A march: coefficients to samples, and samples to coefficients.

    The samples before `first` only lead to the steady state.
    """

    harmonics: tuple[int, ...]
    first: int
    synthesis: Float[ndarray, "time coefficient"]
    analysis: Float[ndarray, "time coefficient"]


def cycle(harmonics: Sequence[int], times: int = CYCLE_SAMPLES, fade: float = 0.0) -> Cycle:
    """Samples of the given harmonics, ascending; 0 is the mean. ValueError if too few times.

    Without fading the second of two cycles is analysed. With it (fade: zeta of the decay), the
    second and third of three are, with triangular weights about the instant between them, for which
    the coefficients hold: so the trend of force over motion with amplitude cancels.
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
    return Cycle(tuple(harmonics), times, synthesis, analysis)


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
    )


@njit(cache=True, error_model="numpy", fastmath=True)
@no_type_check
def _contact_forces(kn, kt, n0, mu, varies, coefficients, first, synthesis, analysis):
    contacts, sliders = kn.shape
    times, size = synthesis.shape
    force = np.zeros((contacts, 3, size))
    jacobian = np.zeros((contacts, 3, size, 3, size))
    slipped = np.zeros((contacts, sliders))
    counted = analysis[first:].copy()
    whole = np.dot(counted.T, synthesis[first:].copy())
    wave = np.zeros((times - first, 3))
    lifted = np.zeros((size, size))
    moved = np.zeros((2, 3 * size))  # derivative of the friction point by all coefficients
    wait = np.zeros(size)  # analysis summed over the present stick
    # A row for each time in slip, so that sums over time are products of matrices: the force's
    # derivative across the slip, and that direction's samples to coefficients; motion's samples,
    # and their way to coefficients of a spring and of a limit that the normal load moves. The row
    # behind the last one kept is for times that do not count.
    rows = times - first + 1
    turned, across = np.zeros((rows, 3 * size)), np.zeros((rows, 2 * size))
    moving, along = np.zeros((rows, size)), np.zeros((rows, 3 * size))
    for c in range(contacts):
        motion = np.dot(synthesis, coefficients[c].T)
        wave[:] = 0.0
        lifted[:] = 0.0
        tangent = jacobian[c].reshape(3, size, 3 * size)
        for s in range(sliders):
            k = kt[c, s]
            w1, w2 = 0.0, 0.0
            moved[:] = 0.0
            wait[:] = 0.0
            n, rested = 0, False  # times in slip
            for t in range(times):
                counts = t >= first
                un, u1, u2 = motion[t, 0], motion[t, 1], motion[t, 2]
                normal, slope, limit, steeper, length, e1, e2, slips = slide(
                    kn[c, s], k, n0[c, s], mu[c, s], varies, un, u1, u2, w1, w2
                )
                pull = limit if slips else k  # e1, e2 are a direction only in slip
                if counts:
                    wave[t - first, 0] += normal
                    wave[t - first, 1] += pull * e1
                    wave[t - first, 2] += pull * e2
                    if slope != kn[c, s]:
                        for h in range(size):
                            for g in range(size):
                                lifted[h, g] += kn[c, s] * analysis[t, h] * synthesis[t, g]
                if not slips:
                    if counts:
                        rested = True
                        for h in range(size):
                            wait[h] += analysis[t, h]
                    continue
                if rested:
                    _settle(tangent, wait, moved, k)
                    rested = False
                turn = limit / length
                r1, r2 = turn * e1, turn * e2
                for p in range(3 * size):
                    turned[n, p] = r2 * moved[0, p] - r1 * moved[1, p]
                for g in range(size):
                    b = synthesis[t, g]
                    turned[n, size + g] -= r2 * b
                    turned[n, 2 * size + g] += r1 * b
                c1, c2 = e1 / k, e2 / k
                for p in range(3 * size):
                    moved[0, p] = c2 * turned[n, p]
                    moved[1, p] = -c1 * turned[n, p]
                for g in range(size):
                    b = synthesis[t, g]
                    moved[0, g] -= steeper * c1 * b
                    moved[1, g] -= steeper * c2 * b
                    moved[0, size + g] += b
                    moved[1, 2 * size + g] += b
                w1, w2 = u1 - limit * c1, u2 - limit * c2
                if counts:
                    for h in range(size):
                        q = analysis[t, h]
                        moving[n, h] = synthesis[t, h]
                        across[n, h], across[n, size + h] = -e2 * q, e1 * q
                        along[n, h] = q
                        along[n, size + h] = steeper * e1 * q
                        along[n, 2 * size + h] = steeper * e2 * q
                    n += 1
            _settle(tangent, wait, moved, k)
            if n == 0:
                continue
            slipped[c, s] = n / (times - first)
            turning = np.dot(across[:n].T, turned[:n])
            direct = np.dot(along[:n].T, moving[:n])
            for h in range(size):
                for p in range(3 * size):
                    tangent[1, h, p] += turning[h, p]
                    tangent[2, h, p] += turning[size + h, p]
                for g in range(size):
                    tangent[1, h, size + g] -= k * direct[h, g]
                    tangent[2, h, 2 * size + g] -= k * direct[h, g]
                    tangent[1, h, g] += direct[size + h, g]
                    tangent[2, h, g] += direct[2 * size + h, g]
        tangent[0, :, :size] += kn[c].sum() * whole - lifted
        tangent[1, :, size : 2 * size] += kt[c].sum() * whole
        tangent[2, :, 2 * size :] += kt[c].sum() * whole
        force[c] = np.dot(wave.T, counted)
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
