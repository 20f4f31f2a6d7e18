"""The water of a run at every frame: fields by their names."""

from typing import cast

import numpy as np
from numpy.typing import NDArray

from ryusa.model import ColumnRow, Flow

Floats = NDArray[np.float64]
_OF_FLOW = ("z", "faces", "floor")  # heights [m]


class WaterFrames:
    """Fields of the water at every frame, each an attribute by its name, shape (n_frame, ...).

    Units and places are those of `flow.fields()`, which `repr` lists; `z`, `faces` and `floor` are heights of
    the flow [m].

    Attributes
    ----------
    flow : what the water moves in, at the start of the run.
    t : times of the frames [s], shape (n_frame,).
    """

    def __init__(self, flow: Flow, t: Floats, **fields: Floats) -> None:
        self.flow, self.t, self._of = flow, t, fields

    def __getattr__(self, name: str) -> Floats:
        if name in _OF_FLOW:
            return getattr(self.flow, name)
        if name.startswith("_") or name not in self._of:
            known = ", ".join(vars(self).get("_of", ()))
            raise AttributeError(f"no '{name}' among the fields of the water: {known}")
        return self._of[name]

    @property
    def row(self) -> ColumnRow:
        """The flow, of water along a stream."""
        return cast(ColumnRow, self.flow)

    @property
    def depth(self) -> Floats:
        """Depth of the water of a row over its floor [m], shape (n_frame, n_segment)."""
        return self.surface - self.floor

    def __repr__(self) -> str:
        fields = self.flow.fields().items()
        said = ", ".join(f"{name} [{one.unit}] {' '.join(one.at)}".rstrip() for name, one in fields)
        return f"WaterFrames({len(self.t)} of {self.flow.text}: {said})"
