"""Writing files whole or not at all: under a temporary name, moved into place when on the disk.

So a killed run never leaves half a file under a real name, and neither does a power cut.
"""

import errno
import hashlib
import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path


def save_text(text: str, path: str | Path) -> None:
    """Write a text file (report, table) whole or not at all."""
    with whole_file(path) as part:
        part.write_text(text, encoding="utf-8")


def reason(error: OSError) -> str:
    """What the system says, to stand inside a line."""
    return (error.strerror or str(error)).lower()


@contextmanager
def whole_file(path: str | Path) -> Iterator[Path]:
    """A temporary name beside `path`, moved there when all is on the disk, else removed.

    Raises ValueError, one line that names the file, for what the system refuses: a full disk, a
    folder that cannot be written to, a name that is too long.
    """
    whole = Path(path)
    part = _part(whole)
    try:
        try:
            whole.parent.mkdir(parents=True, exist_ok=True)
            yield part
            _to_disk(part)
            os.replace(part, whole)
        finally:
            with suppress(OSError):
                part.unlink()
    except OSError as error:
        raise ValueError(
            f"{path} cannot be written: {reason(error)}; what was there before is left as it was"
        ) from error


def _part(whole: Path) -> Path:
    """The temporary name, not longer than the longest that is allowed."""
    short = hashlib.sha256(whole.name.encode()).hexdigest()[:16]
    return whole.with_name(f".{short}.{os.getpid()}.part")


@contextmanager
def whole_folder(path: str | Path) -> Iterator[Path]:
    """As `whole_file`, for a folder: an empty one to fill, which then takes the place of `path`."""
    whole = Path(path)
    part = _part(whole)
    try:
        try:
            part.mkdir(parents=True)
            yield part
            for one in part.rglob("*"):
                _to_disk(one)
            shutil.rmtree(whole, ignore_errors=True)
            os.replace(part, whole)
        finally:
            shutil.rmtree(part, ignore_errors=True)
    except OSError as error:
        raise ValueError(f"{path} cannot be written: {reason(error)}") from error


def _to_disk(path: Path) -> None:
    """Have a file, or the names in a folder, written out before anything else is done."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    except OSError as error:
        # some network disks cannot do that for a folder
        if error.errno not in (errno.EINVAL, errno.ENOTSUP, errno.EBADF):
            raise
    finally:
        os.close(handle)
