"""Known decays: the one generator of the tests.

`course` integrates any law of frequency and damping over amplitude; on it stand a mode with a
plateau below an onset (`ring_down`, `backbone`), one with a Coulomb slider (`coulomb_decay`) and a
record from its drive to the tip's return (`shaken`). In closed form: one mode (`ringing`), two that
beat, both laws of damping, and the thesis's mass on a spring and slider (`slider`), whose events
are found exactly. `separated_curves` is FREEVIB of a decay with several modes.
"""

from functools import cache

import numpy as np
from bladeroot.decay.components import separated
from bladeroot.decay.freevib import freevib
from bladeroot.decay.record import later
from scipy.signal import lfilter

START = 0.5  # m/s
RATE = 25600.0  # Hz


def separated_curves(velocity, sampling_Hz, expected_Hz, noise, **options):
    """FREEVIB of one mode of a decay, what else rings taken off, as a record's analysis does."""
    parts = separated(velocity, sampling_Hz, expected_Hz)
    begin_s = parts.first / sampling_Hz
    taken = parts.time - begin_s, parts.widening, parts.doubt
    own = parts.velocity[parts.first :]
    curves = freevib(own, sampling_Hz, expected_Hz, noise, taken=taken, **options)
    return later(curves, begin_s).assign_attrs(other_modes_Hz=parts.lines_Hz)


def course(alpha, omega, time, level):
    """ln A and phase at `time` of a decay from amplitude 1, for alpha(A) < 0, omega(A) in 1/s.

    level: ln A, falling from 0, at the kinks of the laws too; quadrature between them. Beyond
    its end the last rates hold.
    """
    a, step = np.exp(level), -np.diff(level)
    fall, turn = -1.0 / alpha(a), -omega(a) / alpha(a)
    clock, phase = (
        np.append(0.0, np.cumsum(0.5 * (rate[1:] + rate[:-1]) * step)) for rate in (fall, turn)
    )
    late = np.maximum(time - clock[-1], 0.0)
    return (
        np.interp(time, clock, level) - late / fall[-1],
        np.interp(time, clock, phase) + late * turn[-1] / fall[-1],
    )


def levels(nepers, *kinks, count=20001):
    """ln A from 0 over so many nepers, with the kinks (relative amplitudes) among them."""
    return -np.sort(np.append(np.linspace(0.0, nepers, count), -np.log(kinks)))


def ringing(time, frequency_Hz, decline, size=1.0, phase=0.0):
    """One mode: size exp(-decline t) cos(2 pi f t + phase)."""
    return size * np.exp(-decline * time) * np.cos(2.0 * np.pi * frequency_Hz * time + phase)


def restless(time, frequency_Hz, decline, size, rng):
    """Answer of a mode to a white force, of rms amplitude `size`: exact at even times."""
    kept = np.exp(-decline * (time[1] - time[0]))
    steps = (
        size * np.sqrt(0.5) * (rng.standard_normal(time.size) + 1j * rng.standard_normal(time.size))
    )
    steps[1:] *= np.sqrt(1.0 - kept**2)
    return (lfilter([1.0], [1.0, -kept], steps) * np.exp(2j * np.pi * frequency_Hz * time)).real


def truth_of(alpha, omega):
    """truth(A) -> (f_n, loss factor) of (3.11), for rates over A."""

    def truth(a):
        e = 1e-6
        d_alpha, d_omega = (
            (rate(a * (1 + e)) - rate(a * (1 - e))) / (2 * e) * alpha(a) for rate in (alpha, omega)
        )
        square = omega(a) ** 2 - d_alpha - alpha(a) ** 2
        return np.sqrt(square) / (2 * np.pi), -(2 * omega(a) * alpha(a) + d_omega) / square

    return truth


def ring_down(*arguments, **more):
    """Velocity, noise rms, largest amplitude and truth(A): a decay with a plateau and slip."""
    velocity, *rest = _ring_down(*arguments, **more)
    return velocity.copy(), *rest


@cache
def _ring_down(
    seed=0,
    softening=0.01,
    onset=0.2,
    eta=(0.004, 0.006),
    frequency_Hz=250.0,
    sampling_Hz=RATE,
    count=51200,
    noise_db=60.0,
    second=0.3,
    bits=16,
):
    """Above `onset` (relative to the start) frequency falls and damping rises linearly in A."""
    rng = np.random.default_rng(seed)
    largest = START / (2 * np.pi * frequency_Hz)

    def slip(a):
        return np.maximum(0.0, a / (onset * largest) - 1.0) / (1.0 / onset - 1.0)

    def omega(a):
        return 2 * np.pi * frequency_Hz * (1.0 - softening * slip(a))

    def alpha(a):
        return -np.pi * frequency_Hz * (eta[0] + (eta[1] - eta[0]) * slip(a))

    first = rng.uniform(0, 2 * np.pi)
    time = np.arange(count) / sampling_Hz
    level, turn = course(
        lambda x: alpha(x * largest), lambda x: omega(x * largest), time,
        levels(-2.0 * np.log(onset), onset),
    )  # fmt: skip
    a = largest * np.exp(level)
    velocity = ((alpha(a) + 1j * omega(a)) * a * np.exp(1j * (turn + first))).real
    other = 6.27 * frequency_Hz
    fall = np.pi * 0.003 * other
    velocity += ringing(time, other, fall, second * START, rng.uniform(0, 2 * np.pi))
    noise = START / np.sqrt(2) * 10 ** (-noise_db / 20)
    velocity += noise * rng.standard_normal(count)
    if bits:
        quantum = 3.0 * START / 2**bits
        velocity = np.round(velocity / quantum) * quantum
    return velocity, noise, largest, truth_of(alpha, omega)


def backbone(
    seed,
    noise_db=60.0,
    sharp=True,
    frequency_Hz=250.0,
    sampling_Hz=RATE,
    count=102400,
    second=0.3,
):
    """A decay over its whole record, drawn anew: velocity, noise rms, largest amplitude, truth.

    The backbone leaves a plateau at `onset` (of the start), sharply or gradually.
    """
    rng = np.random.default_rng(seed)
    largest = START / (2 * np.pi * frequency_Hz)
    onset, softening, rise = rng.uniform(0.1, 0.6), rng.uniform(0.002, 0.02), rng.uniform(0, 1.0)

    def slip(a):
        x, top = np.maximum(0.0, a / (onset * largest) - 1.0), 1.0 / onset - 1.0
        return x / top if sharp else x**2 / (1.0 + x) * (1.0 + top) / top**2

    def omega(a):
        return 2 * np.pi * frequency_Hz * (1.0 - softening * slip(a))

    # so slow that the amplitude falls by exp(5.5) within the record
    level = levels(6.0, onset)
    slow = np.append(
        0.0, np.cumsum(-np.diff(level) / (1.0 + rise * slip(largest * np.exp(level[1:]))))
    )
    pace = np.interp(5.5, -level, slow) * sampling_Hz / count

    def alpha(a):
        return -pace * (1.0 + rise * slip(a))

    time = np.arange(count) / sampling_Hz
    now, turn = course(lambda x: alpha(x * largest), lambda x: omega(x * largest), time, level)
    now = largest * np.exp(now)
    phase = turn + rng.uniform(0, 2 * np.pi)
    velocity = ((alpha(now) + 1j * omega(now)) * now * np.exp(1j * phase)).real
    other = frequency_Hz * rng.choice([2.0, 2.6, 6.3])
    velocity += ringing(time, other, np.pi * 0.003 * other, second * START, rng.uniform(0, 6))
    noise = START / np.sqrt(2) * 10 ** (-noise_db / 20)
    velocity += noise * rng.standard_normal(count)
    return velocity, noise, largest, truth_of(alpha, omega)


def coulomb(onset):
    """Stiffness lost by a slider (3.19) that sticks below `onset`, over the relative amplitude."""

    def lost(a):
        x = np.maximum(a / onset, 1.0)
        angle = np.arccos(1.0 - 2.0 / x)
        return 1.0 - (angle - 0.5 * np.sin(2.0 * angle)) / np.pi

    return lost


def coulomb_decay(onset, softening, loss=0.002, nepers=7.0, noise_db=60):
    """Velocity at 250 Hz with a slider by harmonic balance; the record ends after `nepers`."""
    lost = coulomb(onset)

    def alpha(a):
        x = np.maximum(a / onset, 1.0)
        return -np.pi * 250.0 * (loss + 8.0 / np.pi * softening * (1.0 - 1.0 / x) / x)

    def omega(a):
        return 2.0 * np.pi * 250.0 * np.sqrt(1.0 - 2.0 * softening * lost(a))

    level = levels(nepers)
    # later than the slowest decay ends
    time = np.arange(int(nepers / (np.pi * 250.0 * loss) * RATE)) / RATE
    log, phase = course(alpha, omega, time, level)
    wave = (np.exp(log) * np.cos(phase))[log >= -nepers]
    noise = 10.0 ** (-noise_db / 20) * np.random.default_rng(0).standard_normal(wave.size)
    return START * (wave + noise / np.sqrt(2.0))


def shaken(seed, eta=0.004, noise_db=60.0, sampling_Hz=RATE, frequency_Hz=250.0, tip=True):
    """A record as of fig. 2.5: quiet, driven, released, decaying, the tip's return."""
    rng = np.random.default_rng(seed + 1000)
    decay, _, _, _ = ring_down(
        seed, eta=(eta, 1.5 * eta), noise_db=400.0, second=0.0, bits=0, sampling_Hz=sampling_Hz,
        frequency_Hz=frequency_Hz,
    )  # fmt: skip
    quiet, driven = rng.uniform(0.05, 0.2), rng.uniform(0.4, 0.8)
    before = np.arange(-int(driven * sampling_Hz), 0) / sampling_Hz
    drive = 2 * np.pi * frequency_Hz * (0.99 + 0.002 * rng.standard_normal())
    at = np.angle(decay[0] - 1j * (decay[1] - decay[0]) * sampling_Hz / drive)
    build = 1.0 - np.exp(-(before - before[0]) / rng.uniform(0.03, 0.07))
    forced = START * build * np.cos(drive * before + at)
    whole = np.concatenate([np.zeros(int(quiet * sampling_Hz)), forced, decay])
    release = (whole.size - decay.size) / sampling_Hz
    returned = release + rng.uniform(0.3, 1.2)
    if tip:
        first = int(returned * sampling_Hz)
        after = np.arange(whole.size - first) / sampling_Hz
        whole[first:] *= np.exp(-after / 0.05)
        whole[first:] += ringing(after, 900.0, 100.0, 0.05, -np.pi / 2)
        whole[first:] += ringing(after, 0.9 * frequency_Hz, 20.0, 0.03, -np.pi / 2)
    noise = START / np.sqrt(2) * 10 ** (-noise_db / 20)
    whole += noise * rng.standard_normal(whole.size)
    quantum = 3.0 * START / 2**16
    return np.round(whole / quantum) * quantum, release, returned, noise


def two_modes(ratio, size, other_loss, loss=0.003, rate=32.0, seed=0):
    """A decay at 1 Hz with a close mode, and its sampling frequency; it falls to 0.5 %."""
    time = np.arange(int(np.log(200.0) / (np.pi * loss) * rate)) / rate
    wave = ringing(time, 1.0, np.pi * loss)
    wave += ringing(time, ratio, np.pi * ratio * other_loss, size, 1.0)
    return wave + 1e-3 * np.random.default_rng(seed).standard_normal(time.size), rate


def viscous(zeta=2.5e-3, frequency_Hz=250.0, sampling_Hz=12800.0, start=1e-4, noise=1e-9, seed=0):
    """Velocity of y'' + 2 zeta omega_n y' + omega_n^2 y = 0 over 4 s."""
    rate = 2 * np.pi * frequency_Hz * (-zeta + 1j * np.sqrt(1 - zeta**2))
    time = np.arange(int(4 * sampling_Hz)) / sampling_Hz
    clean = (start * rate * np.exp(rate * time)).real
    return clean + noise * np.random.default_rng(seed).standard_normal(time.size)


def hysteretic(eta=5e-3, frequency_Hz=250.0, sampling_Hz=12800.0, start=1e-4, duration_s=4.0):
    """Velocity of Y'' + omega_n^2 (1 + i eta) Y = 0."""
    rate = 1j * 2 * np.pi * frequency_Hz * np.sqrt(1 + 1j * eta)
    time = np.arange(int(duration_s * sampling_Hz)) / sampling_Hz
    return (start * rate * np.exp(rate * time)).real


def slider(
    sampling_Hz=51200.0, duration_s=0.33, zeta=2.5e-3, mass=0.7, spring=4.2e6, contact=4e6,
    slip_force=400.0, start=100e-4,
):  # fmt: skip
    """Velocity of the thesis's 1-DOF model (3.3), exact between the events of stick and slip."""
    damping = zeta * np.sqrt((spring + contact) / mass)
    count = int(duration_s * sampling_Hz)
    velocity = np.zeros(count)
    now, x, v, stuck, anchor, sense, k = 0.0, start, 0.0, True, start - slip_force / contact, 0.0, 0
    while k < count:
        stiffness = spring + contact if stuck else spring
        rest = contact * anchor / stiffness if stuck else -sense * slip_force / stiffness
        omega = np.sqrt(stiffness / mass - damping**2)
        c, s = x - rest, (v + damping * (x - rest)) / omega

        def state(t, rest=rest, omega=omega, c=c, s=s):
            cos, sin, fall = np.cos(omega * t), np.sin(omega * t), np.exp(-damping * t)
            place = rest + fall * (c * cos + s * sin)
            return place, fall * ((omega * s - damping * c) * cos - (omega * c + damping * s) * sin)

        def over(t, stuck=stuck, anchor=anchor, sense=sense, state=state):
            place, speed = state(t)
            return np.abs(contact * (place - anchor)) - slip_force if stuck else -speed * sense

        grid = np.linspace(1e-9, 2 * np.pi / omega, 4001)
        late = np.flatnonzero(over(grid) > (1e-9 * slip_force if stuck else 0.0))
        event = np.inf
        if late.size:
            low, high = grid[max(late[0] - 1, 0)], grid[late[0]]
            for _ in range(60 if late[0] else 0):
                middle = 0.5 * (low + high)
                low, high = (low, middle) if over(middle) > 0 else (middle, high)
            event = high
        stop = count if np.isinf(event) else min(count, int(np.ceil((now + event) * sampling_Hz)))
        velocity[k:stop] = state(np.arange(k, stop) / sampling_Hz - now)[1]
        k = stop
        if np.isinf(event):
            break
        x, v = state(event)
        now += event
        if stuck:
            stuck, sense = False, float(np.sign(contact * (x - anchor)))
        else:
            stuck, anchor = True, x - sense * slip_force / contact
    return velocity
