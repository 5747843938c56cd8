"""What a pair of mode and sensor has to do with: names by which faults are counted."""

import numpy as np

from .event import Event

CLOSE, RATIO = 0.17, 0.05  # of the frequency, and of two or three times it
LOUD = 10.0  # another mode has so many times the velocity
FEW_CYCLES, FEW_SAMPLES = 150, 10


def velocities(event: Event, sensor: int) -> np.ndarray:
    """Velocity of each mode at the sensor when the motion starts."""
    at = event.sensors[sensor].at_modes
    return np.array([m.law.omega * m.law.scale for m in event.modes]) * at


def circumstances(event: Event, mode: int, sensor: int) -> list[str]:
    """Features of the event, of this sensor's chain, and of this mode among the others."""
    one = event.sensors[sensor]
    found = set(event.features) | one.chain.features | {f"law {event.truths[mode].name}"}
    found |= {one.chain.quantity, f"filter {one.chain.filter}", f"{one.chain.bits} bits"}
    own, speed = event.modes[mode].law.omega, velocities(event, sensor)
    for k, other in enumerate(event.modes):
        ratio = other.law.omega / own
        if k == mode:
            continue
        if abs(ratio - 1.0) < CLOSE and speed[k] > 0.02 * speed[mode]:
            found.add("own: close mode")
        for whole in (2.0, 3.0):
            if abs(max(ratio, 1.0 / ratio) - whole) < RATIO * whole:
                found.add(f"own: {whole:.0f}:1")
        if speed[k] > LOUD * speed[mode]:
            found.add(f"own: louder mode {'above' if ratio > 1 else 'below'}")
        if not other.structural and speed[k] > 0.01 * speed[mode]:
            found.add("own: suspension above 1 %")
    near = own / (2.0 * np.pi)
    if one.samples.size / event.sampling_Hz * near < FEW_CYCLES:
        found.add("own: record below 150 cycles")
    if event.sampling_Hz / near < FEW_SAMPLES:
        found.add("own: below 10 samples a cycle")
    if (
        float(
            event.truths[mode].shape(
                np.array(event.modes[mode].law.scale / event.truths[mode].scale)
            )[1]
        )
        > 0.015
    ):
        found.add("own: damping above 1.5 %")
    return sorted(found)
