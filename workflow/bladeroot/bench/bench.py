"""One record of the virtual test bench, from the specimen's matrices to the laser's file."""

from collections.abc import Mapping

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.bench.chance import generator
from bladeroot.bench.clamping import Clamping, clamp
from bladeroot.bench.conditions import Conditions
from bladeroot.bench.joint import Parts
from bladeroot.bench.sensor import read_velocity
from bladeroot.bench.stepping import Motion, run
from bladeroot.bench.tip import Blow, Course, tip_force

# Largest energy that may go missing in a run, over the work put in.
ENERGY_TOLERANCE = 2e-3


def course_of(bench: dict, clamping: Clamping) -> Course:
    """Durations of a record's phases: by the mode's own decay, or as long as the bench says."""
    number = clamping.number
    times = bench["recording"]
    own = 2 / (clamping.loss_factor[number] * clamping.modes.omega[number])
    constant = float(times.get("time_constant_s", {}).get(clamping.modes.names[number], own))
    return Course(
        quiet=float(times["quiet_s"]),
        push=float(times["push_s"]),
        drive=float(times["drive_time_constants"] * constant),
        decay=float(times["decay_time_constants"] * constant),
        back=float(times["back_s"]),
    )


def sine_force(bench: dict, clamping: Clamping, drive: float) -> float:
    """Amplitude of the tip's sine (N) at a drive current (A)."""
    return drive * bench["tip"]["newton_per_ampere"][clamping.modes.names[clamping.number]]


def move(bench: dict, clamping: Clamping, drive: float) -> tuple[Motion, float]:
    """Run one record of a clamped specimen driven with `drive` (A); also the release time (s).

    Raises RuntimeError if the energy balance is not kept to ENERGY_TOLERANCE.
    """
    modes, number = clamping.modes, clamping.number
    tip, times = bench["tip"], bench["recording"]
    dt = 1 / (times["sampling_Hz"] * times["substeps"])
    course = course_of(bench, clamping)
    sine = sine_force(bench, clamping, drive)
    preload = float(max(tip["least_preload_N"], tip["preload_over_sine"] * sine))
    blow = Blow(*_touch(clamping, course, sine))
    push_and_sine, release = tip_force(
        course, preload, sine, float(tip["knock_N"]), number, dt, blow
    )
    # The specimen's damping is structural: each stuck mode decays as its complex stiffness
    # omega^2 (1 + i eta) makes it, which a damper of slightly higher frequency does exactly.
    pole = modes.omega * np.sqrt(1 + 1j * clamping.loss_factor)
    slips = np.isfinite(clamping.limit).all()
    sliders, pairs = (clamping.limit.size * 2, clamping.limit.size) if slips else (0, 0)
    motion = run(
        np.abs(pole),
        pole.imag / np.abs(pole),
        modes.slider_shape[:sliders],
        modes.slider_kt[:sliders],
        modes.residual[:sliders, :sliders],
        clamping.limit[:pairs],
        modes.tip_shape,
        modes.laser_shape,
        push_and_sine,
        dt,
        times["substeps"],
        forces=clamping.forces,
    )
    if not motion.energy_error <= ENERGY_TOLERANCE:
        raise RuntimeError(
            f"energy balance: {motion.energy_error:.1e} of the work put in is not accounted for"
        )
    return motion, release * dt


def _touch(clamping: Clamping, course: Course, sine: float) -> tuple[float, float]:
    """Time after release (s) and impulse (N s) of a touch of the tip, by the linear decay."""
    true, number = clamping.conditions, clamping.number
    omega = clamping.modes.omega[number]
    rate = clamping.loss_factor[number] * omega / 2
    seen = abs(clamping.modes.tip_shape[number])
    driven = sine * seen / (2 * rate * omega) * (1 - np.exp(-rate * course.drive))
    after = true.touched_at * course.decay
    left = driven * np.exp(-rate * after)
    return float(after), float(true.touched * omega * left / seen)


def simulate(
    bench: dict, whole: Parts, row: Mapping, conditions: Conditions | None = None
) -> tuple[xr.Dataset, xr.Dataset]:
    """One raw record and its truth.

    `bench` is the content of the bench's file, `whole` beam and slots, `row` a row of records.csv
    (record, mode, hold, drive_A, and force_N or pressure_bar), `conditions` those of the record
    (without hidden effect if not given). The numbers of a record depend on the bench's seed and
    the names of record and hold only.
    """
    clamping = clamp(bench, whole, row, conditions)
    motion, release = move(bench, clamping, float(row["drive_A"]))
    sampling = float(bench["recording"]["sampling_Hz"])
    laser = bench["laser"]
    at_release = round(release * sampling)
    record = str(row["record"])
    faults = generator(bench["seed"], "faults", record)
    velocity, step = read_velocity(
        disturbed(motion, clamping, at_release, sampling, faults),
        sampling,
        float(laser["noise_m_per_s"]),
        float(laser["drift_m_per_s"]),
        clipped_at(motion, clamping, at_release, float(laser["full_scale_m_per_s"])),
        float(laser["full_scale_m_per_s"]),
        generator(bench["seed"], "record", record),
    )
    return (
        _raw(velocity, step, sampling),
        _truth(clamping, motion, record, release, float(motion.amplitude[at_release])),
    )


def disturbed(
    motion: Motion, clamping: Clamping, release: int, sampling: float, chance: np.random.Generator
) -> Float[ndarray, " sample"]:
    """Velocity (m/s) at the laser with the faults of the signal: hum, and a close second mode."""
    true = clamping.conditions
    time = np.arange(motion.velocity.size) / sampling
    hum, beat = chance.uniform(0, 2 * np.pi, 2)
    seen = motion.velocity + true.hum * np.cos(2 * np.pi * true.hum_Hz * time + hum)
    omega = true.beating_ratio * clamping.modes.omega[clamping.number]
    second = true.beating * omega * motion.amplitude * np.cos(omega * time + beat)
    seen[release:] += second[release:]
    return seen


def clipped_at(motion: Motion, clamping: Clamping, release: int, full_scale: float) -> float:
    """Largest velocity (m/s) that the converter lets through."""
    cut = clamping.conditions.clipped
    return float((1 - cut) * np.abs(motion.velocity[release:]).max()) if cut else full_scale


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
        "kn": (clamping.conditions.kn, "N/m", "normal contact stiffness of one flank"),
        "kt": (clamping.conditions.kt, "N/m", "tangential contact stiffness of one flank"),
        "force": (clamping.conditions.force, "N", "axial force in the specimen"),
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
