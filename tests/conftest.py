"""Two processes share the tests: a file stays together, and so do all that use the small house."""

import os
from pathlib import Path

# for the two processes that share the tests, and for what they start: two cores
os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"

import pytest

TESTS = Path(__file__).parent


def pytest_itemcollected(item: pytest.Item) -> None:
    """Put a test into its group for `--dist loadgroup`: what a fixture makes is made once."""
    shared = "house" in getattr(item, "fixturenames", ())
    name = "house" if shared else str(item.path.relative_to(TESTS))
    item.add_marker(pytest.mark.xdist_group(name))
