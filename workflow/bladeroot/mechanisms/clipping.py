"""Records: the sensor or digitiser cuts off the peaks."""

from bladeroot.mechanisms.mechanism import Mechanism, Parameter

MECHANISM = Mechanism(
    id="clipping",
    kind="record",
    sentence="the sensor or digitiser cuts off the peaks",
    parameters=(
        Parameter(
            "share", "1", 0.003, 1.0, 0.0, 1.0,
            "false alarms a record, docs/findings.md: false alarms 0.3 %",
        ),
    ),
    splitter="a record at a wider range, or a smaller drive",
    finding="clipping",
    spoils=True,
)  # fmt: skip
