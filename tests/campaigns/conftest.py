"""The houses that the tests of campaigns share."""

import fcntl
import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from house import House, copy_house, floors_lab


@contextmanager
def alone(folder: Path) -> Iterator[None]:
    """Whoever comes later waits, and finds what the first has made."""
    with (folder / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


@pytest.fixture(scope="session")
def kept(tmp_path_factory) -> Path:
    """Where the finished run is kept, for all processes of a session."""
    own = tmp_path_factory.getbasetemp()
    folder = (own.parent if "PYTEST_XDIST_WORKER" in os.environ else own) / "kept"
    folder.mkdir(exist_ok=True)
    return folder


@pytest.fixture(scope="session")
def floors(kept) -> Path:
    """The folder of a campaign of recorded files, outside the house."""
    with alone(kept):
        folder = kept / "floors"
        return folder if folder.exists() else floors_lab(folder)


@pytest.fixture(scope="session")
def house(kept, floors, tmp_path_factory) -> House:
    """A house in which the small campaign and the floors have run to the end, in one run.

    Tests leave it as they found it; its own configuration has the small campaign alone.
    """
    said = kept / "said.txt"
    with alone(kept):
        if not said.exists():
            done = copy_house(kept / "house").run("--config", f"campaigns=small,{floors}")
            said.write_text(done.stdout + done.stderr)
    copy = tmp_path_factory.mktemp("house") / "copy"
    return House(shutil.copytree(kept / "house", copy, symlinks=True), said.read_text())


@pytest.fixture(scope="session")
def bare(tmp_path_factory) -> House:
    """A house in which nothing has run, for what must end before any job."""
    return copy_house(tmp_path_factory.mktemp("bare"))


@pytest.fixture
def untouched(house, tmp_path) -> House:
    """A copy of the finished house with its times, for one change."""
    return house.copied(tmp_path / "copy")
