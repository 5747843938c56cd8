"""From a recording to the judged free decay of one mode."""

from dataclasses import replace

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.decay.component_lines import ABOUT
from bladeroot.decay.components import Separated, onset, separated
from bladeroot.decay.cut import (
    AMBIENT,
    FEWEST_CYCLES,
    LEAST_FALL,
    coarse,
    cut,
    sensor_noise,
    too_fast_or_short,
)
from bladeroot.decay.ending import NOISE, RECORD_END, STEPPED
from bladeroot.decay.overrides import in_band, shortened
from bladeroot.decay.release import AT_ONCE, BEGUN, SHAKER, Release
from bladeroot.quality.findings import clipping
from bladeroot.quality.integrity import bridged, carried, examined, judge, unspiked
from bladeroot.signal.lines import CLOSE_MODE_DISTANCE
from bladeroot.signal.recording import Recording, difference_reach, uncut, velocity
from bladeroot.variables import dataset

# Cycles of the mode by which two looks at its release differ at most: a frame.
SMEARED = 3.0
BLOW_CYCLES = 2.0  # of the mode, that a blow's contact lasts at most
PADDED_CYCLES = 2.0  # of the mode: a record that stands still for longer at last has ended before
PADDED = "nothing but one value from {:.4g} s on: the record is taken to end there"
SEVERAL = "{} decays are in this record, the deepest is taken; from_s and to_s take each by itself"
SHORT = (
    "the mode falls by a factor of {:.3g} only: this is a free decay if nothing drives it, and "
    "the record ends soon"
)
NOT_APART = (
    "the mode expected at {:.5g} Hz is not seen apart from this one: the curve may be that mode's, "
    "or hold its beat"
)


def free_decay(
    recording: Recording,
    expected_Hz: float,
    modes_Hz: tuple[float, ...] = (),
    end: float | str = "noise",
    start_s: float | None = None,
    end_s: float | None = None,
    remarks: tuple[tuple[str, str], ...] = (),
    band_Hz: tuple[float, float] | None = None,
) -> xr.Dataset:
    """The free decay of one mode, cut, without what else rings, with its findings and its mask.

    Arguments as of `decay.cut.cut`, `decay.overrides.shortened` and `quality.integrity.judge`.
    band_Hz: nothing but this band of the record is looked at. Attribute `crowded`: 1 for a record
    of more lines than are followed. ValueError: the band does not suit the record.
    """
    recording, padded = _unpadded(recording, expected_Hz)
    recording, wrong = _unspiked(recording, expected_Hz)
    whole = carried(uncut(recording, expected_Hz), expected_Hz)
    motion = velocity(whole, expected_Hz)
    rate = recording.sampling_Hz
    edge = _edge(recording, expected_Hz)
    clear = bridged(motion, rate, expected_Hz)[: motion.size - edge]
    steps = _steps(recording, expected_Hz)
    noise = _noise(recording, expected_Hz)
    seen = cut(clear, rate, expected_Hz, end, least=steps, noise=noise)
    remarks += tuple(("reader", note) for note in (*whole.notes, *padded))
    remarks += (("spike", wrong),) if wrong else ()
    asked = expected_Hz, modes_Hz, recording
    decay = shortened(seen, clear, start_s, end_s)
    struck = onset(clear, rate / expected_Hz)
    ambient = decay.attrs["excitation"] == AMBIENT and not struck
    if ambient or too_fast_or_short(clear.size, rate, expected_Hz):
        return judge(decay, motion, *asked, remarks=remarks)
    after = struck / rate if struck > seen.attrs["start_s"] * rate else None
    unclipped, told = _clipped(shortened(seen, clear, after, None), clear, expected_Hz, recording)
    skipped = edge if struck or seen.attrs["start_s"] * rate < edge else 0
    let_go = struck or _let_go(clear, rate, expected_Hz, modes_Hz, seen)
    first = max(struck + skipped, let_go, unclipped)
    how = decay.attrs["excitation"] or AT_ONCE
    if struck and how in (BEGUN, AMBIENT):  # beats rise as slowly as they fall, too
        how = AT_ONCE
    before, reach = struck, 0
    if band_Hz is not None:  # the filter smears a blow by its reach
        noise = seen.attrs["noise_velocity"]
        clear, reach = in_band(clear, rate, band_Hz, expected_Hz)
        clear, first, before = clear[:-reach], first + reach, max(struck - reach, 0)
    parts = separated(clear, rate, expected_Hz, modes_Hz, first, quiet=before)
    release = Release((parts.first - skipped) / rate, 0.5 * skipped / rate, how)
    lone = not parts.lines_Hz and parts.velocity is clear and band_Hz is None
    freed = seen
    if struck or unclipped or skipped or not lone:
        freed = cut(parts.velocity, rate, expected_Hz, end, release, steps, noise)
    if freed.attrs["end_reason"] == STEPPED:  # unless what is louder than the steps blurs them
        blurred = _blurred(clear, parts.velocity, freed, steps, expected_Hz)
        further = cut(parts.velocity[:blurred], rate, expected_Hz, end, release, 0.0, noise)
        if blurred < parts.velocity.size and further.attrs["end_reason"] == RECORD_END:
            further.attrs["end_reason"] = STEPPED
        freed = further if further.attrs["verdict"] == "usable" else freed
    if parts.velocity.size < clear.size and freed.attrs["end_reason"] == RECORD_END:
        freed.attrs["end_reason"] = NOISE
    if freed.sizes["time"] < 2 * reach:
        raise ValueError("what is shorter than the filter is the filter's own ringing")
    if start_s is not None:
        start_s = max(start_s, unclipped / rate)
    freed = shortened(freed, parts.velocity, start_s, end_s)
    count = seen.attrs["decays"]
    if count > 1 and "close-mode" in dict(parts.remarks):  # two modes that beat rise again, too
        count = cut(parts.velocity, rate, expected_Hz, end, None, steps, noise).attrs["decays"]
    remarks += told + _remarks(count, freed) + parts.remarks
    remarks += _not_apart(parts.lines_Hz, expected_Hz, modes_Hz)
    judged = judge(freed, motion, *asked, None if lone else parts.velocity, remarks)
    return _with_widening(judged, parts).assign_attrs(crowded=int(parts.crowded))


def _unpadded(recording: Recording, expected_Hz: float) -> tuple[Recording, tuple[str, ...]]:
    """The recording without a last part that stands still, and a note of it.

    It was switched off, or filled up with zeros: its end is no end of the mode.
    """
    x, rate = recording.samples, recording.sampling_Hz
    moving = np.flatnonzero(x != x[-1]) if x.size else np.zeros(0, int)
    count = int(moving[-1]) + 1 if moving.size else x.size
    if x.size - count < PADDED_CYCLES * rate / expected_Hz:
        return recording, ()
    kept = {
        name: one[one < count] for name, one in (("lost", recording.lost), ("over", recording.over))
    }
    note = PADDED.format(recording.start_s + count / rate)
    return replace(recording, samples=x[:count], **kept), (note,)


def _unspiked(recording: Recording, expected_Hz: float) -> tuple[Recording, str]:
    """`quality.integrity.unspiked`, where no blow is taken for wrong samples."""
    made, told = unspiked(recording, expected_Hz)
    if not told:
        return recording, ""
    cycle = recording.sampling_Hz / expected_Hz
    struck = onset(velocity(made, expected_Hz), cycle)
    after = struck + round(BLOW_CYCLES * cycle)
    return unspiked(recording, expected_Hz, after) if struck else (made, told)


def _remarks(count: int, mode: xr.Dataset) -> tuple[tuple[str, str], ...]:
    """Findings that warn where a record holds more than one decay, or but the start of one.

    mode: the cut of the mode by itself.
    """
    fall = mode.attrs["fall"]
    several = (("several-decays", SEVERAL.format(count)),) if count > 1 else ()
    short = mode.attrs["excitation"] == BEGUN and fall < LEAST_FALL
    return (*several, ("short-record", SHORT.format(fall))) if short else several


def _not_apart(
    lines_Hz: list[float], expected_Hz: float, modes_Hz: tuple[float, ...]
) -> tuple[tuple[str, str], ...]:
    """A finding that warns where a close mode of the campaign is not among what was taken off."""
    for one in modes_Hz:
        close = abs(one / expected_Hz - 1.0) < CLOSE_MODE_DISTANCE
        if close and not any(abs(line / one - 1.0) < ABOUT for line in lines_Hz):
            return (("not-apart", NOT_APART.format(one)),)
    return ()


def _let_go(
    velocity: Float[ndarray, " sample"],
    sampling_Hz: float,
    expected_Hz: float,
    modes_Hz: tuple[float, ...],
    decay: xr.Dataset,
) -> int:
    """The sample in which a drive ends, 0 where none is seen.

    A mode that beats with others looks driven, too: what remains without them decides. Their
    lines, followed from before the release on, smear it: where it lies cycles earlier than in the
    record as it is, that is the one.
    """
    if decay.attrs["excitation"] != SHAKER:
        return 0
    freed = separated(velocity, sampling_Hz, expected_Hz, modes_Hz).velocity
    own = decay if freed is velocity else cut(freed, sampling_Hz, expected_Hz)
    # what ends where the drive does is the drive
    driven = own.attrs["excitation"] == SHAKER or own.attrs["end_s"] < decay.attrs["start_s"]
    early = decay.attrs["start_s"] - own.attrs["start_s"] > SMEARED / expected_Hz
    start_s = (decay if early else own).attrs["start_s"]
    return round(start_s * sampling_Hz) if driven else 0


def _blurred(
    velocity: Float[ndarray, " sample"],
    own: Float[ndarray, " kept"],
    decay: xr.Dataset,
    steps: float,
    expected_Hz: float,
) -> int:
    """Samples until what rings beside the mode blurs a digitiser's steps no more.

    own: the mode by itself. decay: its decay down to these steps (m/s).
    """
    rate = decay.attrs["sampling_Hz"]
    last, count = round(decay.attrs["end_s"] * rate) + 1, round(SMEARED * rate / expected_Hz)
    beside = velocity[last : own.size] - own[last:]
    power = np.mean(beside[: beside.size // count * count].reshape(-1, count) ** 2, axis=1)
    clear = np.flatnonzero(power <= steps**2)
    return last + int(clear[0]) * count if clear.size else own.size


def _clipped(
    decay: xr.Dataset,
    velocity: Float[ndarray, " sample"],
    expected_Hz: float,
    recording: Recording,
) -> tuple[int, tuple[tuple[str, str], ...]]:
    """The sample from which a decay is clipped no more, 0 for one that is not; its finding.

    A flat top is no mode's: its harmonics look like other lines, and what is left of it is wrong.
    """
    samples, rate = decay.sizes["time"], float(decay.attrs["sampling_Hz"])
    if decay.attrs["findings"] or too_fast_or_short(samples, rate, expected_Hz):
        return 0, ()
    seen = examined(decay, velocity, expected_Hz, recording=recording)
    found = clipping.find(seen)
    if not found.counts:
        return 0, ()
    return seen.first + found.spans[-1][1], (("clipping", found.text),)


def _edge(recording: Recording, expected_Hz: float) -> int:
    """Samples whose velocity hangs on what is no free decay: the record's ends, a blow before.

    That of a displacement is a slope over so many samples on either side. A record keeps the cycles
    that it needs.
    """
    if recording.quantity != "displacement":
        return 0
    rate, samples = recording.sampling_Hz, recording.samples.size
    spare = int(samples - np.ceil(2 * FEWEST_CYCLES * rate / expected_Hz))
    return min(difference_reach(rate, expected_Hz), max(spare, 0))


def _noise(recording: Recording, expected_Hz: float) -> float | None:
    """Noise (m/s, rms) of a displacement, as the mode sees it: white in the sensor's own samples.

    That of their slope grows with the frequency. None: the motion's own samples tell.
    """
    if recording.quantity != "displacement":
        return None
    return 2.0 * np.pi * expected_Hz * sensor_noise(recording.samples)


def _steps(recording: Recording, expected_Hz: float) -> float:
    """Velocity (m/s) of the mode that is but some steps of the sensor's digitiser high."""
    least = coarse(recording.samples)
    if recording.quantity == "acceleration":
        return least / (2.0 * np.pi * expected_Hz)
    return least * (2.0 * np.pi * expected_Hz if recording.quantity == "displacement" else 1.0)


def _with_widening(decay: xr.Dataset, parts: Separated) -> xr.Dataset:
    """The decay, with what its mode is less sure by for the components taken off."""
    if not np.isfinite(decay.attrs["start_s"]):
        return decay
    time = parts.time - decay.attrs["start_s"]
    made = {"widening": parts.widening, "doubt": parts.doubt, "widening_time": time}
    return decay.assign(dataset("decay/beside", made)).assign_attrs(components_Hz=parts.lines_Hz)
