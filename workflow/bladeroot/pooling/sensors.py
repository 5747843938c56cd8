"""What the sensors of one event tell of one motion of one mode together.

All see a mode at one frequency, and lose its amplitude alike. Where one stands near the mode's
node, another mode may be followed there (`unlike_sensors`). A mode close to this one is a mode at
every sensor, though few may see the two apart (`close_elsewhere`). What touches the specimen makes
a step in all of them at one time (`shared_steps`), and ends the decay in all (`passed_ends`).
"""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

# Two sensors differ where their frequency or damping is so many stated errors of both apart, or
# more, for a part of the time. Of 3,981 right curves of drawn events one differs so and has no
# other finding, of 154 wrong ones five (benchmarks/real_like.py, seeds 62800 to 63699).
UNLIKE = ((0.25, 4.0), (0.05, 10.0))  # part of the time, errors
# What another sensor sees so close to this one's frequency, and tells of as a close mode, is in
# this one too, though it is no line here within twice that.
CLOSE = 0.03
# Sensors see one step, or one disturbance, where they see it within so many cycles.
SHARED_CYCLES = 2.0
# A step is shared where each sensor sees this part of what one sensor tells of at least, and all
# together (added in squares) more than that.
LEAST_SHARE = 0.3


def unlike_sensors(
    records: Sequence[xr.Dataset], decays: Sequence[xr.Dataset]
) -> list[tuple[int, int, float]]:
    """Number of each record that differs from another sensor's of its event, that one, and how far.

    records: free decays with event, mode and start_s (s on the event's clock) in the attributes;
    decays: their curves. How far is over what tells. Of several sensors that one is out which
    differs from the most others.
    """
    found = []
    for numbers in _of_one_motion(records, decays):
        curves = [_on_the_clock(records[k], decays[k]) for k in numbers]
        away = np.array([[_apart(one, other) for other in curves] for one in curves])
        differs = (away > 1.0).sum(axis=1)
        for own, k in enumerate(numbers):
            if differs[own] and differs[own] >= differs[away[own] > 1.0].max():
                other = int(away[own].argmax())
                found.append((k, numbers[other], float(away[own, other])))
    return sorted(found)


def close_elsewhere(
    records: Sequence[xr.Dataset], decays: Sequence[xr.Dataset]
) -> list[tuple[int, int, float]]:
    """Number of each record in which a close mode is not seen that another of its event shows.

    Then that one's number, and the close mode's frequency, Hz.

    records: judged free decays with event, mode and components_Hz (of what was taken off) in the
    attributes; decays: their curves.
    """
    found = []
    for numbers in _of_one_motion(records, decays):
        lines = [np.atleast_1d(records[k].attrs.get("components_Hz", [])) for k in numbers]
        telling = [own for own, k in enumerate(numbers) if _tells_of_one(records[k])]
        for own, k in enumerate(numbers):
            at_Hz = float(decays[k]["frequency"].median())
            if (np.abs(lines[own] / at_Hz - 1.0) < 2.0 * CLOSE).any():
                continue
            near = [
                (abs(line / at_Hz - 1.0), numbers[other], float(line))
                for other in telling
                for line in lines[other]
            ]
            if near and min(near)[0] < CLOSE:
                found.append((k, *min(near)[1:]))
    return sorted(found)


def shared_steps(records: Sequence[xr.Dataset]) -> list[tuple[int, float, float, int]]:
    """Number of each usable record of a step that sensors of its event share, and how clear it is.

    Records that tell of it by themselves are left out.

    records: free decays with event, mode, expected_Hz, and step_s (s on the event's clock) and
    step_ratio (of the largest step, over what one sensor tells of) in the attributes. How clear:
    the ratio of all that share it; then the step's time and how many sensors see it.
    """
    seen: dict[tuple[str, str], list[int]] = {}
    for k, record in enumerate(records):
        facts = record.attrs
        known = facts.get("event") and facts.get("step_ratio", 0.0) > LEAST_SHARE
        if known and facts["verdict"] == "usable":
            seen.setdefault((str(facts["event"]), str(facts["mode"])), []).append(k)
    found = []
    for numbers in seen.values():
        ratio, time = (
            np.array([float(records[k].attrs[name]) for k in numbers])
            for name in ("step_ratio", "step_s")
        )
        cycle = 1.0 / float(records[numbers[0]].attrs["expected_Hz"])
        near = np.abs(time[:, None] - time) < SHARED_CYCLES * cycle
        together = np.sqrt((near * ratio**2).sum(axis=1))
        count = near.sum(axis=1)
        found += [
            (k, float(together[own]), float(time[own]), int(count[own]))
            for own, k in enumerate(numbers)
            if count[own] > 1 and together[own] > 1.0 >= ratio[own]
        ]
    return sorted(found)


def passed_ends(
    records: Sequence[xr.Dataset], decays: Sequence[xr.Dataset]
) -> list[tuple[int, float, int]]:
    """Number of each record whose curve goes on where others of its event are disturbed together.

    Then the time (s on the event's clock) and how many sensors are disturbed: two or more.

    records: free decays with event, mode, expected_Hz, start_s, end_s (s on the event's clock) and
    end_reason in the attributes; decays: their curves.
    """
    found = []
    for numbers in _of_one_motion(records, decays):
        facts = [records[k].attrs for k in numbers]
        ends = [float(one["end_s"]) for one in facts if one.get("end_reason") == "disturbed"]
        if len(ends) < 2:
            continue
        near = SHARED_CYCLES / float(facts[0]["expected_Hz"])
        counts = {end: sum(abs(end - one) < near for one in ends) for end in ends}
        shared = [end for end, count in counts.items() if count > 1]
        for k in numbers:
            time = _on_the_clock(records[k], decays[k])[0]
            passed = [end for end in shared if (time < end - near).any() and time[-1] > end + near]
            if passed:
                found.append((k, min(passed), counts[min(passed)]))
    return sorted(found)


def _tells_of_one(record: xr.Dataset) -> bool:
    return "close-mode" in record["finding_id"].values


def _of_one_motion(records: Sequence[xr.Dataset], decays: Sequence[xr.Dataset]) -> list[list[int]]:
    """Numbers of the records with curves of each mode in each event."""
    motions: dict[tuple[str, str], list[int]] = {}
    for k, (record, decay) in enumerate(zip(records, decays, strict=True)):
        event = str(record.attrs.get("event", ""))
        if event and decay.sizes.get("point", 0) > 1 and decay.attrs["verdict"] == "usable":
            motions.setdefault((event, str(record.attrs["mode"])), []).append(k)
    return list(motions.values())


def _on_the_clock(record: xr.Dataset, decay: xr.Dataset) -> Float[ndarray, "5 point"]:
    """Time (s) on the event's clock, frequency, loss factor and their errors, in rising time."""
    names = ("time", "frequency", "loss_factor", "frequency_std", "loss_factor_std")
    rows = np.stack([decay[name].values.astype(float) for name in names])
    rows = rows[:, np.isfinite(rows).all(axis=0)]
    rows[0] += float(record.attrs["start_s"])
    return rows[:, np.argsort(rows[0])]


def _apart(one: Float[ndarray, "5 point"], other: Float[ndarray, "5 other"]) -> float:
    """By how much two differ over what tells; 0 if they share no time.

    It is the same whichever comes first.
    """
    time = np.union1d(one[0], other[0])
    ends = [(rows[0].min(initial=np.inf), rows[0].max(initial=-np.inf)) for rows in (one, other)]
    time = time[(time >= max(ends)[0]) & (time <= min(end for _, end in ends))]
    if time.size < 2:
        return 0.0
    first, second = (
        np.array([np.interp(time, rows[0], row) for row in rows[1:]]) for rows in (one, other)
    )
    off = np.abs(first[:2] - second[:2]) / np.hypot(first[2:], second[2:])
    return max(
        float(np.quantile(off, 1.0 - part, axis=1).max()) / errors for part, errors in UNLIKE
    )
