"""Contact that is not full below a seating force, and does not grow above it."""

import numpy as np

from bladeroot.mechanisms.mechanism import Mechanism, Parameter, Records, StickEffect

SEATED_PART = 1.0 - np.exp(-1.0)  # part of a flank that touches at the seating force, in all forms
_CORNER_SHARPNESS = 6.0  # how sharply growth ends at a threshold


def exponential(records: Records, values: np.ndarray) -> StickEffect:
    """kn and kt have the share (1 - exp(-(F/Fs)^q))^(1/q): F/Fs far below Fs, 1 far above."""
    seating, sharpness = values
    ln_ratio = np.clip(np.log(records.force / seating), -7.0, 7.0)
    power = np.exp(np.minimum(sharpness * ln_ratio, 6.0))
    touching = -np.expm1(-power)
    share = np.log(touching) / sharpness
    growing = power * np.exp(-power) / touching  # d ln(touching) / d ln(power)
    return _effect(share, -growing / seating, (growing * ln_ratio - share) / sharpness)


def logistic(records: Records, values: np.ndarray) -> StickEffect:
    """The share 1 / (1 + (F/F')^-q), a logistic function of ln F."""
    seating, sharpness = values
    ln_ratio = np.log(records.force / seating)
    away = np.exp(np.clip(-sharpness * ln_ratio, -30.0, 30.0)) * (1.0 - SEATED_PART) / SEATED_PART
    left = away / (1.0 + away)
    return _effect(-np.log1p(away), -left * sharpness / seating, left * ln_ratio)


def threshold(records: Records, values: np.ndarray) -> StickEffect:
    """The share (F/F')^q up to the force F' and 1 above, with a short bend between."""
    seating, growth = values
    steep = _CORNER_SHARPNESS * growth
    ln_ratio = np.log(records.force / seating) + np.log(SEATED_PART) / growth
    away = np.exp(np.clip(-steep * ln_ratio, -60.0, 60.0))
    left = away / (1.0 + away)
    by_growth = left * (ln_ratio - np.log(SEATED_PART) / growth)
    return _effect(-np.log1p(away) / _CORNER_SHARPNESS, -left * growth / seating, by_growth)


def _effect(share: np.ndarray, by_seating: np.ndarray, by_shape: np.ndarray) -> StickEffect:
    slope = np.stack([by_seating, by_shape], axis=1)
    return StickEffect({"ln_kn": share, "ln_kt": share}, {"ln_kn": slope, "ln_kt": slope})


def _starts(shape: float) -> tuple[tuple[float, float], ...]:
    """Full at nearly any force, and far from it at most."""
    return tuple((float(np.log(seating)), float(np.log(shape))) for seating in (800.0, 9e3, 5e4))


MECHANISM = Mechanism(
    id="incomplete-contact",
    kind="force-law",
    sentence="at low {load} the {flanks} touch on a part of their area only",
    parameters=(
        Parameter(
            "seating_force", "N", 4e3, 0.8, 300.0, 30e3,
            "63 % of a flank touch there; section 5.2: not all of it below 12 kN", log=True,
        ),
        Parameter(
            "sharpness", "1", 1.0, 0.3, 0.3, 5.0,
            "a gap that is used up at a constant rate 1, one that closes at once above 3",
            log=True,
        ),
    ),
    splitter="stick frequencies at more {forces}, below the seating {force} and far above it; "
    "pressure-sensitive film",
    stick=exponential,
    starts=_starts(1.0),
    form="exponential",
    measured_by="pressure film",
).also(
    "logistic",
    Parameter(
        "sharpness", "1", 2.0, 0.3, 0.5, 8.0,
        "steeper than a layer in series with the bulk, 1", log=True,
    ),
    keep=1, stick=logistic, starts=_starts(2.0),
).also(
    "threshold",
    Parameter(
        "growth", "1", 0.7, 0.4, 0.1, 3.0,
        "area over force below the threshold: elastic flanks 1/2, a wedge 1", log=True,
    ),
    keep=1, stick=threshold, starts=_starts(0.7),
)  # fmt: skip
