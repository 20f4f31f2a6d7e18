"""Lit spheres, faces and lines as pixels, by the processor alone: no display and no OpenGL.

Each pixel is the mean of 2 x 2 samples. Places are in samples: to the right and downwards from the upper left
corner, and towards the eye. What is nearest to the eye is found first, by a buffer of depths; only that is
lit, as in the page of `ryusa view` (draw.js). A picture is made in bands of rows, which do not depend on each
other: any number of threads gives the same bits.
"""

import math
import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ryusa.compiled.function import compiled

Singles = NDArray[np.float32]
Bytes = NDArray[np.uint8]

SAMPLES = 2  # per pixel, along each side
BACKGROUND = (246, 247, 249)
CHOSEN = (255, 89, 0)  # the rim of a grain that is followed
LEAST = 0.75  # radius below which a grain would fall between samples
_LONG = math.sqrt(0.35**2 + 0.75**2 + 0.55**2)
LIGHT = (-0.35 / _LONG, 0.75 / _LONG, 0.55 / _LONG)  # where it comes from: right, up, towards the eye
_ROWS = 64  # of samples in a band
_CORES = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@dataclass(frozen=True)
class Spheres:
    """Spheres of one picture.

    Attributes
    ----------
    place : of the centres, in samples, shape (n, 3).
    radius : in samples, shape (n,).
    colour : red, green, blue, shape (n, 3).
    chosen : index of the one with a marked rim; -1: none.
    """

    place: Singles
    radius: Singles
    colour: Bytes
    chosen: int = -1


@dataclass(frozen=True)
class Line:
    """A straight line from one place to another, shape (2, 3), two samples wide."""

    ends: Singles
    colour: tuple[int, int, int]


@dataclass(frozen=True)
class Face:
    """A translucent convex polygon; corners in order around it, shape (n, 3)."""

    corners: Singles
    colour: tuple[int, int, int]
    alpha: float


@dataclass(frozen=True)
class Canvas:
    """A picture of width x height pixels that can be drawn again and again."""

    width: int
    height: int
    depth: Singles = field(init=False)
    which: NDArray[np.int32] = field(init=False)  # sphere at a sample; -1: none
    colour: Bytes = field(init=False)

    def __post_init__(self) -> None:
        shape = (SAMPLES * self.height, SAMPLES * self.width)
        object.__setattr__(self, "depth", np.empty(shape, dtype=np.float32))
        object.__setattr__(self, "which", np.empty(shape, dtype=np.int32))
        object.__setattr__(self, "colour", np.empty((*shape, 3), dtype=np.uint8))

    def draw(self, spheres: Spheres, lines: list[Line], faces: list[Face]) -> Bytes:
        """The picture as red, green, blue, shape (height, width, 3).

        Lines hide spheres behind them and the reverse; faces lie over both, in the order given.
        """
        picture = np.empty((self.height, self.width, 3), dtype=np.uint8)
        rows = len(self.depth)

        def band(top: int) -> None:
            self._band(top, min(top + _ROWS, rows), spheres, lines, faces, picture)

        with ThreadPoolExecutor(_CORES) as pool:
            list(pool.map(band, range(0, rows, _ROWS)))
        return picture

    def _band(
        self, top: int, end: int, spheres: Spheres, lines: list[Line], faces: list[Face], picture: Bytes
    ) -> None:
        depth, colour = self.depth, self.colour
        nearest(spheres.place, spheres.radius, top, end, depth, self.which)
        light(spheres.place, spheres.radius, spheres.colour, spheres.chosen, top, end, self.which, colour)
        for line in lines:
            draw_line(line.ends, np.array(line.colour, dtype=np.uint8), top, end, depth, colour)
        for face in faces:
            lay_face(face.corners, np.array(face.colour, dtype=np.uint8), face.alpha, top, end, depth, colour)
        reduce(top, end, colour, picture)


@compiled(nogil=True)
def nearest(
    place: Singles, radius: Singles, top: int, end: int, depth: Singles, which: NDArray[np.int32]
) -> None:
    """Find the sphere that is seen at each sample of rows top .. end - 1, and its depth."""
    depth[top:end] = -np.inf
    which[top:end] = -1
    wide = depth.shape[1]
    for g in range(len(radius)):
        r, cx, cy, cz = radius[g], place[g, 0], place[g, 1], place[g, 2]
        if cy + r < top or cy - r > end or cx + r < 0 or cx - r > wide:
            continue
        first, last = max(top, math.ceil(cy - r - 0.5)), min(end - 1, math.floor(cy + r - 0.5))
        for row in range(first, last + 1):
            dy = row + 0.5 - cy
            rest = r * r - dy * dy
            if rest < 0.0:
                continue
            half = math.sqrt(rest)
            left, right = max(0, math.ceil(cx - half - 0.5)), min(wide - 1, math.floor(cx + half - 0.5))
            for column in range(left, right + 1):
                if depth[row, column] >= cz + half:
                    continue
                dx = column + 0.5 - cx
                z = cz + math.sqrt(max(rest - dx * dx, 0.0))
                if z > depth[row, column]:
                    depth[row, column] = z
                    which[row, column] = g


@compiled(nogil=True)
def light(
    place: Singles, radius: Singles, own: Bytes, chosen: int,
    top: int, end: int, which: NDArray[np.int32], colour: Bytes,
) -> None:  # fmt: skip
    """Light the samples of rows top .. end - 1 by the formula of the page's shader."""
    for row in range(top, end):
        for column in range(which.shape[1]):
            g = which[row, column]
            if g < 0:
                for k in range(3):
                    colour[row, column, k] = BACKGROUND[k]
                continue
            nx = (column + 0.5 - place[g, 0]) / radius[g]
            ny = (place[g, 1] - row - 0.5) / radius[g]
            nz = math.sqrt(max(1.0 - nx * nx - ny * ny, 0.0))  # towards the eye
            share = min(nz / 0.4, 1.0)
            rim = 0.55 + 0.45 * share * share * (3.0 - 2.0 * share)
            strong = (0.5 + 0.5 * max(nx * LIGHT[0] + ny * LIGHT[1] + nz * LIGHT[2], 0.0)) * rim
            for k in range(3):
                plain = CHOSEN[k] if g == chosen and nz < 0.5 else own[g, k]
                colour[row, column, k] = np.uint8(plain * strong + 0.5)


@compiled(nogil=True)
def draw_line(ends: Singles, own: Bytes, top: int, end: int, depth: Singles, colour: Bytes) -> None:
    """Draw a line, two samples wide, where nothing nearer hides it."""
    wide = depth.shape[1]
    begin, until = 0.0, 1.0  # share of the line within the rows and columns
    for axis, low, high in ((0, -2.0, wide + 2.0), (1, top - 2.0, end + 2.0)):
        way = ends[1, axis] - ends[0, axis]
        a, b = low - ends[0, axis], high - ends[0, axis]
        if way == 0.0:
            if a > 0.0 or b < 0.0:
                return
        else:
            begin, until = max(begin, min(a / way, b / way)), min(until, max(a / way, b / way))
    if begin > until:
        return
    length = max(abs(ends[1, 0] - ends[0, 0]), abs(ends[1, 1] - ends[0, 1]))
    # steps counted from the first end, so that bands of rows agree
    for step in range(math.floor(begin * length), math.ceil(until * length) + 1):
        share = min(step / length, 1.0) if length > 0.0 else 0.0
        x, y, z = ends[0] + share * (ends[1] - ends[0])
        across, down = math.floor(x - 0.5), math.floor(y - 0.5)
        for row in range(max(down, top), min(down + 2, end)):
            for column in range(max(across, 0), min(across + 2, wide)):
                if z >= depth[row, column]:
                    depth[row, column] = z
                    for k in range(3):
                        colour[row, column, k] = own[k]


@compiled(nogil=True)
def lay_face(
    corners: Singles, own: Bytes, alpha: float, top: int, end: int, depth: Singles, colour: Bytes
) -> None:
    """Lay a translucent face over the samples that are not nearer than it; none where it is seen edge on."""
    wide, n = depth.shape[1], len(corners)
    area, a, b, c = 0.0, 0, 0, 0  # the largest triangle that begins at corner 0 gives the depth
    for k in range(1, n - 1):
        e, f = corners[k] - corners[0], corners[k + 1] - corners[0]
        twice = e[0] * f[1] - e[1] * f[0]
        if abs(twice) > abs(area):
            area, b, c = twice, k, k + 1
    if abs(area) < 1.0:
        return
    e, f = corners[b] - corners[a], corners[c] - corners[a]
    slope_x = (e[2] * f[1] - f[2] * e[1]) / area
    slope_y = (f[2] * e[0] - e[2] * f[0]) / area
    for row in range(top, end):
        y = row + 0.5
        low, high = np.inf, -np.inf
        for k in range(n):
            p, q = corners[k], corners[(k + 1) % n]
            if (p[1] <= y) != (q[1] <= y):
                x = p[0] + (y - p[1]) / (q[1] - p[1]) * (q[0] - p[0])
                low, high = min(low, x), max(high, x)
        if low > high:
            continue
        for column in range(max(math.ceil(low - 0.5), 0), min(math.ceil(high - 0.5), wide)):
            z = corners[a, 2] + slope_x * (column + 0.5 - corners[a, 0]) + slope_y * (y - corners[a, 1])
            if z >= depth[row, column]:
                for k in range(3):
                    mixed = alpha * own[k] + (1.0 - alpha) * colour[row, column, k]
                    colour[row, column, k] = np.uint8(mixed + 0.5)


@compiled(nogil=True)
def reduce(top: int, end: int, colour: Bytes, picture: Bytes) -> None:
    """Mean of the samples of each pixel in rows top .. end - 1 of samples."""
    for row in range(top // SAMPLES, end // SAMPLES):
        for column in range(picture.shape[1]):
            for k in range(3):
                total = 0
                for a in range(SAMPLES):
                    for b in range(SAMPLES):
                        total += colour[SAMPLES * row + a, SAMPLES * column + b, k]
                picture[row, column, k] = (total + SAMPLES * SAMPLES // 2) // (SAMPLES * SAMPLES)
