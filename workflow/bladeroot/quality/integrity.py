"""Judge a cut decay: every finding with its statistic, and the samples that may be used."""

import importlib
import pkgutil
from dataclasses import replace
from functools import cache
from types import ModuleType

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.quality import findings
from bladeroot.quality.examined import LEFTOVER, Examined, Finding
from bladeroot.quality.findings import spike
from bladeroot.signal.lines import HIGHEST_OF_SAMPLING
from bladeroot.signal.recording import SHORT_GAP, Recording, filled
from bladeroot.variables import dataset

FEWEST_CYCLES = 5  # of a decay that masks must leave for a curve
FEWEST_BRIDGED_CYCLES = 40  # of a record: in a shorter one nothing is bridged

# What other modes leave in the course of this one looks like these findings, which therefore only
# warn where other modes were taken off.
LIKE_LEFTOVERS = ("gap", "shaker-recontact", "driven-residue", "mode-beating")
REMOVING = ("mask", "drop")  # consequences that become a warning then
# Above this many times its threshold such a finding keeps its name, otherwise it is a leftover.
# Leftovers of 114 real curves of three structures without a shaker reach 1.8 to 4.0 times the
# threshold; touches of 10 % of the velocity beside other modes, 3.2 to 3.6 times, are not told from
# them, those of 22 % reach 6.9 times.
SURE_OVER_THRESHOLD = 4.0

STILL_TEXT = "nothing but one value from {:.4g} s to {:.4g} s"
CUT_ENDS = ("start_s", "end_s")  # attributes of a cut decay that the text is filled with


@cache
def checks() -> dict[str, ModuleType]:
    """Module of every finding by its id, those that look at single samples first."""
    known = {}
    for found in pkgutil.iter_modules(findings.__path__):
        module = importlib.import_module(f"{findings.__name__}.{found.name}")
        known[found.name.replace("_", "-")] = module
    return dict(sorted(known.items(), key=lambda entry: not hasattr(entry[1], "FIRST")))


def judge(
    decay: xr.Dataset,
    whole: Float[ndarray, " whole"],
    expected_Hz: float,
    modes_Hz: tuple[float, ...] = (),
    recording: Recording | None = None,
    freed: Float[ndarray, " kept"] | None = None,
    remarks: tuple[tuple[str, str], ...] = (),
) -> xr.Dataset:
    """A cut decay with its findings and its mask.

    Added to what `decay.cut.cut` returns: `usable` (time), 0 where a finding masks the sample;
    `finding_*` (finding); attributes `verdict`, `findings`, `reason`, those that drop, and of the
    largest step its time in the raw record (`step_s`) and how large it is over what is told
    (`step_ratio`). Steady hum is taken off `velocity`; `noise_velocity` is what noise amounts to
    around the mode. A record is rejected where a finding drops it or masks leave fewer than five
    cycles.

    Args:
        decay: the cut decay; one that was rejected stays so, with finding `cut`.
        whole: the raw record in m/s.
        expected_Hz: the mode's expected frequency.
        modes_Hz: expected frequencies of the structure's other modes, to check the clock.
        recording: the sensor's own samples, from which `whole` was made.
        freed: `whole` with the mode by itself (`decay.components`), if others were taken off; it
            may end earlier, where the mode has drowned.
        remarks: findings that were made before, by id, which warn: the reader's, the separation's.
    """
    found, told = [(name, _fact(text, "warn")) for name, text in remarks], dict(remarks)
    velocity = decay["velocity"].values
    usable = np.ones(velocity.size, np.int8)
    if not decay.attrs["findings"] and _still(examined(decay, whole, expected_Hz).velocity):
        decay = decay.assign_attrs(findings=STILL_TEXT.format(*map(decay.attrs.get, CUT_ENDS)))
    if decay.attrs["findings"]:
        kind = "cut" if whole.size else "unreadable"
        found.append((kind, _fact(decay.attrs["findings"], "drop")))
        if not _still(whole) and np.isfinite(decay.attrs["sampling_Hz"]):
            rate = decay.attrs["sampling_Hz"]
            seen = Examined(velocity, rate, expected_Hz, 0.0, whole, recording=recording)
            for name, module in checks().items():
                text = module.without_decay(seen) if hasattr(module, "without_decay") else ""
                found += [(name, _fact(text, "warn"))] if text else []
    else:
        seen = examined(decay, whole, expected_Hz, modes_Hz, recording)
        own = seen if freed is None else examined(decay, freed, expected_Hz, modes_Hz, recording)
        candidates = examine(seen, own)
        decay = decay.assign_attrs(noise_velocity=own.noise_around, **_step(own, candidates))
        for name, finding in candidates:
            if not finding.counts or name in told:
                continue
            if freed is not None and name in LIKE_LEFTOVERS and finding.consequence in REMOVING:
                # what other modes leave looks alike, and is in the curve's errors
                what = finding.text.partition(";")[0]
                text = f"{what}; or what other modes leave: nothing masked"
                # a close mode that is struck or let go with this one makes a step in its course
                stepped = name != "mode-beating" and any(one == "close-mode" for one, _ in remarks)
                if stepped or finding.statistic <= SURE_OVER_THRESHOLD * finding.threshold:
                    name = LEFTOVER
                finding = replace(finding, consequence="warn", text=text)
            found.append((name, finding))
            if finding.consequence == "mask":
                for first, last in finding.spans:
                    usable[first:last] = 0
            if finding.excess is not None:
                velocity = velocity - finding.excess
        cycles = usable.sum() / seen.sampling_Hz * seen.own_Hz
        if cycles < FEWEST_CYCLES:
            text = f"what is masked leaves {cycles:.3g} cycles, at least {FEWEST_CYCLES} are needed"
            found.append(("masked", _fact(text, "drop")))
    return _dataset(decay, velocity, usable, found)


def _step(seen: Examined, candidates: list[tuple[str, Finding]]) -> dict[str, float]:
    """When the decay makes its largest step, and that over what would be told; nothing for none."""
    return {
        name: value
        for _, one in candidates
        if np.isfinite(one.at)
        for name, value in (
            ("step_s", (seen.first + one.at) / seen.sampling_Hz),
            ("step_ratio", one.statistic / one.threshold),
        )
    }


def bridged(
    velocity: Float[ndarray, " sample"], sampling_Hz: float, expected_Hz: float
) -> Float[ndarray, " sample"]:
    """A raw record with single wrong samples and dropouts bridged, so that it can be cut.

    Short spans are bridged by straight lines, longer ones by the mode's own course; padding at
    either end is left.
    """
    if _too_short(velocity.size, sampling_Hz, expected_Hz):
        return velocity
    seen = Examined(velocity, sampling_Hz, expected_Hz, 0.0, velocity)
    found = [module.find(seen) for module in checks().values() if hasattr(module, "FIRST")]
    spans = tuple(
        (first, stop)
        for f in found
        if f is not None and f.counts
        for first, stop in f.spans
        if first > 0 and stop < velocity.size
    )
    return mended(seen, spans).velocity if spans else velocity


def unspiked(recording: Recording, expected_Hz: float, first: int = 0) -> tuple[Recording, str]:
    """A displacement or an acceleration whose single wrong samples count as lost; what is told.

    A velocity is made of many of these samples: in it a wrong one is no longer single. first: the
    sample from which on they are looked for.
    """
    x, rate = recording.samples, recording.sampling_Hz
    if recording.quantity == "velocity" or _too_short(x.size, rate, expected_Hz):
        return recording, ""
    seen = Examined(x - x.mean(), rate, expected_Hz, 0.0, x, recording=recording)
    found = spike.find(replace(seen, blind=((0, first), *seen.lost)))
    if not found.counts:
        return recording, ""
    wrong = np.concatenate([np.arange(*span) for span in found.spans])
    lost = np.union1d(recording.lost, wrong)
    made = replace(recording, samples=filled(x, lost), lost=lost)
    return made, f"{found.text.partition(';')[0]}; taken for lost"


def carried(recording: Recording, expected_Hz: float) -> Recording:
    """A recording with the mode's own course through its long gaps, to make a velocity of."""
    x, rate = recording.samples, recording.sampling_Hz
    if not recording.lost.size or _too_short(x.size, rate, expected_Hz):
        return recording
    mean = x.mean()
    seen = Examined(x - mean, rate, expected_Hz, 0.0, x, recording=recording)
    spans = tuple((first, stop) for first, stop in seen.lost if first and stop - first > SHORT_GAP)
    return replace(recording, samples=mended(seen, spans).velocity + mean)


def _too_short(count: int, sampling_Hz: float, expected_Hz: float) -> bool:
    """Whether a record is sampled too slowly, or too short, for anything to be bridged."""
    return (
        expected_Hz >= HIGHEST_OF_SAMPLING * sampling_Hz
        or count * expected_Hz < FEWEST_BRIDGED_CYCLES * sampling_Hz
    )


def examined(
    decay: xr.Dataset,
    whole: Float[ndarray, " whole"],
    expected_Hz: float,
    modes_Hz: tuple[float, ...] = (),
    recording: Recording | None = None,
) -> Examined:
    """What the checks look at: the samples of the cut as they were recorded."""
    rate = float(decay.attrs["sampling_Hz"])
    first = round(decay.attrs["start_s"] * rate)
    return Examined(
        velocity=whole[first : first + decay.sizes["time"]],
        sampling_Hz=rate,
        expected_Hz=float(expected_Hz),
        noise=float(decay.attrs["noise_velocity"]),
        whole=whole,
        first=first,
        modes_Hz=tuple(modes_Hz),
        recording=recording,
    )


def examine(seen: Examined, freed: Examined | None = None) -> list[tuple[str, Finding]]:
    """Every check's candidate, whether it counts or not.

    freed: the same decay without what else rings; then only the checks that say so (`MIXED`) look
    at the decay as it was recorded.
    """
    found = []
    seen, freed = (one and mended(one, one.lost) for one in (seen, freed))
    freed = seen if freed is None else replace(freed, mixed=seen)
    first = [name for name, module in checks().items() if hasattr(module, "FIRST")]
    for name, module in checks().items():
        if name not in first and first:
            spans = tuple(s for _, f in found if f.counts for s in f.spans)
            freed, first = mended(freed, spans), []
            seen = freed if freed.mixed is None else mended(seen, spans)
            if _still(seen.velocity) or _still(freed.velocity):
                break
        finding = module.find(seen if hasattr(module, "MIXED") else freed)
        if finding is not None:
            found.append((finding.name or name, finding))
            if finding.counts and finding.excess is not None:  # later checks see it taken off
                freed = replace(freed, velocity=freed.velocity - finding.excess)
    return found


def _still(velocity: Float[ndarray, " sample"]) -> bool:
    """Whether all samples have one value."""
    return bool((velocity == velocity[:1]).all())


def mended(seen: Examined, spans: tuple[tuple[int, int], ...]) -> Examined:
    """The record with spans bridged: by straight lines, or by the mode over long ones."""
    if not spans:
        return seen
    keep = np.ones(seen.velocity.size, bool)
    for first, last in spans:
        keep[first:last] = False
    if not keep.any():
        return seen
    at = np.flatnonzero(keep)
    velocity = seen.velocity.copy()
    velocity[~keep] = np.interp(np.flatnonzero(~keep), at, velocity[at])
    made = replace(seen, velocity=velocity, blind=spans)
    frames = made.frames
    whole = frames.whole
    if whole.all() or not whole.any():
        return made
    velocity = velocity.copy()
    # unwrapped without the frames of a gap, in which the phase may slip by whole turns
    course = np.unwrap(frames.log.imag[whole])
    for first, last in spans:
        if last - first > 0.1 * seen.sampling_Hz / seen.own_Hz:
            inside = np.arange(first, last)
            log = np.interp(inside, frames.centre[whole], frames.log.real[whole])
            phase = np.interp(inside, frames.centre[whole], course)
            turn = np.mod(frames.frequency_Hz / seen.sampling_Hz * inside, 1.0) * 2.0 * np.pi
            velocity[inside] = np.exp(log) * np.cos(turn + phase)
    return replace(seen, velocity=velocity, blind=spans)


def _fact(text: str, consequence: str) -> Finding:
    """A finding that needs no statistic."""
    return Finding(1.0, 0.0, consequence, text)


def _dataset(
    decay: xr.Dataset, velocity: ndarray, usable: ndarray, found: list[tuple[str, Finding]]
) -> xr.Dataset:
    kinds = {"consequence": str, "text": str, "statistic": float, "threshold": float}
    columns = {
        name: np.array([getattr(f, name) for _, f in found], kind) for name, kind in kinds.items()
    }
    columns["id"] = np.array([name for name, _ in found], str)
    # first and last sample concerned; NaN where no span is named
    ends = [(np.min(f.spans), np.max(f.spans) - 1) if f.spans else (np.nan,) * 2 for _, f in found]
    ends = np.array(ends, float).reshape(-1, 2) / decay.attrs["sampling_Hz"]
    columns["from_s"], columns["to_s"] = ends.T
    made = {f"finding_{name}": values for name, values in columns.items()}
    judged = decay.assign(dataset("quality/findings", made | {"usable": usable}))
    judged["velocity"] = ("time", velocity, decay["velocity"].attrs)
    judged.attrs["findings"] = "; ".join(f.text for _, f in found)
    judged.attrs["reason"] = "; ".join(f.text for _, f in found if f.consequence == "drop")
    judged.attrs["verdict"] = "rejected" if judged.attrs["reason"] else "usable"
    return judged
