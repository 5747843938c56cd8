"""Records: the mains hums in the signal."""

from bladeroot.mechanisms.mechanism import Mechanism, Parameter

MECHANISM = Mechanism(
    id="mains-hum",
    kind="record",
    sentence="the mains hums in the signal",
    parameters=(
        Parameter(
            "share", "1", 0.003, 1.0, 0.0, 1.0,
            "false alarms a record, docs/findings.md: none in 1000",
        ),
    ),
    splitter="a record without excitation; another ground",
    finding="mains-hum",
)  # fmt: skip
