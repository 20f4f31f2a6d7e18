import os
import shutil
from collections.abc import Iterator
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from ryusa.build import scene
from ryusa.build.walls import WallMotion, rectangle, with_walls
from ryusa.casefile.read import read
from ryusa.cases import case_path
from ryusa.results import Results
from ryusa.running.runner import run, run_scene
from ryusa.running.stops import Stop

CHROMIUM = ("chromium", "chromium-browser", "google-chrome")
PERIOD = 0.04  # m
V = np.array([[0.1, 0.0, 0.0], [0.2, 0.0, 0.0], [0.0, 0.0, 0.1]])
X = np.array([[0.010, 0.010, 0.010], [0.036, 0.020, 0.010], [0.020, 0.030, 0.020]])
D = np.array([0.004, 0.002, 0.004])


@pytest.fixture(scope="session")
def saltation(tmp_path_factory: pytest.TempPathFactory) -> Results:
    """Grains that hop over a bed within a period, under a given profile of water."""
    folder = tmp_path_factory.mktemp("view") / "saltation"
    changes = {"build.starts": "3", "stop.time": "0.3 s", "record.frames": "4 ms", "record.settle": "0 s"}
    return run(read(case_path("saltation.toml"), changes), folder, progress=False)


@pytest.fixture(scope="session")
def flight() -> SimpleNamespace:
    """Where the grains of `three` begin, how fast and how large they are; the period [m]."""
    return SimpleNamespace(x=X, v=V, d=D, period=PERIOD)


@pytest.fixture(scope="session")
def three(tmp_path_factory: pytest.TempPathFactory) -> Results:
    """Three grains in free flight over a plane; grain 1 crosses the side of the period at 0.02 s."""
    flying, state = scene(
        X, D, v=V, gravity=0.0, period=(PERIOD, PERIOD), planes=[("floor", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0))],
        x_fixed=np.array([[0.02, 0.02, 0.002]]), d_fixed=np.array([0.004]),
    )  # fmt: skip
    folder = tmp_path_factory.mktemp("view") / "three"
    return run_scene(flying, state, folder, frames=0.01, stop=Stop(time=0.1), progress=False)


@pytest.fixture(scope="session")
def dragged(three: Results) -> Results:
    """`three`, as if under a lid as long as the period that is dragged by 1.3 periods in the run."""
    lid = rectangle("lid", (0.0, 0.0, 0.03), (PERIOD, 0.0, 0.0), (0.0, PERIOD, 0.0))
    found = Results.open(three.folder)
    found.scene = with_walls(found.scene, [replace(lid, motion=WallMotion(velocity=(13 * PERIOD, 0.0, 0.0)))])
    found.scenes = [(0, 0.0, found.scene)]
    return found


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    """A Chromium; where there is none, skipped, unless RYUSA_BROWSER says that there must be one."""
    path = next(
        (
            found
            for name in ("chromium", "chromium-browser", "google-chrome")
            if (found := shutil.which(name))
        ),
        None,
    )
    if path is None:
        assert "RYUSA_BROWSER" not in os.environ, (
            "RYUSA_BROWSER is set, but neither chromium nor google-chrome is there"
        )
        pytest.skip("no Chromium on this machine (apt install chromium); the pages are not opened")
    from playwright.sync_api import sync_playwright

    with sync_playwright() as play:
        # drawn by the processor, so that no graphics card is needed; no sandbox, since root has none
        started = play.chromium.launch(
            executable_path=path,
            args=["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
        )
        yield started
        started.close()
