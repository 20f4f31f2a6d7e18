from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from ryusa.build import scene
from ryusa.build.walls import WallMotion, rectangle, with_walls
from ryusa.casefile.read import read
from ryusa.cases import case_path
from ryusa.report.brief import brief_page
from ryusa.report.page import report_page
from ryusa.results import Results
from ryusa.running.runner import run, run_scene
from ryusa.running.stops import Stop

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
def report(three: Results, saltation: Results) -> str:
    """The page about both."""
    return report_page([three, saltation], size=5.0e6)


@pytest.fixture(scope="session")
def brief(saltation: Results) -> str:
    """The sheet about grains that hop."""
    return brief_page([saltation])
