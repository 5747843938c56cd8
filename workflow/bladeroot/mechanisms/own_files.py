"""The files of a user's folder of mechanisms; what can be told of them without running them."""

from pathlib import Path


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
        except (SyntaxError, ValueError) as error:  # ValueError: a null byte, another encoding
            row = f", row {error.lineno}" if getattr(error, "lineno", None) else ""
            faults.append(f"expected Python: {getattr(error, 'msg', error)} ({path}{row})")
    if faults:
        raise ValueError("\n".join(faults))
    return paths
