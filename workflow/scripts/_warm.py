"""A process that has the libraries loaded and forks once a job.

A run of the workflow starts it (workflow/rules/warm.smk), and it ends with the run. Of each job
it is sent a socket, on which it reads what is to run and answers with the process id and, in the
end, the exit code. The project's own modules are loaded by each job for itself, as they are at
that moment.
"""

import gc
import io
import json
import os
import runpy
import select
import signal
import socket
import sys
from contextlib import suppress
from importlib import import_module

# What takes longest to load, of all that stages import; what most of them need comes first.
LIBRARIES = (
    "netCDF4",
    "pandas",
    "pint",  # which xarray asks for, too
    "xarray",
    "importlib.metadata",
    "jaxtyping",
    "scipy.interpolate",
    "scipy.optimize",
    "scipy.sparse.linalg",
    "scipy.sparse.csgraph",
    "scipy.signal",
    "numba",
    "yaml",
    "jsonschema",
    "matplotlib.backends.backend_svg",
    "matplotlib.projections",
    "jinja2",
)


def load(library: str) -> None:
    with suppress(ImportError):  # the stage that needs it says so
        loaded = import_module(library)
        if library == "numba":  # whose tables of types come with the first function
            loaded.njit("void()")(lambda: None)
        if library == "matplotlib.projections":  # fonts, and how powers of ten are set
            first = import_module("matplotlib.figure").Figure(layout="constrained")
            first.subplots().loglog([1.0, 1e3], [1.0, 1e3])
            first.savefig(io.StringIO(), format="svg")


def next_job(asked: socket.socket) -> dict:
    """Fork for each job that is asked for, until the run ends; only a job's process returns.

    Libraries are loaded while no job waits: the first one loads what is not there for itself.
    """
    waiting = list(LIBRARIES)
    while True:
        while waiting and not select.select([asked], [], [], 0.0)[0]:
            load(waiting.pop(0))
        if not (sockets := socket.recv_fds(asked, 1, 1)[1]):
            break
        gc.freeze()  # a collection in a job would copy all of it
        with socket.socket(fileno=sockets[0]) as told:
            if os.fork() == 0:
                return _kept(told)
        os.waitpid(-1, os.WNOHANG)  # an earlier one
    with suppress(ChildProcessError):
        while True:  # what jobs took is then counted as the run's
            os.wait()
    os._exit(0)


def _kept(told: socket.socket) -> dict:
    """The job, in a process of its own; this one says which that is, and how it ended."""
    job = json.loads(told.makefile().readline())
    process = os.fork()
    if process == 0:
        return job
    with suppress(OSError):  # the run was killed: its job goes on
        told.sendall(b"%d\n" % process)
        code = os.waitstatus_to_exitcode(os.waitpid(process, 0)[1])
        told.sendall(b"%d\n" % code)
    os._exit(0)


def become(job: dict) -> None:
    """Run a stage's script as if this process had been started for it."""
    os.environ.clear()
    os.environ.update(job["environment"])
    nothing = os.open(os.devnull, os.O_RDONLY)
    log = os.open(job["log"], os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o666)
    for number, file in enumerate((nothing, log, log)):
        os.dup2(file, number)
    sys.argv = job["command"]
    runpy.run_path(sys.argv[0], run_name="__main__")


if __name__ == "__main__":
    # Ctrl-C is for the jobs and the run, with which this ends.
    interrupted = signal.signal(signal.SIGINT, signal.SIG_IGN)
    with socket.socket(fileno=os.dup(0)) as run:
        wanted = next_job(run)
    signal.signal(signal.SIGINT, interrupted)
    become(wanted)
