"""A run that is killed at any moment is continued by the same command, to the same numbers."""

import shutil
import subprocess
import time

import numpy as np
import psutil
import xarray as xr
from bladeroot import runs

MADE = ("small", "bench", "structures/tiny/map")


def kill_tree(process):
    """kill -9 of a process and all that it started."""
    tree = [*psutil.Process(process.pid).children(recursive=True), psutil.Process(process.pid)]
    for member in tree:
        try:
            member.kill()
        except psutil.NoSuchProcess:
            continue
    process.wait()


def artifacts(folder):
    """Those of the small campaign, its raw records and its structure's maps."""
    results = (folder / "results" / name for name in MADE)
    return sorted(path.relative_to(folder) for place in results for path in place.rglob("*.nc"))


def test_a_killed_run_goes_on_and_ends_in_the_same_numbers(house, untouched):
    broken = untouched
    finished = len(artifacts(house.folder))
    for name in MADE:
        shutil.rmtree(broken.folder / "results" / name)
    for share in (0.0, 0.6):
        process = subprocess.Popen(
            broken.command(),
            cwd=broken.folder,
            env=broken.environment,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        while process.poll() is None and len(artifacts(broken.folder)) <= share * finished:
            time.sleep(0.05)
        assert process.poll() is None, "the run ended before it could be killed"
        kill_tree(process)
        for path in artifacts(broken.folder):
            xr.load_dataset(broken.folder / path)  # whole, or not there at all
    broken.run()
    assert artifacts(broken.folder) == artifacts(house.folder)
    assert not list((broken.folder / "results").rglob("*.part"))
    for path in artifacts(house.folder):
        left = xr.load_dataset(house.folder / path)
        right = xr.load_dataset(broken.folder / path)
        for name in left.variables:
            np.testing.assert_array_equal(left[name], right[name], err_msg=f"{path}: {name}")


def test_a_lock_whose_run_lives_is_respected(house):
    """Only the lock of a dead run is removed: two runs at once would spoil each other."""
    lock = house.folder / ".snakemake" / "locks" / "0.output.lock"
    lock.parent.mkdir(parents=True, exist_ok=True)
    lock.write_text("\n".join(str(path) for path in artifacts(house.folder)))
    living = runs.Run(house.folder / ".snakemake")
    living.begin(print)
    living.started()
    refused = house.run("--forceall", check=False)
    assert refused.returncode != 0
    assert "lock" in (refused.stdout + refused.stderr).lower()
    living.end()
    assert house.run().returncode == 0
    assert not lock.exists()
