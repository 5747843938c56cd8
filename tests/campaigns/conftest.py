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
def visited(house):
    """The finished house for a test that runs other campaigns in it: what they make goes after."""
    results = house.folder / "results"

    def folders():
        return {path for pattern in ("*", "structures/*") for path in results.glob(pattern)}

    before = folders()
    yield house
    for path in folders() - before:
        shutil.rmtree(path)
