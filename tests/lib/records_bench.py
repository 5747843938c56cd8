"""Raw records of known release and known disturbance, drawn at random for each kind."""

from dataclasses import dataclass

import numpy as np

KINDS = (
    "shaker", "shaker beating", "shaker slow ramp", "shaker chatter", "hammer", "hammer double",
    "hammer several", "step", "step offset", "begins in the decay",
)  # fmt: skip
RETURNS = ("none", "hard", "gentle")


@dataclass(frozen=True)
class Truth:
    """What a drawn record is: times in s; `free` are the spans (first, last) of free decay.

    `visible` is when the mode (of one undisturbed decay) falls to the noise of three cycles.
    """

    kind: str
    back: str
    frequency_Hz: float
    sampling_Hz: float
    eta: float
    noise: float
    noise_db: float
    free: tuple
    amplitude: float
    visible: float

    @property
    def excitation(self):
        how = self.kind.split()[0]
        return {"shaker": how, "begins": self.kind}.get(how, "at once")


def draw(
    seed, kind, noise_db, back="none", eta=None, frequency_Hz=None, samples_a_cycle=None,
    count=None, other=0.15,
):  # fmt: skip
    """One record (m/s) and its truth; what is not given is drawn.

    Damping grows with amplitude and the frequency falls with it, as a joint's do. `other` is the
    amplitude of a mode at 2.0 to 6.3 times the frequency. `count` bounds the length.
    """
    rng = np.random.default_rng([seed, KINDS.index(kind), round(noise_db), RETURNS.index(back)])
    log = lambda low, high: float(np.exp(rng.uniform(np.log(low), np.log(high))))  # noqa: E731
    f = frequency_Hz or log(5.0, 1e4)
    per = samples_a_cycle or log(8.0, 100.0)
    eta = eta or log(2e-4, 0.03)
    fs, amplitude = f * per, log(1e-3, 1.0)
    # cycles of decay: to somewhat below the noise, or less where the length is bounded
    depth = np.log(10.0) * min(noise_db, 70.0) / 20.0 * rng.uniform(0.9, 1.3)
    cycles = depth / (np.pi * eta)
    count = count or 200_000
    cycles = min(cycles, 0.6 * count / per)
    eta = max(eta, 1.6 / (np.pi * cycles))  # a fall by a factor of 5 at least
    excess, soft = rng.uniform(0.0, 1.5), rng.choice([0.0, rng.uniform(0.0, 0.02)])

    def decay(c):
        """Complex velocity over its amplitude at the release, c cycles after it (closed form)."""
        fall = np.exp(-np.pi * eta * c)
        level = fall / (1.0 + excess * (1.0 - fall))
        area = np.log1p(excess * (1.0 - fall)) / max(excess, 1e-9) if excess > 1e-9 else 1 - fall
        phase = 2 * np.pi * c - 2.0 * soft * area / eta
        return level * np.exp(1j * phase)

    ratio = rng.choice([2.0, 2.4, 6.27])
    ratio = min(ratio, 0.42 * per)
    ratio = ratio if ratio > 1.6 else 0.0
    other = other * rng.uniform(0.2, 1.0) if ratio else 0.0

    def burst(c, size):
        """Other modes struck at c = 0."""
        c = np.maximum(c, 0.0)
        ring = np.exp(-np.pi * 3.0 * eta * ratio * c) * np.cos(2 * np.pi * ratio * c)
        sharp = np.exp(-c / 1.5) * np.sin(2 * np.pi * min(0.37 * per, 9.0) * c)
        return size * (ring + 0.5 * sharp)

    lead = {"begins in the decay": 0.0}.get(kind, float(rng.uniform(5.0, 60.0)))
    driven = 0.0
    if kind.startswith("shaker"):
        driven = float(np.clip(rng.uniform(2.0, 6.0) / (np.pi * eta), 60, 0.4 * count / per))
    release = lead + driven
    tail = rng.uniform(0.15, 0.4) * cycles if back != "none" else 0.0
    total = release + cycles + tail
    c = np.arange(int(total * per)) / per - release
    c = c + rng.uniform(0.0, 1.0) / per
    phase = rng.uniform(0, 2 * np.pi)
    v = np.zeros(c.size)
    after = c >= 0.0
    free = [(0.0, cycles)]
    start = np.exp(1j * phase)
    if kind.startswith("shaker"):
        half_width = 0.5 * eta * (1 + excess)
        detune = rng.uniform(-1.0, 1.0) * half_width - soft
        build = (
            np.clip((c + driven) / driven, 0, 1) ** 0.7
            if "ramp" in kind
            else 1 - np.exp(-np.pi * eta * np.maximum(c + driven, 0.0))
        )
        if "beating" in kind:
            beat = rng.uniform(0.05, 0.3) * np.exp(-0.3 * np.pi * eta * (c + driven))
            swing = rng.uniform(3.0, 12.0) * eta
            build = build * (1 + beat * np.exp(1j * (2 * np.pi * swing * c + rng.uniform(0, 6))))
        at = build[np.flatnonzero(after)[0]] if np.iscomplexobj(build) else build[after][0]
        forced = build / at * np.exp(2j * np.pi * (1 + detune) * c)
        whole = np.where(after, decay(np.maximum(c, 0.0)), np.where(c > -driven, forced, 0.0))
        v += (start * whole).real
        v += np.where(after, burst(c, rng.choice([0.0, 0.5 * other])), 0.0)
        if "chatter" in kind:
            for knock in np.sort(rng.uniform(0.5, 10.0, rng.integers(1, 4))):
                size = rng.uniform(0.03, 0.12) * np.exp(1j * rng.uniform(0, 2 * np.pi))
                v += np.where(c >= knock, (size * start * decay(np.maximum(c - knock, 0))).real, 0)
                v += np.where(c >= knock, burst(c - knock, abs(size)), 0.0)
                free = [(float(knock), cycles)]
    elif kind.startswith("hammer"):
        hits = [(0.0, 1.0)]
        if "double" in kind:
            late = rng.uniform(2.0, max(3.0, min(40.0, 0.4 / (np.pi * eta * (1 + excess)))))
            hits.append((float(late), float(rng.uniform(0.15, 0.7))))
        if "several" in kind:
            places = np.cumsum(rng.uniform(0.2, 0.45, 2)) * cycles
            hits += [(float(p), float(rng.uniform(0.4, 1.5))) for p in places]
        width = rng.uniform(0.1, 0.5)
        free, z = [], np.zeros(c.size, complex)
        for k, (place, size) in enumerate(hits):
            for node, weight in ((0.15, 0.3), (0.5, 0.4), (0.85, 0.3)):
                x = c - place - node * width
                z += np.where(x >= 0, weight * size * decay(np.maximum(x, 0.0)), 0.0)
                v += np.where(x >= 0, weight * burst(x, size * other), 0.0)
            stop = hits[k + 1][0] if k + 1 < len(hits) else cycles
            free.append((place + width, stop))
        v += z.real
    elif kind.startswith("step"):
        v += np.where(after, (-1j * decay(np.maximum(c, 0.0))).real, 0.0)
        v += np.where(after, burst(c, other / max(ratio, 1.0)), 0.0)
        if "offset" in kind:
            v += np.where(after, 0.0, rng.uniform(0.02, 0.3) * rng.choice([-1, 1]))
    else:
        v += (start * decay(c - c[0])).real + burst(c - c[0], other)
        free = [(-release, cycles)]
    if back != "none":
        when = free[-1][0] + (free[-1][1] - free[-1][0]) * rng.uniform(0.35, 0.8)
        free[-1] = (free[-1][0], float(when))
        x = np.maximum(c - when, 0.0)
        late = c >= when
        z = start * decay(np.maximum(c, 0.0))
        size = float(np.abs(np.interp(when, c, np.abs(z))))
        # the tip's stiffness and damping come on within a few cycles
        ramp = rng.uniform(1.0, 12.0)
        on = np.where(x < ramp, 0.5 * x**2 / ramp, x - 0.5 * ramp)
        shift = rng.uniform(0.003, 0.02) * rng.choice([-1, 1])
        added = np.exp(-np.pi * rng.uniform(1.0, 5.0) * eta * on + 2j * np.pi * shift * on)
        v = np.where(late, v * 0.0 + (z * added).real, v)
        if back == "hard":
            knock = max(0.3 * size, 3 * 10 ** (-noise_db / 20))
            v += np.where(late, burst(x, knock) + knock * (np.exp(-x / 9) * np.sin(6 * x)), 0.0)
    noise = amplitude / np.sqrt(2.0) * 10 ** (-noise_db / 20)
    v = amplitude * v + noise * rng.standard_normal(c.size)
    shift = -c[0]
    # until the mode's amplitude is that of the noise in a frame of three cycles
    above = np.abs(decay(np.maximum(c, 0.0))) * amplitude > noise * np.sqrt(2.0 / per)
    visible = float((c[above][-1] + shift) / f)
    spans = tuple(((a + shift) / f, (b + shift) / f) for a, b in free)
    return v, Truth(
        kind, back, f, fs, eta * (1 + excess), noise, noise_db, spans, amplitude, visible
    )
