"""Error propagation of Appendix F: its bounds as printed, the same made right, and the limit.

Appendix F takes frequency and loss factor from two samples of the analytic signal, n periods
apart: omega = (phi_2 - phi_1) / dt and eta = 2 ln(V_1 / V_2) / (omega dt). Its result is called a
bound and uses the noise-to-signal ratio of the first sample for both. Three things are not right:
the rms of Gaussian noise is no bound but one standard deviation, exceeded in 32 % of cases; the
second sample is smaller by exp(pi n eta), its noise-to-signal ratio larger by as much (a factor of
1000 where a decay is followed to 1/1000); and independent terms add in squares. `two_points` does
all three. What all samples between the two can tell is `limit`, the Cramer-Rao bound.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from numpy import ndarray

Numbers = Float[ndarray, "*shape"] | float


@dataclass(frozen=True)
class Errors:
    """Errors of frequency (Hz) and loss factor: bounds or standard errors, as their maker says."""

    frequency: Numbers
    loss_factor: Numbers


def published(
    frequency_Hz: Numbers,
    loss_factor: Numbers,
    ratio: Numbers,
    periods: Numbers,
    clock: float = 0.0,
) -> Errors:
    """The bounds that Appendix F prints.

    Args:
        frequency_Hz, loss_factor: of the decay.
        ratio: rms of the noise over the envelope of the velocity at the first sample.
        periods: number of periods between the two samples.
        clock: relative error of the sampling frequency (epsilon_f there).
    """
    phase = ratio / (np.sqrt(2.0) * np.pi * periods)
    loss = loss_factor * phase + np.sqrt(2.0) * ratio / (np.pi * periods)
    return Errors(frequency_Hz * (clock + phase), loss)


def two_points(
    frequency_Hz: Numbers,
    loss_factor: Numbers,
    ratio: Numbers,
    periods: Numbers,
    clock: float = 0.0,
) -> Errors:
    """Standard errors of Appendix F's procedure, made right; arguments as of `published`.

    `ratio` is that of the filtered signal, either component of its noise with its own rms.
    """
    both = ratio * np.hypot(1.0, np.exp(np.pi * periods * loss_factor))
    phase = both / (2.0 * np.pi * periods)
    relative = np.hypot(clock, phase)
    # a clock error leaves the loss factor alone: omega dt is counted in periods
    loss = np.hypot(loss_factor * phase, both / (np.pi * periods))
    return Errors(frequency_Hz * relative, loss)


def limit(
    frequency_Hz: float, loss_factor: float, ratio: float, periods: float, samples_a_period: float
) -> Errors:
    """Cramer-Rao bound of a constant frequency and loss factor from all samples in white noise.

    `ratio` is that of the unfiltered signal at the first sample; other arguments as above. Any
    unbiased estimate, also one through `FREEVIB`, has at least these standard errors.
    """
    node, weight = np.polynomial.legendre.leggauss(64)
    place = 0.5 * (node + 1.0)  # of the segment
    power = 0.5 * weight * np.exp(-2.0 * np.pi * loss_factor * periods * place)
    mean = (power @ place) / power.sum()
    spread = power @ (place - mean) ** 2
    # of phase and log-amplitude over the segment: a sample of V cos(phi) tells V^2 / 2 of either
    total = ratio * np.sqrt(2.0 / (periods * samples_a_period * spread))
    return Errors(frequency_Hz * total / (2.0 * np.pi * periods), total / (np.pi * periods))
