"""A call in a fork of this process, which has all but the library loaded: a start costs little."""

import os
import subprocess
import sys
import tempfile
import traceback
from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


@cache
def snakemake_main() -> Callable[[list[str]], None]:
    """Snakemake's command with its plugins, loaded once for all that is forked off from here on."""
    import snakemake.cli

    snakemake.cli.get_argument_parser()
    return snakemake.cli.main


def forked(
    call: Callable[[], object], folder: Path, environment: Mapping[str, str] | None = None
) -> subprocess.CompletedProcess:
    """Run `call` as a process of its own in `folder`, with no library loaded; what came of it.

    Without arrays' shapes checked. What is on PYTHONPATH in the environment is found first.
    """
    with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as err:
        child = os.fork()
        if child == 0:
            status = 1
            try:
                for number, file in ((1, out), (2, err)):
                    os.dup2(file.fileno(), number)
                sys.stdout, sys.stderr = out, err
                _settle(folder, environment)
                call()
                status = 0
            except SystemExit as end:
                status = end.code or 0
            except BaseException:
                traceback.print_exc()
            finally:
                out.flush()
                err.flush()
                os._exit(status)
        _, status = os.waitpid(child, 0)
        out.seek(0)
        err.seek(0)
        code = os.waitstatus_to_exitcode(status)
        return subprocess.CompletedProcess("", code, out.read(), err.read())


def _settle(folder: Path, environment: Mapping[str, str] | None) -> None:
    for name in [name for name in sys.modules if name.split(".")[0] == "bladeroot"]:
        del sys.modules[name]
    # what is installed stays, also where the environment stands in the checkout
    sys.path[:] = [
        one for one in sys.path if "site-packages" in one or not Path(one).is_relative_to(ROOT)
    ]
    kinds = [(one if isinstance(one, type) else type(one)).__module__ for one in sys.meta_path]
    sys.meta_path[:] = [
        one for one, kind in zip(sys.meta_path, kinds, strict=True) if "jaxtyping" not in kind
    ]
    os.chdir(folder)
    if environment is not None:
        os.environ.clear()
        os.environ.update(environment)
    sys.path[:0] = os.environ.get("PYTHONPATH", "").split(os.pathsep)
