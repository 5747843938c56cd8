"""Missing samples, the gap closed up: the motion goes on with another phase."""

from bladeroot.records.finding import Finding
from bladeroot.records.findings.shaker_recontact import THRESHOLD, gap, largest, step_finding
from bladeroot.records.sight import Sight

STATISTIC = "largest step of ln A + i phase that is in phase alone, in its usual size"


def find(sight: Sight) -> Finding | None:
    """The largest step, if it is one that missing samples make."""
    at, size, statistic = largest(sight)
    if at is None or not gap(size):
        return Finding(0.0, THRESHOLD, "mask", "")
    lost = size.imag / 6.283185307179586 % 1.0 * sight.sampling_Hz / sight.own_Hz
    what = f"samples are missing ({lost:.3g}, or whole cycles more): the phase steps"
    return step_finding(sight, at, statistic, THRESHOLD, what)
