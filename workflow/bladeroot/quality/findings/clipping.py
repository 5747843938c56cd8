"""Flat tops: the record stops at the largest value that the converter or the sensor can give."""

from dataclasses import replace

import numpy as np

from bladeroot.quality.finding import Finding
from bladeroot.quality.sight import Sight
from bladeroot.signal.recording import SI, Recording
from bladeroot.signal.runs import joined, runs
from bladeroot.signal.spectrum import white_noise

MIXED = True
STATISTIC = "samples piled up at an extreme, over those that an unclipped cosine has there"
THRESHOLD = 3.0
# Where one extreme is clipped, the other is masked from this ratio on.
OTHER = 1.5


# So many cycles before the cut are looked at too: the loudest cycles may end with the release.
LEAD = 30
# A steadily driven wave with overtones piles up at its top too, by up to twice the threshold.
DRIVEN = 3.0


def find(sight: Sight) -> Finding:
    """Flat tops of the decay, or else of the cycles before it, which tell of a range too small."""
    found = _flat(sight)
    lead = min(int(LEAD * sight.sampling_Hz / sight.own_Hz), sight.first)
    first = sight.first - lead
    stop = sight.first + min(lead, sight.velocity.size)
    early, later = (np.abs(x).max(initial=0.0) for x in np.split(sight.whole[first:stop], [lead]))
    if found.counts or lead < 8.0 * sight.sampling_Hz / sight.own_Hz or early < 0.9 * later:
        return found
    before = _flat(replace(sight, velocity=sight.whole[first:stop], first=first, blind=()))
    before = replace(before, statistic=before.statistic / DRIVEN)
    if before.counts:
        text = f"clipped before the release, at {max(early, later):.4g} {sight.unit}"
        return replace(before, consequence="warn", text=text, spans=())
    return found if found.statistic > before.statistic else replace(before, spans=())


def find_in(recording: Recording, sight: Sight) -> Finding:
    """The same in the sensor's own samples; the velocity made from them is wrong up to the last."""
    part = slice(sight.first, sight.first + sight.velocity.size)
    own = {"noise": white_noise(recording.samples), "unit": SI[recording.quantity]}
    found = find(replace(sight, velocity=recording.samples[part], whole=recording.samples, **own))
    if not found.spans:
        return found
    stop = found.spans[-1][1]
    text = found.text.replace("masked", "masked up to there")
    return replace(found, text=text, spans=((0, stop),))


def _flat(sight: Sight) -> Finding:
    """Samples within a step, or three times the noise, of the largest or smallest value.

    An unclipped decay is there on the tops of its first cycles only, for as long as the envelope
    says. The flat tops are masked, their flanks stay.
    """
    ratios = {sign: _piled(sight, sign) for sign in (1.0, -1.0)}
    statistic = max(ratios.values())
    if statistic <= THRESHOLD:
        return Finding(statistic, THRESHOLD, "mask", "")
    x = sight.velocity
    # noise parts a flat top into runs
    near = max(2, int(0.1 * sight.sampling_Hz / sight.own_Hz))
    flat = np.zeros(x.size, bool)
    for sign, ratio in ratios.items():
        if ratio > OTHER:
            level = (sign * x).max() - max(_reaches(sight)) - 5.0 * sight.floor
            flat |= sign * x >= level
    tops = joined(runs(flat), near)
    last = int(tops[-1, 1])
    text = (
        f"clipped: {len(tops)} flat tops at {np.abs(x).max():.4g} {sight.unit}, the last "
        f"{sight.seconds(last):.4g} s into the decay; masked"
    )
    spans = tuple((max(int(a) - 2, 0), min(int(b) + 2, x.size)) for a, b in tops)
    return Finding(statistic, THRESHOLD, "mask", text, spans)


def _reaches(sight: Sight) -> tuple[float, float]:
    return 1.001 * sight.quantum, 3.0 * sight.floor


def _piled(sight: Sight, sign: float) -> float:
    """Samples at one extreme over those expected."""
    x, frames = sight.velocity, sight.frames
    top = float(x.max() if sign > 0.0 else -x.min())
    if top <= 0.0:
        return 0.0
    envelope = frames.amplitude * (top / frames.amplitude.max())
    ratio = 0.0
    for reach in _reaches(sight):
        angle = np.arccos(np.clip((top - reach) / envelope, -1.0, 1.0))
        limit = sign * (top - reach)
        count = np.count_nonzero(x >= limit if sign > 0.0 else x <= limit)
        ratio = max(ratio, float(count / (1.0 + frames.hop / np.pi * angle.sum())))
    return ratio
