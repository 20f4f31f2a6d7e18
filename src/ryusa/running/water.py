"""The water of a run: its start, and the steps of an engine between exchanges with it.

An engine of several processes has a column in each of them; that of the process that leads is the one here.
"""

from functools import partial
from typing import Any

import numpy as np

from ryusa.engine.protocol import Engine, Flags, SharesColumn
from ryusa.model import FluidState, Scene, State
from ryusa.model.arrays import Floats
from ryusa.water.coupling import Coupling
from ryusa.water.kinds import KINDS
from ryusa.water.processes import SharingProcesses
from ryusa.water.protocol import Fluid


def started(scene: Scene, engine: Engine, state: State, step: int, threads: int = 1) -> Fluid | None:
    """The water of a scene at its first step, or as a state holds it; None where there is none.

    Parameters
    ----------
    engine : has loaded the state; its grains are told of the water where the state does not hold it.
    step : of the engine.
    threads : share the exchange between grains and a row of columns; the bits do not depend on them.
    """
    if scene.flow is None:
        return None
    found, told = state.coupling, None if state.fluid is None else state.fluid.sampled
    if isinstance(engine, SharesColumn):
        return engine.couple(partial(_in_process, step, found), told=found is not None)
    kind = KINDS[type(scene.flow)].fluid
    if found is not None:
        return kind.resume(scene, scene.flow, found, told, threads)
    water = kind.begin(scene, scene.flow, engine.kinematics()[0], step, threads)
    engine.set_fluid(water.sampled)
    return water


def _in_process(
    step: int, found: Any, scene: Scene, ids: np.ndarray, x: Floats, sampled: Floats,
    processes: SharingProcesses | None,
) -> Fluid:  # fmt: skip
    """The column for the grains of one of several processes."""
    assert scene.column is not None
    if found is not None:
        return Coupling.resume(scene, scene.column, found, sampled, ids=ids, processes=processes)
    return Coupling.begin(scene, scene.column, x, step, ids=ids, processes=processes)


def advanced(engine: Engine, water: Fluid | None, step: int, n_steps: int) -> tuple[int, Flags]:
    """Step the engine, with an exchange between water and grains at each coupling interval.

    Returns
    -------
    step : that the engine has reached, if no fault has stopped it.
    flags : of the call that a fault stopped.
    """
    end, shared = step + n_steps, engine if isinstance(engine, SharesColumn) else None
    while step < end:
        k = (end if water is None else min(end, water.due)) - step
        flags = engine.advance(k)
        if flags:
            return step, flags
        step += k
        if water is not None and step == water.due:
            if shared is None:
                engine.set_fluid(water.exchange(*engine.kinematics()))
            else:
                shared.exchange()
    return step, Flags()


def finish_before(engine: Engine, water: Fluid, step: int, after: Scene) -> None:
    """End an interval before the timeline makes the scene another one, where the water needs that."""
    if water.ends_with(after):
        water.finish(step, *engine.kinematics())
        engine.set_fluid(water.sampled)


def changed(engine: Engine, water: Fluid, scene: Scene) -> None:
    """Let the water take over a scene that the timeline changed and the engine has loaded."""
    if isinstance(engine, SharesColumn):
        engine.change_column()
    else:
        water.change(scene)


def snapshot(engine: Engine, water: Fluid) -> FluidState:
    """State of the water, for an exact resume."""
    return water.snapshot(engine.kept() if isinstance(engine, SharesColumn) else None)
