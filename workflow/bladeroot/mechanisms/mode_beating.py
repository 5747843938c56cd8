"""Records: a close second mode beats with the measured one."""

from bladeroot.mechanisms.mechanism import Mechanism, Parameter

MECHANISM = Mechanism(
    id="mode-beating",
    kind="record",
    sentence="a close second mode beats with the measured one",
    parameters=(
        Parameter(
            "share", "1", 0.003, 1.0, 0.0, 1.0,
            "false alarms a record, docs/findings.md: 0.1 %",
        ),
    ),
    splitter="a record from another laser position, at a node of the other mode",
    finding="mode-beating",
    spoils=True,
)  # fmt: skip
