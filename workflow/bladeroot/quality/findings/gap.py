"""Missing or repeated samples, the gap closed up: the motion goes on with another phase."""

from bladeroot.quality.finding import Finding
from bladeroot.quality.findings.shaker_recontact import (
    THRESHOLD,
    at_ends,
    largest,
    step_finding,
)
from bladeroot.quality.sight import Sight

STATISTIC = "largest step of ln A + i phase that is in phase alone, in its usual size"


def find(sight: Sight) -> Finding | None:
    """The largest step, if it is one that missing samples make."""
    step = largest(sight)
    if step is not None and step.gap and step.statistic > THRESHOLD:
        return step_finding(sight, step, _told(sight, step.size))
    beside = at_ends(sight)
    if beside is not None and beside[0].gap:
        step, moment, span = beside
        text = f"{_told(sight, step.size)} at {moment:.4g} s, where the decay was cut"
        return Finding(step.statistic, THRESHOLD, "mask", text, (span,))
    return Finding(step.statistic if step is not None and step.gap else 0.0, THRESHOLD, "mask", "")


def _told(sight: Sight, size: complex) -> str:
    cycle = sight.sampling_Hz / sight.own_Hz
    lost = size.imag / 6.283185307179586 % 1.0 * cycle
    return (
        f"samples are missing ({lost:.3g}) or repeated ({cycle - lost:.3g}), or whole cycles more: "
        "the phase steps"
    )
