"""Compile ahead what a run of a case compiles: the run is begun in a temporary folder and left at once."""

import os
from dataclasses import replace
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from ryusa.compiled import waiting
from ryusa.compiled.waiting import Done
from ryusa.model import Scene
from ryusa.running.runner import run_scene
from ryusa.running.stops import Stop
from ryusa.running.timeline import Change

if TYPE_CHECKING:
    from ryusa.casefile.case import Case

_STEPS = 8  # between two instants at which grains enter and leave
_ENOUGH = 100_000  # particle-steps, after which grains that move have been listed anew


def warm(case: "Case | str | os.PathLike[str]", *, threads: int = 1) -> Done:
    """Compile what a run of a case compiles, unless the store has it.

    The grains take the steps that ask for every kernel: to list and prune pairs, to step, to exchange with
    the water, to record and to write a checkpoint. Feeds begin at once, and each entry of the timeline
    follows the one before after a few steps.

    Parameters
    ----------
    case : a checked case, from `ryusa.load`, or the path of a case file.
    threads : threads of the CPU engine.

    Returns
    -------
    done : what was compiled; no function where the store has all.

    Raises
    ------
    CaseError, RunError : as a run of the case.
    """
    from ryusa.build import build, change
    from ryusa.casefile import derive

    before = waiting.done()
    if isinstance(case, str | os.PathLike):
        from ryusa.casefile.read import read

        case = read(Path(case))
    built = build(case, derive(case))
    scene = _fed_at_once(built.scene)
    stretch = _stretch(scene)
    begin = built.state.t - built.state.step * scene.dt
    changes = [
        Change(begin + (k + 1) * stretch * scene.dt, partial(change, case, entry=entry))
        for k, entry in enumerate(case.timeline)
    ]
    end = begin + (len(changes) + 1) * stretch * scene.dt
    with TemporaryDirectory(prefix="ryusa-warm-") as folder:
        run_scene(
            scene, built.state, Path(folder) / "run", frames=stretch * scene.dt, stop=Stop(time=end),
            changes=changes, threads=threads, progress=False,
        )  # fmt: skip
    return waiting.done().since(before)


def _stretch(scene: Scene) -> int:
    """Steps in which every kernel of a scene is asked for."""
    exchange = 0 if scene.flow is None else scene.flow.interval
    return max(2 * _STEPS, exchange + 1, _ENOUGH // max(scene.n_grain, 1))


def _fed_at_once(scene: Scene) -> Scene:
    """The scene whose feeds begin with the run, and where grains enter and leave after a few steps."""
    traffic = scene.traffic
    if traffic is None:
        return scene
    arrivals = traffic.arrivals
    if arrivals is not None and len(arrivals.t):
        arrivals = replace(arrivals, t=arrivals.t - arrivals.t[0])
    feeds = tuple(replace(one, begin=0.0) for one in traffic.feeds)
    return replace(scene, traffic=replace(traffic, feeds=feeds, arrivals=arrivals, interval=_STEPS))
