# A run killed with kill -9 leaves Snakemake's lock behind, and the same command would then refuse
# to go on. The run's process is written beside the lock; what a dead run left is removed.
import psutil

OWNER = Path(".snakemake") / "bladeroot_owner"


def claim():
    """Write this process down as the owner of the working directory's run."""
    OWNER.parent.mkdir(exist_ok=True)
    OWNER.write_text(f"{os.getpid()} {psutil.Process().create_time()}")


def owner_lives():
    try:
        pid, born = OWNER.read_text().split()
        return abs(psutil.Process(int(pid)).create_time() - float(born)) < 1
    except (OSError, ValueError, psutil.Error):
        return False


if workflow.is_main_process and not owner_lives():
    for lock in (Path(".snakemake") / "locks").glob("*.lock"):
        lock.unlink()
    for part in Path("results").glob("**/.*.part"):
        part.unlink()
    claim()
