"""Records: the shaker's tip touches the specimen again during the decay."""

from bladeroot.mechanisms.mechanism import Mechanism, Parameter

MECHANISM = Mechanism(
    id="shaker-recontact",
    kind="record",
    sentence="the shaker's tip touches the specimen again during the decay",
    parameters=(
        Parameter(
            "share", "1", 0.003, 1.0, 0.0, 1.0,
            "false alarms a record, docs/findings.md: none in 1000",
        ),
    ),
    splitter="a record with the shaker further away",
    finding="shaker-recontact",
    spoils=True,
)  # fmt: skip
