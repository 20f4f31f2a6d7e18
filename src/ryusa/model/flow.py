"""What the water of a run moves in, whatever its kind, and the fields that a run keeps of it."""

from collections.abc import Mapping
from typing import ClassVar, NamedTuple

from ryusa.printed import ByShape


class Field(NamedTuple):
    """What a run folder keeps of the water at each frame under one name."""

    unit: str  # SI
    at: tuple[str, ...] = ()  # its axes, names of `Flow.places`; none: one number


class Flow(ByShape):
    """What water that feels the grains moves in: cells, bottom, ends, closures; fixed while the scene is."""

    GROUP: ClassVar[str]  # of its datasets in a run folder

    @property
    def text(self) -> str:
        """What it is, in words."""
        raise NotImplementedError

    @property
    def places(self) -> Mapping[str, int]:
        """How many places of each kind it has, such as cells."""
        raise NotImplementedError

    def fields(self) -> Mapping[str, Field]:
        """What a run folder keeps of the water at a frame, by name."""
        raise NotImplementedError

    def frame_shapes(self) -> dict[str, tuple[int, ...]]:
        """Shapes of the fields of a frame."""
        places = self.places
        return {name: tuple(places[one] for one in field.at) for name, field in self.fields().items()}
