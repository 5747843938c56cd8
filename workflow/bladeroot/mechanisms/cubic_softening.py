"""A spring that softens with amplitude and loses nothing: a material, or a root that turns."""

import numpy as np

from bladeroot.mechanisms.mechanism import CurveEffect, Mechanism, Parameter, Points
from bladeroot.mechanisms.over_amplitude import OWN_LOSS, of_spring

REFERENCE_AMPLITUDE = 1e-5  # m, at which `fall` is stated


def power(points: Points, values: np.ndarray) -> CurveEffect:
    """ln f falls by `fall` at 10 um, over amplitude as a power, at all forces alike."""
    x = np.log(points.amplitude / REFERENCE_AMPLITUDE)
    course = -np.exp(values[3] * x)
    return of_spring(points, values[:3], course, course * x)


MECHANISM = Mechanism(
    id="cubic-softening",
    kind="amplitude",
    sentence="a spring softens with the amplitude without any loss, whatever the {load}",
    parameters=(
        Parameter(
            "fall", "1", 1e-4, 2.0, 1e-9, 1.0, "of ln f at 10 um in the first mode", log=True
        ),
        Parameter(
            "ratio", "1", 1.0, 1.0, 1e-3, 1e3,
            "another mode over the first: the same spring by another shape", log=True,
            ratio=True,
        ),
        OWN_LOSS,
        Parameter(
            "power", "1", 2.0, 0.4, 0.5, 6.0,
            "of the amplitude: 2 for a cubic law or a slight asymmetry, 1 for a kink, 4 beyond",
            log=True,
        ),
    ),
    splitter="loss factors at the same amplitudes, which friction raises; twice the {load}",
    curve=power,
    starts=tuple((float(np.log(1e-4)), 0.0, OWN_LOSS.start, float(np.log(p))) for p in (1.0, 4.0)),
)  # fmt: skip
