"""Records that a person must look at, and why: in the report, and where a run ends."""

import numpy as np
import xarray as xr

_PREFIX = "rejected: "
MOST_LINES = 10  # of a kind where a run ends
WHERE_MORE = (
    "    more on them: in the report's chapters Measurement and Quality; "
    "what a finding means: docs/findings.md"
)


def rejected(stick: xr.Dataset) -> list[tuple[str, str]]:
    """Name of each rejected record (dim record as from `bladeroot.pooling.stick`) and why."""
    return [
        (str(name), str(verdict).removeprefix(_PREFIX))
        for name, verdict in zip(stick["record"].values, stick["verdict"].values, strict=True)
        if str(verdict).startswith(_PREFIX)
    ]


def unlike_repeats(judged: xr.Dataset) -> list[tuple[str, str]]:
    """Name of each record that is unlike its repeats (`bladeroot.pooling.judgement`), and how."""
    rows = np.flatnonzero(judged["finding_id"].values == "unlike-repeats")
    return [
        (str(judged["finding_record"].values[k]), str(judged["finding_text"].values[k]))
        for k in rows
    ]


def bad_lines(stick: xr.Dataset, judged: xr.Dataset) -> list[str]:
    """A line for each of a campaign's first bad records, how many more, and where to read more."""
    campaign, lines = stick.attrs["campaign"], []
    for word, bad in (("rejected", rejected(stick)), ("look at", unlike_repeats(judged))):
        lines += [f"{word}: {name} of {campaign}: {why}" for name, why in bad[:MOST_LINES]]
        if len(bad) > MOST_LINES:
            lines.append(f"{word}: {len(bad) - MOST_LINES} more of {campaign}")
    return [*lines, WHERE_MORE] if lines else []
