"""Arrays and numbers that an engine needs for an exact resume, and that only this engine reads."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from ryusa.model.arrays import Floats
from ryusa.printed import ByShape


@dataclass(frozen=True, repr=False)
class EngineBlock(ByShape):
    """Internal data of one engine, part of snapshots and checkpoints.

    Attributes
    ----------
    engine : name of the engine that wrote it.
    version : version of its content.
    arrays, numbers : data by name.
    """

    engine: str
    version: int
    arrays: Mapping[str, np.ndarray] = field(default_factory=dict[str, np.ndarray])
    numbers: Mapping[str, float] = field(default_factory=dict[str, float])

    def check(self, version: int) -> None:
        """Refuse a block of another version.

        Raises
        ------
        ValueError : the versions differ.
        """
        if self.version != version:
            raise ValueError(
                f"the block of engine '{self.engine}' has version {self.version}, this one reads {version}"
            )

    def array(self, name: str, shape: tuple[int, ...], most: float) -> Floats:
        """Return one array of doubles after checking it.

        Parameters
        ----------
        name : name of the array.
        shape : required shape.
        most : largest permitted absolute value.

        Raises
        ------
        ValueError : it is missing, has another shape or type, or a value that is not finite or too large.
        """
        found = self.arrays.get(name)
        if found is None or found.shape != shape or found.dtype != np.float64:
            what = "missing" if found is None else f"{found.shape} of {found.dtype}"
            raise ValueError(f"'{name}' of engine '{self.engine}' is {what}, expected {shape} of float64")
        if not np.all(np.abs(found) <= most):
            raise ValueError(f"'{name}' of engine '{self.engine}' holds a value that is not within {most:g}")
        return found

    def number(self, name: str, least: float, most: float) -> float:
        """Return one number after checking that it is within `least` to `most`.

        Raises
        ------
        ValueError : it is missing or outside its range.
        """
        value = self.numbers.get(name)
        if value is None or not least <= value <= most:
            found = "missing" if value is None else f"{value:g}"
            raise ValueError(f"'{name}' of engine '{self.engine}' is {found}: must be {least:g} to {most:g}")
        return value
