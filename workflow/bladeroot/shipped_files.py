"""Files that ship with the library and are no code: the settings and the structures.

A checkout has them beside the library, a wheel within it (`setup.py`).
"""

from pathlib import Path

_LIBRARY = Path(__file__).resolve().parent


def shipped(name: str) -> Path:
    """Where a shipped file lies, by its path in a checkout, such as `config/config.yaml`."""
    within = _LIBRARY / "shipped" / name
    return within if within.is_file() else _LIBRARY.parents[1] / name


def structure_file(name: str, folder: Path | None = None) -> Path:
    """The file of a structure: a campaign folder's own, else the shipped one of that name."""
    own = folder / f"{name}.yaml" if folder else None
    if own is not None and own.is_file():
        return own
    return shipped(f"resources/structures/{name}.yaml")
