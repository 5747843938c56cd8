"""Compiled functions, kept by the content of all the code that is compiled into them.

numba's own cache looks at the file of a function alone. A function or constant of another module
that is compiled into it would stay as it was when that module is edited, so each module has a
folder by the hash of itself and all that it imports. A cache only saves time: one that is damaged,
full or cannot be written to means compiling again, never an end.
"""

import fcntl
import hashlib
import os
import shutil
import time
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from pathlib import Path

import llvmlite
import numba
import numpy as np
from numba.core.caching import CompileResultCacheImpl, FunctionCache, UserProvidedCacheLocator

from bladeroot.provenance import code_hash

_LIBRARY = Path(__file__).parent
# Folders of one module that are kept, the last used ones: branches that are worked on in turn.
_KEPT_FOLDERS = 4
# Seconds that a process waits for another that compiles the same function, which takes one or two.
_PATIENCE_S = 120.0


def njit(**options: object) -> Callable[[Callable], Callable]:
    """`numba.njit`, whose `cache=True` follows all the code that is compiled in."""
    cached = options.pop("cache", False)

    def compiled(function: Callable) -> Callable:
        dispatcher = numba.njit(**options)(function)
        # NUMBA_DISABLE_JIT leaves a plain function
        if cached and hasattr(dispatcher, "enable_caching") and _folder(_file_of(function)):
            dispatcher._cache = _Cache(function)
        return dispatcher

    return compiled


def _file_of(function: Callable) -> str:
    return function.__code__.co_filename


@cache
def _folder(file: str) -> Path | None:
    """Where the compiled functions of a module are; None where nothing can be written."""
    stands_on = (code_hash(file), numba.__version__, llvmlite.__version__, np.__version__)
    short = hashlib.sha256(" ".join(stands_on).encode()).hexdigest()[:16]
    path = Path(file).resolve()
    inside = path.relative_to(_LIBRARY) if path.is_relative_to(_LIBRARY) else Path(path.name)
    module = ".".join(inside.with_suffix("").parts)
    for place in _places():
        folder = place / f"{module}-{short}"
        with suppress(OSError):
            new = not folder.is_dir()
            folder.mkdir(parents=True, exist_ok=True)
            os.utime(folder)  # the last use
            if new:
                _prune(place, module)
            if os.access(folder, os.W_OK):
                return folder
    return None


def _places() -> list[Path]:
    """Folders to try: the one that was asked for, the library's own, the user's."""
    asked, user = os.environ.get("NUMBA_CACHE_DIR"), os.environ.get("XDG_CACHE_HOME")
    places = [_LIBRARY / "__pycache__"]
    if user or os.environ.get("HOME"):
        places.append(Path(user or f"{os.environ['HOME']}/.cache") / "bladeroot")
    return [place / "compiled" for place in ([Path(asked)] if asked else []) + places]


def _prune(place: Path, module: str) -> None:
    """Remove a module's folders but for the last used ones."""
    own = [one for one in place.glob(f"{module}-*") if one.name.rpartition("-")[0] == module]
    own.sort(key=lambda one: one.stat().st_mtime)
    for old in own[:-_KEPT_FOLDERS]:
        shutil.rmtree(old, ignore_errors=True)


class _Place(UserProvidedCacheLocator):
    """The module's folder."""

    def __init__(self, py_func: Callable, py_file: str) -> None:
        self._py_file = py_file
        self._lineno = py_func.__code__.co_firstlineno
        self._cache_path = str(_folder(_file_of(py_func)))

    @classmethod
    def from_function(cls, py_func: Callable, py_file: str) -> "_Place":
        return cls(py_func, py_file)


class _Compiled(CompileResultCacheImpl):
    _locator_classes = (_Place,)


class _Cache(FunctionCache):
    """numba's, whose faults are no end: what cannot be read is compiled again.

    Jobs that start together need the same functions: one compiles, the others wait for it.
    """

    _impl_class = _Compiled

    def __init__(self, function: Callable) -> None:
        super().__init__(function)
        self._turn = None  # the open file that says that this process compiles
        self._sign = _folder(_file_of(function)) / f"{function.__qualname__}.lock"

    def load_overload(self, sig: object, target_context: object) -> object:
        found = self._read(sig, target_context)
        if found is None and self._wait():
            found = self._read(sig, target_context)
            if found is not None:
                self._done()
        return found

    def _wait(self) -> bool:
        """Take the turn to compile; whether another had it before."""
        last = time.monotonic() + _PATIENCE_S
        waited = False
        with suppress(OSError):  # a disk without locks: each compiles for itself
            self._turn = self._turn or open(self._sign, "a")  # noqa: SIM115
            while time.monotonic() < last:
                try:
                    fcntl.flock(self._turn, fcntl.LOCK_EX | fcntl.LOCK_NB)
                    break
                except BlockingIOError:
                    waited = True
                    time.sleep(0.02)
        return waited

    def _done(self) -> None:
        if self._turn:
            self._turn.close()
        self._turn = None

    def _read(self, sig: object, target_context: object) -> object:
        try:
            return super().load_overload(sig, target_context)
        except Exception:  # a damaged pickle throws anything
            with suppress(OSError):
                self._cache_file.flush()
            return None

    def save_overload(self, sig: object, data: object) -> None:
        with suppress(Exception):  # no space, no right, a folder that is gone
            super().save_overload(sig, data)
        self._done()
