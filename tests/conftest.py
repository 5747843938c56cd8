"""Two processes share the tests: a file stays together.

Tiers: `pytest` (quick), `pytest -m slow` (the rest of what CI runs: what stands on a whole run, and
what takes long), `pytest -m suite` (long suites on demand). With the arrays' shapes checked, tests
that give a wrong one are left out.
"""

import os
import random
from itertools import groupby
from pathlib import Path

# for the two processes that share the tests, and for what they start: two cores
if "PYTEST_XDIST_WORKER" in os.environ:
    os.environ["OMP_NUM_THREADS"] = "1"  # more threads than cores wait for each other
os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ["OPENBLAS_NUM_THREADS"] = os.environ["OMP_NUM_THREADS"]

import pytest
from hypothesis import HealthCheck, settings

TESTS = Path(__file__).parent

# The same examples in every run, and none judged by the clock of a loaded machine; `drawn` draws
# others each time (.ci/flaky).
patient = {"deadline": None, "suppress_health_check": [HealthCheck.too_slow]}
settings.register_profile("drawn", **patient)
settings.register_profile("repeatable", derandomize=True, **patient)
settings.load_profile("repeatable")


def pytest_addoption(parser: pytest.Parser) -> None:
    told = "files, and the tests of each, in an order drawn from this seed"
    parser.addoption("--shuffle", type=int, metavar="SEED", help=told)
    told = "with --shuffle: so large a part of the files, drawn as well"
    parser.addoption("--part", type=float, default=1.0, metavar="SHARE", help=told)
    told = "write the agreed verdict and report of the small campaign anew"
    parser.addoption("--golden", action="store_true", help=told)


def pytest_configure(config: pytest.Config) -> None:
    if config.getoption("--jaxtyping-packages"):
        import shapes

        shapes.check_outer_functions_at_first()


def pytest_runtest_setup(item: pytest.Item) -> None:
    if item.config.getoption("--jaxtyping-packages"):
        import shapes

        shapes.calls.clear()


def pytest_itemcollected(item: pytest.Item) -> None:
    """Put a test into its group for `--dist loadgroup`: what a fixture makes is made once."""
    path = item.path.relative_to(TESTS)
    item.add_marker(pytest.mark.xdist_group(str(path)))
    if "house" in getattr(item, "fixturenames", ()):
        item.add_marker("slow")
    if path.parts[0] == "unit":
        item.add_marker("unit")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    left_out = set()
    if "suite" not in config.option.markexpr:
        left_out.add("suite")
    if config.getoption("--jaxtyping-packages"):
        left_out.add("wrong_shape")
    gone = [item for item in items if left_out & {mark.name for mark in item.iter_markers()}]
    if gone:
        config.hook.pytest_deselected(items=gone)
        items[:] = [item for item in items if item not in set(gone)]
    if (seed := config.getoption("--shuffle")) is not None:
        draw = random.Random(seed)
        files = [list(group) for _, group in groupby(items, lambda item: item.path)]
        drawn = draw.sample(files, round(config.getoption("--part") * len(files)))
        items[:] = [item for file in drawn for item in draw.sample(file, len(file))]
