"""What the shaker's tip does in a record: wait, push, drive at resonance, let go, come back."""

from dataclasses import dataclass

import numpy as np

from bladeroot.bench.stepping import Drive

_RETURN_S = 0.02  # rise of the push as the tip comes back
_KNOCK_S = 0.001  # its blow
_SINE_RAMP_S = 0.02  # rise of the sine
_TOUCH_S = 0.0001  # a touch during the decay


@dataclass(frozen=True)
class Course:
    """Durations (s) of a record's phases, in order; see fig. 2.5."""

    quiet: float
    push: float
    drive: float
    decay: float
    back: float


@dataclass(frozen=True)
class Blow:
    """A touch of the tip during the decay: time after release (s) and impulse (N s)."""

    after: float = 0.0
    impulse: float = 0.0


def tip_force(
    course: Course,
    preload: float,
    sine: float,
    knock: float,
    mode: int,
    dt: float,
    touch: Blow | None = None,
) -> tuple[Drive, int]:
    """Force of the tip at every instant, and the step at which it has let go.

    `preload`, `sine` and `knock` (the blow as the tip comes back) are in newtons; `touch` is a
    touch too early. The tip must stay in contact while it drives: raises ValueError unless
    preload > sine.
    """
    if not preload > sine:
        raise ValueError(f"the tip needs a preload above its sine, got {preload} and {sine} N")
    pushed_at = round(course.quiet / dt)
    driven_at = round((course.quiet + course.push) / dt)
    release = round((course.quiet + course.push + course.drive) / dt)
    back_at = release + round(course.decay / dt)
    end = back_at + round(course.back / dt)

    push = np.zeros(end + 1)
    push[pushed_at:driven_at] = preload * _rise(driven_at - pushed_at)
    push[driven_at:release] = preload
    ramp = min(round(_RETURN_S / dt), end - back_at)
    push[back_at : back_at + ramp] = preload * _rise(ramp)
    push[back_at + ramp :] = preload
    blow = min(round(_KNOCK_S / dt), end - back_at)
    push[back_at : back_at + blow] += knock * np.sin(np.pi * np.arange(blow) / blow)
    if touch is not None and touch.impulse:
        at = release + round(touch.after / dt)
        steps = max(round(_TOUCH_S / dt), 2)
        push[at : at + steps] += touch.impulse / (steps * dt)

    wave = np.zeros(end + 1)
    ramp = min(round(_SINE_RAMP_S / dt), release - driven_at)
    wave[driven_at:release] = sine
    wave[driven_at : driven_at + ramp] *= _rise(ramp)
    return Drive(push=push, sine=wave, mode=mode), release


def _rise(steps: int) -> np.ndarray:
    """Smooth rise from 0 to 1."""
    return 0.5 - 0.5 * np.cos(np.pi * np.arange(steps) / max(steps, 1))
