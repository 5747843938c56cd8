"""Single wrong samples: outliers, flipped bytes, up to four samples in a row."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from numpy import ndarray
from numpy.lib.stride_tricks import sliding_window_view

from bladeroot.quality.examined import Examined, Finding, block_scale, joined
from bladeroot.signal.runs import medians, runs

FIRST = True
MIXED = True
STATISTIC = "largest isolated miss of a sample by its 32 neighbours, in local rms of the miss"
THRESHOLD = 8.0
# Which places may hold single wrong samples. More than MOST_IN_CROWD of them, a place itself
# counted, within CROWD_CYCLES cycles to either side are a rough waveform.
MOST_IN_CROWD = 6
CROWD_CYCLES = 10.0
MOST_PLACES = 400  # places that are looked at, the first of the decay
# Up to MOST_IN_A_ROW wrong samples are sought that explain all of the miss around a place, but for
# half the threshold or, where it is more, this part of the largest miss there.
MOST_IN_A_ROW = 4
UNEXPLAINED_PART = 0.02
# As many wrong samples as these are none if a step explains their miss with so many times what is
# left at most.
FEWEST_OF_STEP = 3
AS_WELL = 1.5

# The interpolation of a sample by its neighbours, with one set of weights for the whole decay.
NEIGHBOURS = 16  # samples on either side
FIT_PLACES = 1500  # places, evenly spread, from which the weights are found
DEFECT_OVER_MEDIAN = 5.0  # without those that miss by more than this many times the median miss
SMALLEST_MISS = 1e-5  # part of the largest sample; a smaller miss harms no curve


@dataclass(frozen=True)
class Residual:
    """What a symmetric interpolation from 2 x 16 neighbours misses, and its local rms.

    Steady or slowly changing oscillations of any frequency are interpolated and leave nothing;
    noise and single wrong samples are left over. `response` is what a unit defect leaves.
    """

    miss: Float[ndarray, " sample"]
    scale: Float[ndarray, " sample"]
    response: Float[ndarray, " tap"]


def find(seen: Examined) -> Finding | None:
    """Samples that their neighbours contradict."""
    left = residual(seen)
    ratio = np.abs(left.miss) / left.scale
    reach = left.response.size // 2
    for first, stop in seen.blind:
        ratio[max(first - reach, 0) : stop + reach] = 0.0
    over = joined(runs(ratio > THRESHOLD), 2 * reach)
    cycle = seen.sampling_Hz / seen.own_Hz
    spans, largest = [], 0.0
    for first, last in _lonely(over, CROWD_CYCLES * cycle)[:MOST_PLACES]:
        at = _single(left.miss, left.scale, left.response, int(first), int(last))
        if at:
            largest = max(largest, max(float(ratio[k]) for k in at))
            spans += [(k, k + 1) for k in sorted(at)]
    if not spans:
        # the largest miss is below the threshold, or no single sample
        return Finding(min(float(ratio.max()), THRESHOLD), THRESHOLD, "mask", "")
    where = ", ".join(f"{seen.seconds(first):.6g}" for first, _ in spans[:3])
    count = "1 wrong sample" if len(spans) == 1 else f"{len(spans)} wrong samples"
    text = (
        f"{count} at {where}{' ...' if len(spans) > 3 else ''} s: up to "
        f"{largest:.3g} times the local noise off their neighbours; masked"
    )
    return Finding(largest, THRESHOLD, "mask", text, tuple(spans))


def _lonely(spans: np.ndarray, reach: float) -> np.ndarray:
    """Spans with fewer than `MOST_IN_CROWD` others within a distance."""
    middle = spans.mean(axis=1)
    near = np.searchsorted(middle, middle + reach) - np.searchsorted(middle, middle - reach)
    return spans[near <= MOST_IN_CROWD]


def _single(
    miss: np.ndarray, scale: np.ndarray, response: np.ndarray, first: int, last: int
) -> set[int]:
    """Up to four samples whose errors explain all of the miss around, or none."""
    reach = response.size // 2
    low, high = max(first - reach, 0), min(last + reach, miss.size)
    rest = miss[low:high].copy()
    limit = 0.5 * THRESHOLD * scale[low:high]
    allowed = np.maximum(limit, UNEXPLAINED_PART * np.abs(rest).max())
    found: list[int] = []
    for _ in range(MOST_IN_A_ROW):
        found.append(int(np.argmax(np.abs(rest / scale[low:high]))))
        columns = np.zeros((high - low, len(found)))
        for j, k in enumerate(found):
            a, b = max(k - reach, 0), min(k + reach + 1, high - low)
            columns[a:b, j] = response[a - k + reach : b - k + reach]
        size = np.linalg.lstsq(columns, miss[low:high], rcond=None)[0]
        rest = miss[low:high] - columns @ size
        if (np.abs(rest) <= allowed).all():
            steps = len(found) >= FEWEST_OF_STEP and _steps(miss[low:high], rest, response, found)
            return set() if steps else {low + k for k in found}
    return set()


def _steps(miss: np.ndarray, rest: np.ndarray, response: np.ndarray, found: list[int]) -> bool:
    """Whether a step, from which on the motion goes on smoothly, explains the miss as well.

    Samples that are missing make one: some neighbours of it then look wrong.
    """
    at, reach = np.arange(miss.size), response.size // 2
    for k in range(min(found), max(found) + 2):
        after = np.stack([at >= k, (at >= k) * (at - k) / reach])
        made = [np.convolve(one, response, mode="full")[reach : reach + at.size] for one in after]
        near = np.abs(at - k) < reach
        columns = np.stack(made, axis=1)[near]
        size = np.linalg.lstsq(columns, miss[near], rcond=None)[0]
        if np.linalg.norm(miss[near] - columns @ size) < AS_WELL * np.linalg.norm(rest[near]):
            return True
    return False


def residual(seen: Examined) -> Residual:
    """Each sample less its interpolation from its neighbours, and the local rms of that."""
    x = seen.velocity
    reach = min(NEIGHBOURS, (x.size - 1) // 6)
    view = sliding_window_view(x, 2 * reach + 1)
    rows = view[np.linspace(0, len(view) - 1, FIT_PLACES).astype(int)]
    pairs = rows[:, reach + 1 :] + rows[:, reach - 1 :: -1]
    middle = rows[:, reach]
    keep = np.ones(middle.size, bool)
    for _ in range(2):  # rows with a defect in them must not shape the interpolation
        a = pairs[keep]
        gram = a.T @ a
        gram[np.diag_indices(reach)] += 1e-13 * np.trace(gram) + 1e-300
        weights = np.linalg.solve(gram, a.T @ middle[keep])
        left = np.abs(middle - pairs @ weights)
        keep = left <= DEFECT_OVER_MEDIAN * medians(left) + 1e-300
    response = np.concatenate([-weights[::-1], [1.0], -weights])
    miss = np.zeros(x.size)  # zero at the ends, where there are too few neighbours
    miss[reach : x.size - reach] = np.convolve(x, response, mode="valid")
    least = max(0.5 * seen.quantum, SMALLEST_MISS * float(np.abs(x).max()))
    scale = np.maximum(block_scale(np.abs(miss), stride=3) / 0.6745, least)
    return Residual(miss, scale, response)
