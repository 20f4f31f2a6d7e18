"""A run folder of 23 frames in four parts, two grains, written by the recorder."""

import math
from pathlib import Path

import numpy as np
import pytest

from ryusa.build import scene as build_scene
from ryusa.model import EVENT, State, Tally
from ryusa.model.tally import N_TERM
from ryusa.running.recorder import Recorder

PERIOD = 0.04
N_FRAME = 23


def position(k: int) -> np.ndarray:
    """Wrapped centres of frame k [m]."""
    return np.array([[0.01 + 1e-4 * k, 0.0, 0.01], [0.02, 0.0, 0.01 + 1e-4 * k]])


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    run = tmp_path / "run"
    run.mkdir()
    (run / "provenance.json").write_text('{"format": 2, "ryusa": "0.1.0", "status": "complete"}')
    (run / "case.json").write_text('{"title": "two grains", "record": {"settle": 0.5}}')
    (run / "summary.json").write_text('{"steps": 230}')
    scene, _ = build_scene(
        x=position(0),
        d=[0.002, 0.003],
        x_fixed=[[0.0, 0.0, 0.0]],
        planes=[("floor", (0, 0, -0.01), (0, 0, 1))],
        period=(PERIOD, math.inf),
    )
    recorder = Recorder(run, scene)
    for k in range(N_FRAME):
        x = position(k)
        image = np.array([[k // 10, 0], [0, 0]], dtype=np.int32)
        state = State(x=x, v=x * 2, omega=-x, step=10 * k, t=0.1 * k, image=image)
        recorder.frame(
            state, Tally(0.1 * k, float(k), 0, 0, 0, 0, 0, (0.0,) * N_TERM, 0.004, 1, 7, 1.0, 2.0, 3)
        )
        if k in {0, 1, 12}:
            event = np.zeros(1, dtype=EVENT)
            event["t_part"], event["i"] = 10.0 - k, k
            recorder.contacts(event)
            recorder.flush()
    recorder.flush()
    return run
