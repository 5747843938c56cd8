"""Appendix F's error bounds against what really happens, and against FREEVIB's standard errors.

    python benchmarks/error_bounds.py [records]

Linear decays (250 Hz, loss factor 0.005, 25.6 kHz, 60 dB over the full band) in white noise. First
the appendix's own procedure, two samples of the filtered analytic signal n periods apart; then the
plateau that FREEVIB gives for whole decays of n periods, beside the Cramer-Rao bound.
"""

import sys

import numpy as np
from bladeroot.decay.freevib import freevib
from bladeroot.plateau.plateau import plateau
from bladeroot.reproduction.error_bounds import limit, published, two_points
from scipy import fft

FREQUENCY, LOSS, RATE, RATIO = 250.0, 0.005, 25600.0, 1e-3
LOW, HIGH = 150.0, 350.0
# noise that the band passes, in either component of the analytic signal
IN_BAND = RATIO * np.sqrt(2 * 0.6875 * (HIGH - LOW) / RATE)


def band_signal(
    velocity: np.ndarray, sampling_Hz: float, low_Hz: float, high_Hz: float
) -> np.ndarray:
    """Analytic signal (3.1) of what lies between two frequencies.

    The band is a zero-phase filter with cosine edges a quarter of the band wide, set in Hz. Near
    the ends of the record it rings for about one over the band's width; the record is padded by
    forty times that, so that a strong start does not ring round into a weak end.
    """
    count = velocity.size
    padded = fft.next_fast_len(count + int(40 * sampling_Hz / (high_Hz - low_Hz)) + 1)
    spectrum = fft.fft(velocity, padded)
    frequency = fft.fftfreq(padded, 1.0 / sampling_Hz)
    edge = (high_Hz - low_Hz) / 4.0
    rise = np.clip((frequency - low_Hz) / edge, 0.0, 1.0)
    fall = np.clip((high_Hz - frequency) / edge, 0.0, 1.0)
    gain = 2.0 * np.sin(0.5 * np.pi * rise) ** 2 * np.sin(0.5 * np.pi * fall) ** 2
    return fft.ifft(spectrum * gain)[:count]


def main() -> None:
    records = int(sys.argv[1]) if len(sys.argv) > 1 else 40
    rng = np.random.default_rng(0)
    wave_rate = -np.pi * FREQUENCY * LOSS + 2j * np.pi * FREQUENCY
    print("ppm and % of 250 Hz and 0.005       as printed   made right   happens   Cramer-Rao")
    for periods in (20, 100, 440):
        found, whole = [], []
        count = int(periods / FREQUENCY * RATE) + 1
        lead = int(0.1 * RATE)
        time = (np.arange(count + 2 * lead) - lead) / RATE
        clean = np.exp(wave_rate * time).real
        for _ in range(records):
            velocity = clean + RATIO * rng.standard_normal(time.size)
            analytic = band_signal(velocity, RATE, LOW, HIGH)
            pair = analytic[[lead, lead + count - 1]]
            turn = 2 * np.pi * periods + np.angle(pair[1] / pair[0])
            found.append((turn, 2 * np.log(np.abs(pair[0] / pair[1])) / turn))
            if periods >= 100:
                curve = freevib(velocity[lead : lead + count], RATE, 250.0, RATIO)
                stick = plateau(curve)
                whole.append(
                    [
                        stick[name]
                        for name in (
                            "stick_frequency",
                            "loss_factor",
                            "stick_frequency_std",
                            "loss_factor_std",
                        )
                    ]
                )
        turn, loss = np.array(found).T
        bound = published(FREQUENCY, LOSS, IN_BAND, periods)
        right = two_points(FREQUENCY, LOSS, IN_BAND, periods)
        best = limit(FREQUENCY, LOSS, RATIO, periods, RATE / FREQUENCY)
        happens = turn.std() / (2 * np.pi * periods), loss.std() / LOSS
        rows = (
            ("frequency", 1e6 / FREQUENCY, bound.frequency, right.frequency, 1e6 * happens[0],
             best.frequency),
            ("loss factor", 1e2 / LOSS, bound.loss_factor, right.loss_factor, 1e2 * happens[1],
             best.loss_factor),
        )  # fmt: skip
        for name, scale, a, b, c, d in rows:
            print(
                f"{periods:4d} periods, two points, {name:12s} {scale * a:9.4f} {scale * b:12.4f}"
                f" {c:9.4f} {scale * d:12.4f}"
            )
        if whole:
            value = np.array(whole)
            value = value[np.isfinite(value).all(axis=1)]
            for k, (name, scale) in enumerate(
                (("frequency", 1e6 / FREQUENCY), ("loss factor", 1e2 / LOSS))
            ):
                print(
                    f"{periods:4d} periods, FREEVIB, {name:12s} stated "
                    f"{scale * np.median(value[:, 2 + k]):.4f}, happens "
                    f"{scale * value[:, k].std():.4f} ({value.shape[0]} of {records} records)"
                )


if __name__ == "__main__":
    main()
