"""Records that were rejected, and why: in the report, and where a run ends."""

import xarray as xr

_PREFIX = "rejected: "
SHOWN = 10  # lines of a campaign where a run ends
MORE = "    all of them: the report, What was measured; what the reasons mean: docs/findings.md"


def rejected(stick: xr.Dataset) -> list[tuple[str, str]]:
    """Name of each rejected record (dim record as from `bladeroot.decay.stick`) and why."""
    return [
        (str(name), str(verdict).removeprefix(_PREFIX))
        for name, verdict in zip(stick["record"].values, stick["verdict"].values, strict=True)
        if str(verdict).startswith(_PREFIX)
    ]


def rejected_lines(stick: xr.Dataset) -> list[str]:
    """A line for each of the first rejected records of a campaign, and where to read more."""
    bad = rejected(stick)
    campaign = stick.attrs["campaign"]
    lines = [f"rejected: {name} of {campaign}: {why}" for name, why in bad[:SHOWN]]
    if len(bad) > SHOWN:
        lines.append(f"rejected: {len(bad) - SHOWN} more of {campaign}")
    return [*lines, MORE] if bad else []
