"""All mechanisms: the files of this folder, and those of a user's own folder."""

import pkgutil
from importlib import import_module
from pathlib import Path

from bladeroot import mechanisms
from bladeroot.mechanisms.mechanism import Mechanism
from bladeroot.mechanisms.probe import own_mechanisms


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
    own, faults = own_mechanisms(folder) if folder else ({}, [])
    whole = found | own
    return tuple(whole[name] for name in sorted(whole)), tuple(faults)
