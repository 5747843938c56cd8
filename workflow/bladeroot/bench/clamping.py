"""The specimen clamped in one hold: its modes, its damping, its flanks and what acts on them."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.bench.chance import generator
from bladeroot.bench.conditions import Conditions, baseline
from bladeroot.bench.forces import ModalForces, modal_forces
from bladeroot.bench.friction import pressure_profile, slider_limits
from bladeroot.bench.joint import Parts, specimen, with_interfaces
from bladeroot.bench.modes import StuckModes, stuck_modes


@dataclass(frozen=True)
class Clamping:
    """The specimen in one hold, seen by the laser and the tip of one mode."""

    conditions: Conditions
    modes: StuckModes
    loss_factor: Float[ndarray, " mode"]
    limit: Float[ndarray, " pair"]
    number: int
    forces: ModalForces

    @property
    def frequency(self) -> float:
        """Stuck eigenfrequency of the measured mode (Hz)."""
        return float(self.modes.omega[self.number] / (2 * np.pi))

    @property
    def onset(self) -> float:
        """Amplitude at the laser (m) at which the measured mode brings the first pair to slip."""
        pull = self.modes.slider_kt * self.modes.slider_shape[:, self.number]
        reach = self.limit / np.hypot(pull[0::2], pull[1::2])
        return float(reach.min() * abs(self.modes.laser_shape[self.number]))


def clamp(
    bench: dict,
    whole: Parts,
    row: Mapping,
    conditions: Conditions | None = None,
    slipping: bool | None = None,
) -> Clamping:
    """Clamp the specimen as in a record's hold: what `row` calls mode, hold and force is used.

    `conditions` are those of the record (without hidden effect if not given). `slipping` False
    spares the work for sliders that will not be moved; if not given the friction decides.
    Raises ValueError if the mode is not among those kept or the force is not positive.
    """
    true = baseline(bench, row) if conditions is None else conditions
    real = bench["specimen"]
    if whole.interfaces:
        told = (bench["joint"]["interface_factor"], bench["joint"]["normal_over_load"])
        whole = with_interfaces(whole, *(tuple(one.items()) for one in told))
    slipping = bool(np.isfinite(true.friction)) if slipping is None else slipping
    mode = str(row["mode"])
    body = specimen(
        whole,
        true.force,
        modulus_factor=true.modulus,
        density_factor=true.density,
        added_mass=true.added_mass,
        added_mass_x=true.added_mass_x,
        slot_factor=true.slot,
        hung_at_Hz=float(real.get("hung_at_Hz", 0.0)),
    )
    modes = stuck_modes(
        body,
        true.kn,
        true.kt,
        bench["specimen"]["modes"],
        bench["laser"]["x_mm"][mode] * 1e-3,
        bench["tip"]["x_mm"][mode] * 1e-3,
        slipping,
        real.get("bending_nodes"),
    )
    if mode not in modes.names:
        raise ValueError(f"mode {mode} is not among the kept modes {modes.names}")
    number = modes.names.index(mode)
    damping = bench["damping"]
    scatter = generator(bench["seed"], "damping", str(row["hold"])).standard_normal(
        bench["specimen"]["modes"]
    )
    loss = np.array(
        [damping["loss_factor"].get(name, damping["other_loss_factor"]) for name in modes.names]
    )
    loss = true.loss * loss * np.exp(damping["reclamping_scatter"] * scatter)
    friction = bench["friction"]
    waviness = generator(bench["seed"], "flanks").standard_normal(whole.share.size)
    profile = pressure_profile(
        whole.place,
        whole.share,
        whole.flank,
        float(friction["edge_pressure"]),
        np.exp(friction["spread"] * waviness),
    )
    load = true.force * whole.pressing
    pressing = slider_limits(load, 1.0, whole.share, profile)
    lowest = next(iter(real.get("bending_nodes", {"1B": 0})))
    return carry(
        Clamping(
            conditions=true,
            modes=modes,
            loss_factor=loss,
            limit=slider_limits(load, true.friction, whole.share, profile),
            number=number,
            forces=modal_forces(
                true, modes, pressing, bench["laser"]["x_mm"][lowest] * 1e-3, lowest
            ),
        )
    )


def carry(clamping: Clamping) -> Clamping:
    """Let the measured mode carry the small oscillator: a mass that depends on the frequency."""
    true, modes, number = clamping.conditions, clamping.modes, clamping.number
    if not true.oscillator:
        return clamping
    seen = np.interp(true.oscillator_x, modes.line_x, modes.line_shape[:, number])
    spring = (2 * np.pi * true.oscillator_Hz) ** 2 * (1 + 1j * true.oscillator_loss)
    own = modes.omega[number] ** 2
    square = own * (1 + 1j * clamping.loss_factor[number])
    square /= 1 + true.oscillator * seen**2 * spring / (spring - own)
    omega, loss = modes.omega.copy(), clamping.loss_factor.copy()
    omega[number], loss[number] = np.sqrt(square.real), square.imag / square.real
    return replace(clamping, modes=replace(modes, omega=omega), loss_factor=loss)
