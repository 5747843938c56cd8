"""TDMS, as NI's systems write it: waveform properties, units, NI's scalings, several groups."""

import logging
import struct
from pathlib import Path

from bladeroot.io.channel import Channel, Entry, check_claim, pick, time_factor
from bladeroot.io.statements import one_time, statements

SUFFIXES = (".tdms",)
# bit of a segment's table of contents; its byte is the lowest in either order
_BIG_ENDIAN = 1 << 6


def read(path: str, channel: str | None = None, quantity: str | None = None) -> Channel:
    """Read one channel, named `group/channel`, by its last part, or by its number.

    Time is `wf_increment` (and `wf_start_offset`), or a channel called time in the same group;
    where there are both, they must agree.
    """
    import nptdms
    from nptdms.log import log_manager

    log_manager.set_level(logging.CRITICAL)  # what matters is checked below, in one line

    _check_whole(path)
    # an open file, not a name: an index file beside it may be an older one's
    with open(path, "rb") as raw, nptdms.TdmsFile.open(raw) as file:
        channels = [one for group in file.groups() for one in group.channels() if _numbers(one)]
        entries = [
            Entry(
                k + 1,
                f"{one.group_name}/{one.name}",
                _unit(one),
                timelike=time_factor(one.name, _unit(one), path) is not None,
            )
            for k, one in enumerate(channels)
        ]
        entry = pick(entries, channel, quantity, path)
        wanted = channels[entry.number - 1]
        check_claim(len(wanted), wanted.dtype.itemsize, path)
        step = wanted.properties.get("wf_increment")
        places = (file.properties, file[wanted.group_name].properties, wanted.properties)
        # an increment of 0 is what a channel without one has
        words = [
            (name, value)
            for place in places
            for name, value in place.items()
            if name != "wf_increment" or value
        ]
        said = statements(words, path)
        times = [
            one
            for one, other in zip(channels, entries, strict=True)
            if other.timelike and one.group_name == wanted.group_name and len(one) == len(wanted)
        ]
        for one in times:
            check_claim(len(one), one.dtype.itemsize, path)
        clocks = {one.name: one[:] * time_factor(one.name, _unit(one), path) for one in times}
        return Channel(
            name=entry.name,
            samples=wanted[:],
            unit=entry.unit,
            time=one_time(clocks, path),
            sampling_Hz=said.sampling_Hz,
            sampling_error=said.sampling_error,
            start_s=float(dict(words).get("wf_start_offset", 0.0)) if step else 0.0,
            facts=said.facts,
            notes=said.notes,
        )


def _check_whole(path: str) -> None:
    """Refuse a file whose segments do not end where the file ends; the library reads on."""
    size, at = Path(path).stat().st_size, 0
    with open(path, "rb") as file:
        while at < size:
            file.seek(at)
            lead = file.read(28)
            if len(lead) < 28 or lead[:4] != b"TDSm":
                raise ValueError(f"expected a TDMS segment at byte {at}, got {lead[:4]!r} ({path})")
            order = ">" if lead[4] & _BIG_ENDIAN else "<"
            at += 28 + struct.unpack_from(f"{order}Q", lead, 12)[0]
    if at != size:
        raise ValueError(f"the last segment is not whole: cut off? ({path})")


def _numbers(channel) -> bool:
    return len(channel) > 0 and channel.dtype is not None and channel.dtype.kind in "iuf"


def _unit(channel) -> str | None:
    for name in ("unit_string", "NI_UnitDescription", "unit", "units"):
        if channel.properties.get(name):
            return str(channel.properties[name])
    return None
