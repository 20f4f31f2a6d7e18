"""The grains, walls and water of a run at a moment, as pixels."""

import math
from dataclasses import dataclass
from typing import Any

import matplotlib as mpl
import numpy as np

from ryusa.model import Scene
from ryusa.model.wall_shape import in_world, lines_of, triangles_of, within_periods
from ryusa.results import Results
from ryusa.view.box import Floats, edges_of, plane_in_box
from ryusa.view.camera import Camera
from ryusa.view.colouring import Colouring
from ryusa.view.flow import surface_line, surfaces
from ryusa.view.raster import CHOSEN, LEAST, SAMPLES, Bytes, Canvas, Face, Line, Spheres

SHADES = 256  # of a colour scale
FIXED = (168, 163, 153)  # as in the page, and so the other colours
EDGE, WALL, WATER, LEVEL = (140, 148, 158), (128, 120, 107), (38, 128, 204), (0, 114, 178)
WALL_ALPHA, WATER_ALPHA, DEEP_ALPHA = 0.25, 0.22, 0.1
THIN_ALPHA = 0.12  # of the faces of walls, of which several lie behind each other
MOST_FACES = 4000  # of walls that are drawn; of more the edges alone
RING = 1.35  # radius of the ring around a grain that is followed, in its own
_ABOVE = 1.0e9  # towards the eye, in samples: before everything


@dataclass(frozen=True)
class Look:
    """How the pictures of a film are drawn, alike in all of them.

    Attributes
    ----------
    view : a word of `camera.VIEWS`.
    colouring, low, high : of the grains, and the ends of its scale in SI.
    camera : where it looks is that of the first picture; it moves with the grain that is followed.
    box : lowest and highest corner of what is shown [m].
    follow : free grain in the middle of the picture; None: the camera stands still.
    """

    view: str
    colouring: Colouring
    low: float
    high: float
    camera: Camera
    box: tuple[Floats, Floats]
    follow: int | None = None


class Painter:
    """Draws a run at any time between its first and last frame.

    Between two frames grains are on straight lines, with the colours of the nearer frame. A grain that leaves
    a period on one side enters it on the other; where a grain is followed, the period around it is shown.
    """

    def __init__(self, results: Results, look: Look, width: int, height: int) -> None:
        self.results, self.look = results, look
        self.canvas = Canvas(width, height)
        self._frames: dict[int, Floats] = {}
        self._shades: tuple[int, Bytes] | None = None
        self._palette = np.rint(
            255.0 * mpl.colormaps[look.colouring.colours](np.linspace(0.0, 1.0, SHADES))[:, :3]
        ).astype(np.uint8)
        self._line = surface_line(results)
        self._surfaces = np.zeros(0) if self._line is not None else surfaces(results)
        self._walls: tuple[Floats, Any, Floats, Any] | None = None  # faces and edges, and whose
        self._period = np.array([*results.scene.period, math.inf])

    def at(self, t: float) -> Bytes:
        """The picture at time `t` [s], shape (height, width, 3)."""
        k, share = self._between(t)
        nearer = k + round(share)
        x = self._frame(k)
        if share > 0.0:
            x = self._towards_next(k, share)
        low, high, camera = self._seen(x)
        scene = self.results.scene_at(t)
        fixed = np.flatnonzero(scene.fixed_active)
        there = np.flatnonzero(np.isfinite(x[:, 0]))  # nan: a grain that has not entered, or has left
        centres = np.concatenate([x[there], scene.x_fixed[fixed].reshape(-1, 3)])
        d = np.concatenate([scene.d[there], scene.d_fixed[fixed]])
        for axis in np.flatnonzero(np.isfinite(self._period)):
            row = centres[:, axis]
            row -= self._period[axis] * np.floor((row - low[axis]) / self._period[axis])
        wide, high_up = SAMPLES * self.canvas.width, SAMPLES * self.canvas.height
        scale = 0.5 * high_up / camera.half
        colour = np.concatenate(
            [self._colours(nearer)[there], np.full((len(fixed), 3), FIXED, dtype=np.uint8)]
        )
        spheres = Spheres(
            camera.project(centres, wide, high_up),
            np.maximum(0.5 * d * scale, LEAST).astype(np.float32),
            colour,
            -1 if self.look.follow is None else self.look.follow,
        )
        lines: list[Line] = []
        faces: list[Face] = []

        def line(ends: Floats, own: tuple[int, int, int]) -> None:
            lines.append(Line(camera.project(ends, wide, high_up), own))

        def face(
            corners: Floats, own: tuple[int, int, int], alpha: float, rim: tuple[int, int, int] | None
        ) -> None:
            faces.append(Face(camera.project(corners, wide, high_up), own, alpha))
            if rim is not None:
                for k in range(len(corners)):
                    line(corners[[k, (k + 1) % len(corners)]], rim)

        for ends in edges_of(low, high):
            line(ends, EDGE)
        for plane in np.flatnonzero(scene.plane_active):
            corners = plane_in_box(scene.plane_point[plane], scene.plane_normal[plane], low, high)
            if len(corners):
                face(corners, WALL, WALL_ALPHA, WALL)
        self._add_walls(scene, t, low, line, face)
        self._add_row(k, share, low, high, line, face)
        if len(self._surfaces) and low[2] < (z := float(self._surfaces[nearer])) <= high[2]:
            level = [(low[0], low[1]), (high[0], low[1]), (high[0], high[1]), (low[0], high[1])]
            face(np.array([(*place, z) for place in level]), WATER, WATER_ALPHA, LEVEL)
            if self.look.view == "side":  # the surface is a line there: the water behind the grains is tinted
                behind = [(low[0], z), (high[0], z), (high[0], low[2]), (low[0], low[2])]
                face(np.array([(a, high[1], b) for a, b in behind]), WATER, DEEP_ALPHA, None)
        if self.look.follow is not None:
            lines += self._ring(spheres, self.look.follow)
        return self.canvas.draw(spheres, lines, faces)

    def _towards_next(self, k: int, share: float) -> Floats:
        """Centres on the way from a frame to the next; grains that pass a feed or an exit stay at either."""
        before, after = self._frame(k), self._frame(k + 1)
        x = before + share * (after - before)
        if self.results.scene.traffic is None:
            return x
        passages, step = self.results.passages, self.results.frames.step
        within = (passages["step"] > step[k]) & (passages["step"] <= step[k + 1])
        ids = self.results.scene.spheres_of(passages["grain"][within])
        x[ids] = (before if share < 0.5 else after)[ids]
        return x

    def _add_walls(self, scene: Scene, t: float, low: Floats, line: Any, face: Any) -> None:
        """Edges of the walls that are there, and their faces if few, in the periods from `low`."""
        walls = scene.walls
        if walls is None:
            return
        if self._walls is None:
            self._walls = (*triangles_of(walls), *lines_of(walls))
        corners, of, ends, end_of = self._walls
        there = walls.active
        if len(corners) <= MOST_FACES:
            for one in within_periods(in_world(walls, corners, of, t)[there[of]], low, self._period):
                face(one, WALL, THIN_ALPHA, None)
        for one in within_periods(in_world(walls, ends, end_of, t)[there[end_of]], low, self._period):
            line(one, WALL)

    def _add_row(self, k: int, share: float, low: Floats, high: Floats, line: Any, face: Any) -> None:
        """The surface along a row of columns, and from the side the water behind the grains."""
        if self._line is None:
            return
        for x, z, bottom in self._line.within(self._line.at(k, share), low[0], high[0]):
            for ends in np.stack([x, z, bottom], axis=1)[np.arange(len(x) - 1)[:, None] + [0, 1]]:
                if ends[:, 1].max() > high[2]:  # far above the grains
                    continue
                near, far = (np.insert(ends[:, :2], 1, y, axis=1) for y in (low[1], high[1]))
                line(near, LEVEL)
                line(far, LEVEL)
                face(np.concatenate([near, far[::-1]]), WATER, WATER_ALPHA, None)
                if self.look.view == "side":
                    below = far[::-1].copy()
                    below[:, 2] = np.maximum(ends[::-1, 2], low[2])
                    face(np.concatenate([far, below]), WATER, DEEP_ALPHA, None)

    def _between(self, t: float) -> tuple[int, float]:
        """The frame before a time, and the share of the way to the next."""
        times = self.results.frames.t
        k = int(np.clip(np.searchsorted(times, t, side="right") - 1, 0, len(times) - 1))
        if k == len(times) - 1 or t <= times[k]:
            return k, 0.0
        return k, float((t - times[k]) / (times[k + 1] - times[k]))

    def _frame(self, k: int) -> Floats:
        """Unwrapped centres at a frame; the last two asked for are kept."""
        if k not in self._frames:
            if len(self._frames) > 1:
                del self._frames[min(self._frames)]
            self._frames[k] = self.results.frames.x[k]
        return self._frames[k]

    def _colours(self, k: int) -> Bytes:
        """Red, green, blue of the free grains at a frame."""
        if self._shades is None or (self._shades[0] != k and not self.look.colouring.steady):
            low, high = self.look.low, self.look.high
            share = np.nan_to_num((self.look.colouring.values(self.results, k) - low) / (high - low))
            shade = np.clip(np.rint(share * (SHADES - 1)), 0, SHADES - 1).astype(np.int64)
            self._shades = k, self._palette[shade]
        return self._shades[1]

    def _seen(self, x: Floats) -> tuple[Floats, Floats, Camera]:
        """The box shown and the camera: as they are, or around the grain that is followed."""
        low, high = self.look.box
        if self.look.follow is None:
            return low, high, self.look.camera
        target = x[self.look.follow].copy()
        periodic = np.isfinite(self._period)
        shift = np.where(periodic, target - 0.5 * (low + high), 0.0)
        return low + shift, high + shift, self.look.camera.at(target)

    def _ring(self, spheres: Spheres, grain: int) -> list[Line]:
        """A ring around a grain, over everything that hides it."""
        x, y, _ = spheres.place[grain]
        turn = np.linspace(0.0, 2.0 * math.pi, 97)
        lines: list[Line] = []
        for wider in range(4):  # two samples each
            r = RING * float(spheres.radius[grain]) + 4.0 + wider
            points = np.column_stack([x + r * np.cos(turn), y + r * np.sin(turn), np.full(len(turn), _ABOVE)])
            ends = points.astype(np.float32)
            lines += [Line(ends[k : k + 2], CHOSEN) for k in range(len(turn) - 1)]
        return lines
