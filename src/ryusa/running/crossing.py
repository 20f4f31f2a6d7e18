"""Grains that are beyond an exit: when they crossed it, and the record of it."""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from ryusa.model import PASSAGE, Exit, Scene, State, Traffic
from ryusa.model.arrays import Floats
from ryusa.model.feeds import OUT
from ryusa.model.wall_feeds import carrier_of
from ryusa.running.insertion import wrapped

Ints = NDArray[np.int64]
Surface = Callable[[Floats], Floats]  # height of the water at places along x [m], same shape; -inf without


def leaving_at(
    traffic: Traffic, scene: Scene, state: State, through: list[Ints], surface: Surface
) -> np.ndarray:
    """Records of grains that leave, dtype PASSAGE, in the order of exits and ids.

    Parameters
    ----------
    traffic, scene : the exits, and the scene that holds now.
    state : snapshot of all its grains.
    through : ids of the grains that are beyond each exit; empty without an exit.
    surface : height of the water of a column or a row.
    """
    x, v = of_heads(scene, state)
    step, t, inside, (d, m) = state.step, state.t, wrapped(x, scene.period), scene.of_heads()
    longest = traffic.interval * scene.dt
    found: list[np.ndarray] = [np.zeros(0, PASSAGE)]
    for k, (one, ids) in enumerate(zip(traffic.exits, through, strict=bool(through))):
        carrier = carrier_of(scene, one.wall, t)
        rows = np.zeros(len(ids), PASSAGE)
        rows["step"], rows["way"], rows["at"], rows["to"] = step, OUT, k, one.to
        rows["grain"], rows["d"], rows["m"], rows["due"] = ids, d[ids], m[ids], math.nan
        rows["omega"] = state.omega[ids]  # of a clump, that of its first member
        rows["momentum"] = m[ids, None] * v[ids]
        rates = fall(scene, ids, x[ids, 2], surface(x[ids, 0]))
        for row, i, a in zip(rows, ids.tolist(), rates, strict=True):
            speed = v[i] + 0.5 * scene.dt * a  # v belongs to half a step before x
            way = (inside[i], speed, a)
            if carrier is not None:  # its acceleration since then is left out
                seen = carrier.frame(inside[i])
                way = (seen, (speed - carrier.velocity_at(inside[i])) @ carrier.turn, a @ carrier.turn)
            since = min(time_since(one, *way), longest, t)
            row["t"], row["v"] = t - since, speed - since * a
            row["x"] = inside[i] - since * speed + 0.5 * since * since * a
        found.append(rows)
    return np.concatenate(found)


def fall(scene: Scene, ids: Ints, z: Floats, surface: Floats) -> Floats:
    """Acceleration of grains at heights z [m] by their weight alone [m/s2], shape (n, 3).

    Above the surface [m] of a column or a row, shape (n,), it is that of gravity; a given profile of water
    has none.
    """
    share = scene.m_weight[ids] / (scene.m[ids] + scene.m_added[ids])
    if scene.coupled:
        share = np.where(z - 0.5 * scene.of_heads()[0][ids] > surface, 1.0, share)
    return share[:, None] * scene.gravity


def of_heads(scene: Scene, state: State) -> tuple[Floats, Floats]:
    """Centres [m] and velocities [m/s] by id; those of a clump stand at its first member."""
    if scene.bodies is None:
        return state.x, state.v
    x, v, moved = state.x.copy(), state.v.copy(), state.bodies
    assert moved is not None
    x[scene.bodies.first], v[scene.bodies.first] = moved.x, moved.v
    return x, v


def time_since(one: Exit, x: Floats, v: Floats, a: Floats) -> float:
    """Time since a grain in free flight crossed an exit [s]; inf where it did not come from outside.

    Parameters
    ----------
    x, v, a : its centre [m], velocity [m/s] and acceleration [m/s2] now, shape (3,).

    >>> floor = Exit("floor", point=(0.0, 0.0, 0.0), normal=(0.0, 0.0, -1.0))
    >>> x, v, a = np.array([0.0, 0.0, -0.75]), np.array([0.0, 0.0, -2.0]), np.array([0.0, 0.0, -2.0])
    >>> time_since(floor, x, v, a)
    0.5
    """
    if one.is_plane:
        normal = np.array(one.normal)
        return _back(float((x - np.array(one.point)) @ normal), float(v @ normal), float(a @ normal))
    faces = [(x[k] - one.low[k], v[k], a[k]) for k in range(3)]
    faces += [(one.high[k] - x[k], -v[k], -a[k]) for k in range(3)]
    return min(_back(*(float(part) for part in face)) for face in faces)


def _back(depth: float, speed: float, a: float) -> float:
    """Smallest time since a depth [m] was zero, with the speed [m/s] at which it grows; inf if it never was.

    depth - speed t + a t**2/2 = 0, solved without cancellation.
    """
    square = speed * speed - 2.0 * a * depth
    if square < 0.0:
        return math.inf
    below = speed + math.copysign(math.sqrt(square), speed)
    times = [2.0 * depth / below] if below != 0.0 else []
    times += [below / a] if a != 0.0 else []
    return min((one for one in times if one >= 0.0), default=math.inf)
