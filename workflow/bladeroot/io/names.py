"""Names that become files' names, and paths that may be none."""

import re
from collections.abc import Callable

# Signs of a name that becomes a file's, with a mode, a channel and an ending behind it: file
# systems allow 255 bytes.
LONGEST_NAME = 100
ID_RULE = f"letters, digits, - and _, {LONGEST_NAME} at most"
# Signs that the path of an input must not have: braces are Snakemake's wildcards, angle brackets a
# page's tags.
SPECIAL = frozenset("{}<>")
SPECIAL_TEXT = "{ } < >"  # as messages say them
_ID = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]*")


def is_id(name: str) -> bool:
    """Whether a name is one that files can have everywhere."""
    return len(name) <= LONGEST_NAME and bool(_ID.fullmatch(name))


def short(text: str, most: int = 80) -> str:
    """As much of a text as a message can bear."""
    return text if len(text) <= most else f"{text[:most]}..."


def is_there(asked: Callable[[], bool]) -> bool:
    """Whether a path is there; a name that is too long, or no right to look, is that it is not."""
    try:
        return asked()
    except (OSError, ValueError):
        return False
