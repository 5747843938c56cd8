"""What is true of the machine in one record, whatever its sheet says."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd

from bladeroot.bench.chance import generator


@dataclass(frozen=True)
class Conditions:
    """The machine in one record; a hidden effect is a change of these.

    Axial force in N, contact stiffness of one flank in N/m. `loss` multiplies all loss factors,
    `friction` is the coefficient at the flanks (inf: they never slip). The rest is absent where
    it is 0, `preload` where it is inf: `preload` is the part of the nominal pressure that keeps
    the flanks closed; `hardening` (1/m^2) makes 1B's restoring force grow as x + hardening x^3
    with the displacement x at the laser, by stretching the beam; `drag` (1/m) is the growth of
    1B's loss factor with amplitude at the laser; `tangential_cubic` (1/m^2) softens the tangential
    springs as u - tangential_cubic u^3 without loss; `oscillator` is a small mass (kg) on a spring
    of `oscillator_Hz` and loss factor `oscillator_loss` at `oscillator_x` (m). Faults of the
    record: `clipped` part of the peak, `hum` (m/s) at `hum_Hz`, `beating` part of the amplitude at
    `beating_ratio` of the frequency, `touched` part of the amplitude at `touched_at` (part of the
    decay).
    """

    force: float
    kn: float
    kt: float
    modulus: float = 1.0
    density: float = 1.0
    slot: float = 1.0
    added_mass: float = 0.0
    added_mass_x: float = 0.0
    loss: float = 1.0
    friction: float = np.inf
    preload: float = np.inf
    hardening: float = 0.0
    drag: float = 0.0
    tangential_cubic: float = 0.0
    oscillator: float = 0.0
    oscillator_Hz: float = 0.0
    oscillator_loss: float = 0.0
    oscillator_x: float = 0.0
    clipped: float = 0.0
    hum: float = 0.0
    hum_Hz: float = 50.0
    beating: float = 0.0
    beating_ratio: float = 1.0
    touched: float = 0.0
    touched_at: float = 0.0


@dataclass(frozen=True)
class Moment:
    """When and how a record was taken: what an effect may depend on besides its size."""

    seed: int
    record: str
    mode: str
    direction: str
    reading: float
    time: float
    duration: float
    since_clamping: float
    clampings: int


def baseline(bench: dict, row: Mapping) -> Conditions:
    """The machine of a record without any hidden effect: mode, hold and force of `row` are used.

    Raises ValueError if the force is not positive.
    """
    hold = generator(bench["seed"], "hold", str(row["hold"]))
    scatter = {name: float(hold.standard_normal()) for name in ("kn", "kt", "friction")}
    rounding = float(hold.uniform(-0.5, 0.5))
    force = true_force(bench, row, rounding)
    joint, friction, real = bench["joint"], bench["friction"], bench["specimen"]
    relative = force / joint["reference_force_N"]
    kn, kt = (
        joint[f"{name}_N_per_m"]
        * relative ** joint[f"{name}_exponent"]
        * np.exp(joint["reclamping_scatter"] * scatter[name])
        for name in ("kn", "kt")
    )
    slip = friction["coefficient"] * np.exp(friction["reclamping_scatter"] * scatter["friction"])
    return Conditions(
        force=force,
        kn=float(kn),
        kt=float(kt),
        modulus=float(real["modulus_factor"]),
        density=float(real["density_factor"]),
        added_mass=float(real["added_mass_kg"]),
        added_mass_x=real["added_mass_x_mm"] * 1e-3,
        friction=float(slip),
    )


def reading(bench: dict, row: Mapping) -> float:
    """Axial force (N) that a row's gauge shows: `force_N`, or pressure times the piston's area."""
    newton_per_bar = bench["gauge"]["piston_area_cm2"] * 1e-4 * 1e5
    return float(row["force_N"] if "force_N" in row else row["pressure_bar"] * newton_per_bar)


def true_force(bench: dict, row: Mapping, rounding: float) -> float:
    """Axial force (N) behind a gauge reading: `rounding` (-0.5 to 0.5) is a part of its last digit.

    `row` gives the reading as `force_N` or `pressure_bar`; the force is pressure times the
    piston's area (section 2.1.6). Raises ValueError if it is not positive.
    """
    gauge = bench["gauge"]
    last_digit = gauge["resolution_bar"] * gauge["piston_area_cm2"] * 1e-4 * 1e5
    force = gauge["gain"] * (reading(bench, row) + rounding * last_digit)
    if not force > 0:
        raise ValueError(f"the axial force must be positive, got {force} N for {dict(row)}")
    return float(force)


def moments(bench: dict, sheet: pd.DataFrame) -> list[Moment]:
    """When each row of a sheet of records was taken; holds are counted in the order of time."""
    began = sheet.groupby("hold")["time_s"].transform("min")
    count = began.rank(method="dense").astype(int) - 1
    duration = float(sheet["time_s"].max() - sheet["time_s"].min())
    return [
        Moment(
            seed=bench["seed"],
            record=str(row["record"]),
            mode=str(row["mode"]),
            direction=str(row["direction"]),
            reading=reading(bench, row),
            time=float(row["time_s"] - sheet["time_s"].min()),
            duration=duration,
            since_clamping=float(row["time_s"] - start),
            clampings=int(number),
        )
        for row, start, number in zip(sheet.to_dict("records"), began, count, strict=True)
    ]
