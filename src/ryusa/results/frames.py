"""Frames of a run: big arrays are read from the disk when indexed."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ryusa.model import BodyState
from ryusa.printed import ByShape
from ryusa.results.lazy import LazyFrames, Part

Floats = NDArray[np.float64]


@dataclass(frozen=True, repr=False)
class Frame(ByShape):
    """One moment of a run."""

    t: float  # [s]
    step: int
    x: Floats  # centres, unwrapped [m], shape (n_grain, 3)
    v: Floats  # [m/s], half a step before x
    omega: Floats  # [rad/s]
    x_wrapped: Floats  # centres inside the period [m]


class Frames:
    """All recorded frames; big arrays are read from the disk when indexed."""

    def __init__(self, parts: list[Part], n_grain: int, period: tuple[float, float]) -> None:
        self.t: Floats = joined([part.t for part in parts], np.dtype(np.float64))  # [s], shape (n_frame,)
        self.step: NDArray[np.int64] = joined([part.step for part in parts], np.dtype(np.int64))
        lift = np.array([period[0], period[1], 0.0])
        self._lift = np.where(np.isfinite(lift), lift, 0.0)
        self.x_wrapped = LazyFrames(parts, "x", n_grain)  # [m], shape (n_frame, n_grain, 3)
        self.v = LazyFrames(parts, "v", n_grain)  # [m/s]
        self.omega = LazyFrames(parts, "omega", n_grain)  # [rad/s]
        self.image = LazyFrames(parts, "image", n_grain)  # periods crossed, shape (n_frame, n_grain, 2)
        self.x = LazyFrames(parts, "x", n_grain, lift=self._lift)  # unwrapped [m]

    def __repr__(self) -> str:
        if not len(self):
            return "Frames(none)"
        span = f"{self.t[0]:.4g} to {self.t[-1]:.4g} s"
        return f"Frames({len(self)} of {self.x.shape[1]} grains, {span}; t, step, x, v, omega, image)"

    def __len__(self) -> int:
        return len(self.t)

    def __getitem__(self, k: int) -> Frame:
        k = range(len(self))[k]
        wrapped, image = self.x_wrapped[k], self.image[k]
        x = wrapped.copy()
        x[:, :2] += image * self._lift[:2]
        x.flags.writeable = False
        return Frame(float(self.t[k]), int(self.step[k]), x, self.v[k], self.omega[k], wrapped)

    def __iter__(self) -> Iterator[Frame]:
        return (self[k] for k in range(len(self)))


class BodyFrames:
    """Motion of clumps at all frames, as `model.BodyState`; read from the disk when indexed."""

    def __init__(self, parts: list[Part], n_body: int) -> None:
        self.x = LazyFrames(parts, "bodies/x", n_body)  # inside the period [m], (n_frame, n_body, 3)
        self.v = LazyFrames(parts, "bodies/v", n_body)  # [m/s]
        self.q = LazyFrames(parts, "bodies/q", n_body)  # orientations, (n_frame, n_body, 4)
        self.momentum = LazyFrames(parts, "bodies/momentum", n_body)  # angular momenta [N m s]
        self.image = LazyFrames(parts, "bodies/image", n_body)  # periods crossed, (n_frame, n_body, 2)

    def __getitem__(self, k: int) -> BodyState:
        return BodyState(self.x[k], self.v[k], self.q[k], self.momentum[k], self.image[k])


def joined(arrays: list[NDArray[Any]], dtype: np.dtype[Any]) -> NDArray[Any]:
    """Arrays of all parts one after another, read-only."""
    found = np.concatenate(arrays) if arrays else np.zeros(0, dtype=dtype)
    found.flags.writeable = False
    return found
