"""What must be looked at before an HDF5 file (NetCDF-4, MATLAB 7.3) is trusted."""

import os
import signal
import struct
from collections.abc import Callable, Iterable
from contextlib import suppress
from pathlib import Path

from bladeroot.checksum import LENGTH, is_sealed

# How long reading may take before a file is called damaged.
PATIENCE_S = 30.0
SLOWEST_BYTES_A_SECOND = 2e6  # and a second more for so many bytes of the file

# Files that a child process has read to the end.
_TRIED: set[str] = set()

_SIGNATURE = b"\x89HDF\r\n\x1a\n"
# Offset of the end-of-file address, by the superblock's version.
_END_OFFSET = {0: 40, 1: 44, 2: 28, 3: 28}


def length_notes(path: str) -> tuple[str, ...]:
    """A line if bytes follow the file's end: the library refuses less, but not more.

    Something put in moves all samples behind it. Nothing is said of other files.
    """
    head = _head(path)
    at = _END_OFFSET.get(head[8]) if head else None
    if at is None:
        return ()
    stated, size = struct.unpack_from("<Q", head, at)[0], Path(path).stat().st_size
    if is_sealed(path):  # the virtual bench's own records
        size -= LENGTH
    if size <= stated:
        return ()
    return (f"the file has {size - stated} bytes more than its header says: damaged?",)


def _head(path: str) -> bytes:
    """The begin of an HDF5 file's superblock; nothing of other files."""
    with open(path, "rb") as file:
        for start in (0, 512, 1024, 2048):
            file.seek(start)
            head = file.read(64)
            if head.startswith(_SIGNATURE) and len(head) == 64:
                return head
    return b""


def try_first(work: Callable[[], object], path: str) -> None:
    """Read in a child process first: damaged files can catch the library in an endless loop.

    It cannot be interrupted from within, and some damage makes it crash. An error of `work` is
    left to be met again.

    Raises:
        ValueError: the library did not come back.
    """
    if path in _TRIED:
        return
    patience = _patience(path)
    ended = _in_child(work, patience)
    if ended == -signal.SIGALRM:
        raise ValueError(f"reading does not end after {patience:.0f} s: damaged? ({path})")
    if ended < 0:
        name = signal.Signals(-ended).name
        raise ValueError(f"reading makes the HDF5 library crash ({name}): damaged? ({path})")


def try_together(work: Callable[..., object], asked: Iterable[tuple]) -> None:
    """Read many files in one child process, so that `try_first` need not for each of them.

    A child takes longer to begin and to end than to read a record. Where one file catches it, each
    has to be tried by itself. Files of other formats are left out.

    asked: arguments of `work`, of which the first is the path.
    """
    some = [one for one in dict.fromkeys(asked) if Path(one[0]).is_file() and _head(one[0])]
    _TRIED.update(path for path, *_ in some)  # the child tries them itself

    def every() -> None:
        for one in some:
            with suppress(Exception):  # met again, and told there
                work(*one)

    if some and _in_child(every, sum(_patience(path) for path, *_ in some)) < 0:
        _TRIED.difference_update(path for path, *_ in some)


def _patience(path: str) -> float:
    return PATIENCE_S + Path(path).stat().st_size / SLOWEST_BYTES_A_SECOND


def _in_child(work: Callable[[], object], patience: float) -> int:
    """How a child process that does something ended: minus a signal's number, or 0."""
    if not hasattr(os, "fork"):
        return 0
    child = os.fork()
    if child == 0:
        try:
            signal.signal(signal.SIGALRM, signal.SIG_DFL)
            signal.setitimer(signal.ITIMER_REAL, patience)
            work()
        finally:
            os._exit(0)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
