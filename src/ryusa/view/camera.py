"""Where the grains are seen from: parallel lines of sight, so that lengths have one scale in the picture."""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ryusa.view.box import Floats, corners_of

# word -> azimuth and elevation of the eye [rad], as in the page of `ryusa view`
VIEWS = {
    "oblique": (-1.15, 0.38),
    "side": (-0.5 * math.pi, 0.0),
    "top": (-0.5 * math.pi, 0.5 * math.pi),
}
ROOM = 1.06  # of a picture around what it is fitted to


@dataclass(frozen=True)
class Camera:
    """Looks at a point; z is up in the picture, or y where the eye is above.

    Attributes
    ----------
    target : in the middle of the picture [m], shape (3,).
    axes : to the right, up and towards the eye, unit vectors, shape (3, 3).
    half : half the height of the picture [m].
    """

    target: Floats
    axes: Floats
    half: float

    @staticmethod
    def fitted(low: Floats, high: Floats, view: str, aspect: float) -> "Camera":
        """The camera of a view in whose picture, of width over height `aspect`, a box has its place."""
        azimuth, elevation = VIEWS[view]
        ca, sa, ce, se = math.cos(azimuth), math.sin(azimuth), math.cos(elevation), math.sin(elevation)
        axes = np.array([(-sa, ca, 0.0), (-se * ca, -se * sa, ce), (ce * ca, ce * sa, se)])
        middle = 0.5 * (low + high)
        across, upward, _ = np.abs((corners_of(low, high) - middle) @ axes.T).max(axis=0)
        return Camera(middle, axes, ROOM * max(across / aspect, upward))

    def at(self, target: Floats) -> "Camera":
        """The same camera that looks at another point [m]."""
        return replace(self, target=target)

    def closer(self, half: float) -> "Camera":
        """The same camera with at most this half height of the picture [m]."""
        return replace(self, half=min(self.half, half))

    def project(self, points: Floats, width: int, height: int) -> NDArray[np.float32]:
        """Places of points in a picture of width x height pixels, shape (n, 3).

        Columns are pixels to the right and downwards from the upper left corner, and pixels towards the eye.
        """
        seen = (points - self.target) @ self.axes.T * (0.5 * height / self.half)
        seen[:, 0] += 0.5 * width
        seen[:, 1] = 0.5 * height - seen[:, 1]
        return seen.astype(np.float32)
