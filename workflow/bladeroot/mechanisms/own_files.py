"""The files of a user's folder of mechanisms, and how one is run without harm to what reads it."""

import os
import signal
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

# Seconds that a file of one mechanism may take to be read and tried; the shipped ones take some
# hundredths.
PATIENCE_S = 30.0


def own_files(folder: str | Path) -> list[Path]:
    """The folder's Python files, in alphabetical order.

    Raises ValueError if the folder is missing or a file is not Python, with one line for each.
    """
    if not Path(folder).is_dir():
        raise ValueError(f"folder of mechanisms not found: {folder}")
    paths = sorted(Path(folder).glob("*.py"))
    faults = []
    for path in paths:
        try:
            compile(path.read_bytes(), str(path), "exec")
        # a null byte, another encoding; nested too deep
        except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
            row = f", row {error.lineno}" if getattr(error, "lineno", None) else ""
            faults.append(f"expected Python: {getattr(error, 'msg', error)} ({path}{row})")
    if faults:
        raise ValueError("\n".join(faults))
    return paths


def try_apart(work: Callable[[], object], path: Path) -> None:
    """Do it in a child process first, which a user's code may end, crash or keep for ever.

    An error of `work` is left to be met again. Raises ValueError where the child does not come back
    by itself within `PATIENCE_S` seconds.
    """
    if not hasattr(os, "fork"):
        return
    ours, theirs = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            os.close(ours)
            signal.signal(signal.SIGALRM, signal.SIG_DFL)
            signal.setitimer(signal.ITIMER_REAL, PATIENCE_S)
            with suppress(Exception):
                work()
            os.write(theirs, b"done")
        finally:
            os._exit(0)
    os.close(theirs)
    with os.fdopen(ours, "rb") as pipe:
        ended = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        came_back = pipe.read(4) == b"done"
    if ended == -signal.SIGALRM:
        raise ValueError(f"reading and trying it does not end after {PATIENCE_S:g} s ({path})")
    if ended < 0:
        raise ValueError(f"it makes Python crash ({signal.Signals(-ended).name}) ({path})")
    if not came_back:
        raise ValueError(f"it ends the program ({path})")
