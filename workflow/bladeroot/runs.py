"""Who works in a folder: locks that the system takes back when their process ends, however it ends.

Snakemake's own lock is a file that a killed run leaves behind, and two starts at once may both find
none. So a run holds `starting` until Snakemake's lock is written, and its machine's file in
`running` as long as it lives; a stage's process holds `working`, for it may outlive a killed run.
"""

import fcntl
import os
import platform
import re
import shutil
from collections.abc import Callable
from pathlib import Path

_FOLDER = Path("bladeroot_runs")
_BOOT = Path("/proc/sys/kernel/random/boot_id")


def _lock(place: Path, how: int) -> int | None:
    """Take a lock; None where another has it (LOCK_NB), or where the disk knows no locks."""
    handle = None
    try:
        handle = os.open(place, os.O_RDWR | os.O_CREAT, 0o666)
        fcntl.flock(handle, how)
        return handle
    except OSError:
        if handle is not None:
            os.close(handle)
        return None


def _free(place: Path) -> bool:
    """Whether nobody holds a lock."""
    handle = _lock(place, fcntl.LOCK_EX | fcntl.LOCK_NB)
    if handle is not None:
        os.close(handle)
    return handle is not None


def _wait(place: Path, why: str, say: Callable[[str], None]) -> int | None:
    """Take a lock as soon as nobody holds it."""
    handle = _lock(place, fcntl.LOCK_EX | fcntl.LOCK_NB)
    if handle is None:
        say(f"{why}: waiting for it")
        handle = _lock(place, fcntl.LOCK_EX)
    return handle


def _machine() -> tuple[str, str]:
    """The running system, which containers share, and the name that outlives a restart."""
    booted = _BOOT.read_text().strip() if _BOOT.is_file() else platform.node()
    return booted, platform.node()


class Run:
    """A run of the workflow in a working directory, from its start to its end."""

    def __init__(self, snakemake: str | Path = ".snakemake") -> None:
        """Of the working directory whose `.snakemake` this is."""
        self._folder = Path(snakemake) / _FOLDER
        self._folder.mkdir(parents=True, exist_ok=True)
        self._starting = self._own = None

    def begin(self, say: Callable[[str], None]) -> bool:
        """Sign in. True if no other run lives, and what dead ones left may go.

        say: takes a line before another run's start, or a dead one's last job, is waited for.
        """
        starting, working = self._folder / "starting", self._folder / "working"
        self._starting = _wait(starting, "another run is starting here", say)
        alone = self.alone()
        self._own = self._sign()
        if alone:
            handle = _wait(working, "a job of a run that was killed still works", say)
            if handle is not None:
                os.close(handle)
        return alone

    def started(self) -> None:
        """Let others start: Snakemake's lock is written."""
        if self._starting is not None:
            os.close(self._starting)
            self._starting = None

    def alone(self) -> bool:
        """Whether no run lives here; another machine's sign counts as one, seen locked or not."""
        return not any(self._lives(sign) for sign in self._folder.glob("running-*"))

    def _sign(self) -> int | None:
        booted, name = _machine()
        sign = self._folder / f"running-{booted}"
        handle = _lock(sign, fcntl.LOCK_SH)
        if handle is not None:
            os.ftruncate(handle, 0)
            os.pwrite(handle, name.encode(), 0)
        return handle

    def _lives(self, sign: Path) -> bool:
        booted, name = _machine()
        own = sign.name == f"running-{booted}" or sign.read_text(errors="replace") == name
        return not (own and _free(sign))

    def end(self) -> None:
        """Sign out; the last of a machine takes its sign away."""
        self.started()
        if self._own is None:
            return
        os.close(self._own)
        self._own = None
        sign = self._folder / f"running-{_machine()[0]}"
        if _free(sign):
            sign.unlink(missing_ok=True)


def work(snakemake: str | Path = ".snakemake") -> None:
    """Hold `working` until this process ends, where a run has its folder."""
    folder = Path(snakemake) / _FOLDER
    if folder.is_dir():
        _lock(folder / "working", fcntl.LOCK_SH)


def remove_what_is_left(
    snakemake: str | Path = ".snakemake", results: str | Path = "results"
) -> None:
    """Remove the locks and the half-written files and folders of runs that are dead."""
    left = [*(Path(snakemake) / "locks").glob("*.lock"), *Path(results).rglob(".*.part")]
    left += Path(snakemake, _FOLDER).glob("running-*")
    # Snakemake's copies of what jobs were about to update
    left += Path(snakemake).glob("backups")
    for one in left:
        if one.is_dir() and not one.is_symlink():
            shutil.rmtree(one, ignore_errors=True)
        else:
            one.unlink(missing_ok=True)


def system_fault(text: str) -> str:
    """Of a traceback the line in which the system refuses something (no space, no right), or ""."""
    found = re.findall(r"^.*\[Errno \d+\] .+$", text, re.MULTILINE)
    return found[-1].strip() if found and re.search(r'^ +File "', text, re.MULTILINE) else ""
