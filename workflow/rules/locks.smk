# A run killed with kill -9 leaves Snakemake's lock behind, and the same command would then refuse
# to go on. Each run signs in with its process; when none of them lives, what they left is removed.
# On a shared disk that is known only of the own machine's: a run of another one counts as alive.
import platform

import psutil

RUNS = Path(".snakemake") / "bladeroot_runs"


def sign_in():
    """Write this process down as a run of the working directory, once its jobs begin."""
    RUNS.mkdir(parents=True, exist_ok=True)
    signed().write_text(str(psutil.Process().create_time()))


def sign_out():
    signed().unlink(missing_ok=True)


def signed():
    return RUNS / f"{os.getpid()}@{platform.node()}"


def lives(run):
    number, _, machine = run.name.partition("@")
    if machine not in ("", platform.node()):
        return True
    try:
        return (
            abs(psutil.Process(int(number)).create_time() - float(run.read_text())) < 1
        )
    except (OSError, ValueError, psutil.Error):
        return False


def remove_what_dead_runs_left():
    """Remove locks and half-written files, if there was a run and none is left alive."""
    runs = list(RUNS.glob("*"))
    if not runs or any(lives(run) for run in runs):
        return
    for left in [
        *(Path(".snakemake") / "locks").glob("*.lock"),
        *Path("results").glob("**/.*.part"),
        *runs,
    ]:
        left.unlink()


if workflow.is_main_process:
    remove_what_dead_runs_left()
