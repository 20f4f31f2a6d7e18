"""Places for grains that enter: drawn from a stream of random numbers, and free of any overlap."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ryusa.model import BodyState, Feed, Scene
from ryusa.model.arrays import Floats
from ryusa.model.wall_feeds import carrier_of, corners
from ryusa.model.wall_shape import WallsAt
from ryusa.model.walls import across, corners_of_box
from ryusa.water.eddies import draw

Ints = NDArray[np.int64]
ATTEMPTS = 50  # places tried for a grain at one instant
_STREAM = 0x2545F4914F6CDD1D  # tells these random numbers from those of the eddies of the same seed
_TURNS = 0x3C6EF372FE94F82B  # tells orientations from places


@dataclass
class Neighbours:
    """Grains near a feed, and walls, that a place must not overlap.

    Attributes
    ----------
    walls : where they are now; None where the scene has none.
    x, d : centres, inside the period [m], shape (n, 3), and diameters [m], shape (n,).
    lowest : no grain that is placed reaches below this height [m].
    """

    scene: Scene
    x: Floats
    d: Floats
    walls: WallsAt | None
    lowest: float

    @staticmethod
    def of(
        scene: Scene, feed: Feed, x: Floats, there: NDArray[np.bool_], reach: float, t: float
    ) -> "Neighbours":
        """Free grains that are there and fixed ones, as far from a feed as a grain may be that is placed.

        Parameters
        ----------
        x : centres of all free grains [m], shape (n_grain, 3).
        there : whether each is there.
        reach : how far beyond the feed a centre may be placed [m].
        t : time [s].
        """
        largest = scene.d_max
        low, high = corners(feed)
        if (carrier := carrier_of(scene, feed.wall, t)) is not None:
            every = carrier.place(corners_of_box(low, high))
            low, high = every.min(axis=0), every.max(axis=0)
        low, high = low - reach - largest, high + reach + largest
        axes = [k for k in range(3) if k == 2 or not math.isfinite(scene.period[k])]

        def near(rows: Floats) -> NDArray[np.bool_]:
            inside = (rows[:, axes] > low[axes]) & (rows[:, axes] < high[axes])
            return np.asarray(inside.all(axis=1))

        free, fixed = np.flatnonzero(there), np.flatnonzero(scene.fixed_active)
        free = free[near(x[free])]
        stones = scene.x_fixed.reshape(-1, 3)
        fixed = fixed[near(stones[fixed])]
        return Neighbours(
            scene, np.concatenate([x[free], stones[fixed]]),
            np.concatenate([scene.d[free], scene.d_fixed[fixed]]),
            None if scene.walls is None else WallsAt(scene.walls, t, scene.period).around(low, high),
            float(low[2]),
        )  # fmt: skip

    def free(self, place: Floats, d: float) -> bool:
        """Whether a grain of diameter d [m] fits at a place [m], shape (3,)."""
        scene = self.scene
        planes = scene.plane_active
        if np.any(np.sum((place - scene.plane_point) * scene.plane_normal, axis=1)[planes] < 0.5 * d):
            return False
        gap = self.x - place
        for axis, period in enumerate(scene.period):
            if math.isfinite(period):
                gap[:, axis] -= period * np.round(gap[:, axis] / period)
        if np.any(np.sum(gap**2, axis=1) < (0.5 * (self.d + d)) ** 2):
            return False
        return self.walls is None or not self.walls.touch(place, 0.5 * d)

    def add(self, place: Floats, d: float) -> None:
        """Take a grain that has been placed."""
        self.x, self.d = np.concatenate([self.x, place[None]]), np.append(self.d, d)


def drawn_place(feed: Feed, plane_case: bool, d: float, grain: int, step: int, attempt: int) -> Floats:
    """Place drawn for the centre of a grain of diameter d [m] in a feed [m], shape (3,).

    Notes
    -----
    The numbers follow from (seed, grain, step, attempt) alone. The whole grain lies within a box; in a
    direction in which the box is thinner than a grain, and across a plane scene, the centre lies in its
    middle. On a disc all points that are a radius of the grain away from its rim are alike; in a plane scene
    it is a line.
    """
    u = [draw(feed.seed ^ _STREAM, grain, step, 3 * attempt + k) for k in range(3)]
    if feed.is_box:
        low, high = np.array(feed.low), np.array(feed.high)
        room = high - low - d
        return 0.5 * (low + high) + np.where(room > 0.0, (np.array(u) - 0.5) * room, 0.0)
    normal, free = np.array(feed.normal), feed.radius - 0.5 * d
    if plane_case:
        return np.array(feed.centre) + free * (2.0 * u[0] - 1.0) * np.array([normal[2], 0.0, -normal[0]])
    side = across(normal)
    other = np.cross(normal, side)
    far, turn = free * math.sqrt(u[0]), 2.0 * math.pi * u[1]
    return np.array(feed.centre) + far * (math.cos(turn) * side + math.sin(turn) * other)


def drawn_orientation(feed: Feed, grain: int, step: int, attempt: int) -> Floats:
    """Orientation drawn for a clump, a quaternion (w, x, y, z); all are as likely.

    Notes
    -----
    Of three numbers that follow from (seed, grain, step, attempt) alone, after Shoemake (1992, Graphics Gems
    III, 124).
    """
    u = [draw(feed.seed ^ _TURNS, grain, step, 3 * attempt + k) for k in range(3)]
    low, high = math.sqrt(1.0 - u[0]), math.sqrt(u[0])
    a, b = 2.0 * math.pi * u[1], 2.0 * math.pi * u[2]
    return np.array([low * math.sin(a), low * math.cos(a), high * math.sin(b), high * math.cos(b)])


def spheres_at(scene: Scene, i: int, place: Floats, q: Floats) -> tuple[Ints, Floats]:
    """Ids and centres of the spheres of a grain or clump at a place [m], shape (n,) and (n, 3)."""
    spheres = scene.spheres_of(np.array([i]))
    if scene.bodies is None or len(spheres) == 1:
        return spheres, place[None]
    which = scene.bodies.of_grain(scene.n_grain)[[i]]
    some = scene.bodies.some(which, scene.bodies.first[which])
    none = np.zeros((1, 3))
    return spheres, place + BodyState(place[None], none, q[None], none, np.zeros((1, 2), np.int32)).arms(some)


def wrapped(place: Floats, period: tuple[float, float]) -> Floats:
    """A place taken into the period [m]; rows of shape (n, 3) too."""
    place = place.copy()
    for axis, length in enumerate(period):
        if math.isfinite(length):
            place[..., axis] -= np.floor(place[..., axis] / length) * length
    return place
