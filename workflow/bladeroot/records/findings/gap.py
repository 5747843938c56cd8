"""Missing samples, the gap closed up: the motion goes on with another phase."""

from bladeroot.records.finding import Finding
from bladeroot.records.findings.shaker_recontact import (
    THRESHOLD,
    at_ends,
    gap,
    largest,
    step_finding,
)
from bladeroot.records.sight import Sight

STATISTIC = "largest step of ln A + i phase that is in phase alone, in its usual size"


def find(sight: Sight) -> Finding | None:
    """The largest step, if it is one that missing samples make."""
    at, size, statistic = largest(sight)
    if at is not None and gap(size) and statistic > THRESHOLD:
        return step_finding(sight, at, statistic, THRESHOLD, _told(sight, size))
    beside = at_ends(sight)
    if beside is not None and gap(beside[1]):
        statistic, step, moment, span = beside
        text = f"{_told(sight, step)} at {moment:.4g} s, where the decay was cut"
        return Finding(statistic, THRESHOLD, "mask", text, (span,))
    return Finding(statistic if gap(size) else 0.0, THRESHOLD, "mask", "")


def _told(sight: Sight, size: complex) -> str:
    lost = size.imag / 6.283185307179586 % 1.0 * sight.sampling_Hz / sight.own_Hz
    return f"samples are missing ({lost:.3g}, or whole cycles more): the phase steps"
