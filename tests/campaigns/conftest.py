"""The small house that the whole-run tests share."""

import shutil

import pytest
from house import House, copy_house


@pytest.fixture(scope="session")
def house(tmp_path_factory) -> House:
    """A house whose small campaign has run to the end. Tests leave it as they found it."""
    made = copy_house(tmp_path_factory.mktemp("house"))
    made.run()
    return made


@pytest.fixture
def own_house(house, tmp_path) -> House:
    """A copy of the finished house for a test that runs other campaigns in it."""
    copy = tmp_path / "own_house"
    shutil.copytree(house.folder, copy)
    return House(copy)
