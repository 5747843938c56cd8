"""Known decays: a mode with a given backbone, and the thesis's mass on a spring and slider."""

import numpy as np

START = 0.5  # m/s


def ring_down(
    seed=0,
    softening=0.01,
    onset=0.2,
    eta=(0.004, 0.006),
    frequency_Hz=250.0,
    sampling_Hz=25600.0,
    count=51200,
    noise_db=60.0,
    second=0.3,
    bits=16,
):
    """Velocity, noise rms, largest amplitude and truth(A) -> (f_n, loss factor) of (3.11).

    Above `onset` (relative to the start) frequency falls and damping rises linearly in amplitude.
    """
    rng = np.random.default_rng(seed)
    largest = START / (2 * np.pi * frequency_Hz)

    def slip(a):
        return np.maximum(0.0, a / (onset * largest) - 1.0) / (1.0 / onset - 1.0)

    def omega(a):
        return 2 * np.pi * frequency_Hz * (1.0 - softening * slip(a))

    def alpha(a):
        return -np.pi * frequency_Hz * (eta[0] + (eta[1] - eta[0]) * slip(a))

    # Runge-Kutta for ln A and phase, one step a sample pair
    step = 2.0 / sampling_Hz
    log_a, phase = np.log(largest), rng.uniform(0, 2 * np.pi)
    states = np.empty((count // 2 + 2, 2))
    for k in range(states.shape[0]):
        states[k] = log_a, phase
        a1 = alpha(np.exp(log_a))
        a2 = alpha(np.exp(log_a + 0.5 * step * a1))
        a3 = alpha(np.exp(log_a + 0.5 * step * a2))
        a4 = alpha(np.exp(log_a + step * a3))
        middle = np.exp(log_a + 0.25 * step * (a1 + a2))
        before = np.exp(log_a)
        log_a += step / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
        phase += step / 6 * (omega(before) + 4 * omega(middle) + omega(np.exp(log_a)))
    time = np.arange(count) / sampling_Hz
    knots = np.arange(states.shape[0]) * step
    a = np.exp(np.interp(time, knots, states[:, 0]))
    turn = np.interp(time, knots, states[:, 1])
    velocity = ((alpha(a) + 1j * omega(a)) * a * np.exp(1j * turn)).real
    other = 6.27 * frequency_Hz
    velocity += (
        second
        * START
        * np.exp(-np.pi * 0.003 * other * time)
        * np.cos(2 * np.pi * other * time + rng.uniform(0, 2 * np.pi))
    )
    noise = START / np.sqrt(2) * 10 ** (-noise_db / 20)
    velocity += noise * rng.standard_normal(count)
    if bits:
        quantum = 3.0 * START / 2**bits
        velocity = np.round(velocity / quantum) * quantum

    def truth(a):
        e = 1e-6
        d_alpha = (alpha(a * (1 + e)) - alpha(a * (1 - e))) / (2 * e) * alpha(a)
        d_omega = (omega(a * (1 + e)) - omega(a * (1 - e))) / (2 * e) * alpha(a)
        square = omega(a) ** 2 - d_alpha - alpha(a) ** 2
        return np.sqrt(square) / (2 * np.pi), -(2 * omega(a) * alpha(a) + d_omega) / square

    return velocity, noise, largest, truth


def backbone(
    seed,
    noise_db=60.0,
    sharp=True,
    frequency_Hz=250.0,
    sampling_Hz=25600.0,
    count=102400,
    second=0.3,
):
    """A decay over its whole record, drawn anew: velocity, noise rms, largest amplitude, truth.

    The backbone leaves a plateau at `onset` (of the start), sharply or gradually; ln A and phase
    are quadratures over ln A.
    """
    rng = np.random.default_rng(seed)
    largest = START / (2 * np.pi * frequency_Hz)
    onset, softening, rise = rng.uniform(0.1, 0.6), rng.uniform(0.002, 0.02), rng.uniform(0, 1.0)

    def slip(a):
        x, top = np.maximum(0.0, a / (onset * largest) - 1.0), 1.0 / onset - 1.0
        return x / top if sharp else x**2 / (1.0 + x) * (1.0 + top) / top**2

    def omega(a):
        return 2 * np.pi * frequency_Hz * (1.0 - softening * slip(a))

    level = np.log(largest) - np.sort(np.append(np.linspace(0.0, 6.0, 40001), -np.log(onset)))
    a, step = np.exp(level), -np.diff(level)

    def along(rate):
        return np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * step)])

    # so slow that the amplitude falls by exp(5.5) within the record
    pace = np.interp(-5.5, (level - level[0])[::-1], along(1.0 / (1.0 + rise * slip(a)))[::-1])
    pace *= sampling_Hz / count

    def alpha(a):
        return -pace * (1.0 + rise * slip(a))

    clock, turn = along(-1.0 / alpha(a)), along(-omega(a) / alpha(a))
    time = np.arange(count) / sampling_Hz
    now = np.exp(np.interp(time, clock, level))
    phase = np.interp(time, clock, turn) + rng.uniform(0, 2 * np.pi)
    velocity = ((alpha(now) + 1j * omega(now)) * now * np.exp(1j * phase)).real
    other = frequency_Hz * rng.choice([2.0, 2.6, 6.3])
    fall = np.exp(-np.pi * 0.003 * other * time)
    velocity += second * START * fall * np.cos(2 * np.pi * other * time + rng.uniform(0, 6))
    noise = START / np.sqrt(2) * 10 ** (-noise_db / 20)
    velocity += noise * rng.standard_normal(count)

    def truth(a):
        e = 1e-6
        d_alpha = (alpha(a * (1 + e)) - alpha(a * (1 - e))) / (2 * e) * alpha(a)
        d_omega = (omega(a * (1 + e)) - omega(a * (1 - e))) / (2 * e) * alpha(a)
        square = omega(a) ** 2 - d_alpha - alpha(a) ** 2
        return np.sqrt(square) / (2 * np.pi), -(2 * omega(a) * alpha(a) + d_omega) / square

    return velocity, noise, largest, truth


def shaken(seed, eta=0.004, noise_db=60.0, sampling_Hz=25600.0, frequency_Hz=250.0, tip=True):
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
        whole[first:] += 0.05 * np.exp(-after / 0.01) * np.sin(2 * np.pi * 900 * after)
        whole[first:] += 0.03 * np.exp(-after / 0.05) * np.sin(1.8 * np.pi * frequency_Hz * after)
    noise = START / np.sqrt(2) * 10 ** (-noise_db / 20)
    whole += noise * rng.standard_normal(whole.size)
    quantum = 3.0 * START / 2**16
    return np.round(whole / quantum) * quantum, release, returned, noise


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
