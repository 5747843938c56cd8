"""Faults of single records, by what the records' own check finds, against its false alarms."""

from bladeroot.mechanisms.mechanism import Mechanism, Parameter

_FALSE = "false alarms a record, docs/findings.md: "


def _fault(
    finding: str, sentence: str, splitter: str, alarms: str, harmless: str = "", spoils: bool = True
) -> Mechanism:
    """By the id of the finding, which is the mechanism's, or of one that leaves the curve right."""
    share = Parameter("share", "1", 0.003, 1.0, 0.0, 1.0, _FALSE + alarms)
    shown = ";".join(one for one in (finding, harmless) if one)
    return Mechanism(
        finding, "record", sentence, (share,), splitter, finding=shown,
        spoils=finding if spoils else "",
    )  # fmt: skip


MECHANISMS = (
    _fault(
        "clipping", "the sensor or digitiser cuts off the peaks",
        "a record at a wider range, or a smaller drive", "0.3 %",
    ),
    _fault(
        "mains-hum", "the mains hums in the signal", "a record without excitation; another ground",
        "none in 1000", spoils=False,
    ),
    _fault(
        "mode-beating", "a close second mode beats with the measured one",
        "a record from another laser position, at a node of the other mode", "0.1 %",
        harmless="close-mode",
    ),
    _fault(
        "shaker-recontact", "the {tip} touches the specimen again during the decay",
        "a record with the shaker further away", "none in 1000",
    ),
)  # fmt: skip
