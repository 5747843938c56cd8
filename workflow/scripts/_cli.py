"""The command line that all stage scripts share, and the library that they use.

Scripts import this first: it puts their own checkout's library before an installed one, which may
be another checkout's.
"""

import argparse
import sys
from collections.abc import Callable
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from bladeroot.bytecode import follow_content

follow_content()  # before more of the library is read

from bladeroot import runs  # noqa: E402


def run(stage: Callable[..., None], **options: str) -> None:
    """Call `stage` with one string (or list, for `nargs` given as "many") per option.

    `options` maps an option's name to its help; a help that starts with "many:" takes several
    values, with "any:" none or several, one that starts with "optional:" may be missing. A
    ValueError ends the script with its text alone: it is an answer to bad input, not a crash. So
    does what the system refuses (a full disk, a file without the right to read it).
    """
    parser = argparse.ArgumentParser(description=sys.modules["__main__"].__doc__)
    for name, text in options.items():
        parser.add_argument(
            f"--{name}",
            help=text,
            nargs={"many": "+", "any": "*"}.get(text.partition(":")[0]),
            required=not text.startswith("optional:"),
        )
    runs.work()
    try:
        stage(**vars(parser.parse_args()))
    except (ValueError, OSError) as error:
        sys.exit(f"{parser.prog}: {error}")
