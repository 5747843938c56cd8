"""What must be looked at before an HDF5 file (NetCDF-4, MATLAB 7.3) is trusted."""

import os
import signal
import struct
from collections.abc import Callable
from pathlib import Path

from bladeroot.checksum import LENGTH, is_sealed

# Seconds that reading may take, and bytes that it may take a second for.
PATIENCE_S, SLOWEST = 30.0, 2e6

_SIGNATURE = b"\x89HDF\r\n\x1a\n"
# offset of the end-of-file address by the superblock's version
_END = {0: 40, 1: 44, 2: 28, 3: 28}


def length_notes(path: str) -> tuple[str, ...]:
    """A line if bytes follow the file's end: the library refuses less, but not more.

    Something put in moves all samples behind it. Nothing is said of other files.
    """
    with open(path, "rb") as file:
        for start in (0, 512, 1024, 2048):
            file.seek(start)
            head = file.read(64)
            if head.startswith(_SIGNATURE) and len(head) == 64:
                break
        else:
            return ()
    at = _END.get(head[8])
    if at is None:
        return ()
    stated, size = struct.unpack_from("<Q", head, at)[0], Path(path).stat().st_size
    if is_sealed(path):  # the virtual bench's own records
        size -= LENGTH
    if size <= stated:
        return ()
    return (f"the file has {size - stated} bytes more than its header says: damaged?",)


def try_first(work: Callable[[], object], path: str) -> None:
    """Read in a child process first: damaged files can catch the library in an endless loop.

    It cannot be interrupted from within, and some damage makes it crash. An error of `work` is
    left to be met again.

    Raises:
        ValueError: the library did not come back.
    """
    if not hasattr(os, "fork"):
        return
    patience = PATIENCE_S + Path(path).stat().st_size / SLOWEST
    child = os.fork()
    if child == 0:
        try:
            signal.signal(signal.SIGALRM, signal.SIG_DFL)
            signal.setitimer(signal.ITIMER_REAL, patience)
            work()
        finally:
            os._exit(0)
    ended = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    if ended == -signal.SIGALRM:
        raise ValueError(f"reading does not end after {patience:.0f} s: damaged? ({path})")
    if ended < 0:
        name = signal.Signals(-ended).name
        raise ValueError(f"reading makes the HDF5 library crash ({name}): damaged? ({path})")
