"""What the rest of ryusa knows of water that moves: one protocol, whatever its kind."""

from abc import abstractmethod
from collections.abc import Mapping
from typing import Any, Protocol, Self

import numpy as np
from numpy.typing import NDArray

from ryusa.model import FluidState, Scene
from ryusa.model.arrays import Floats


class Fluid(Protocol):
    """Water of a run that exchanges momentum with its grains once per interval of steps.

    Cells, bottom and ends are those of the `flow` of the scene; `water.kinds` has what moves in which.

    Attributes
    ----------
    steps : steps of the engine in the present interval.
    due : step of the engine at which the next exchange is due.
    sampled : water at the grains as given last, columns of `model.fluid`, shape (n_grain, N_SAMPLED).
    """

    steps: int
    due: int
    sampled: Floats

    @staticmethod
    @abstractmethod
    def begin(scene: Scene, flow: Any, /, x: Floats, step: int = 0, threads: int = 1) -> "Fluid":
        """Fill the flow of a scene with its first water.

        Parameters
        ----------
        flow : of the scene; of the kind that this moves in.
        x : centres of the grains [m], shape (n_grain, 3); nan for one that is away.
        step : of the engine.
        threads : share the loops over grains; the bits do not depend on them.

        Raises
        ------
        ValueError : the flow is not valid.
        WaterError : no first water was found.
        """
        ...

    @staticmethod
    @abstractmethod
    def resume(
        scene: Scene, flow: Any, found: Any, /, sampled: Floats | None = None, threads: int = 1
    ) -> "Fluid":
        """Go on from a snapshot of this kind, and the water at the grains with it; else as `begin`."""
        ...

    @abstractmethod
    def exchange(self, x: Floats, v: Floats, impulse: Floats) -> Floats:
        """Give the water what the grains took in the interval, move it on, and tell the grains anew.

        Parameters
        ----------
        x, v : centres and velocities of the grains now [m], [m/s], shape (n_grain, 3); nan for one that is
            away.
        impulse : what each took from the water in the interval, columns of `model.fluid`.

        Returns
        -------
        sampled : as the attribute.

        Raises
        ------
        WaterError : the water cannot be moved on, or drag acts faster than a step resolves.
        RunError : a grain is at no place that the water can be cut at.
        """
        ...

    def finish(self, step: int, x: Floats, v: Floats, impulse: Floats) -> None:
        """End the interval at this step, before the next exchange is due; else as `exchange`."""
        if step > self.due - self.steps:  # grains have moved since the last exchange
            self.steps, self.due = self.steps - (self.due - step), step
            self.exchange(x, v, impulse)

    @abstractmethod
    def among(self, x: Floats, step: int) -> Self:
        """The same water at a step at which grains have entered or left, just after an exchange.

        Parameters
        ----------
        x : centres of the grains now [m], shape (n_grain, 3); nan for one that is away.
        step : of the engine; the next exchange is due one later, as the drag on those that entered is not
            known yet, but an interval later where their flux begins with a pressure.
        """
        ...

    def ends_with(self, after: Scene) -> bool:
        """Whether its interval has to end before the timeline makes the scene this one."""
        del after
        return False

    @abstractmethod
    def change(self, scene: Scene) -> None:
        """Take over a scene that the timeline changed: its slope, its ends, or removed fixed grains."""
        ...

    @abstractmethod
    def snapshot(self, kept: Floats | None = None) -> FluidState:
        """All that an exact resume needs, beside the water at the grains.

        Parameters
        ----------
        kept : what goes with the grains, of all processes that share them, columns of `model.fluid` by id.
        """
        ...

    @abstractmethod
    def frame(self) -> Mapping[str, NDArray[Any]]:
        """What a run folder keeps of it at a frame: the fields of `scene.flow`."""
        ...

    @abstractmethod
    def surface_at(self, x: Floats) -> Floats:
        """Height of the surface over z = 0 at places along x [m], same shape."""
        ...

    def refuse_lost(self, x: Floats, grains: NDArray[np.int64], step: int, t: float) -> None:
        """Raise a `GrainLost` for a grain where there is no water to be in.

        Parameters
        ----------
        x : centres of spheres and clumps [m], nan where one is away, shape (n, 3).
        grains : their ids, shape (n,).
        step, t : of the engine now, its time [s].
        """
        del x, grains, step, t

    @property
    def bed_at_inlet(self) -> float:
        """Thickness of the bed where water and grains enter [m]; 0 where none do."""
        return 0.0

    @property
    @abstractmethod
    def text(self) -> str:
        """State in a line, for the progress of a run without grains."""
        ...

    @abstractmethod
    def numbers(self) -> dict[str, float | int]:
        """State for the summary of a run; SI."""
        ...

    @abstractmethod
    def warnings(self) -> list[str]:
        """Warnings, one sentence each."""
        ...
