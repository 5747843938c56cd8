"""The houses that the tests of campaigns share."""

import shutil
from dataclasses import replace
from pathlib import Path

import pytest
from house import House, copy_house, floors_lab


@pytest.fixture(scope="session")
def floors(tmp_path_factory) -> Path:
    """The folder of a campaign of recorded files, outside the house."""
    return floors_lab(tmp_path_factory.mktemp("labs") / "floors")


@pytest.fixture(scope="session")
def house(tmp_path_factory, floors) -> House:
    """A house in which the small campaign and the floors have run to the end, in one run.

    Tests leave it as they found it; its own configuration has the small campaign alone.
    """
    made = copy_house(tmp_path_factory.mktemp("house"))
    done = made.run("--config", f"campaigns=small,{floors}")
    return replace(made, said=done.stdout + done.stderr)


@pytest.fixture(scope="session")
def bare(tmp_path_factory) -> House:
    """A house in which nothing has run, for what must end before any job."""
    return copy_house(tmp_path_factory.mktemp("bare"))


@pytest.fixture
def untouched(house, tmp_path) -> House:
    """A copy of the finished house with its times, for one change."""
    left = shutil.ignore_patterns("log")
    return House(shutil.copytree(house.folder, tmp_path / "copy", symlinks=True, ignore=left))
