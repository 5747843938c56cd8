"""All mechanisms: the files of this folder, and those of a user's own folder."""

import importlib.util
import pkgutil
from importlib import import_module
from pathlib import Path

from bladeroot import mechanisms
from bladeroot.mechanisms.mechanism import Mechanism
from bladeroot.mechanisms.own_files import own_files
from bladeroot.mechanisms.probe import probe

_NO_MECHANISM = ("catalogue", "mechanism", "own_files", "probe", "slip_curve")


def catalogue(folder: str | Path | None = None) -> tuple[Mechanism, ...]:
    """The mechanisms in alphabetical order of their ids, with those of `folder` among them.

    A user's file is a Python file with a `MECHANISM`; one with the id of a shipped mechanism
    replaces it. Raises ValueError if the folder is missing, a file cannot be read, its law fails
    the `probe`, or two of the folder's files have one id.
    """
    found = {}
    for module in pkgutil.iter_modules(mechanisms.__path__):
        if module.name not in _NO_MECHANISM:
            one = import_module(f"bladeroot.mechanisms.{module.name}").MECHANISM
            found[one.id] = one
    own = {}
    if folder:
        for path in own_files(folder):
            one = _read(path)
            if one.id in own:
                raise ValueError(f"two mechanisms have the id {one.id!r} ({path})")
            own[one.id] = one
    whole = found | own
    return tuple(whole[name] for name in sorted(whole))


def _read(path: Path) -> Mechanism:
    spec = importlib.util.spec_from_file_location(f"mechanism_{path.stem}", path)
    module = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except ValueError as error:
        raise ValueError(f"{error} ({path})") from error
    except Exception as error:
        raise ValueError(f"{type(error).__name__}: {error} ({path})") from error
    one = getattr(module, "MECHANISM", None)
    if not isinstance(one, Mechanism):
        raise ValueError(f"expected MECHANISM, a bladeroot.mechanisms.mechanism.Mechanism ({path})")
    try:
        probe(one)
    except ValueError as error:
        raise ValueError(f"law of {one.id}: {error} ({path})") from error
    return one
