"""Settings of all tests, the quick level (`--quick` leaves out what is marked `full`), and the browser."""

import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings

os.environ["RYUSA_KERNELS"] = "native"  # what is tested is compiled from this source, whatever is installed
os.environ["RYUSA_RUN_TIMES"] = "off"  # no estimate depends on what this machine has run

# With new examples on every run one run of the suite fails and the next passes; `make fuzz` looks further.
# No deadline: first calls compile, and machines are shared.
settings.register_profile("ryusa", deadline=None, derandomize=True)
settings.register_profile("random", deadline=None)  # pytest --hypothesis-profile=random
settings.load_profile("ryusa")


if os.environ.get("PYTEST_XDIST_WORKER"):  # there is a process for each core already
    from ryusa.compiled import beside

    beside.cores = lambda: 1


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--quick", action="store_true", help="without tests marked `full`, and only the kernels of make test"
    )


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave out what is marked `full`."""
    if not config.getoption("quick"):
        return
    left_out = [item for item in items if item.get_closest_marker("full")]
    config.hook.pytest_deselected(items=left_out)
    items[:] = [item for item in items if not item.get_closest_marker("full")]


def pytest_collection_finish(session: pytest.Session) -> None:
    """Let no test of the quick level ask for a kernel of another one (tests/kernel_variants.py)."""
    if session.config.getoption("quick"):
        from tests.kernel_variants import confined

        from ryusa.engine.cpu import engine

        engine.PiecesOfStep = confined(engine.PiecesOfStep)


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    """A Chromium; where there is none, skipped, unless RYUSA_BROWSER says that there must be one."""
    from tests.accessible import MISSING, chromium, chromium_path

    if chromium_path() is None:
        assert "RYUSA_BROWSER" not in os.environ, f"RYUSA_BROWSER is set, but there is {MISSING}"
        pytest.skip(f"{MISSING}; the pages are not opened")
    with chromium() as started:
        yield started


@pytest.fixture
def faults_of(browser: Any) -> Callable[[Path], list[Any]]:
    """What axe-core finds wrong on a page that lies on the disk, in light and in dark."""
    from tests.accessible import faults_of_page

    return lambda path: faults_of_page(browser, path)
