"""A small scene, and an engine that only lets grains fall, for tests of recorder, loop and stops."""

import math
import os
import signal
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from ryusa.engine.protocol import Flags
from ryusa.errors import RunError
from ryusa.model import EVENT, ContactLaw, Scene, State, Tally, Term
from ryusa.model.tally import N_TERM
from ryusa.running import loop

DROP = """
[grains]
diameter = "0.2 cm"
density = "2650 kg/m3"
[contact]
stiffness = { overlap = 0.01, speed = "0.6 m/s" }
restitution = 0.7
friction_angle = "30 deg"
[motion]
rotation = "locked"
[build]
kind = "drop"
height = "1 cm"
[stop]
time = "0.01 s"
"""


def make_scene(n: int = 3, **changes: object) -> Scene:
    d = np.full(n, 2e-3)
    m = 2650 * math.pi / 6 * d**3
    scene = Scene(
        d=d,
        m=m,
        m_added=np.zeros(n),
        m_weight=m,
        inertia=m * d**2 / 10,
        x_fixed=np.array([[0.001, 0.0, 0.001], [0.003, 0.0, 0.001]]),
        d_fixed=np.full(2, 2e-3),
        fixed_active=np.ones(2, bool),
        plane_normal=np.array([[0.0, 0.0, 1.0]]),
        plane_point=np.zeros((1, 3)),
        plane_active=np.ones(1, bool),
        contact=ContactLaw(1e4, 2857.0, 0.5, e_n=0.7, e_s=0.7, zeta_n=0.12),
        dt=1e-5,
        period=(0.04, math.inf),
        gravity=np.array([0.0, 0.0, -9.8]),
    )
    return replace(scene, **changes)  # type: ignore[arg-type]


def make_tally(t: float = 0.0, overlap_max: float = 0.004, speed_max: float = 1.0) -> Tally:
    return Tally(t, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, (0.0,) * N_TERM, overlap_max, 0, 0, speed_max, 1.0, 1)


def make_event(i: int, j: int, t_begin: float, t_part: float, **columns: object) -> np.ndarray:
    event = np.zeros(1, dtype=EVENT)
    event["i"], event["j"], event["t_begin"], event["t_end"], event["t_part"] = i, j, t_begin, t_part, t_part
    event["closing_begin"], event["closing_end"], event["alone"] = 1.0, -0.7, 1.0
    for name, value in columns.items():
        event[name] = value
    return event


class FallingGrains:
    """An engine in which nothing touches: x(step) is known; events and faults are put in by the test."""

    name = "falling grains"

    def __init__(self) -> None:
        self.fault_at: int | None = None
        self.events_at: dict[int, np.ndarray] = {}
        self.speed: Callable[[int], float] = lambda step: 1.0
        self.on_advance: Callable[[int], None] = lambda step: None
        self.loaded: list[tuple[int, Scene]] = []
        self.calls: list[int] = []

    def refuses(self, scene: Scene) -> tuple[str, ...]:
        return ("no rolling friction here",) if scene.rolling.model else ()

    def load(self, scene: Scene, state: State) -> None:
        self.loaded.append((state.step, scene))
        self.scene, self._state = scene, state

    def advance(self, n_steps: int) -> Flags:
        self.calls.append(n_steps)
        step = self._state.step
        flags = Flags()
        if self.fault_at is not None and step + n_steps > self.fault_at:
            n_steps = self.fault_at - step
            flags = Flags(RunError("made to fail", grain=1, step=self.fault_at, t=0.0, hint="Do not."))
        self._begun, step = step, step + n_steps
        self._state = replace(self._state, step=step, t=step * self.scene.dt, x=self.position(step))
        self.on_advance(step)
        return flags

    def position(self, step: int) -> np.ndarray:
        return np.full((self.scene.n_grain, 3), float(step)) + np.arange(self.scene.n_grain)[:, None] / 8

    def state(self) -> State:
        return self._state

    def grains(self) -> State:
        return self.state()

    def tally(self) -> Tally:
        tally = make_tally(self._state.t, speed_max=self.speed(self._state.step))
        terms = [0.0] * N_TERM
        terms[Term.START] = tally.held
        return replace(tally, terms=tuple(terms))

    def events(self) -> np.ndarray:
        due = [self.events_at.pop(k) for k in sorted(self.events_at) if k <= self._state.step]
        return np.concatenate(due) if due else np.zeros(0, dtype=EVENT)


@pytest.fixture
def scene() -> Scene:
    return make_scene()


@pytest.fixture
def state(scene: Scene) -> State:
    return State.at_rest(np.zeros((scene.n_grain, 3)))


@pytest.fixture
def engine() -> FallingGrains:
    return FallingGrains()


@pytest.fixture
def event() -> Callable[..., np.ndarray]:
    return make_event


@pytest.fixture
def tally() -> Callable[..., Tally]:
    return make_tally


@pytest.fixture
def scene_with() -> Callable[..., Scene]:
    return make_scene


@pytest.fixture
def stop_at(monkeypatch: pytest.MonkeyPatch) -> Any:
    """Send a signal once the loop has passed a step, in calls of 37 steps."""
    asked: list[tuple[int, signal.Signals]] = []
    advance = loop.Loop._advance

    def watched(self: Any, n_steps: int) -> None:
        advance(self, n_steps)
        while asked and self._step >= asked[0][0]:
            os.kill(os.getpid(), asked.pop(0)[1])

    monkeypatch.setattr(loop.Loop, "_advance", watched)
    monkeypatch.setattr(loop.Loop, "_chunk", lambda self: 37)
    return lambda step, number=signal.SIGTERM: asked.append((step, number))
