"""What the loop over steps asks of an engine."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol, runtime_checkable

import numpy as np

from ryusa.errors import RunError
from ryusa.model import Scene, State, Tally
from ryusa.model.pieces import RowsInPieces
from ryusa.model.scene import Floats


@dataclass(frozen=True)
class Flags:
    """The first fault of an `advance`, or none: a kernel cannot raise."""

    fault: RunError | None = None  # names grain, partner, step, cause and remedy

    def __bool__(self) -> bool:
        return self.fault is not None

    def raise_if_any(self) -> None:
        """Raise the fault, if there is one."""
        if self.fault is not None:
            raise self.fault


class Engine(Protocol):
    """Steps the grains of a scene.

    Attributes
    ----------
    name : as in the registry; provenance and checkpoints record it.
    """

    @property
    def name(self) -> str:
        """Name by which a user chooses it, such as "cpu"."""
        ...

    def refuses(self, scene: Scene) -> tuple[str, ...]:
        """Reasons why this engine cannot simulate the scene; () when it can."""
        ...

    def load(self, scene: Scene, state: State) -> None:
        """Take a scene and an initial state or a snapshot; also when the timeline changes the scene."""
        ...

    def set_fluid(self, sampled: Floats) -> None:
        """Set the water at every grain, columns of model.fluid by id, held until it is set again.

        The impulse of the fluid on the grains is counted anew from here. A snapshot carries both.
        """
        ...

    def set_walls(self, motion: Floats) -> None:
        """Set the motion of the walls from this step on (model.walls), shape (n_wall, N_MOTION).

        Walls are where they were, and no faster than the scene says; a snapshot does not carry the motion.
        """
        ...

    def kinematics(self) -> tuple[Floats, Floats, Floats]:
        """Centres [m], velocities [m/s] and impulse from the fluid (model.fluid), by id; cheap."""
        ...

    def advance(self, n_steps: int) -> Flags:
        """Do n_steps steps, fewer if a fault stops the run; the state before the fault stays readable."""
        ...

    def grains(self) -> State:
        """Positions and motion of the grains, without contacts or energy account: a frame, not a snapshot."""
        ...

    def state(self) -> State:
        """Read-only snapshot: all that an exact resume needs."""
        ...

    def tally(self) -> Tally:
        """Energy account and extremes, summed while stepping."""
        ...

    def events(self) -> np.ndarray:
        """Contacts ended since the last call: structured array of dtype model.EVENT, in order of parting."""
        ...


@runtime_checkable
class GivesPieces(Protocol):
    """An engine that gives its snapshot piece by piece, for which there need not be memory beside its own."""

    def state_in_pieces(self) -> tuple[State, tuple[RowsInPieces, ...]]:
        """Snapshot without the arrays of grains and contacts, and these by the names of its fields.

        A name within a part has a slash, as "contacts/i". They are read before the next step.
        """
        ...


@runtime_checkable
class SharesColumn(Protocol):
    """An engine of several processes, each with a column of water for the grains that it has.

    The columns (`water.coupling.Coupling`) move alike; that of the process that leads stands for all.
    """

    def couple(self, begin: Callable[..., Any], told: bool) -> Any:
        """Begin a column in every process, and return that of this one.

        Parameters
        ----------
        begin : called with the scene, the ids of the grains in a process, their centres, the water at them
            (model.fluid) and the processes (water.processes), None of one process; can be pickled.
        told : whether the grains know of the water, from a snapshot.
        """
        ...

    def exchange(self) -> None:
        """Let the grains of every process exchange momentum with its column."""
        ...

    def change_column(self) -> None:
        """Let the columns take over the scene that was loaded last."""
        ...

    def kept(self) -> Floats:
        """What the grains keep for the column, columns of model.fluid by id."""
        ...
