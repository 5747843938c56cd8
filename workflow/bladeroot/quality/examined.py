"""What the checks of a decay look at, and return; blocks, spans and trends as they need them."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Complex, Float, Int
from numpy import ndarray
from scipy import fft

from bladeroot.signal.envelope import tapered
from bladeroot.signal.lines import blackman_harris, hann, loudest, mode_Hz, quantum
from bladeroot.signal.recording import SHORT_GAP, Recording, difference_reach
from bladeroot.signal.runs import medians, runs

# The frames in which the mode is fitted, a cycle apart.
FRAME_CYCLES = 4
LEAST_FRAME_SAMPLES = 16  # a frame is longer than FRAME_CYCLES where these have fewer samples
# Standard errors by which the mode stands out of the noise in a frame.
MODE_OVER_ERROR = 8.0
# A frame that overlaps a span of blind samples longer than this part of a cycle is not used.
LONG_SPAN_CYCLES = 0.1
# Frames of at least this many samples tell the mode from other lines, which are then fitted too.
FIT_OTHERS_SAMPLES = 24
HIGHEST_HARMONIC = 0.42  # its 2nd and 3rd harmonic, if below this part of the sampling frequency
# Other modes in these bands of its frequency; nearer ones are not told apart in four cycles.
OTHER_MODE_BANDS = ((0.3, 0.65), (1.35, 1.7))

FEWEST_WHOLE_FRAMES = 38  # frames without blind samples from which a trend is taken off
LEAST_FRAME_STD = 3e-4  # of ln A + i phase: no frame is believed to be more certain, in weights

# The rate at which hum and noise around the mode are looked for, on means of samples: at least the
# larger of these.
MEANS_PER_CYCLE = 16.0
MEANS_HZ = 4000.0

# The noise around the mode, from the median power of the spectral lines near it.
NOISE_BANDS = ((0.3, 0.8), (1.3, 1.8))  # where it is looked for, over the mode's frequency
# Beyond this part of the spectrum's highest frequency a filter takes noise away.
UNFILTERED_PART = 0.9
FEWEST_NOISE_LINES = 24  # in the bands, at least
# The noise is coloured where its power exceeds that of white noise by this many standard errors,
# and by a factor of two.
COLOURED_NOISE_ERRORS = 6.0
TAPER_NOISE_BANDWIDTH = 2.0044  # of the Blackman-Harris taper, in lines
MEDIAN_POWER_ERROR = 1.2  # standard error of ln of the median power of n lines, times sqrt(n)

# Id of a finding on what other modes left in the curve: no fault of records is named for it.
LEFTOVER = "leftover"


@dataclass(frozen=True)
class Finding:
    """A candidate fault of a decay: it counts where `statistic` exceeds `threshold`.

    `consequence` is warn, subtract, mask or drop. `spans` are the samples concerned, as pairs of
    first and one past the last, which lose their weight where it masks; `excess` is what it
    subtracts from the velocity. `name` is the finding's id, if not that of its check. `at`: the
    sample of a step, also of one that does not count, which other sensors may see, too.
    """

    statistic: float
    threshold: float
    consequence: str
    text: str
    spans: tuple[tuple[int, int], ...] = ()
    excess: Float[ndarray, " sample"] | None = None
    name: str = ""
    at: float = np.nan

    @property
    def counts(self) -> bool:
        """Whether the statistic exceeds the threshold."""
        return bool(self.statistic > self.threshold)


@dataclass(frozen=True)
class Frames:
    """Log-phasor of the mode in frames of `FRAME_CYCLES` cycles, a cycle apart.

    `centre` is in samples; `log` is ln(velocity amplitude) + i (phase against `frequency_Hz`),
    `std` its standard error from noise as loud as it is around the mode. `row` makes a frame's
    phasor from its samples; a frame that overlaps a long span of blind samples is not `whole`.
    """

    frequency_Hz: float
    hop: int
    centre: Float[ndarray, " frame"]
    log: Complex[ndarray, " frame"]
    std: Float[ndarray, " frame"]
    row: Complex[ndarray, " width"]
    whole: Bool[ndarray, " frame"]

    @cached_property
    def clear(self) -> int:
        """Number of frames before the mode first sinks to `MODE_OVER_ERROR` standard errors."""
        lost = np.flatnonzero((self.std > 1.0 / MODE_OVER_ERROR) & self.whole)
        return int(lost[0]) if lost.size else self.std.size

    @cached_property
    def amplitude(self) -> Float[ndarray, " frame"]:
        """Velocity amplitude."""
        return np.exp(self.log.real)


@dataclass(frozen=True)
class Examined:
    """A cut decay and views of it, each made once when first asked for.

    `velocity` is the cut decay, `whole` the raw record, `first` the sample in it at which the cut
    begins, `noise` the rms of the sensor's noise, `modes_Hz` the expected frequencies of the
    structure's other modes. `blind` are spans of samples that other findings have set aside. `unit`
    is m/s, except where the sensor's own channel is looked at. `mixed` is the decay with all that
    rings, where other modes have been taken off this one. `recording` has the sensor's own samples,
    where known.
    """

    velocity: Float[ndarray, " sample"]
    sampling_Hz: float
    expected_Hz: float
    noise: float
    whole: Float[ndarray, " whole"]
    first: int = 0
    modes_Hz: tuple[float, ...] = ()
    blind: tuple[tuple[int, int], ...] = ()
    unit: str = "m/s"
    mixed: "Examined | None" = None
    recording: Recording | None = None

    @cached_property
    def lost(self) -> tuple[tuple[int, int], ...]:
        """Spans of the decay that rest on samples that the sensor's recording has lost."""
        if self.recording is None or not self.recording.lost.size:
            return ()
        at = np.zeros(self.recording.samples.size, bool)
        at[self.recording.lost] = True
        spans = runs(at)
        if self.recording.quantity == "displacement":
            reach = difference_reach(self.sampling_Hz, self.expected_Hz)
            spans += np.where(np.diff(spans) > SHORT_GAP, (-reach, reach), 0)
        spans = np.clip(spans - self.first, 0, self.velocity.size)
        return tuple((int(a), int(b)) for a, b in spans if a < b)

    @cached_property
    def early(self) -> tuple[Float[ndarray, " line"], Float[ndarray, " line"]]:
        """Frequencies and magnitudes (Hann) of the loudest 80 cycles, a decay's first."""
        return loudest(self.velocity, self.sampling_Hz, self.expected_Hz)

    @cached_property
    def own_Hz(self) -> float:
        """The mode's frequency in its loudest cycles; the expected one stands in for none."""
        return mode_Hz(*self.early, self.expected_Hz)

    @cached_property
    def quantum(self) -> float:
        """The digitiser's step."""
        return quantum(self.velocity)

    @cached_property
    def frames(self) -> Frames:
        """The mode, frame by frame, fitted together with mean, trend and two harmonics."""
        x, rate, f = self.velocity, self.sampling_Hz, self.own_Hz
        hop = max(1, round(rate / f))
        width = min(max(FRAME_CYCLES, -(-LEAST_FRAME_SAMPLES // hop)), x.size // hop) * hop
        # a louder mode leaks into the frames unless it is fitted too
        lines = [order * f for order in (2, 3) if order * f < HIGHEST_HARMONIC * rate]
        ratio = [one / f for one in self.modes_Hz]
        lines += [
            one * f for one in ratio if any(low < one < high for low, high in OTHER_MODE_BANDS)
        ]
        found = tapered(x, rate, f, hop, width, tuple(lines) if width >= FIT_OTHERS_SAMPLES else ())
        log, half, own = found.log, 0.5 * width, np.linalg.norm(found.solver[0])
        return Frames(
            frequency_Hz=f,
            hop=hop,
            centre=found.centre,
            log=log,
            std=max(self.noise_around, self.floor) * own / np.exp(log.real),
            row=found.solver[0] - 1j * found.solver[1],
            whole=self.free(found.centre - half, found.centre + half),
        )

    def free(self, first: Float[ndarray, " k"], last: Float[ndarray, " k"]) -> Bool[ndarray, " k"]:
        """Whether segments of samples are free of long blind spans."""
        clear = np.ones(first.size, bool)
        for start, stop in self.blind:
            if stop - start > LONG_SPAN_CYCLES * self.sampling_Hz / self.expected_Hz:
                clear &= (last <= start) | (first >= stop)
        return clear

    @cached_property
    def floor(self) -> float:
        """Rms of the noise, at least what the digitiser makes."""
        return max(self.noise, self.quantum / np.sqrt(12.0), 1e-9 * np.abs(self.velocity).max())

    @cached_property
    def few(self) -> int:
        """Samples in a mean that is as good as each of them up to the mode's frequency."""
        return max(1, int(self.sampling_Hz / max(MEANS_PER_CYCLE * self.own_Hz, MEANS_HZ)))

    @cached_property
    def halves(self) -> tuple[Float[ndarray, " line"], Complex[ndarray, "2 line"], int]:
        """Frequencies and spectra of both halves of the means over `few` samples; means in each.

        Scaled so that a steady line A cos(w t + p), t from the first mean, shows A exp(i p) in
        both (Blackman-Harris). White noise stays white, with a variance that is `few` times less.
        """
        count = self.velocity.size // (2 * self.few)
        samples = self.velocity[: 2 * count * self.few].reshape(-1, self.few)
        means = samples @ np.full(self.few, 1.0 / self.few)
        taper = blackman_harris(count)
        padded = fft.next_fast_len(count, real=True)
        spectra = 2.0 / taper.sum() * fft.rfft(means.reshape(2, count) * taper, padded, axis=1)
        return fft.rfftfreq(padded, self.few / self.sampling_Hz), spectra, count

    @cached_property
    def noise_around(self) -> float:
        """Rms of the white noise that has the power around the mode, where that is the larger.

        From the median in `NOISE_BANDS` of the later half, where modes have died down most: what
        remains of them cannot raise it.
        """
        frequency, spectra, count = self.halves
        relative = frequency / self.own_Hz
        around = np.any([(relative > low) & (relative < high) for low, high in NOISE_BANDS], axis=0)
        around &= frequency < UNFILTERED_PART * frequency[-1]
        if around.sum() < FEWEST_NOISE_LINES or not self.floor:
            return self.noise
        # of white noise, the median of chi2_2
        white = 4.0 * np.log(2.0) * TAPER_NOISE_BANDWIDTH * self.floor**2 / (count * self.few)
        power = float(np.median(np.abs(spectra[1, around]) ** 2))
        excess = np.log(max(power / white, 1.0))
        sure = max(
            COLOURED_NOISE_ERRORS * MEDIAN_POWER_ERROR / np.sqrt(around.sum() / 2.0), np.log(2.0)
        )
        return float(self.floor * np.exp(0.5 * excess)) if excess > sure else self.noise

    def seconds(self, sample: float | np.number | int) -> float:
        """Time of a sample since the start of the cut."""
        return float(sample / self.sampling_Hz)


def block_scale(
    size: Float[ndarray, " k"], block: int = 256, stride: int = 1
) -> Float[ndarray, " k"]:
    """The largest median of an element's block of about `block` elements and of its neighbours.

    The medians are those of every `stride`-th element.
    """
    count = max(1, size.size // block)
    edges = np.linspace(0, size.size, count + 1).astype(int)
    whole = size[: count * (size.size // count)].reshape(count, -1)
    middle = medians(whole[:, ::stride])
    wide = np.pad(middle, 1, mode="edge")
    middle = np.maximum(np.maximum(wide[:-2], wide[2:]), middle)
    return np.repeat(middle, np.diff(edges))


def joined(spans: Int[ndarray, "run 2"], reach: int) -> Int[ndarray, "span 2"]:
    """Spans less than `reach` apart as one."""
    if len(spans) < 2:
        return spans
    far = spans[1:, 0] - spans[:-1, 1] >= reach
    first = spans[np.concatenate([[True], far]), 0]
    last = spans[np.concatenate([far, [True]]), 1]
    return np.stack([first, last], axis=1)


def frame_weights(frames: Frames, used: slice) -> Float[ndarray, " frame"]:
    """One over the standard error of some frames; zero where they are not whole."""
    return frames.whole[used] / np.maximum(frames.std[used], LEAST_FRAME_STD)


def without_trend(frames: Frames, used: slice, degree: int) -> Complex[ndarray, " frame"] | None:
    """Tapered `log` of some frames less a polynomial; None where too few are whole."""
    log, whole = frames.log[used], frames.whole[used]
    if np.count_nonzero(whole) < FEWEST_WHOLE_FRAMES:
        return None
    trend = np.polynomial.chebyshev.chebvander(np.linspace(-1.0, 1.0, log.size), degree)
    weight = frame_weights(frames, used)
    weighted = trend * weight[:, None]
    fit = np.linalg.solve(weighted.T @ weighted, weighted.T @ (log * weight))
    return (log - trend @ fit) * hann(log.size) * whole
