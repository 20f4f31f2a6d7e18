"""Grains that enter and leave during a run: feeds, exits, and the record of each passage."""

import math
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ryusa.model.arrays import Floats
from ryusa.model.course import Course
from ryusa.printed import ByShape

Vector = tuple[float, float, float]
NAN = math.nan
_NOWHERE: Vector = (NAN, NAN, NAN)
IN, OUT = 1, -1  # of `way`
NONE = -1  # no feed, or no wall
WAITING, PRESENT, GONE = 0, 1, 2  # of a grain

# One row per grain that entered or left, in the order in which it happened.
PASSAGE = np.dtype(
    [
        ("step", np.int64),  # step of the engine at which it was placed or removed
        ("t", np.float64),  # when it entered, or crossed the exit, interpolated [s]
        ("way", np.int64),  # IN or OUT
        ("at", np.int64),  # number of the feed or of the exit
        ("grain", np.int64),  # id
        ("to", np.int64),  # OUT: number of the feed at which it will come in again; else NONE
        ("due", np.float64),  # IN: when it should have entered [s]
        ("d", np.float64),  # diameter [m]
        ("m", np.float64),  # mass [kg]
        ("x", np.float64, (3,)),  # centre where it was placed, or where it crossed [m]
        ("v", np.float64, (3,)),  # its velocity there [m/s]
        ("omega", np.float64, (3,)),  # its spin [rad/s]
        # that it brings or takes: mass times its velocity in the state at `step`, half a step old [N s]
        ("momentum", np.float64, (3,)),
    ]
)


@dataclass(frozen=True)
class Feed:
    """A place where grains enter: a box, or a disc (in a plane scene a line) that they pass.

    Attributes
    ----------
    name : of the feed; `Scene.groups` gives the ids of its grains under this name.
    low, high : corners of a box [m]; nan for a disc.
    centre, normal, radius : of a disc [m]; nan for a box. `normal` has length 1.
    velocity : of every grain that enters [m/s]; of a feeder reach, that of its fastest grain.
    rate : grains or kilograms in a second; 0 where only grains that have left come in; of a feeder reach,
        the mean; of a sedigraph, the largest.
    by_mass : whether `rate` is in kg/s.
    begin, end : when grains of its own are due [s].
    first, count : ids of its own grains, first to first + count - 1, in the order in which they are due.
    seed : of the places drawn.
    wall : number of the wall with which it moves; NONE where it stays. Place, normal and velocity are
        those in the frame of the wall.
    times, rates : of a sedigraph, straight between them; empty where the rate stays.
    """

    name: str
    low: Vector = _NOWHERE
    high: Vector = _NOWHERE
    centre: Vector = _NOWHERE
    normal: Vector = _NOWHERE
    radius: float = NAN
    velocity: Vector = (0.0, 0.0, 0.0)
    rate: float = 0.0
    by_mass: bool = False
    begin: float = 0.0
    end: float = math.inf
    first: int = 0
    count: int = 0
    seed: int = 0
    wall: int = NONE
    times: tuple[float, ...] = ()
    rates: tuple[float, ...] = ()

    @property
    def is_box(self) -> bool:
        """Whether it is a box, not a disc."""
        return math.isnan(self.radius)

    def due(self, m: Floats) -> Floats:
        """When each of its own grains is due [s], shape (count,); `m` are the masses of all grains [kg].

        Notes
        -----
        A grain is due when the amount of the grains before it has been fed: the first at `begin`.

        >>> Feed("sand", rate=4.0, begin=1.0, first=1, count=3).due(np.ones(4))
        array([1.  , 1.25, 1.5 ])
        """
        own = m[self.first : self.first + self.count] if self.by_mass else np.ones(self.count)
        before = np.concatenate([[0.0], np.cumsum(own)[:-1]]) if self.count else np.zeros(0)
        if self.times:
            course = Course(self.times, self.rates)
            return np.array([course.when(one) for one in before.tolist()])
        return self.begin + before / self.rate if self.count else before


@dataclass(frozen=True)
class Exit:
    """A place where grains leave: beyond a plane, or within a box; the centre of a grain counts.

    Attributes
    ----------
    name : of the exit.
    point, normal : a point on the plane [m], and the direction in which grains leave, of length 1; nan for a
        box.
    low, high : corners of a box [m]; nan for a plane.
    to : number of the feed at which the grains come in again; NONE where they do not.
    wall : number of the wall with which it moves; NONE where it stays.
    """

    name: str
    point: Vector = _NOWHERE
    normal: Vector = _NOWHERE
    low: Vector = _NOWHERE
    high: Vector = _NOWHERE
    to: int = NONE
    wall: int = NONE

    @property
    def is_plane(self) -> bool:
        """Whether it is a plane, not a box."""
        return not math.isnan(self.point[0])

    def beyond(self, x: Floats) -> NDArray[np.bool_]:
        """Whether each centre x [m], shape (n, 3), has left; False where it is nan.

        An exit that moves with a wall is asked in the frame of the wall.
        """
        if self.is_plane:
            return (x - np.array(self.point)) @ np.array(self.normal) > 0.0
        return np.asarray(((x > np.array(self.low)) & (x < np.array(self.high))).all(axis=1))


@dataclass(frozen=True, repr=False)
class Arrivals(ByShape):
    """When, where and how the grains of one feed come in, each by itself: those of a feeder reach.

    They enter at the upper end of a row of columns, in its box, and count their heights from the bed there.

    Attributes
    ----------
    feed : number of the feed, whose grains are these in the order of their ids.
    t : when each is due [s], ascending, shape (n,).
    y : place across the row [m], shape (n,).
    height : of its centre over the bed, along z [m], shape (n,).
    v, omega : velocity [m/s] and spin [rad/s], shape (n, 3).
    """

    feed: int
    t: Floats
    y: Floats
    height: Floats
    v: Floats
    omega: Floats


@dataclass(frozen=True, repr=False)
class Traffic(ByShape):
    """Feeds and exits of a scene.

    Attributes
    ----------
    feeds, exits : in the order of the case; the feed of a feeder reach is the last.
    interval : steps between two instants at which grains enter and leave.
    n_first : grains that are there from the start, ids 0 to n_first - 1.
    arrivals : of the grains of a feeder reach; None without one.
    """

    feeds: tuple[Feed, ...] = ()
    exits: tuple[Exit, ...] = ()
    interval: int = 1
    n_first: int = 0
    arrivals: Arrivals | None = None

    @property
    def moves(self) -> bool:
        """Whether a feed or an exit moves with a wall."""
        return any(one.wall != NONE for one in (*self.feeds, *self.exits))

    @staticmethod
    def from_data(data: dict[str, Any], arrivals: Arrivals | None = None) -> "Traffic":
        """The inverse of `dataclasses.asdict` but for arrivals, from numbers as JSON gives them."""
        return Traffic(
            feeds=tuple(Feed(**_values(one)) for one in data["feeds"]),
            exits=tuple(Exit(**_values(one)) for one in data["exits"]),
            interval=int(data["interval"]),
            n_first=int(data["n_first"]),
            arrivals=arrivals,
        )


def _values(data: dict[str, Any]) -> dict[str, Any]:
    """Keys of a feed or an exit; lists of numbers are vectors."""
    return {
        key: tuple(float(part) for part in one) if isinstance(one, list | tuple) else one
        for key, one in data.items()
    }


@dataclass(frozen=True, repr=False)
class Population(ByShape):
    """Which grains of a scene are there, at one moment.

    Attributes
    ----------
    status : WAITING, PRESENT or GONE, shape (n_grain,), int64.
    due : when a waiting grain is due [s], shape (n_grain,); inf where not.
    feed : number of the feed at which a waiting grain enters, shape (n_grain,), int64.
    """

    status: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, np.int64))
    due: Floats = field(default_factory=lambda: np.zeros(0))
    feed: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, np.int64))

    @staticmethod
    def first(traffic: Traffic, m: Floats, heads: NDArray[np.bool_] | None = None) -> "Population":
        """Before any grain has entered; `m` are the masses of all grains [kg].

        `heads` tells which of them count: the members of a clump but the first are never due.
        """
        n = len(m)
        heads = np.ones(n, np.bool_) if heads is None else heads
        status, due = np.full(n, WAITING, np.int64), np.full(n, math.inf)
        feeds = np.full(n, NONE, np.int64)
        status[: traffic.n_first] = PRESENT
        for k, feed in enumerate(traffic.feeds):
            own = slice(feed.first, feed.first + feed.count)
            mine = feed.first + np.flatnonzero(heads[own])
            due[mine], feeds[own] = replace(feed, first=0, count=len(mine)).due(m[mine]), k
            if traffic.arrivals is not None and traffic.arrivals.feed == k:
                due[mine] = traffic.arrivals.t
        return Population(status, due, feeds)
