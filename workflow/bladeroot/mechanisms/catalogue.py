"""All mechanisms: the files of this folder, and those of a user's own folder."""

import importlib.util
import pkgutil
from functools import partial
from importlib import import_module
from pathlib import Path

from bladeroot import mechanisms
from bladeroot.mechanisms.mechanism import Mechanism
from bladeroot.mechanisms.own_files import own_files, try_apart
from bladeroot.mechanisms.probe import probe


def catalogue(folder: str | Path | None = None) -> tuple[Mechanism, ...]:
    """The mechanisms in alphabetical order of their ids, with those of `folder` among them.

    A user's file is a Python file with a `MECHANISM`; one with the id of a shipped mechanism
    replaces it. Raises ValueError if the folder is missing, a file cannot be read, its law fails
    the `probe`, or two of the folder's files have one id.
    """
    found, faults = usable_catalogue(folder)
    if faults:
        raise ValueError("\n".join(faults))
    return found


def usable_catalogue(
    folder: str | Path | None = None,
) -> tuple[tuple[Mechanism, ...], tuple[str, ...]]:
    """The mechanisms as `catalogue`, without the user's that fail; and a line for each that does.

    Each of the user's files is tried in a process of its own first: it may end the program or never
    end. Raises ValueError if the folder is missing or a file is not Python.
    """
    found = {}
    for module in pkgutil.iter_modules(mechanisms.__path__):
        made = vars(import_module(f"bladeroot.mechanisms.{module.name}"))
        several = made.get("MECHANISMS") or (made.get("MECHANISM"),)  # None: a helper of several
        found |= {one.id: one for one in several if one}
    own, faults = {}, []
    for path in own_files(folder) if folder else []:
        try:
            try_apart(partial(_read, path), path)
            one = _read(path)
        except ValueError as error:
            faults.append(" ".join(str(error).split()))
            continue
        if one.id in own:
            faults.append(f"two mechanisms have the id {one.id!r} ({path})")
            continue
        own[one.id] = one
    whole = found | own
    return tuple(whole[name] for name in sorted(whole)), tuple(faults)


def _read(path: Path) -> Mechanism:
    spec = importlib.util.spec_from_file_location(f"mechanism_{path.stem}", path)
    module = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except ValueError as error:
        raise ValueError(f"{error} ({path})") from error
    except (Exception, SystemExit) as error:
        raise ValueError(f"{type(error).__name__}: {error} ({path})") from error
    one = getattr(module, "MECHANISM", None)
    if not isinstance(one, Mechanism):
        raise ValueError(f"expected MECHANISM, a bladeroot.mechanisms.mechanism.Mechanism ({path})")
    try:
        probe(one)
    except ValueError as error:
        raise ValueError(f"law of {one.id}: {error} ({path})") from error
    return one
