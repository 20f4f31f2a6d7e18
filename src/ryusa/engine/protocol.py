"""The narrow seam between the one loop and whatever machine steps the grains."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ryusa.errors import RunError
from ryusa.model import Scene, State, Tally
from ryusa.model.scene import Floats


@dataclass(frozen=True)
class Flags:
    """What a kernel could not say by raising: the first fault of an `advance`, or nothing."""

    fault: RunError | None = None  # names grain, partner, step, cause and remedy

    def __bool__(self) -> bool:
        return self.fault is not None

    def raise_if_any(self) -> None:
        """Raise the fault, if there is one."""
        if self.fault is not None:
            raise self.fault


class Engine(Protocol):
    """A handful of verbs; growing it wants a design note."""

    def refuses(self, scene: Scene) -> tuple[str, ...]:
        """Reasons why this engine cannot carry a law of the scene; () when it can carry all."""
        ...

    def load(self, scene: Scene, state: State) -> None:
        """Take a scene and a fresh state or a snapshot; also when the timeline changes the scene mid-run."""
        ...

    def set_fluid(self, sampled: Floats) -> None:
        """Tell every grain its water, columns of model.fluid, held until told again.

        A snapshot carries it, and the impulse that each grain took since.
        """
        ...

    def kinematics(self) -> tuple[Floats, Floats, Floats]:
        """Centres [m], velocities [m/s] and what was taken from the water (model.fluid), by id; cheap."""
        ...

    def advance(self, n_steps: int) -> Flags:
        """Do n_steps steps, fewer if a fault stops the run; the state before the fault stays readable."""
        ...

    def grains(self) -> State:
        """Where grains are and how they move, no contacts and no books: a frame, not enough to go on from."""
        ...

    def state(self) -> State:
        """Read-only snapshot: all that an exact resume needs."""
        ...

    def tally(self) -> Tally:
        """Energy account and extremes, summed while stepping."""
        ...

    def events(self) -> np.ndarray:
        """Contacts ended since last asked: structured array of dtype model.EVENT, in order of ending step."""
        ...
