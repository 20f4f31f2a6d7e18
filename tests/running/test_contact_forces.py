"""Recorded contact forces: they move the grains, carry their weight, and survive a stop."""

import math
import os
import signal
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ryusa.build import scene as scene_of
from ryusa.errors import ResultsError
from ryusa.laws.families import ContactTiming
from ryusa.model import Scene, State
from ryusa.model.contacts import Contacts
from ryusa.results import Results
from ryusa.running import loop
from ryusa.running.recorder import RecordedSoFar, Recorder
from ryusa.running.runner import run_scene
from ryusa.running.stops import Stop

D = 0.002


def heap(plane: bool, timing: ContactTiming = ContactTiming.EXACT) -> tuple[Scene, State]:
    """Twelve grains that fall with spin on a slope of fixed grains, between walls if in a plane."""
    rng = np.random.default_rng(3)
    side = np.arange(3) * 1.05 * D
    x = np.stack(np.meshgrid(side, [0.0] if plane else side[:2], side[:2] + 0.97 * D), axis=-1).reshape(-1, 3)
    bed = np.stack(np.meshgrid(np.arange(4) * D, [0.0] if plane else np.arange(4) * D, [0.0]), axis=-1)
    scene, state = scene_of(
        x=x + np.array([0.6 * D, 0.0, 0.0]),
        d=np.full(len(x), D),
        v=rng.normal(size=x.shape) * (0.1, 0.0 if plane else 0.1, 0.1),
        omega=rng.normal(size=x.shape) * (0.0 if plane else 60.0, 60.0, 0.0 if plane else 60.0),
        x_fixed=bed.reshape(-1, 3),
        planes=[("wall", (0.05 * D, 0, 0), (1, 0, 0)), ("far", (3.25 * D, 0, 0), (-1, 0, 0))],
        period=(math.inf, math.inf if plane else 4.0 * D),
        slope=0.3,
        plane_case=plane,
        timing=timing,
        steps_per_contact=20.0,
    )
    return replace(scene, forces=True), state


@pytest.mark.full
@pytest.mark.parametrize("plane", [True, False])
def test_recorded_forces_and_gravity_are_what_accelerates_the_grains(tmp_path: Path, plane: bool) -> None:
    # with exact timing half of a dashpot acts between two steps
    scene, state = heap(plane, ContactTiming.AT_STEPS)
    results = run_scene(
        scene, state, tmp_path / "run", frames=scene.dt, stop=Stop(time=4000 * scene.dt), progress=False
    )
    seen = 0
    partners: set[int] = set()
    for k in range(1, len(results.frames)):
        f = results.contact_forces(k)
        net = scene.m[:, None] * scene.gravity
        np.add.at(net, f["i"], f["force"])
        both = f["j"] < scene.n_grain
        np.add.at(net, f["j"][both], -f["force"][both])
        change = scene.m[:, None] * (results.frames.v[k] - results.frames.v[k - 1]) / scene.dt
        most = np.abs(f["force"]).max(initial=0.0) + scene.m[0] * 9.8
        assert np.abs(change - net).max() < 1e-8 * most
        seen += len(f)
        partners |= set(f["j"].tolist())
    n, n_all = scene.n_grain, scene.n_grain + scene.n_fixed
    assert seen > 500
    assert any(j < n for j in partners)
    assert any(n <= j < n_all for j in partners)
    assert any(j >= n_all for j in partners)


def test_forces_survive_a_stop_and_are_the_same_as_without_it(tmp_path: Path, monkeypatch: Any) -> None:
    scene, state = heap(False)
    how: dict[str, Any] = {"frames": 50 * scene.dt, "stop": Stop(time=3000 * scene.dt), "progress": False}
    whole = run_scene(scene, state, tmp_path / "whole", **how)
    advance, at = loop.Loop._advance, [1480]

    def watched(self: Any, n_steps: int) -> None:
        advance(self, n_steps)
        if at and self._step >= at[0]:
            at.clear()
            os.kill(os.getpid(), signal.SIGTERM)

    monkeypatch.setattr(loop.Loop, "_advance", watched)
    monkeypatch.setattr(loop.Loop, "_chunk", lambda self: 37)
    assert run_scene(scene, state, tmp_path / "run", **how).status == "stopped"
    again = run_scene(scene, state, tmp_path / "run", **how, resume=True)
    assert len(again.frames) == len(whole.frames)
    for k in range(len(whole.frames)):
        np.testing.assert_array_equal(again.contact_forces(k), whole.contact_forces(k))


def test_forces_that_wait_in_the_buffer_are_kept_by_a_checkpoint(tmp_path: Path, tally: Any) -> None:
    scene, state = heap(False)
    held = Contacts.none()
    pair = {"i": np.array([0, 1]), "j": np.array([5, 13]), "f_n": np.array([2.0, 3.0])}
    shapes = {name: np.zeros((2, *one.shape[1:])) for name, one in vars(held).items()}
    pressed = replace(state, contacts=replace(held, **shapes | pair))
    folder = tmp_path / "run"
    folder.mkdir()
    (folder / "provenance.json").write_text('{"format": 2, "ryusa": "0", "status": "running"}')
    first = Recorder(folder, scene)
    for k, one in enumerate((pressed, state, pressed)):
        first.frame(replace(one, step=k, t=k * 1e-3), tally(k * 1e-3))
    block = first.to_block()
    earlier = RecordedSoFar([], [(0.0, scene)], n_frame=3, buffered=block.arrays)
    again = Recorder(folder, scene, earlier=earlier)
    again.frame(replace(pressed, step=3, t=3e-3), tally(3e-3))
    again.flush()
    results = Results.open(folder)
    assert [len(results.contact_forces(k)) for k in range(4)] == [2, 0, 2, 2]
    for k in (0, 2, 3):
        f = results.contact_forces(k)
        assert f["j"].tolist() == [5, 13]
        np.testing.assert_allclose(np.linalg.norm(f["force"], axis=1), [2.0, 3.0])


def test_a_run_without_forces_names_the_key_that_records_them(tmp_path: Path) -> None:
    scene, state = heap(True)
    bare = replace(scene, forces=False)
    results = run_scene(
        bare, state, tmp_path / "run", frames=scene.dt, stop=Stop(time=5 * scene.dt), progress=False
    )
    with pytest.raises(ResultsError, match=r"record\.forces=true"):
        results.contact_forces(0)
    assert Results.open(tmp_path / "run").complete
