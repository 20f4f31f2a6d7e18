"""The column of water of a run: its start, and the steps of an engine between exchanges with it."""

from ryusa.engine.protocol import Engine, Flags
from ryusa.model import Scene, State
from ryusa.water.coupling import Coupling


def started(scene: Scene, engine: Engine, state: State, step: int) -> Coupling | None:
    """The column of water of a scene at its first step, or as a state holds it; None where there is none.

    Parameters
    ----------
    engine : has loaded the state; its grains are told of the water where the state does not hold it.
    step : of the engine.
    """
    column = scene.column
    if column is None:
        return None
    if state.coupling is not None and state.fluid is not None:
        return Coupling.resume(scene, column, column.interval, state.coupling, state.fluid.sampled)
    x, _, _ = engine.kinematics()
    water = Coupling.begin(scene, column, column.interval, x, step=step)
    engine.set_fluid(water.sampled)
    return water


def advanced(engine: Engine, water: Coupling | None, step: int, n_steps: int) -> tuple[int, Flags]:
    """Step the engine, with an exchange between water and grains at each coupling interval.

    Returns
    -------
    step : that the engine has reached, if no fault has stopped it.
    flags : of the call that a fault stopped.
    """
    end = step + n_steps
    while step < end:
        k = (end if water is None else min(end, water.due)) - step
        flags = engine.advance(k)
        if flags:
            return step, flags
        step += k
        if water is not None and step == water.due:
            engine.set_fluid(water.exchange(*engine.kinematics()))
    return step, Flags()
