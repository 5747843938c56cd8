"""Decays beside noise that shakes the mode itself, as wind or a floor does.

    python benchmarks/shaken.py [--seed 9000] [--count 220] [--wide 1]

A mode of constant rates (1.6 to 50 Hz, loss factor 0.6 to 4 %) with an rms noise of 0.1 to 3 % of
its start that has the mode's own line shape, or one `--wide` times as wide, and white noise of
0.001 to 0.1 %. Points that are wrong in silence lie beyond three stated errors and beyond 500 ppm
or 10 %, in a record that tells of nothing. Beside it the same where such noise is not looked for.
"""

import argparse

import bladeroot as br
import bladeroot.decay.track as track
import numpy as np
from scipy.signal import lfilter

UNTOLD = {"short-record"}


def drawn(seed: int, wide: float) -> tuple[np.ndarray, float, float, float]:
    """Velocity, sampling frequency (Hz), and the true frequency (Hz) and loss factor."""
    rng = np.random.default_rng(seed)
    omega = 2.0 * np.pi * 10.0 ** rng.uniform(0.2, 1.7)
    rate = omega * 10.0 ** rng.uniform(-2.5, -1.7)
    sampling = omega / (2.0 * np.pi) * rng.uniform(15.0, 40.0)
    time = np.arange(round(rng.uniform(3.0, 6.0) / rate * sampling)) / sampling
    level, white = 10.0 ** rng.uniform(-3.0, -1.5), 10.0 ** rng.uniform(-5.0, -3.0)
    # an Ornstein-Uhlenbeck process of unit rms, exact at even times, turning with the mode
    kept = np.exp(-wide * rate / sampling)
    force = rng.standard_normal((2, time.size)).T @ [1.0, 1.0j]
    force[1:] *= np.sqrt(1.0 - kept**2)
    shaken = lfilter([1.0], [1.0, -kept], force)
    turning = np.exp(1j * (omega * time + rng.uniform(0.0, 2.0 * np.pi)))
    velocity = ((np.exp(-rate * time) + level * shaken) * turning).real
    velocity += white * rng.standard_normal(time.size)
    natural = np.hypot(omega, rate)  # (3.11)
    return velocity, sampling, natural / (2.0 * np.pi), 2.0 * rate / natural


def scored(seed: int, wide: float) -> tuple[np.ndarray, np.ndarray]:
    """Which points are wrong in silence, and the median of z^2 of frequency and loss factor."""
    velocity, sampling, frequency, loss = drawn(seed, wide)
    made = br.ringdown(velocity, mode_Hz=frequency, sampling_Hz=sampling, quantity="velocity")
    told = set(made.free_decay["finding_id"].values.tolist()) - UNTOLD
    wrong, middle = np.zeros(made.curves.sizes["point"], dtype=bool), []
    for name, true, far in (("frequency", frequency, 5e-4), ("loss_factor", loss, 0.1)):
        off = np.abs(made.curves[name].values - true)
        z = off / made.curves[f"{name}_std"].values
        wrong |= (z > 3.0) & (off > far * true)
        middle.append(np.median(z**2))
    return wrong & (not told), np.array(middle)


def main() -> None:
    """Both codes on the same decays."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--seed", type=int, default=9000)
    parser.add_argument("--count", type=int, default=220)
    parser.add_argument("--wide", type=float, default=1.0, help="of the noise, over the mode's")
    asked = parser.parse_args()
    looked_for = track.shaken
    for what, own in (("as it is", looked_for), ("not looked for", lambda *_: None)):
        track.shaken = own
        rows = [scored(asked.seed + k, asked.wide) for k in range(asked.count)]
        rows = [row for row in rows if row[0].size]  # the others have no curve
        wrong = np.concatenate([points for points, _ in rows])
        curves = np.mean([points.mean() > 0.05 for points, _ in rows])
        # of a normal error the median of z^2 is 0.455
        z = np.sqrt(np.median([middle for _, middle in rows], axis=0) / 0.455)
        print(
            f"{what:15s} {len(rows)} curves, wrong in silence: {wrong.mean():6.1%} of points, "
            f"{curves:6.1%} of curves; "
            f"errors over stated: frequency {z[0]:.2f}, loss factor {z[1]:.2f} in the median"
        )


if __name__ == "__main__":
    main()
