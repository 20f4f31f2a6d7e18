"""What the water of a run moves in, whatever its kind, and the fields that a run keeps of it."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any, ClassVar, NamedTuple, Protocol, Self

from ryusa.model.arrays import Floats
from ryusa.printed import ByShape


class Field(NamedTuple):
    """What a run folder keeps of the water at each frame under one name."""

    unit: str  # SI
    at: tuple[str, ...] = ()  # its axes, names of `Flow.places`; none: one number


class FluidState(Protocol):
    """State of the water between two exchanges: a dataclass of numbers, arrays and such dataclasses.

    An array is annotated with its axes: names of `Flow.places`, "grain", or lengths. With the water at the
    grains (`model.fluid`) it is complete for a resume.
    """

    @property
    def steps(self) -> int:
        """Steps of the engine in the present coupling interval."""
        ...

    @property
    def due(self) -> int:
        """Step of the next exchange."""
        ...

    def fault(self, touched: int) -> str:
        """Why this is no state of a water that so many grains touch; "" where it is one."""
        ...


class Flow(ByShape, ABC):
    """What water that feels the grains moves in: cells, bottom, ends, closures; fixed while the scene is."""

    GROUP: ClassVar[str]  # of its datasets in a run folder

    @property
    @abstractmethod
    def text(self) -> str:
        """What it is, in words."""

    @abstractmethod
    def account(self, found: Mapping[str, Any]) -> str:
        """What is said at the end of a run of the numbers in its summary."""

    @property
    @abstractmethod
    def interval(self) -> int:
        """Largest coupling interval [steps]."""

    @property
    @abstractmethod
    def places(self) -> Mapping[str, int]:
        """How many places of each kind it has, such as cells."""

    @abstractmethod
    def fields(self) -> Mapping[str, Field]:
        """What a run folder keeps of the water at a frame, by name."""

    @abstractmethod
    def first_surface(self, x: Floats) -> Floats:
        """Height of the surface at the start at places along x [m], same shape; -inf if not given."""

    @abstractmethod
    def tilted(self, g_x: float, g_z: float) -> Self:
        """The same with another gravity along and normal to the x axis [m/s2]."""

    def frame_shapes(self) -> dict[str, tuple[int, ...]]:
        """Shapes of the fields of a frame."""
        places = self.places
        return {name: tuple(places[one] for one in field.at) for name, field in self.fields().items()}
