"""What the loop over steps asks of an engine."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ryusa.errors import RunError
from ryusa.model import Scene, State, Tally
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
