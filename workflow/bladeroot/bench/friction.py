"""Friction limits of the flanks' node pairs under a pressure that falls off towards the edges."""

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray


def pressure_profile(
    place: Float[ndarray, "pair 2"],
    share: Float[ndarray, " pair"],
    flank: Int[ndarray, " pair"],
    edge: float,
    spread: Float[ndarray, " pair"],
) -> Float[ndarray, " pair"]:
    """Pressure at each pair over its flank's mean: round-topped, `edge` of the top at the edges.

    `place` runs from -1 to 1 across the flank; `spread` multiplies the pairs one by one (the
    flanks' waviness). The mean over a flank, weighted by area, is one.
    """
    from_middle = np.abs(place).max(axis=1)
    raw = (edge + (1 - edge) * np.sqrt(np.clip(1 - from_middle**2, 0, 1))) * spread
    mean = np.bincount(flank, share * raw) / np.bincount(flank, share)
    return raw / mean[flank]


def slider_limits(
    force: float | Float[ndarray, " pair"],
    coefficient: float,
    share: Float[ndarray, " pair"],
    profile: Float[ndarray, " pair"],
) -> Float[ndarray, " pair"]:
    """Largest tangential force of each pair (N): Coulomb's mu N.

    Two flanks at 45 degrees carry the axial force, so each is pressed by force / sqrt(2).
    """
    return coefficient * force / np.sqrt(2) * share * profile
