"""Divide the path of one grain over a fixed bed into bounces and hops."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ryusa.measure._run import Floats, Run, crest_of, path_of
from ryusa.model import Scene
from ryusa.printed import ByShape

# One row per hop: from the landing that begins one bounce to the landing that begins the next.
HOP = np.dtype(
    [
        ("grain", np.int64),
        ("t_begin", np.float64),  # landing of the bounce it leaves [s]
        ("t_takeoff", np.float64),  # last contact of that bounce parts [s]
        ("t_end", np.float64),  # next landing [s]
        ("period", np.float64),  # t_end - t_begin [s]
        ("flight_time", np.float64),  # t_end - t_takeoff [s]
        ("x_begin", np.float64),  # where it landed, unwrapped [m]
        ("length", np.float64),  # from landing to landing [m]
        ("flight_length", np.float64),  # from take-off to landing [m]
        ("z_takeoff", np.float64),  # centre at take-off [m]
        ("rise", np.float64),  # highest centre above the take-off [m]
        ("above_crest", np.float64),  # highest centre above that of a grain standing on a crest [m]
        ("v_x_takeoff", np.float64),  # [m/s]
        ("v_z_takeoff", np.float64),
        ("v_x_landing", np.float64),
        ("v_z_landing", np.float64),
        ("impulse_normal", np.float64),  # upward impulse of the bed in the bounce it leaves [N s]
        ("impulse_shear", np.float64),  # impulse of the bed against x in that bounce [N s]
        ("impulse_friction", np.float64),  # the part of it that tangential forces give [N s]
    ]
)
# One row per bounce: bed contacts without a flight between them that rises more than the threshold.
BOUNCE = np.dtype(
    [
        ("grain", np.int64),
        ("t_begin", np.float64),  # [s]
        ("t_end", np.float64),  # end of the last normal force [s]
        ("duration", np.float64),  # t_end - t_begin [s]
        ("n_contact", np.int64),
        ("touch", np.float64),  # summed contact times [s]
        ("x_begin", np.float64),  # [m]
        ("omega_before", np.float64),  # spin about y [rad/s], positive rolls downstream
        ("omega_after", np.float64),
        ("overlap", np.float64),  # largest [m]
        ("impulse_normal", np.float64),  # [N s]
        ("impulse_shear", np.float64),
    ]
)


@dataclass(frozen=True, repr=False)
class Bounces(ByShape):
    """Hops and bounces of one grain, in order of time."""

    hops: NDArray[Any]  # dtype HOP
    bounces: NDArray[Any]  # dtype BOUNCE; bounces that a counted hop leaves
    contact_time: Floats  # of every bed contact in those bounces [s]
    contact_time_alone: Floats  # of those that touched one bed grain only [s]


@dataclass(frozen=True)
class _Flight:
    """A stretch without bed contact."""

    t_takeoff: float
    x_takeoff: float
    z_takeoff: float
    z_top: float


@dataclass(frozen=True, repr=False)
class PathOverBed(ByShape):
    """All hops and bounces of one grain, with the bed contacts of each bounce that a hop leaves."""

    hops: NDArray[Any]  # dtype HOP
    bounces: NDArray[Any]  # dtype BOUNCE
    contacts: list[NDArray[Any]]

    def since(self, begin: float, most: int | None = None) -> Bounces:
        """Leave out bounces that began before `begin` [s]; of the others keep the first `most`."""
        kept = np.flatnonzero(self.bounces["t_begin"] >= begin)[:most]
        inside = [self.contacts[k] for k in kept]
        # of some the bed grain was taken away
        inside = [one[np.isfinite(one["closing_end"])] for one in inside]
        touch, alone = [np.zeros(0)], [np.zeros(0)]
        for one in inside:
            time = one["t_end"] - one["t_begin"]
            touch.append(time)
            alone.append(time[one["alone"] > 0.0])
        return Bounces(self.hops[kept], self.bounces[kept], np.concatenate(touch), np.concatenate(alone))


def path_over_bed(run: Run, grain: int, rise: float) -> PathOverBed:
    """Bounces and hops of one grain.

    Parameters
    ----------
    run : a run folder with contact events.
    grain : id of a free grain.
    rise : flights that rise less than this many diameters join their bounces.
    """
    scene = run.scene
    events = run.contacts
    first, end = scene.n_grain, scene.n_grain + scene.n_fixed
    events = events[(events["i"] == grain) & (events["j"] >= first) & (events["j"] < end)]
    events = events[np.argsort(events["t_begin"], kind="stable")]
    if len(events) == 0:
        return PathOverBed(np.zeros(0, HOP), np.zeros(0, BOUNCE), [])
    path = path_of(run, grain)
    d = float(scene.d[grain])
    groups, flights = _group(events, path, rise * d)
    standing = crest_of(scene) + 0.5 * d
    hops = np.zeros(len(flights), HOP)
    bounces = np.zeros(len(flights), BOUNCE)
    for k, flight in enumerate(flights):
        bounces[k] = _bounce(grain, groups[k])
        friction = float(-_tangential(scene, groups[k])[:, 0].sum())
        hops[k] = (*_hop(groups[k], groups[k + 1][0], flight, standing), friction)
    return PathOverBed(hops, bounces, groups[:-1])


def _group(
    events: NDArray[Any], path: tuple[Floats, Floats, Floats, Floats], rise: float
) -> tuple[list[NDArray[Any]], list[_Flight]]:
    """Bounces (n + 1 groups of contacts) and the n flights between them."""
    groups: list[NDArray[Any]] = []
    flights: list[_Flight] = []
    first, last = 0, 0  # last: the contact of this group that parts latest
    for k in range(1, len(events)):
        if events["t_begin"][k] > events["t_part"][last]:
            flight = _flight(events[last], events[k], path)
            if flight.z_top - flight.z_takeoff >= rise and flight.z_top > flight.z_takeoff:
                groups.append(events[first:k])
                flights.append(flight)
                first, last = k, k
        if events["t_part"][k] >= events["t_part"][last]:
            last = k
    groups.append(events[first:])
    return groups, flights


def _flight(leaving: Any, landing: Any, path: tuple[Floats, Floats, Floats, Floats]) -> _Flight:
    """Take-off point and top of a flight, from the frames in it and the two contacts at its ends.

    The top is that of the cubic that keeps height and velocity at every frame (exact for a parabola), so
    neither the frame interval nor its phase biases it.
    """
    t, x, v, _ = path
    t_0, t_1 = float(leaving["t_part"]), float(landing["t_begin"])
    inside = slice(np.searchsorted(t, t_0, side="right"), np.searchsorted(t, t_1, side="left"))
    ends = leaving["v_end"], landing["v_begin"]
    ts = np.concatenate([[t_0], t[inside], [t_1]])
    vs = np.vstack([ends[0], v[inside], ends[1]])
    xs = np.vstack([np.zeros(3), x[inside], landing["x_begin"]])
    # back from the first known point of the flight; over one frame interval velocity is linear enough
    xs[0] = xs[1] - 0.5 * (vs[0] + vs[1]) * (ts[1] - ts[0])
    return _Flight(t_0, float(xs[0, 0]), float(xs[0, 2]), _top(ts, xs[:, 2], vs[:, 2]))


def _top(t: Floats, z: Floats, w: Floats) -> float:
    """Highest value of the piecewise cubic through heights z [m] with slopes w [m/s] at times t [s]."""
    k = int(np.argmax(z))
    top = float(z[k])
    for a in range(max(k - 1, 0), min(k + 1, len(t) - 1)):  # the two pieces beside the highest point
        piece = (t[a + 1] - t[a], z[a], z[a + 1], w[a], w[a + 1])
        top = max(top, _top_of_piece(*(float(one) for one in piece)))
    return top


def _top_of_piece(h: float, z_0: float, z_1: float, w_0: float, w_1: float) -> float:
    """Highest turning point of the cubic with heights z and slopes w at both ends of a time h, or -inf."""
    if h <= 0.0:
        return -math.inf
    rise = (z_1 - z_0) / h
    b, c = (3.0 * rise - 2.0 * w_0 - w_1) / h, (w_0 + w_1 - 2.0 * rise) / h**2
    # slope w_0 + 2 b s + 3 c s^2 = 0, in the form that does not cancel
    inside = b * b - 3.0 * c * w_0
    if inside < 0.0:
        return -math.inf
    q = -(b + math.copysign(math.sqrt(inside), b))
    turns = (q / (3.0 * c) if c != 0.0 else math.nan, w_0 / q if q != 0.0 else math.nan)
    return max((z_0 + s * (w_0 + s * (b + s * c)) for s in turns if 0.0 <= s <= h), default=-math.inf)


def _bounce(grain: int, group: NDArray[Any]) -> tuple[float, ...]:
    last = group[int(np.argmax(group["t_part"]))]
    t_begin, t_end = float(group["t_begin"][0]), float(group["t_end"].max())
    return (
        grain,
        t_begin,
        t_end,
        t_end - t_begin,
        len(group),
        float((group["t_end"] - group["t_begin"]).sum()),
        float(group["x_begin"][0, 0]),
        float(group["omega_begin"][0, 1]),
        float(last["omega_end"][1]),
        float(group["overlap_max"].max()),
        float(group["impulse"][:, 2].sum()),
        float(-group["impulse"][:, 0].sum()),
    )


def _tangential(scene: Scene, events: NDArray[Any]) -> Floats:
    """Impulse of the tangential forces of contacts with fixed grains [N s], shape (n, 3).

    It is the whole impulse without that of the normal force along the line of centres in the middle of the
    contact. The line turns by u t/d during a contact; what is left out is of the square of that.
    """
    middle = 0.5 * (events["t_end"] - events["t_begin"])[:, None]
    # speed falls evenly from first touch to parting, so that half-way three quarters of it are the first
    x = events["x_begin"] + middle * (0.75 * events["v_begin"] + 0.25 * events["v_end"])
    arm = x - scene.x_fixed[events["j"] - scene.n_grain]
    for axis, period in enumerate(scene.period):
        if np.isfinite(period):
            arm[:, axis] -= period * np.round(arm[:, axis] / period)
    normal = arm / np.linalg.norm(arm, axis=1, keepdims=True)
    return np.asarray(events["impulse"] - events["impulse_n"][:, None] * normal, dtype=np.float64)


def _hop(group: NDArray[Any], landing: Any, flight: _Flight, standing: float) -> tuple[float, ...]:
    last = group[int(np.argmax(group["t_part"]))]
    t_begin, t_end = float(group["t_begin"][0]), float(landing["t_begin"])
    x_begin, x_end = float(group["x_begin"][0, 0]), float(landing["x_begin"][0])
    return (
        int(last["i"]),
        t_begin,
        flight.t_takeoff,
        t_end,
        t_end - t_begin,
        t_end - flight.t_takeoff,
        x_begin,
        x_end - x_begin,
        x_end - flight.x_takeoff,
        flight.z_takeoff,
        flight.z_top - flight.z_takeoff,
        flight.z_top - standing,
        float(last["v_end"][0]),
        float(last["v_end"][2]),
        float(landing["v_begin"][0]),
        float(landing["v_begin"][2]),
        float(group["impulse"][:, 2].sum()),
        float(-group["impulse"][:, 0].sum()),
    )
