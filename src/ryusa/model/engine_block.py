"""What one engine needs to continue exactly: a block of arrays and numbers that only this engine reads."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from ryusa.model.arrays import Floats


@dataclass(frozen=True)
class EngineBlock:
    """Arrays and numbers of one engine, opaque to everything else; a snapshot and a checkpoint carry it.

    Attributes
    ----------
    engine : name of the engine that wrote it.
    version : of its content, counted by that engine.
    arrays, numbers : by name.
    """

    engine: str
    version: int
    arrays: Mapping[str, np.ndarray] = field(default_factory=dict[str, np.ndarray])
    numbers: Mapping[str, float] = field(default_factory=dict[str, float])

    def check(self, version: int) -> None:
        """Refuse a block of another version.

        Raises
        ------
        ValueError : says both versions.
        """
        if self.version != version:
            raise ValueError(
                f"the block of engine '{self.engine}' has version {self.version}, this one reads {version}"
            )

    def array(self, name: str, shape: tuple[int, ...], most: float) -> Floats:
        """One array of doubles, checked.

        Parameters
        ----------
        most : largest absolute value.

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
        """One number, checked.

        Raises
        ------
        ValueError : it is missing or outside its range.
        """
        value = self.numbers.get(name)
        if value is None or not least <= value <= most:
            found = "missing" if value is None else f"{value:g}"
            raise ValueError(f"'{name}' of engine '{self.engine}' is {found}: must be {least:g} to {most:g}")
        return value
