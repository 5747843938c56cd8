# Stages run as forks of one process that has loaded the libraries (workflow/scripts/_warm.py), which takes longer
# than most of them; it loads them while the run is planned. Where there is no such process, as on a cluster's node,
# their commands start as they stand.
import atexit
import json
import shlex
import signal
import socket
import subprocess
from types import SimpleNamespace


class Warm:
    """The process, to the run's end."""

    def __init__(self):
        self.asked, its = socket.socketpair()
        with its:
            command = [PYTHON, SCRIPTS / "_warm.py"]
            self.process = subprocess.Popen(command, stdin=its)
        atexit.register(self.end)

    def fork(self, job):
        mine, its = socket.socketpair()
        with its:
            socket.send_fds(self.asked, [b"."], [its.fileno()])
        mine.sendall(json.dumps(job).encode() + b"\n")
        return Fork(mine.makefile())

    def end(self):
        self.asked.close()
        self.process.wait()


class Fork:
    """A job's process, as Snakemake uses one that it started."""

    def __init__(self, told):
        self.told, self.pid = told, int(told.readline())

    def wait(self):
        return int(self.told.readline() or -signal.SIGKILL)

    def kill(self):
        os.kill(self.pid, signal.SIGKILL)

    def terminate(self):
        os.kill(self.pid, signal.SIGTERM)


def stage_of(command):
    """Script with arguments, and log; ValueError if a command is anything but that of one stage."""
    text = command.removeprefix("set -euo pipefail;")
    python, script, *arguments, _, log, _ = shlex.split(text)
    plain = f"{shlex.join([PYTHON, script, *arguments])} > {log} 2>&1"
    if Path(script).parent != SCRIPTS or plain.split() != text.split():
        raise ValueError(f"not the command of one stage: {command}")
    return {"command": [script, *arguments], "log": log}


def started(command, **options):
    """A job's process: a fork, or where that cannot be its command."""
    try:
        return WARM.fork({**stage_of(command), "environment": options["env"]})
    except (ValueError, OSError):
        return subprocess.Popen(command, **options)


# Not on macOS, whose libraries do not bear a fork.
if workflow.is_main_process and sys.platform == "linux":
    WARM = Warm()
    sys.modules["snakemake.shell"].sp = SimpleNamespace(
        **{**vars(subprocess), "Popen": started}
    )
