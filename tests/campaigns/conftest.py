"""The houses that the tests of campaigns share."""

from dataclasses import replace

import pytest
from house import House, copy_house, floors_lab, poor_lab


@pytest.fixture(scope="session")
def labs(tmp_path_factory) -> dict:
    """Campaign folders of recorded files, by name."""
    folder = tmp_path_factory.mktemp("labs")
    return {"poor": poor_lab(folder / "poor"), "floors": floors_lab(folder / "floors")}


@pytest.fixture(scope="session")
def house(tmp_path_factory, labs) -> House:
    """A house in which the small campaign and the labs have run to the end, in one run.

    Tests leave it as they found it; its own configuration has the small campaign alone.
    """
    made = copy_house(tmp_path_factory.mktemp("house"))
    campaigns = ",".join(["small", *map(str, labs.values())])
    done = made.run("--config", f"campaigns={campaigns}")
    return replace(made, said=done.stdout + done.stderr)


@pytest.fixture(scope="session")
def bare(tmp_path_factory) -> House:
    """A house in which nothing has run, for what must end before any job."""
    return copy_house(tmp_path_factory.mktemp("bare"))
