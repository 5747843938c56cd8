"""Python's cache of bytecode, which here follows what a source says.

Python takes a source's time and size for its content. `cp -p`, `rsync -t` and archives that give
all files one time leave another source of the same time and size, which then runs as the old one.
The workflow and its scripts ask for it; `import bladeroot` in somebody's own Python does not.
"""

import os
import zlib
from importlib.machinery import SourceFileLoader

# Packages that are installed change by their installer alone, which removes their bytecode.
_INSTALLED = (os.path.dirname(os.__file__), "site-packages", "dist-packages")


def follow_content() -> None:
    """From now on a checksum of the source stands where its time would, in what is imported."""
    SourceFileLoader.path_stats = _stats


def _stats(loader: SourceFileLoader, path: str, known=SourceFileLoader.path_stats) -> dict:
    found = known(loader, path)
    if not any(part in path for part in _INSTALLED):
        found["mtime"] = zlib.crc32(loader.get_data(path))
    return found
