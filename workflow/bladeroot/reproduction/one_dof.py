"""The thesis's model of 1 degree of freedom with spring and slider (3.3), integrated exactly.

Between two events, the begin and the end of slip, the motion is a damped sine about a rest place.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.contact.laws import closed_forms
from bladeroot.decay.freevib import freevib
from bladeroot.variables import dataset

SAMPLING = 51200.0  # Hz
START = 100.0  # times the critical amplitude
_DURATION = 0.33  # s


@dataclass(frozen=True)
class Slider:
    """Mass (kg), spring K and contact spring k_t (N/m), mu N0 (N), damping zeta; section 3.4."""

    mass: float = 0.7
    spring: float = 4.2e6
    contact: float = 4.0e6
    slip_force: float = 400.0
    zeta: float = 2.5e-3

    @property
    def stick_frequency(self) -> float:
        """Undamped frequency in full adhesion, Hz."""
        return float(np.sqrt((self.spring + self.contact) / self.mass) / (2.0 * np.pi))

    @property
    def critical_amplitude(self) -> float:
        """X_cr = mu N0 / k_t, m."""
        return self.slip_force / self.contact


def free_decay(
    model: Slider, start: float, sampling_Hz: float, duration_s: float
) -> tuple[Float[ndarray, " time"], Float[ndarray, " time"]]:
    """Velocity (m/s) and contact force (N) after a release at rest from `start` (m)."""
    damping = model.zeta * np.sqrt((model.spring + model.contact) / model.mass)
    times = np.arange(int(duration_s * sampling_Hz)) / sampling_Hz
    velocity, force = np.zeros(times.size), np.zeros(times.size)
    now, x, v, stuck, sense = 0.0, start, 0.0, True, 0.0
    anchor = start - model.critical_amplitude
    while True:
        stiffness = model.spring + model.contact if stuck else model.spring
        pull = model.contact * anchor if stuck else -sense * model.slip_force
        motion = _Motion(pull / stiffness, np.sqrt(stiffness / model.mass - damping**2), damping)
        motion = motion.through(x, v)
        if stuck:
            event = motion.first(
                lambda t, m=motion, a=anchor: (
                    np.abs(model.contact * (m.at(t)[0] - a)) / model.slip_force - 1.0 - 1e-9
                )
            )
        else:
            event = motion.first(lambda t, m=motion, s=sense: -m.at(t)[1] * s)
        inside = (times >= now) & (times < now + event)
        place, velocity[inside] = motion.at(times[inside] - now)
        force[inside] = model.contact * (place - anchor) if stuck else sense * model.slip_force
        now += event
        if now >= times[-1]:
            return velocity, force
        x, v = (float(part) for part in motion.at(event))
        if stuck:
            sense = float(np.sign(x - anchor))
        else:
            anchor = x - sense * model.critical_amplitude
        stuck = not stuck


@dataclass(frozen=True)
class _Motion:
    """x(t) = rest + exp(-damping t) (c cos + s sin)."""

    rest: float
    omega: float
    damping: float
    c: float = 0.0
    s: float = 0.0

    def through(self, x: float, v: float) -> "_Motion":
        c = x - self.rest
        return _Motion(self.rest, self.omega, self.damping, c, (v + self.damping * c) / self.omega)

    def at(self, t):
        """Displacement and velocity."""
        cos, sin, fall = np.cos(self.omega * t), np.sin(self.omega * t), np.exp(-self.damping * t)
        place = self.rest + fall * (self.c * cos + self.s * sin)
        along = (self.omega * self.s - self.damping * self.c) * cos
        across = (self.omega * self.c + self.damping * self.s) * sin
        return place, fall * (along - across)

    def first(self, over) -> float:
        """First time at which `over` is positive; infinite if it is not within a period."""
        grid = np.linspace(1e-9, 2.0 * np.pi / self.omega, 4001)
        late = np.flatnonzero(over(grid) > 0.0)
        if not late.size:
            return np.inf
        low, high = grid[max(late[0] - 1, 0)], grid[late[0]]
        for _ in range(60 if late[0] else 0):
            middle = 0.5 * (low + high)
            low, high = (low, middle) if over(middle) > 0.0 else (middle, high)
        return float(high)


@cache
def slider_curves() -> xr.Dataset:
    """Figures 3.7 to 3.9: a decay (velocity, contact force), its frequency and loss factor.

    By FREEVIB on the decay, and by the first harmonic of the contact (3.19); that harmonic's
    stiffness and damping are over k_t. The noise is that of a good record: without any there is no
    error to weigh by.
    """
    model = Slider()
    velocity, force = free_decay(model, START * model.critical_amplitude, SAMPLING, _DURATION)
    noise = 1e-5 * velocity.max()
    seen = velocity + noise * np.random.default_rng(0).standard_normal(velocity.size)
    curve = freevib(seen, SAMPLING, 500.0, noise, tolerance=0.4)
    size = model.critical_amplitude * np.geomspace(0.1, START, 200)
    frequency, loss = closed_forms.one_dof(
        size, model.mass, model.spring, model.contact, model.slip_force
    )
    stiffness, damping = closed_forms.equivalent_stiffness(size, model.contact, model.slip_force)
    viscous = 2.0 * model.zeta * model.stick_frequency / frequency
    made = {
        "balanced_amplitude": size,
        "velocity": velocity,
        "force": force,
        "balanced_frequency": frequency,
        "balanced_loss_factor": loss + viscous,
        "stiffness": stiffness / model.contact,
        "damping": damping / model.contact,
    }
    return curve.merge(dataset("reproduction/slider", made)).assign_attrs(
        sampling_Hz=SAMPLING,
        critical_amplitude_m=model.critical_amplitude,
        slip_force_N=model.slip_force,
        stick_frequency_Hz=model.stick_frequency,
        loss_factor=2.0 * model.zeta,
    )
