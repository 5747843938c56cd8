"""One record of the virtual test bench, from the specimen's matrices to the laser's file."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.rig.chance import generator
from bladeroot.rig.friction import pressure_profile, slider_limits
from bladeroot.rig.joint import Specimen, specimen
from bladeroot.rig.modes import StuckModes, stuck_modes
from bladeroot.rig.sensor import read_velocity
from bladeroot.rig.stepping import Motion, run
from bladeroot.rig.tip import Course, tip_force

# Largest energy that may go missing in a run, over the work put in.
ENERGY_TOLERANCE = 2e-3


@dataclass(frozen=True)
class Clamping:
    """The specimen in one hold, seen by the laser and the tip of one mode."""

    force: float
    kn: float
    kt: float
    modes: StuckModes
    loss_factor: Float[ndarray, " mode"]
    limit: Float[ndarray, " pair"]
    number: int

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


def clamp(bench: dict, reduced: xr.Dataset, row: Mapping) -> Clamping:
    """Clamp the specimen as in a record's hold: what `row` calls mode, hold and force is used.

    Raises ValueError if the mode is not among those kept or the force is not positive.
    """
    seed = bench["seed"]
    mode = str(row["mode"])
    hold = generator(seed, "hold", str(row["hold"]))
    scatter = {name: float(hold.standard_normal()) for name in ("kn", "kt", "friction")}
    rounding = float(hold.uniform(-0.5, 0.5))
    damping_scatter = hold.standard_normal(bench["specimen"]["modes"])

    force = true_force(bench, row, rounding)
    joint = bench["joint"]
    relative = force / joint["reference_force_N"]
    kn, kt = (
        joint[f"{name}_N_per_m"]
        * relative ** joint[f"{name}_exponent"]
        * np.exp(joint["reclamping_scatter"] * scatter[name])
        for name in ("kn", "kt")
    )
    body = _specimen(bench, reduced, force)
    modes = stuck_modes(
        body,
        kn,
        kt,
        bench["specimen"]["modes"],
        bench["laser"]["x_mm"][mode] * 1e-3,
        bench["tip"]["x_mm"][mode] * 1e-3,
    )
    if mode not in modes.names:
        raise ValueError(f"mode {mode} is not among the kept modes {modes.names}")
    damping = bench["damping"]
    loss = np.array(
        [damping["loss_factor"].get(name, damping["other_loss_factor"]) for name in modes.names]
    )
    friction = bench["friction"]
    waviness = generator(seed, "flanks").standard_normal(body.share.size)
    profile = pressure_profile(
        body.place,
        body.share,
        body.flank,
        float(friction["edge_pressure"]),
        np.exp(friction["spread"] * waviness),
    )
    coefficient = friction["coefficient"] * np.exp(
        friction["reclamping_scatter"] * scatter["friction"]
    )
    return Clamping(
        force=force,
        kn=float(kn),
        kt=float(kt),
        modes=modes,
        loss_factor=loss * np.exp(damping["reclamping_scatter"] * damping_scatter),
        limit=slider_limits(force, float(coefficient), body.share, profile),
        number=modes.names.index(mode),
    )


def true_force(bench: dict, row: Mapping, rounding: float) -> float:
    """Axial force (N) behind a gauge reading: `rounding` (-0.5 to 0.5) is a part of its last digit.

    `row` gives the reading as `force_N` or `pressure_bar`; the force is pressure times the
    piston's area (section 2.1.6). Raises ValueError if it is not positive.
    """
    gauge = bench["gauge"]
    newton_per_bar = gauge["piston_area_cm2"] * 1e-4 * 1e5
    read = row["force_N"] if "force_N" in row else row["pressure_bar"] * newton_per_bar
    force = gauge["gain"] * (read + rounding * gauge["resolution_bar"] * newton_per_bar)
    if not force > 0:
        raise ValueError(f"the axial force must be positive, got {force} N for {dict(row)}")
    return float(force)


def move(bench: dict, clamping: Clamping, drive: float) -> tuple[Motion, float]:
    """Run one record of a clamped specimen driven with `drive` (A); also the release time (s).

    Raises RuntimeError if the energy balance is not kept to ENERGY_TOLERANCE.
    """
    modes, number = clamping.modes, clamping.number
    tip, times = bench["tip"], bench["recording"]
    dt = 1 / (times["sampling_Hz"] * times["substeps"])
    rate = clamping.loss_factor[number] * modes.omega[number] / 2
    course = Course(
        quiet=float(times["quiet_s"]),
        push=float(times["push_s"]),
        drive=float(times["drive_time_constants"] / rate),
        decay=float(times["decay_time_constants"] / rate),
        back=float(times["back_s"]),
    )
    mode = modes.names[number]
    sine = drive * tip["newton_per_ampere"][mode]
    preload = float(max(tip["least_preload_N"], tip["preload_over_sine"] * sine))
    push_and_sine, release = tip_force(course, preload, sine, float(tip["knock_N"]), number, dt)
    # The specimen's damping is structural: each stuck mode decays as its complex stiffness
    # omega^2 (1 + i eta) makes it, which a damper of slightly higher frequency does exactly.
    pole = modes.omega * np.sqrt(1 + 1j * clamping.loss_factor)
    motion = run(
        np.abs(pole),
        pole.imag / np.abs(pole),
        modes.slider_shape,
        modes.slider_kt,
        modes.residual,
        clamping.limit,
        modes.tip_shape,
        modes.laser_shape,
        push_and_sine,
        dt,
        times["substeps"],
    )
    if motion.energy_error > ENERGY_TOLERANCE:
        raise RuntimeError(
            f"energy balance: {motion.energy_error:.1e} of the work put in is not accounted for"
        )
    return motion, release * dt


def simulate(bench: dict, reduced: xr.Dataset, row: Mapping) -> tuple[xr.Dataset, xr.Dataset]:
    """One raw record and its truth.

    `bench` is the content of the bench's file, `reduced` the reduced beam and slots, `row` a row
    of records.csv (record, mode, hold, drive_A, and force_N or pressure_bar). The numbers of a
    record depend on the bench's seed and the names of record and hold only.
    """
    clamping = clamp(bench, reduced, row)
    motion, release = move(bench, clamping, float(row["drive_A"]))
    sampling = float(bench["recording"]["sampling_Hz"])
    laser = bench["laser"]
    velocity, step = read_velocity(
        motion.velocity,
        sampling,
        float(laser["noise_m_per_s"]),
        float(laser["drift_m_per_s"]),
        float(laser["full_scale_m_per_s"]),
        generator(bench["seed"], "record", str(row["record"])),
    )
    at_release = round(release * sampling)
    return (
        _raw(velocity, step, sampling),
        _truth(clamping, motion, str(row["record"]), release, float(motion.amplitude[at_release])),
    )


def _specimen(bench: dict, reduced: xr.Dataset, force: float) -> Specimen:
    real = bench["specimen"]
    return specimen(
        reduced,
        force,
        modulus_factor=float(real["modulus_factor"]),
        density_factor=float(real["density_factor"]),
        added_mass=float(real["added_mass_kg"]),
        added_mass_x=real["added_mass_x_mm"] * 1e-3,
    )


def _raw(velocity: Float[ndarray, " sample"], step: float, sampling: float) -> xr.Dataset:
    """The laser's file: stored as 16-bit numbers, the time as sample numbers."""
    raw = xr.Dataset(
        {"velocity": ("time", velocity, {"units": "m/s", "long_name": "velocity at the laser"})},
        {"time": ("time", np.arange(velocity.size) / sampling)},
        {"title": "SIMULATED ring-down record of the virtual test bench"},
    )
    raw["time"].attrs.update(units="s", long_name="time since the start of the record")
    packed = {"zlib": True, "complevel": 4, "shuffle": True}
    raw["velocity"].encoding = {
        **packed,
        "dtype": "int16",
        "scale_factor": step,
        "_FillValue": np.int16(-(2**15)),
    }
    raw["time"].encoding = {
        **packed,
        "dtype": "int32",
        "scale_factor": 1 / sampling,
        "_FillValue": np.int32(-1),
    }
    return raw


def _truth(
    clamping: Clamping, motion: Motion, record: str, release: float, amplitude: float
) -> xr.Dataset:
    """What the bench knows and no inference may read."""
    values = {
        "frequency": (clamping.frequency, "Hz", "stuck eigenfrequency of the measured mode"),
        "loss_factor": (
            float(clamping.loss_factor[clamping.number]),
            "1",
            "loss factor of the measured mode, all stuck",
        ),
        "kn": (clamping.kn, "N/m", "normal contact stiffness of one flank"),
        "kt": (clamping.kt, "N/m", "tangential contact stiffness of one flank"),
        "force": (clamping.force, "N", "axial force in the specimen"),
        "onset_amplitude": (
            clamping.onset,
            "m",
            "amplitude at the laser at which the first node pair slips",
        ),
        "release_time": (release, "s", "instant at which the tip let go"),
        "release_amplitude": (
            amplitude,
            "m",
            "amplitude of the measured mode at the laser when the tip let go",
        ),
        "friction_work": (motion.work_friction, "J", "energy dissipated by friction"),
        "work_in": (motion.work_in, "J", "work done by the tip"),
        "energy_error": (motion.energy_error, "1", "energy not accounted for over work put in"),
    }
    return xr.Dataset(
        {
            name: ((), value, {"units": unit, "long_name": text})
            for name, (value, unit, text) in values.items()
        },
        {"record": record},
        {"title": "truth behind a SIMULATED record of the virtual test bench"},
    )
