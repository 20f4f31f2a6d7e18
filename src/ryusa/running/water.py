"""The column or row of columns of a run: its start, and the steps of an engine between exchanges with it.

An engine of several processes has a column in each of them; that of the process that leads is the one here.
"""

from functools import partial
from typing import Any

import numpy as np

from ryusa.engine.protocol import Engine, Flags, SharesColumn
from ryusa.model import CouplingState, RowCouplingState, Scene, State
from ryusa.model.row import EndKind
from ryusa.model.scene import Floats
from ryusa.water.coupling import Coupling
from ryusa.water.processes import SharingProcesses
from ryusa.water.row_coupling import RowCoupling

RunWater = Coupling | RowCoupling


def started(scene: Scene, engine: Engine, state: State, step: int, threads: int = 1) -> RunWater | None:
    """The water of a scene at its first step, or as a state holds it; None where there is none.

    Parameters
    ----------
    engine : has loaded the state; its grains are told of the water where the state does not hold it.
    step : of the engine.
    threads : share the exchange between grains and a row of columns; the bits do not depend on them.
    """
    column = scene.column
    if scene.row is not None:
        found = state.coupling
        if isinstance(found, RowCouplingState):
            told = None if state.fluid is None else state.fluid.sampled
            return RowCoupling.resume(scene, scene.row, found, told, threads)
        row = RowCoupling.begin(scene, scene.row, engine.kinematics()[0], step, threads)
        engine.set_fluid(row.sampled)
        return row
    if column is None:
        return None
    found = state.coupling if state.fluid is not None else None
    assert not isinstance(found, RowCouplingState)
    if isinstance(engine, SharesColumn):
        return engine.couple(partial(_in_process, step, found), told=found is not None)
    if found is not None and state.fluid is not None:
        return Coupling.resume(scene, column, column.interval, found, state.fluid.sampled)
    x, _, _ = engine.kinematics()
    water = Coupling.begin(scene, column, column.interval, x, step=step)
    engine.set_fluid(water.sampled)
    return water


def _in_process(
    step: int, found: CouplingState | None, scene: Scene, ids: np.ndarray, x: Floats, sampled: Floats,
    processes: SharingProcesses | None,
) -> Coupling:  # fmt: skip
    """The column for the grains of one of several processes."""
    column = scene.column
    assert column is not None
    of_process: dict[str, Any] = {"ids": ids, "processes": processes}
    if found is not None:
        return Coupling.resume(scene, column, column.interval, found, sampled, **of_process)
    return Coupling.begin(scene, column, column.interval, x, step=step, **of_process)


def advanced(engine: Engine, water: RunWater | None, step: int, n_steps: int) -> tuple[int, Flags]:
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


def finish_before(engine: Engine, water: RunWater, step: int, after: Scene) -> None:
    """End the interval of a row before its discharge or level changes, so that each acts in its own time."""
    before = water.scene.row
    if not isinstance(water, RowCoupling) or before is None or after.row is None:
        return
    ends, below = (before.upstream, after.row.upstream), (before.downstream, after.row.downstream)
    if (ends[0] and ends[1] and ends[0].discharge != ends[1].discharge) or (
        below[0] and below[1] and below[0].kind is EndKind.LEVEL and below[0].level != below[1].level
    ):
        water.finish(step, *engine.kinematics())
        engine.set_fluid(water.sampled)


def changed(engine: Engine, water: RunWater, scene: Scene) -> None:
    """Let the water take over a scene that the timeline changed and the engine has loaded."""
    if isinstance(water, RowCoupling):
        assert scene.row is not None
        water.change(scene, scene.row)
    elif isinstance(engine, SharesColumn):
        engine.change_column()
    elif scene.column is not None:
        water.change(scene, scene.column)


def snapshot(engine: Engine, water: RunWater) -> CouplingState | RowCouplingState:
    """State of the water, for an exact resume."""
    if isinstance(water, RowCoupling):
        return water.snapshot()
    return water.snapshot(engine.kept() if isinstance(engine, SharesColumn) else None)
