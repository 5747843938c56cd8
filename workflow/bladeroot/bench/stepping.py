"""Stepping the stuck modes in time while the sliders of the flanks stick and slip.

Between two instants each mode answers exactly to a load that varies linearly, so the decay of a
stuck specimen has no period error at any step. The slip of each step is solved together with the
motion: predicted stuck, then corrected (section 3.3.3), swept over the sliders until it settles.
"""

from dataclasses import dataclass
from typing import no_type_check

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray

from bladeroot.bench.forces import ModalForces, no_forces, nonlinear_force
from bladeroot.bench.sweep import copied, largest, own_give, settle_leading
from bladeroot.compiled import njit

_MOST_SWEEPS = 400  # over the sliders in a step
_SLIP_TOLERANCE = 1e-8  # largest move that counts as none, over the limit


@dataclass(frozen=True)
class Motion:
    """What one run leaves behind.

    `velocity` (m/s) at the laser and `amplitude` (m, of the driven mode at the laser), both a
    sample; `state` of the modes, `slip` of the sliders at the end; the work done (J):
    `work_in` by the drive, `work_damped` by the modal damping, `work_friction` by the sliders,
    `work_forces` by the other nonlinear forces; `energy` (J) stored at the end; `overshoot`, the
    largest slider force over its limit, less one; `sweeps`, the most that one step needed.
    """

    velocity: Float[ndarray, " sample"]
    amplitude: Float[ndarray, " sample"]
    state: Float[ndarray, " mode"]
    slip: Float[ndarray, " slider"]
    work_in: float
    work_damped: float
    work_friction: float
    work_forces: float
    energy: float
    overshoot: float
    sweeps: int

    @property
    def energy_error(self) -> float:
        """Energy that is not accounted for, over the work put in."""
        gone = self.work_damped + self.work_friction - self.work_forces
        left = self.work_in - gone - self.energy
        return abs(left) / max(abs(self.work_in), np.finfo(float).tiny)


@dataclass(frozen=True)
class Drive:
    """Force of the tip at every instant: a push plus a sine of given size, in newtons.

    The sine is kept in phase with the velocity of mode number `mode`: resonance, whatever the
    amplitude does to the frequency.
    """

    push: Float[ndarray, " step"]
    sine: Float[ndarray, " step"]
    mode: int


def linear_load_step(
    omega: Float[ndarray, " mode"], zeta: Float[ndarray, " mode"], dt: float
) -> Float[ndarray, "mode 2 4"]:
    """Exact step of r'' + 2 zeta omega r' + omega^2 r = g with g linear over the step dt.

    Rows give r and r' at the end from (r, r', g) at the start and g at the end.
    """
    omega, zeta = np.broadcast_arrays(omega, zeta)
    generator = np.zeros((omega.size, 4, 4))
    generator[:, 0, 1] = generator[:, 2, 3] = 1.0
    generator[:, 1, 0] = -((omega * dt) ** 2)
    generator[:, 1, 1] = -2 * zeta * omega * dt
    generator[:, 1, 2] = dt**2
    # Time is counted in steps inside, so that r' and the slope of g come out as r' dt and dg.
    grown = exponential(generator)
    step = np.empty((omega.size, 2, 4))
    for row, scale in ((0, 1.0), (1, 1.0 / dt)):
        step[:, row, 0] = scale * grown[:, row, 0]
        step[:, row, 1] = scale * grown[:, row, 1] * dt
        step[:, row, 2] = scale * (grown[:, row, 2] - grown[:, row, 3])
        step[:, row, 3] = scale * grown[:, row, 3]
    return step


def exponential(matrices: Float[ndarray, "matrix n n"]) -> Float[ndarray, "matrix n n"]:
    """Of many small matrices: Taylor's series of a part of each, squared again.

    To rounding; scipy's takes as long for a few dozen matrices as a tenth of a second's motion.
    """
    norm = np.abs(matrices).sum(axis=2).max()
    halvings = max(0, 1 + int(np.ceil(np.log2(norm)))) if norm > 0.0 else 0
    scaled = matrices / 2.0**halvings  # of norm 1/2 at most
    term = whole = np.broadcast_to(np.eye(matrices.shape[1]), matrices.shape)
    for k in range(1, 19):
        term = term @ scaled / k
        whole = whole + term
    for _ in range(halvings):
        whole = whole @ whole
    return whole


def run(
    omega: Float[ndarray, " mode"],
    zeta: Float[ndarray, " mode"],
    slider_shape: Float[ndarray, "slider mode"],
    slider_kt: Float[ndarray, " slider"],
    residual: Float[ndarray, "slider slider"],
    limit: Float[ndarray, " pair"],
    tip_shape: Float[ndarray, " mode"],
    laser_shape: Float[ndarray, " mode"],
    drive: Drive,
    dt: float,
    every: int = 1,
    state: Float[ndarray, " mode"] | None = None,
    forces: ModalForces | None = None,
) -> Motion:
    """Run the stuck modes with sliders under the drive, sampled each `every` steps.

    The motion obeys r'' + 2 zeta omega r' + omega^2 r = S^T kt w + p f, with the slider forces
    T = kt (S r + R kt w - w) kept inside a circle of radius `limit` (N) a pair: sliders 2i and
    2i+1 are the two directions of pair i, slip w (m) goes along T. Starts at rest, from the modal
    displacement `state` (zero if not given), without slip. `forces` act besides; they are known
    at each instant and continued over the next step by their last change.

    Raises RuntimeError if a step's slip does not settle.
    """
    step = linear_load_step(omega, zeta, dt)
    order = _loosest_first(slider_kt[:, None] * slider_shape, limit, drive.mode)
    shape, kt = slider_shape[order], slider_kt[order]
    r = np.zeros(omega.size) if state is None else state.astype(float)
    v = np.zeros(omega.size)
    slip = np.zeros(kt.size)
    flexible = (shape * step[:, 0, 3]) @ shape.T + residual[np.ix_(order, order)]
    # Slider force lost per slip within one step; symmetric, positive definite.
    give = np.diag(kt) - kt[:, None] * flexible * kt
    velocity, amplitude, work, overshoot, sweeps = _march(
        np.ascontiguousarray(step.transpose(1, 2, 0)),
        2 * zeta * omega,
        omega,
        np.ascontiguousarray(shape.T),
        kt,
        np.ascontiguousarray(give),
        limit[order[::2] // 2],
        tip_shape,
        laser_shape,
        drive.push,
        drive.sine,
        drive.mode,
        no_forces(omega.size) if forces is None else forces,
        dt,
        every,
        r,
        v,
        slip,
    )
    w = np.empty_like(slip)
    w[order] = slip
    if sweeps >= _MOST_SWEEPS:
        raise RuntimeError(f"the slip of a step did not settle in {_MOST_SWEEPS} sweeps")
    start = 0.0 if state is None else 0.5 * float(np.sum((omega * state) ** 2))
    return Motion(
        velocity=velocity,
        amplitude=amplitude,
        state=r,
        slip=w,
        work_in=float(work[0]) + start,
        work_damped=float(work[1]),
        work_friction=float(work[2]),
        work_forces=float(work[3]),
        energy=stored_energy(omega, slider_shape, slider_kt, residual, r, v, w),
        overshoot=float(overshoot),
        sweeps=int(sweeps),
    )


def _loosest_first(
    pull: Float[ndarray, "slider mode"], limit: Float[ndarray, " pair"], mode: int
) -> Int[ndarray, " slider"]:
    """Sliders, pair by pair in the order in which a mode makes them slip."""
    reach = np.hypot(pull[0::2, mode], pull[1::2, mode]) / limit
    pairs = np.argsort(-reach, kind="stable")
    return (2 * pairs[:, None] + np.arange(2)).ravel()


def stored_energy(
    omega: Float[ndarray, " mode"],
    slider_shape: Float[ndarray, "slider mode"],
    slider_kt: Float[ndarray, " slider"],
    residual: Float[ndarray, "slider slider"],
    r: Float[ndarray, " mode"],
    v: Float[ndarray, " mode"],
    w: Float[ndarray, " slider"],
) -> float:
    """Kinetic energy and energy of specimen and contact springs (J) with the slip locked in."""
    pulled = slider_kt * w
    modal = 0.5 * np.sum(v**2 + (omega * r) ** 2) - pulled @ (slider_shape @ r)
    return float(modal + 0.5 * pulled @ w - 0.5 * pulled @ residual @ pulled)


@njit(cache=True, fastmath={"reassoc", "contract"})
@no_type_check
def _march(
    step, decay, omega, shape, kt, give, limit, tip, laser, push, sine, driven, forces, dt, every,
    r, v, w,
):  # fmt: skip
    """Step on; r, v, w are changed in place.

    step (row, column, mode). pull = kt shape is the slider force per modal displacement and `give`
    what slip takes from it, its load on the modes within the step included: with `free`, the modes
    at the step's end but for that load, the force is pull free - give w.
    """
    modes, sliders = shape.shape
    steps = push.size - 1
    pull = shape * kt
    at_end = step[0, 3]
    velocity, amplitude = np.zeros(steps // every + 1), np.zeros(steps // every + 1)
    work = np.zeros(4)
    overshoot, most = 0.0, 0
    # Not rows of one array, which the compiler takes for strided.
    force, predicted, before = np.zeros(sliders), np.zeros(sliders), np.zeros(sliders)
    slip, taken, lost = np.zeros(sliders), np.zeros(sliders), np.zeros(sliders)
    guess, slipped, parted = np.zeros(sliders), np.zeros(sliders), np.zeros(sliders)
    hold, load0, load1 = np.zeros(modes), np.zeros(modes), np.zeros(modes)
    free, ahead, known = np.zeros(modes), np.zeros(modes), np.zeros(modes)
    now, expected, earlier = np.zeros(modes), np.zeros(modes), np.zeros(modes)
    rho = own_give(give)
    reach = relative_pull(pull, limit)
    room = -1.0  # part of its limit that every pair had left at `free` = `known`
    sliding = False
    fresh = False  # whether `force` is that of the instant before

    pushed = push[0]
    for m in range(modes):
        load0[m] = tip[m] * pushed
        velocity[0] += laser[m] * v[m]
    amplitude[0] = abs(laser[driven]) * abs(r[driven])

    for n in range(steps):
        here = omega[driven] * (r[driven] - tip[driven] * push[n] / omega[driven] ** 2)
        size = np.sqrt(v[driven] ** 2 + here**2)
        phase = v[driven] / size if size > 0.0 else 1.0
        if tip[driven] < 0.0:
            phase = -phase
        pushing = push[n + 1] + sine[n + 1] * phase

        if forces.active:
            nonlinear_force(forces, r, v, now)
            for m in range(modes):
                load0[m] += now[m] - expected[m]
                expected[m] = 2.0 * now[m] - earlier[m] if n > 0 else now[m]
            copied(now, earlier)

        away = 0.0
        for m in range(modes):
            load = tip[m] * pushing + expected[m]
            free[m] = (
                step[0, 0, m] * r[m]
                + step[0, 1, m] * v[m]
                + step[0, 2, m] * load0[m]
                + at_end[m] * load
            )
            load1[m] = load + hold[m]
            ahead[m] = free[m] + at_end[m] * hold[m]
            away += reach[m] * abs(free[m] - known[m])

        # No pair's force changes by more than this part of its limit; so far all stay stuck.
        if away < room:
            fresh = False
        else:
            if fresh:
                copied(force, before)
            slider_force(pull, free, lost, predicted)
            room = 1.0 - largest(predicted, limit)
            copied(free, known)
            if room >= 0.0:
                copied(predicted, force)
                if sliding:
                    slip[:] = 0.0
                sliding = False
            else:
                if not fresh:
                    for m in range(modes):
                        free[m] = r[m] - at_end[m] * hold[m]
                    slider_force(pull, free, lost, before)
                # The last two steps' slips go on to a guess of this one's, in which their share is.
                if not sliding:
                    taken[:] = 0.0
                    slipped[:] = 0.0
                    parted[:] = 0.0
                for j in range(sliders):
                    force[j] = predicted[j] - (2.0 * taken[j] - parted[j])
                    parted[j] = taken[j]
                    more = 2.0 * slip[j] - slipped[j]
                    slipped[j] = slip[j]
                    slip[j] = more
                most = max(
                    most,
                    settle_leading(
                        force, slip, guess, give, rho, limit, _SLIP_TOLERANCE, _MOST_SWEEPS
                    ),
                )
                sliding = True
                for j in range(sliders):
                    taken[j] = predicted[j] - force[j]
                    lost[j] += taken[j]
                    w[j] += slip[j]
                    work[2] += 0.5 * (before[j] + force[j]) * slip[j]
                for m in range(modes):
                    more = 0.0
                    for j in range(sliders):
                        more += pull[m, j] * slip[j]
                    hold[m] += more
                    load1[m] += more
                    ahead[m] += at_end[m] * more
                overshoot = max(overshoot, largest(force, limit) - 1.0)
            fresh = True

        moved_tip, faster_tip, damped, others = 0.0, 0.0, 0.0, 0.0
        for m in range(modes):
            fast = (
                step[1, 0, m] * r[m]
                + step[1, 1, m] * v[m]
                + step[1, 2, m] * load0[m]
                + step[1, 3, m] * load1[m]
            )
            moved = ahead[m] - r[m]
            gained = fast - v[m]
            moved_tip += tip[m] * moved
            faster_tip += tip[m] * gained
            # Simpson's rule, its middle from the cubic through both ends.
            middle = 1.5 * moved / dt - 0.25 * (v[m] + fast)
            damped += decay[m] * (v[m] * v[m] + 4 * middle * middle + fast * fast)
            others += 0.5 * (now[m] + expected[m]) * moved
            others += (expected[m] - now[m]) * dt / 12 * gained
            v[m] = fast
            r[m] = ahead[m]
            load0[m] = load1[m]
        work[1] += dt / 6 * damped
        work[3] += others
        work[0] += 0.5 * (pushed + pushing) * moved_tip + (pushing - pushed) * dt / 12 * faster_tip
        pushed = pushing

        if (n + 1) % every == 0:
            at = (n + 1) // every
            for m in range(modes):
                velocity[at] += laser[m] * v[m]
            amplitude[at] = abs(laser[driven]) * np.sqrt(
                r[driven] ** 2 + (v[driven] / omega[driven]) ** 2
            )
    return velocity, amplitude, work, overshoot, most


@njit(cache=True, fastmath={"reassoc", "contract"})
@no_type_check
def slider_force(pull, free, lost, force):
    """Force (N) of the sliders at modal displacements without what slip has taken from it."""
    for j in range(force.size):
        force[j] = -lost[j]
    for m in range(free.size):
        q = free[m]
        for j in range(force.size):
            force[j] += pull[m, j] * q


@njit(cache=True)
@no_type_check
def relative_pull(pull, limit):
    """Largest change of a pair's force over its limit by each mode."""
    most = np.zeros(pull.shape[0])
    for m in range(most.size):
        most[m] = largest(pull[m], limit)
    return most
