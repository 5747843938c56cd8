"""WAV: whole numbers of 8 to 64 bits or floats, RIFF, RIFX and RF64, any number of channels.

A WAV file has no unit. Whole numbers are read as parts of full scale (unit FS), so records.csv
must say what full scale is; floats are taken as they are.
"""

import os
import struct

import numpy as np

from bladeroot.io.channel import Channel, Entry, pick

SUFFIXES = (".wav", ".wave")
# Codes of the sample format: whole numbers, floats, and one that is told in an extension.
_PCM, _FLOAT, _EXTENSIBLE = 1, 3, 0xFFFE


def read(path: str, channel: str | None = None, quantity: str | None = None) -> Channel:
    """Read one channel; its name is its number."""
    with open(path, "rb") as file:
        order, form, start, size, notes = _chunks(file, path)
        code, channels, rate, frame, bits = form
        width = frame // max(channels, 1)
        types = {_FLOAT: (4, 8), _PCM: (1, 2, 3, 4, 8)}
        if channels < 1 or frame != channels * width or width not in types.get(code, ()):
            raise ValueError(
                f"expected samples of 8 to 64 bits or floats, got format {code} with {channels} "
                f"channels, {frame} bytes a frame, {bits} bits ({path})"
            )
        if not 0 <= 8 * width - bits < 8:
            raise ValueError(f"{bits} bits a sample do not fit {width} bytes ({path})")
        if size % frame or size > os.path.getsize(path) - start:
            raise ValueError(
                f"the header claims {size} bytes of samples in frames of {frame}, the file has "
                f"{os.path.getsize(path) - start}: cut off? ({path})"
            )
        entries = [Entry(k + 1, f"channel {k + 1}") for k in range(channels)]
        entry = pick(entries, channel, quantity, path)
        file.seek(start)
        raw = np.fromfile(file, np.uint8, size).reshape(-1, channels, width)[:, entry.number - 1]
    if width == 3:  # to the upper three bytes of four
        wide = np.zeros((raw.shape[0], 4), np.uint8)
        wide[:, slice(1, 4) if order == "<" else slice(0, 3)] = raw
        raw, width = wide, 4
    kind = "f" if code == _FLOAT else "u" if width == 1 else "i"
    samples = np.ascontiguousarray(raw).view(f"{order}{kind}{width}")[:, 0]
    if code == _FLOAT:
        return Channel(entry.name, samples, sampling_Hz=float(rate), notes=notes)
    if width == 1:
        samples = samples.astype(np.int16) - 128
    scale = 0.5 ** (8 * width - 1)
    return Channel(
        entry.name, samples, unit="FS", scale=scale, sampling_Hz=float(rate), notes=notes
    )


def _chunks(file, path: str) -> tuple[str, tuple, int, int, tuple[str, ...]]:
    """Byte order, format, where the samples begin, how many bytes they have, and doubts."""
    head = file.read(12)
    orders = {b"RIFF": "<", b"RF64": "<", b"RIFX": ">"}
    if head[:4] not in orders or head[8:] != b"WAVE":
        raise ValueError(f"expected a RIFF WAVE file, got {head[:4]!r} ({path})")
    order, form, large = orders[head[:4]], None, None
    stated, whole = struct.unpack(f"{order}I", head[4:8])[0] + 8, os.path.getsize(path)
    # sizes of a stream that was never finished are 0 or all ones
    odd = head[:4] != b"RF64" and stated not in (8, 0x100000007) and not 0 <= whole - stated <= 1
    notes = (f"the file has {whole} bytes, its header says {stated}: damaged?",) if odd else ()
    while len(start := file.read(8)) == 8:
        name, size = start[:4], struct.unpack(f"{order}I", start[4:])[0]
        if name == b"ds64":
            content = file.read(size)
            large = struct.unpack("<QQ", content[:16])[1] if len(content) >= 16 else None
            continue
        if name == b"fmt ":
            content = file.read(size)
            if len(content) < 16:
                break
            code, channels, rate, speed, frame, bits = struct.unpack(f"{order}HHIIHH", content[:16])
            if code == _EXTENSIBLE and len(content) >= 26:
                code = struct.unpack(f"{order}H", content[24:26])[0]
            if speed != rate * frame:
                raise ValueError(
                    f"{rate} Hz in frames of {frame} bytes are not the {speed} bytes a second that "
                    f"the header states, too ({path})"
                )
            form = (code, channels, rate, frame, bits)
            file.seek(size % 2, os.SEEK_CUR)
        elif name == b"data":
            if form is None:
                break
            if size == 0xFFFFFFFF and large is not None:
                size = large
            return order, form, file.tell(), size, notes
        else:
            file.seek(size + size % 2, os.SEEK_CUR)
    raise ValueError(f"expected a format and samples, the file ends before them ({path})")
