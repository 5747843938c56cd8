"""The thesis's model of 1 degree of freedom with spring and slider (3.3), integrated exactly.

Between two events, the begin and the end of slip, the motion is a damped sine about a rest place.
"""

from dataclasses import dataclass

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.contact.laws import closed_forms
from bladeroot.decay.freevib import freevib
from bladeroot.plateau.plateau import plateau
from bladeroot.reproduction.slider import Slider
from bladeroot.variables import dataset

SAMPLING = 51200.0  # Hz
START = 100.0  # times the critical amplitude
_DURATION = 0.33  # s


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


def slider_curves() -> xr.Dataset:
    """Figures 3.7 to 3.9: a decay (velocity, contact force), its frequency and loss factor.

    By FREEVIB on the decay, and by the first harmonic of the contact (3.19); that harmonic's
    stiffness and damping are over k_t. The noise is that of a good record: without any there is no
    error to weigh by. With it what FREEVIB misses of what was put in, and of that harmonic.
    """
    model = Slider()
    velocity, force = free_decay(model, START * model.critical_amplitude, SAMPLING, _DURATION)
    noise = 1e-5 * velocity.max()
    seen = velocity + noise * np.random.default_rng(0).standard_normal(velocity.size)
    curve = freevib(seen, SAMPLING, 500.0, noise, tolerance=0.4)
    size = model.critical_amplitude * np.geomspace(0.1, START, 200)
    frequency, loss = _balanced(model, size)
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
    found = plateau(curve)
    true = (model.stick_frequency, 2.0 * model.zeta, model.critical_amplitude)
    names = ("stick_frequency", "loss_factor", "onset_amplitude")
    made["found_error"] = np.array([found[name] for name in names]) / np.array(true) - 1.0
    made["balance_error"] = _balance_error()
    return curve.merge(dataset("reproduction/slider", made)).assign_attrs(
        sampling_Hz=SAMPLING,
        critical_amplitude_m=model.critical_amplitude,
        slip_force_N=model.slip_force,
        stick_frequency_Hz=model.stick_frequency,
        loss_factor=2.0 * model.zeta,
    )


def _balance_error() -> float:
    """Largest difference of FREEVIB's frequency from (3.19), 20 to 95 times X_cr, undamped."""
    model = Slider(zeta=0.0)
    velocity, _ = free_decay(model, START * model.critical_amplitude, SAMPLING, 0.2)
    curve = freevib(velocity, SAMPLING, 500.0, 0.0, tolerance=0.4)
    size = curve["amplitude"].values / model.critical_amplitude
    curve = curve.isel(point=np.flatnonzero((size > 20.0) & (size < 95.0)))
    frequency, _ = _balanced(model, curve["amplitude"].values)
    return float(np.abs(curve["frequency"].values / frequency - 1.0).max())


def _balanced(model: Slider, size: Float[ndarray, " amplitude"]) -> tuple[ndarray, ndarray]:
    """Frequency (Hz) and friction's loss factor by (3.19)."""
    return closed_forms.one_dof(size, model.mass, model.spring, model.contact, model.slip_force)
