"""State of a run: positions, velocities, spins, and all other data that an exact resume needs."""

from dataclasses import dataclass, field

import numpy as np

from ryusa.model.arrays import Bools, Floats
from ryusa.model.contacts import Contacts
from ryusa.model.engine_block import EngineBlock
from ryusa.model.flow import FluidState
from ryusa.model.fluid import FluidAtGrains
from ryusa.model.rigid_bodies import BodyState
from ryusa.model.tally import Tally
from ryusa.printed import ByShape


@dataclass(frozen=True, repr=False)
class State(ByShape):
    """One moment of a run (a snapshot); arrays returned by an engine are read-only.

    The scheme is semi-implicit: `v` and `omega` belong to half a step before `x`.
    """

    x: Floats  # grain centres [m], shape (n_grain, 3), columns (x, y, z), inside the period at the last wrap
    v: Floats  # grain velocities [m/s], shape (n_grain, 3)
    omega: Floats  # spin [rad/s], shape (n_grain, 3); +y rolls downstream (the paper plots it negative)
    step: int = 0  # steps done since the start of the run
    t: float = 0.0  # time of x [s]
    # Periods crossed in x, y
    image: np.ndarray = field(default_factory=lambda: np.zeros((0, 2), dtype=np.int32))
    contacts: Contacts = field(default_factory=Contacts.none)
    tally: Tally | None = None  # energy account and extremes so far; None before the first step
    fluid: FluidAtGrains | None = None  # water at every grain, if there is a water column
    coupling: FluidState | None = None  # state of the water, not used by engines
    # whether each grain is there, shape (n_grain,); empty: all are. x, v and omega of absent ones are nan
    present: Bools = field(default_factory=lambda: np.zeros(0, dtype=np.bool_))
    bodies: BodyState | None = None  # motion of clumps, of which x, v and omega of their members follow
    engine: EngineBlock | None = None  # internal data of the engine that wrote this

    @staticmethod
    def at_rest(x: Floats) -> "State":
        """Grains at rest at `x` [m], shape (n_grain, 3)."""
        x = np.ascontiguousarray(x, dtype=np.float64)
        return State(
            x=x, v=np.zeros_like(x), omega=np.zeros_like(x), image=np.zeros((len(x), 2), dtype=np.int32)
        )

    def block_of(self, engine: str, version: int) -> EngineBlock | None:
        """Internal data of this state, where that engine wrote it.

        Raises
        ------
        ValueError : it is of another version of the engine.
        """
        if self.engine is None or self.engine.engine != engine:
            return None
        self.engine.check(version)
        return self.engine

    @property
    def n_grain(self) -> int:
        """Number of free grains."""
        return len(self.x)


def make_read_only(state: State) -> None:
    """Make all arrays of a snapshot read-only."""
    parts = [state, state.contacts, *(one for one in (state.fluid,) if one is not None)]
    arrays = [one for part in parts for one in vars(part).values() if isinstance(one, np.ndarray)]
    for array in (*arrays, *(state.engine.arrays.values() if state.engine else ())):
        array.flags.writeable = False
