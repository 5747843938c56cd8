"""Stepping the stuck modes in time while the sliders of the flanks stick and slip.

Between two instants each mode answers exactly to a load that varies linearly, so the decay of a
stuck specimen has no period error at any step. The slip of each step is solved together with the
motion: predicted stuck, then corrected (section 3.3.3), swept over the sliders until it settles.
"""

from dataclasses import dataclass
from typing import no_type_check

import numpy as np
from jaxtyping import Float
from numpy import ndarray
from scipy.linalg import expm

from bladeroot.compiled import njit
from bladeroot.rig.forces import ModalForces, no_forces, nonlinear_force
from bladeroot.rig.sweep import own_give, settle

_SWEEPS = 400
_TOLERANCE = 1e-8


@dataclass(frozen=True)
class Motion:
    """What one run leaves behind.

    `velocity` (m/s) at the laser and `amplitude` (m, of the driven mode at the laser), both a
    sample; `state` and `speed` of the modes, `slip` of the sliders at the end; the work done (J):
    `work_in` by the drive, `work_damped` by the modal damping, `work_friction` by the sliders,
    `work_forces` by the other nonlinear forces; `energy` (J) stored at the end; `overshoot`, the
    largest slider force over its limit, less one; `sweeps`, the most that one step needed.
    """

    velocity: Float[ndarray, " sample"]
    amplitude: Float[ndarray, " sample"]
    state: Float[ndarray, " mode"]
    speed: Float[ndarray, " mode"]
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
    grown = expm(generator)
    step = np.empty((omega.size, 2, 4))
    for row, scale in ((0, 1.0), (1, 1.0 / dt)):
        step[:, row, 0] = scale * grown[:, row, 0]
        step[:, row, 1] = scale * grown[:, row, 1] * dt
        step[:, row, 2] = scale * (grown[:, row, 2] - grown[:, row, 3])
        step[:, row, 3] = scale * grown[:, row, 3]
    return step


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
    r = np.zeros(omega.size) if state is None else state.astype(float)
    v = np.zeros(omega.size)
    w = np.zeros(slider_kt.size)
    flexible = (slider_shape * step[:, 0, 3]) @ slider_shape.T + residual
    # Slider force lost per slip within one step; symmetric, positive definite.
    give = np.diag(slider_kt) - slider_kt[:, None] * flexible * slider_kt
    velocity, amplitude, work, overshoot, sweeps = _march(
        step,
        2 * zeta * omega,
        omega,
        np.ascontiguousarray(slider_shape.T),
        slider_kt,
        np.ascontiguousarray(slider_kt[:, None] * residual),
        np.ascontiguousarray(give),
        limit,
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
        w,
    )
    if sweeps >= _SWEEPS:
        raise RuntimeError(f"the slip of a step did not settle in {_SWEEPS} sweeps")
    start = 0.0 if state is None else 0.5 * float(np.sum((omega * state) ** 2))
    return Motion(
        velocity=velocity,
        amplitude=amplitude,
        state=r,
        speed=v,
        slip=w,
        work_in=float(work[0]) + start,
        work_damped=float(work[1]),
        work_friction=float(work[2]),
        work_forces=float(work[3]),
        energy=stored_energy(omega, slider_shape, slider_kt, residual, r, v, w),
        overshoot=float(overshoot),
        sweeps=int(sweeps),
    )


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


@njit(cache=True)
@no_type_check
def _march(
    step, decay, omega, shape, kt, kt_residual, give, limit, tip, laser, push, sine, driven, forces,
    dt, every, r, v, w,
):  # fmt: skip
    modes, sliders = shape.shape
    pairs = limit.size
    steps = push.size - 1
    velocity = np.zeros(steps // every + 1)
    amplitude = np.zeros(steps // every + 1)
    work = np.zeros(4)
    overshoot = 0.0
    most = 0
    hold = np.zeros(modes)  # load of the locked-in slip on the modes
    set_back = np.zeros(sliders)  # its displacement through the modes that are not kept
    force = np.zeros(sliders)
    before = np.zeros(sliders)
    slip = np.zeros(sliders)
    load0 = np.zeros(modes)
    load1 = np.zeros(modes)
    ahead = np.zeros(modes)
    now = np.zeros(modes)  # the other forces at this instant, and as expected a step later
    expected = np.zeros(modes)
    earlier = np.zeros(modes)
    rho = own_give(give)

    for j in range(sliders):
        x = 0.0
        for m in range(modes):
            x += shape[m, j] * r[m]
        force[j] = kt[j] * x
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
            earlier[:] = now

        before[:] = force
        force[:] = set_back - w
        for m in range(modes):
            load1[m] = tip[m] * pushing + hold[m] + expected[m]
            ahead[m] = (
                step[m, 0, 0] * r[m]
                + step[m, 0, 1] * v[m]
                + step[m, 0, 2] * load0[m]
                + step[m, 0, 3] * load1[m]
            )
            q = ahead[m]
            for j in range(sliders):
                force[j] += shape[m, j] * q
        stuck = True
        for i in range(pairs):
            force[2 * i] *= kt[2 * i]
            force[2 * i + 1] *= kt[2 * i + 1]
            if force[2 * i] ** 2 + force[2 * i + 1] ** 2 > limit[i] ** 2:
                stuck = False

        if not stuck:
            most = max(most, settle(force, slip, give, rho, limit, _TOLERANCE, _SWEEPS))
            for j in range(sliders):
                if slip[j] != 0.0:
                    w[j] += slip[j]
                    work[2] += 0.5 * (before[j] + force[j]) * slip[j]
                    pull = kt[j] * slip[j]
                    for m in range(modes):
                        more = shape[m, j] * pull
                        hold[m] += more
                        load1[m] += more
                        ahead[m] += step[m, 0, 3] * more
                    for k in range(sliders):
                        set_back[k] += kt_residual[j, k] * slip[j]
            for i in range(pairs):
                size = np.sqrt(force[2 * i] ** 2 + force[2 * i + 1] ** 2)
                overshoot = max(overshoot, size / limit[i] - 1.0)

        moved_tip = 0.0
        faster_tip = 0.0
        for m in range(modes):
            fast = (
                step[m, 1, 0] * r[m]
                + step[m, 1, 1] * v[m]
                + step[m, 1, 2] * load0[m]
                + step[m, 1, 3] * load1[m]
            )
            moved_tip += tip[m] * (ahead[m] - r[m])
            gained = fast - v[m]
            faster_tip += tip[m] * gained
            # Simpson's rule, its middle from the cubic through both ends.
            middle = 1.5 * (ahead[m] - r[m]) / dt - 0.25 * (v[m] + fast)
            work[1] += dt / 6 * decay[m] * (v[m] ** 2 + 4 * middle**2 + fast**2)
            work[3] += 0.5 * (now[m] + expected[m]) * (ahead[m] - r[m])
            work[3] += (expected[m] - now[m]) * dt / 12 * gained
            v[m] = fast
            r[m] = ahead[m]
            load0[m] = load1[m]
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
