"""Feeds and exits that move with a wall."""

from collections.abc import Sequence

import numpy as np

from ryusa.model.arrays import Floats
from ryusa.model.feeds import NONE, Feed
from ryusa.model.scene import Scene
from ryusa.model.walls import MOST_SPEED, Carrier, speed_of


def carrier_of(scene: Scene, wall: int, t: float) -> Carrier | None:
    """The wall of a number at time t [s]; None for no wall."""
    if wall == NONE:
        return None
    assert scene.walls is not None
    return Carrier.of(scene.walls.motion[wall], t)


def speed_of_feed(scene: Scene, feed: Feed) -> float:
    """Bound of the speed of any point of a feed that moves with a wall [m/s]; 0 for one that stays."""
    if feed.wall == NONE:
        return 0.0
    assert scene.walls is not None
    walls = scene.walls
    servo = walls.servo[feed.wall, MOST_SPEED] if len(walls.servo) else 0.0
    return float(servo) + speed_of(walls.motion[feed.wall], *corners(feed))


def corners(feed: Feed) -> tuple[Floats, Floats]:
    """Lowest and highest corner of a feed [m], shape (3,) each."""
    if feed.is_box:
        return np.array(feed.low), np.array(feed.high)
    return corners_of_disc(feed.centre, feed.normal, feed.radius)


def corners_of_disc(
    centre: Sequence[float], normal: Sequence[float] | Floats, radius: float
) -> tuple[Floats, Floats]:
    """Lowest and highest corner of a disc [m], shape (3,) each; its normal has length 1."""
    reach = radius * np.sqrt(np.maximum(1.0 - np.square(normal), 0.0))
    return np.array(centre) - reach, np.array(centre) + reach
