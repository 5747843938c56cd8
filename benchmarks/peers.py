"""The peers, each at its best: what other packages make of the same records.

A peer returns, for each of several settings, either a curve (time, displacement amplitude, f_n,
loss factor) with the number of points at either end that its smoothing spoils, or one number each
for frequency and loss factor. `decays.py` keeps the setting that does best at a noise level, with
the truth known, so no peer is behind for a badly chosen width. All get the record cut where the
mode has fallen to 1 % of its start, and "tail" is what is left of that below 10 % of the start:
both are more than a user has. Most onsets lie above the tail, so it is nearly linear and a linear
fit to it is a strong rival for the stick frequency.

- plain scipy: trapezoidal integration, zero-phase band-pass, `scipy.signal.hilbert`, means over
  cycles, Savitzky-Golay derivatives, (3.11);
- PySDKit: its Hilbert vibration decomposition of the integrated, band-passed record, then the same;
- MorletWaveModal: on segments that slide down the decay, which gives a curve, and as documented;
- sdypy-EMA: LSCF on the spectrum of the decay; one frequency and one damping;
- a nonlinear least-squares fit of one decaying cosine; the same.

Curves give their stick frequency as the median over amplitudes from 0.02 to 0.1. Smoothing spoils
the ends of a Hilbert curve, so each also counts with them cut; what is cut off is then missing.
"""

import contextlib
import importlib
import io
import warnings
from collections.abc import Callable, Iterator

import numpy as np
from scipy import integrate, optimize, signal
from synthetic import EXPECTED_HZ, SAMPLING_HZ, Case

END, TAIL = 0.01, 0.1
CYCLE = round(SAMPLING_HZ / EXPECTED_HZ)  # samples

Curve = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]
Single = tuple[float, float]


def require() -> None:
    """Stop where a peer is not installed; below, an error of a peer is a missing result."""
    for module in ("sdypy.EMA", "mwmodal", "pysdkit"):
        try:
            importlib.import_module(module)
        except ImportError as error:
            raise SystemExit(
                f"expected the peers beside bladeroot, got {error} "
                "(pip install -r benchmarks/environment.txt, or --peer-cases 0)"
            ) from None


def piece(case: Case, first: float, last: float = END) -> np.ndarray:
    """The record between two relative amplitudes of the mode, of a length quick to transform."""
    start, stop = (case.motion.time_of(np.array([first, last])) * SAMPLING_HZ).astype(int)
    stop = min(stop, case.velocity.size)
    return case.velocity[start : stop - (stop - start) % 1024]


def peak_Hz(velocity: np.ndarray) -> float:
    """The highest line within 30 % of the expected frequency."""
    padded = 8 * velocity.size
    level = np.abs(np.fft.rfft(velocity, padded))
    grid = np.fft.rfftfreq(padded, 1.0 / SAMPLING_HZ)
    return float(grid[np.argmax(np.where(np.abs(grid / EXPECTED_HZ - 1.0) < 0.3, level, 0.0))])


def displacement(velocity: np.ndarray, half: float) -> np.ndarray:
    """Trapezoidal integral, band-passed (zero phase) within a relative half-width."""
    band = EXPECTED_HZ * np.array([1.0 - half, 1.0 + half])
    sections = signal.butter(3, band, "bandpass", fs=SAMPLING_HZ, output="sos")
    place = integrate.cumulative_trapezoid(velocity, dx=1.0 / SAMPLING_HZ, initial=0.0)
    return signal.sosfiltfilt(sections, place - place.mean())


def differentiate(place: np.ndarray, window: int) -> Curve:
    """(3.11) on scipy's analytic signal: cycle means, Savitzky-Golay over `window` cycles."""
    analytic = signal.hilbert(place)
    count = place.size // CYCLE
    log = np.log(np.abs(analytic) + 1e-300) + 1j * np.unwrap(np.angle(analytic))
    log = log[: count * CYCLE].reshape(count, CYCLE).mean(axis=1)
    step = CYCLE / SAMPLING_HZ
    window = min(window, (count - 1) // 2 * 2 - 1)
    value, rate, change = (
        signal.savgol_filter(log.real, window, 3, deriv=d, delta=step)
        + 1j * signal.savgol_filter(log.imag, window, 3, deriv=d, delta=step)
        for d in range(3)
    )
    square = rate.imag**2 - change.real - rate.real**2
    with np.errstate(invalid="ignore"):
        frequency = np.sqrt(square) / (2.0 * np.pi)
    loss = -(2.0 * rate.imag * rate.real + change.imag) / square
    time = (np.arange(count) + 0.5) * step - 0.5 / SAMPLING_HZ
    return time, np.exp(value.real), frequency, loss


def scipy_hilbert(case: Case) -> Iterator[tuple[str, Curve, int]]:
    """Plain Hilbert differentiation: integrate, band-pass, analytic signal, smooth, (3.11)."""
    velocity = piece(case, 1.0)
    for half in (0.1, 0.3):
        place = displacement(velocity, half)
        for window in (21, 61, 121, 241):
            yield f"band +-{half:.0%}, {window} cycles", differentiate(place, window), window // 2


def pysdkit_hvd(case: Case) -> Iterator[tuple[str, Curve, int]]:
    """PySDKit's Hilbert vibration decomposition of the integrated record, then as plain Hilbert.

    Its first two components, of which the one nearest the expected frequency is kept; its
    low-pass is set in Hz through the number of FFT bins of the mirrored record.
    """
    from pysdkit import HVD

    place = displacement(piece(case, 1.0), 0.3)
    for half_Hz in (10.0, 40.0):
        bins = round(half_Hz * 2.0 * place.size / SAMPLING_HZ)
        parts, carriers = HVD(K=2, fpar=bins).fit_transform(place, return_all=True)
        own = parts[np.argmin(np.abs(carriers * SAMPLING_HZ - EXPECTED_HZ))]
        for window in (61, 121, 241):
            yield (
                f"low-pass {half_Hz:g} Hz, {window} cycles",
                differentiate(own, window),
                window // 2,
            )


def morlet_sliding(case: Case, segments: int = 12) -> Iterator[tuple[str, Curve, int]]:
    """MorletWaveModal on short segments that slide down the decay: local frequency and damping."""
    for cycles in (60, 100, 200):
        length = cycles * CYCLE
        last = float(case.motion.time_of(np.array(0.015))) - length / SAMPLING_HZ
        lowest = float(np.exp(case.motion.at(np.array(max(last, 0.0)))[0]))
        found = []
        for start in case.motion.time_of(np.geomspace(1.0, lowest, segments)):
            first = int(start * SAMPLING_HZ)
            part = case.velocity[first : first + length]
            with contextlib.suppress(Exception):  # it raises where its own limits are not met
                omega, zeta, speed, _ = morlet(part, int(0.8 * cycles), 3, 0.0015)
                middle = 0.45 * length / SAMPLING_HZ
                size = speed * np.exp(-zeta * omega * middle) / omega
                found.append((start + middle, size, omega / (2.0 * np.pi), 2.0 * zeta))
        if len(found) > 1:
            yield f"{cycles} cycles", tuple(np.array(found).T), 0


def morlet(velocity: np.ndarray, lowest: int, count: int, zeta: float) -> tuple[float, ...]:
    """Circular frequency, damping ratio, amplitude and phase by MorletWaveModal.

    It searches a narrow range around what it is told, so it is told the spectrum's peak.
    """
    from mwmodal import MorletWaveModal

    with contextlib.redirect_stdout(io.StringIO()), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        tool = MorletWaveModal(velocity, SAMPLING_HZ, k_lo=lowest, num_k=count)
        return tool.identify_modal_parameters(2.0 * np.pi * peak_Hz(velocity), zeta)


def ends(case: Case) -> Iterator[tuple[str, np.ndarray]]:
    """The whole record and its tail, for tools that give one number."""
    yield "whole", piece(case, 1.0)
    yield "tail", piece(case, TAIL)


def morlet_single(velocity: np.ndarray) -> Iterator[tuple[str, Single]]:
    """MorletWaveModal as its documentation shows it."""
    for guess in (0.0015, 0.005):  # sets how many cycles it uses
        with contextlib.suppress(Exception):
            omega, zeta, *_ = morlet(velocity, 10, 10, guess)
            yield f"damping ratio {guess:g} first", (omega / (2.0 * np.pi), 2.0 * zeta)


def ema_lscf(velocity: np.ndarray) -> Iterator[tuple[str, Single]]:
    """sdypy-EMA's LSCF on the spectrum of the decay (a mobility after an impulse)."""
    from sdypy import EMA

    spectrum = np.fft.rfft(velocity) / SAMPLING_HZ
    frequency = np.fft.rfftfreq(velocity.size, 1.0 / SAMPLING_HZ)
    for upper in (500.0, 2000.0):
        with (
            contextlib.suppress(Exception),
            contextlib.redirect_stderr(io.StringIO()),
            warnings.catch_warnings(),
        ):
            warnings.simplefilter("ignore")
            tool = EMA.Model(
                spectrum, frequency, lower=0.4 * EXPECTED_HZ, upper=upper, pol_order_high=20,
                frf_form="mobility",
            )  # fmt: skip
            tool.get_poles(method="lscf", show_progress=False)
            tool.select_closest_poles([peak_Hz(velocity)])
            found = float(tool.nat_freq[0]), 2.0 * float(tool.nat_xi[0])
            if abs(found[0] / EXPECTED_HZ - 1.0) < 0.3:
                yield f"to {upper:g} Hz", found


def ring_down_fit(velocity: np.ndarray) -> Iterator[tuple[str, Single]]:
    """Nonlinear least squares of one exponentially decaying cosine."""
    time = np.arange(velocity.size) / SAMPLING_HZ

    def wave(rates: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        carrier = np.exp((-rates[0] + 1j * rates[1]) * time)
        design = np.stack([carrier.real, carrier.imag], axis=1)
        return design, np.linalg.solve(design.T @ design, design.T @ velocity)

    def left(rates: np.ndarray) -> np.ndarray:
        design, weight = wave(rates)
        return (velocity - design @ weight) / np.linalg.norm(velocity)

    first = [2.0, 2.0 * np.pi * peak_Hz(velocity)]
    fit = optimize.least_squares(left, first, method="lm", x_scale=[0.1, 0.1], xtol=1e-11)
    decay, omega = fit.x
    yield "", (float(np.hypot(decay, omega)) / (2.0 * np.pi), 2.0 * decay / omega)


CURVES: dict[str, Callable[[Case], Iterator[tuple[str, Curve, int]]]] = {
    "scipy Hilbert": scipy_hilbert,
    "PySDKit HVD": pysdkit_hvd,
    "MorletWaveModal, sliding": morlet_sliding,
}
SINGLES: dict[str, Callable[[np.ndarray], Iterator[tuple[str, Single]]]] = {
    "sdypy-EMA LSCF": ema_lscf,
    "MorletWaveModal": morlet_single,
    "ring-down fit (NLS)": ring_down_fit,
}
