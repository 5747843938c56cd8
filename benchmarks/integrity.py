"""False alarms and power of the findings of `quality.integrity`, by simulation.

    python benchmarks/integrity.py clean --seed 7 --count 2000
    python benchmarks/integrity.py power --seed 8 --count 100

`clean` draws decays of the widest kind without a fault and counts what fires; `power` puts one
fault of a given size into each and counts how often it is found. `time` compares the cost with that
of `scipy.signal.hilbert` on the same record.
"""

import argparse
import time
import tracemalloc

import numpy as np
import xarray as xr
from bladeroot.decay.cut import cut
from bladeroot.quality.integrity import bridged, checks, examine, examined, judge
from scipy.interpolate import CubicSpline
from scipy.signal import hilbert


def decay(rng, **fixed):
    """A clean decay: velocity before noise and digitiser, and what it is made of."""
    made = {
        "f": np.exp(rng.uniform(np.log(5.0), np.log(10e3))),
        "a_cycle": np.exp(rng.uniform(np.log(5.0), np.log(200.0))),
        "eta": np.exp(rng.uniform(np.log(1e-3), np.log(0.03))),
        "more": rng.uniform(0.0, 3.0),
        "soft": np.exp(rng.uniform(np.log(0.002), np.log(0.03))) * (rng.random() < 0.9),
        "onset": np.exp(rng.uniform(np.log(0.02), np.log(0.6))),
        "sharp": rng.random() < 0.5,
        "start": np.exp(rng.uniform(np.log(1e-3), np.log(2.0))),
        "nepers": rng.uniform(2.0, 8.0),
        "modes": rng.integers(0, 3),
        "harmonics": rng.uniform(0.0, 0.01) * (rng.random() < 0.5),
        "noise_db": rng.choice([20.0, 40.0, 60.0]),
        "bits": rng.choice([12, 16, 24]),
        "quiet": rng.random() < 0.3,
        "longest": 200_000,
        "slider": False,
    } | fixed
    f, start = made["f"], made["start"]
    rate = f * made["a_cycle"]
    log_a = np.linspace(0.0, -12.0, 6001)
    a = np.exp(log_a)
    if made["sharp"]:
        slip = np.maximum(a / made["onset"] - 1.0, 0.0) / (1.0 / made["onset"] - 1.0)
    else:
        slip = a**2 / (a**2 + made["onset"] ** 2) * (1.0 + made["onset"] ** 2)
    loss = slip
    if "hump" in made:  # damping is largest where the joint slides through
        loss = np.exp(-0.5 * ((log_a - np.log(made["onset"])) / made["hump"]) ** 2)
    fall = np.pi * f * made["eta"] * (1.0 + made["more"] * loss)
    turn = 2.0 * np.pi * f * (1.0 - made["soft"] * slip)
    if made["slider"]:  # harmonic balance of a Coulomb slider: its damping follows its softening
        x = np.maximum(a / made["onset"], 1.0)
        angle = np.arccos(1.0 - 2.0 / x)
        slip = 1.0 - (angle - 0.5 * np.sin(2.0 * angle)) / np.pi
        loss = made["eta"] + 8.0 / np.pi * made["soft"] * (1.0 - 1.0 / x) / x
        fall = np.pi * f * loss
        turn = 2.0 * np.pi * f * np.sqrt(1.0 - 2.0 * made["soft"] * slip)
    step = -np.diff(log_a)
    t = np.concatenate([[0.0], np.cumsum(step * 0.5 * (1 / fall[1:] + 1 / fall[:-1]))])
    ratio = turn / fall
    phase = np.concatenate([[0.0], np.cumsum(step * 0.5 * (ratio[1:] + ratio[:-1]))])
    end = np.interp(made["nepers"], -log_a, t)
    count = int(np.clip(end * rate, 45.0 * made["a_cycle"], made["longest"]))
    x = np.arange(count) / rate
    x = np.minimum(x, t[-1])
    level = CubicSpline(t, log_a)(x)
    angle = CubicSpline(t, phase)(x) + rng.uniform(0.0, 2.0 * np.pi)
    own = np.exp(level)
    size = made["harmonics"] * np.interp(level, log_a[::-1], slip[::-1])
    v = own * np.cos(angle)
    for order, part in ((2, 0.5), (3, 1.0), (5, 0.3)):
        if order * made["a_cycle"] ** -1 < 0.45:
            v += size * part * own * np.cos(order * angle + rng.uniform(0.0, 2.0 * np.pi))
    made["others"] = []
    for _ in range(made["modes"]):
        other = rng.choice([rng.uniform(0.15, 0.6), np.exp(rng.uniform(np.log(1.6), np.log(12.0)))])
        if other < 0.42 * made["a_cycle"]:
            part = np.exp(rng.uniform(np.log(0.003), np.log(0.3)))
            rate_other = np.pi * other * f * np.exp(rng.uniform(np.log(1e-3), np.log(0.03)))
            shift = rng.uniform(0.0, 2.0 * np.pi)
            made["others"].append(other * f)
            v += part * np.exp(-rate_other * x) * np.cos(2 * np.pi * other * f * x + shift)
    return start * v, rate, made


def measured(rng, velocity, made):
    """Noise, a quiet stretch before, and the digitiser."""
    start = made["start"]
    if made["quiet"]:
        before = int(rng.uniform(5.0, 40.0) * made["a_cycle"])
        velocity = np.concatenate([np.zeros(before), velocity])
    noise = start / np.sqrt(2.0) * 10.0 ** (-made["noise_db"] / 20.0)
    velocity = velocity + noise * rng.standard_normal(velocity.size)
    step = 2.0 * rng.uniform(1.2, 3.0) * start / 2.0 ** made["bits"]
    return np.round(velocity / step) * step


def faulty(rng, name, size, velocity, rate, made):
    """A clean decay with one fault, before the noise (after it: see `after`)."""
    f, start, n = made["f"], made["start"], velocity.size
    x = np.arange(n) / rate
    own = np.abs(velocity)
    if name == "shaker-recontact":
        k = int(rng.uniform(0.1, 0.5) * np.argmax(np.cumsum(own) > 0.95 * own.sum()))
        k = max(k, int(12 * made["a_cycle"]))
        phasor = hilbert(velocity)
        change = 1.0 + size * np.exp(2j * np.pi * rng.random())
        velocity = np.where(np.arange(n) < k, velocity, (phasor * change).real)
    if name == "gap":
        k = int(rng.uniform(0.1, 0.5) * np.argmax(np.cumsum(own) > 0.95 * own.sum()))
        k = max(k, int(12 * made["a_cycle"]))
        velocity = np.delete(velocity, slice(k, k + max(int(size * made["a_cycle"]), 1)))
    if name == "mode-beating":
        away = rng.choice([-1, 1]) * np.exp(rng.uniform(np.log(0.02), np.log(0.15)))
        envelope = np.abs(hilbert(velocity))
        shift = rng.uniform(0.0, 2.0 * np.pi)
        velocity = velocity + size * envelope * np.cos(2 * np.pi * f * (1 + away) * x + shift)
    if name == "mains-hum":
        shift = rng.uniform(0.0, 2.0 * np.pi)
        velocity = velocity + size * np.cos(2 * np.pi * rng.choice([50, 60, 150]) * x + shift)
    if name == "driven-residue":
        phase = 2 * np.pi * f * x + rng.uniform(0.0, 2.0 * np.pi)
        velocity = velocity + size * start * np.cos(phase)
    return velocity


def after(rng, name, size, velocity, rate, made):
    """Faults of the digitiser and of the file, after noise."""
    velocity = velocity.copy()
    start, n = made["start"], velocity.size
    if name == "clipping":
        top = (1.0 - size) * start
        velocity = np.clip(velocity, -top, top)
    if name == "noisy-clipping":
        top = (1.0 - size) * start
        velocity = np.clip(velocity, -top, top) + 0.003 * start * rng.standard_normal(n)
    if name == "spike":
        for k in rng.integers(int(0.02 * n), int(0.98 * n), 3):
            velocity[k] += size * start * rng.choice([-1, 1])
    if name == "dropout":
        k = int(rng.uniform(0.05, 0.3) * n)
        velocity[k : k + max(int(size * made["a_cycle"]), 5)] = rng.choice([0.0, velocity[k]])
    return velocity


def statistics(velocity, rate, f, modes=()):
    """Candidates by id, or None where the cut refuses."""
    found = cut(bridged(velocity, rate, f), rate, f)
    if found.attrs["verdict"] != "usable":
        return None, found.attrs["findings"]
    return dict(examine(examined(found, velocity, f, modes))), ""


def joint(rng):
    """What a clean decay has of a joint: half have a slider, a third end soon after slip."""
    onset = np.exp(rng.uniform(np.log(0.01), np.log(0.6)))
    made = {"slider": rng.random() < 0.5, "onset": onset}
    if rng.random() < 0.3:
        made["nepers"] = -np.log(onset) + rng.uniform(0.1, 1.5)
    return made


def clean(seed, count, keep=None):
    """Rate at which each finding fires without a fault, and quantiles of its statistic."""
    seen = {name: [] for name in [*checks(), "gap"]}
    used = alarms = 0
    for k in range(count):
        rng = np.random.default_rng([seed, k])
        velocity, rate, made = decay(rng, **joint(np.random.default_rng([seed, k, 1])))
        velocity = measured(rng, velocity, made)
        expected = made["f"] * rng.uniform(0.95, 1.05)
        # what a campaign would know: other modes to some per cent, one that does not show
        known = [*made["others"], made["f"] * rng.uniform(1.5, 10.0)]
        known = tuple(float(other * rng.uniform(0.95, 1.05)) for other in known)
        candidates, _ = statistics(velocity, rate, expected, known)
        if candidates is None:
            continue
        used += 1
        fired = [n for n, c in candidates.items() if c.counts]
        alarms += bool(fired)
        for name in fired:
            if keep is not None:
                keep.append((name, k, candidates[name], made))
        for name, candidate in candidates.items():
            seen[name].append(candidate.statistic)
    print(f"{used} of {count} clean decays are cut as usable; {alarms} raise a finding")
    print("finding              fires    median      99 %    99.8 %   largest threshold")
    for name in seen:
        threshold = checks()["shaker-recontact" if name == "gap" else name].THRESHOLD
        values = np.array(seen[name]) if seen[name] else np.zeros(1)
        q = np.quantile(values, [0.5, 0.99, 0.998, 1.0])
        over = 100.0 * np.sum(values > threshold) / used
        print(f"{name:18s} {over:6.2f}% " + " ".join(f"{v:9.3g}" for v in q), threshold)


POWER = {
    "clipping": (0.02, 0.1, 0.3),
    "noisy-clipping": (0.05, 0.1, 0.3),
    "shaker-recontact": (0.03, 0.05, 0.1, 0.3),
    "gap": (0.1, 0.3),
    "dropout": (0.1, 1.0),
    "spike": (0.1, 0.3, 1.0),
    "mode-beating": (0.02, 0.05, 0.1),
    "mains-hum": (1e-4, 2e-4, 1e-3),
    "driven-residue": (0.003, 0.01, 0.03),
}
# What the power is stated for: a laboratory's record.
USUAL = {
    "modes": 1, "quiet": False, "bits": 16, "nepers": 6.0,
}  # fmt: skip


def usual(rng):
    return USUAL | {
        "f": np.exp(rng.uniform(np.log(100.0), np.log(2000.0))),
        "a_cycle": np.exp(rng.uniform(np.log(20.0), np.log(100.0))),
        "eta": np.exp(rng.uniform(np.log(1e-3), np.log(5e-3))),
        "noise_db": rng.choice([50.0, 70.0]),
        "start": np.exp(rng.uniform(np.log(0.05), np.log(0.5))),
        "more": rng.uniform(0.0, 2.0),
    }


def power(seed, count, names=POWER):
    """How often a fault of a size is found, by its own name or by any."""
    for name in names:
        for size in POWER[name]:
            own = some = used = 0
            for k in range(count):
                rng = np.random.default_rng([seed, k])
                velocity, rate, made = decay(rng, **usual(rng))
                velocity = faulty(rng, name, size, velocity, rate, made)
                velocity = after(rng, name, size, measured(rng, velocity, made), rate, made)
                candidates, _ = statistics(velocity, rate, made["f"])
                used += 1
                if candidates is None:
                    continue
                fired = {n for n, c in candidates.items() if c.counts}
                own += ("clipping" if name == "noisy-clipping" else name) in fired
                some += bool(fired)
            own, some = 100 * own / used, 100 * some / used
            print(f"{name:18s} {size:8.2g}  {own:5.1f} %  any {some:5.1f} %")


def cost():
    """Time of the judgement over one Hilbert transform, and its memory over the record's."""
    for count in (10**5, 10**6, 10**7):
        made = {"f": 250.0, "a_cycle": 100.0, "eta": 180.0 / count, "more": 1.0, "soft": 0.01}
        rng = np.random.default_rng(0)
        fixed = {"modes": 1, "nepers": 7.0, "noise_db": 60.0, "quiet": False, "longest": count}
        velocity, rate, made = decay(rng, **made, **fixed)
        velocity = measured(rng, velocity, made)
        attrs = {
            "sampling_Hz": rate, "start_s": 0.0, "end_reason": "", "findings": "",
            "noise_velocity": made["start"] / np.sqrt(2.0) * 1e-3,
        }  # fmt: skip
        found = xr.Dataset({"velocity": ("time", velocity)}, attrs=attrs)
        ours = best(lambda found=found, v=velocity: judge(found, v, 250.0))
        before = best(lambda v=velocity, rate=rate: bridged(v, rate, 250.0))
        theirs = best(lambda v=velocity: hilbert(v))
        tracemalloc.start()
        judge(found, velocity, 250.0)
        peak = tracemalloc.get_traced_memory()[1] / velocity.nbytes
        tracemalloc.stop()
        print(
            f"{velocity.size} samples: judge {1e3 * ours:.1f} ms, {ours / theirs:.1f} times "
            f"hilbert; bridged {before / theirs:.1f} times; memory {peak:.1f} times the record"
        )


def best(work):
    spans = []
    for _ in range(3):
        begin = time.perf_counter()
        work()
        spans.append(time.perf_counter() - begin)
    return min(spans)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", choices=("clean", "power", "time"))
    parser.add_argument("--seed", type=int, default=7)
    parser.add_argument("--count", type=int, default=1000)
    given = parser.parse_args()
    if given.what == "time":
        cost()
    else:
        {"clean": clean, "power": power}[given.what](given.seed, given.count)
