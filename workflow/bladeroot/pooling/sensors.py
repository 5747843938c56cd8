"""What the sensors of one event tell of one motion of one mode together.

All see a mode at one frequency, and lose its amplitude alike. Where one stands near the mode's
node, another mode may be followed there (`unlike_sensors`). What touches the specimen makes a step
in all of them at one time (`shared_steps`), and ends the decay in all (`passed_ends`).
"""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

# Two sensors differ where their frequency or damping is this many stated errors of both apart, or
# more, for this part of the time. Right curves of drawn events stay below 3.5
# (benchmarks/real_like.py).
UNLIKE_ERRORS = 4.0
UNLIKE_TIME_PART = 0.25
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
    decays: their curves. How far is in stated errors. Of several sensors that one is out which
    differs from the most others.
    """
    found = []
    for numbers in _of_one_motion(records, decays):
        curves = [_on_the_clock(records[k], decays[k]) for k in numbers]
        away = np.array([[_apart(one, other) for other in curves] for one in curves])
        differs = (away > UNLIKE_ERRORS).sum(axis=1)
        for own, k in enumerate(numbers):
            if differs[own] and differs[own] >= differs[away[own] > UNLIKE_ERRORS].max():
                other = int(away[own].argmax())
                found.append((k, numbers[other], float(away[own, other])))
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
    """Stated errors that two differ by for a part of the time that both see; 0 if they share none.

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
    return float(np.quantile(off, 1.0 - UNLIKE_TIME_PART, axis=1).max())
