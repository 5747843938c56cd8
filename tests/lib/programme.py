"""The list of records that the bench's operator would measure."""

import pandas as pd


def programme(bench: dict) -> pd.DataFrame:
    """Sheet of records of a bench's programme: every force up, then down, every mode in each hold.

    Columns are those of a campaign's records.csv; rows stand in the order of measuring. One hold
    is one clamping of the specimen at one pressure.
    """
    plan = bench["programme"]
    steps = list(enumerate(plan["pressure_bar"]))
    holds = [("up", *step) for step in steps] + [("down", *step) for step in reversed(steps)]
    rows = []
    clock = 0
    for number, (direction, step, pressure) in enumerate(holds, start=1):
        for mode, drives in plan["drive_A"].items():
            for drive in drives[step]:
                record = f"r{len(rows) + 1:03d}"
                rows.append(
                    {
                        "record": record,
                        "file": f"{record}.nc",
                        "mode": mode,
                        "pressure_bar": pressure,
                        "hold": f"h{number:02d}",
                        "direction": direction,
                        "time_s": clock,
                        "drive_A": drive,
                    }
                )
                clock += plan["record_interval_s"]
        clock += plan["hold_interval_s"]
    return pd.DataFrame(rows)
