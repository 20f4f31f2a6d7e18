"""The free surface of a heap: height over distance, the slope fitted to it, and whether it stands still."""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ryusa.catalogue import SIDES
from ryusa.errors import ResultsError
from ryusa.measure._run import Floats, Run
from ryusa.measure.snapshot import Snapshot, frame_at, scene_at, snapshot
from ryusa.measure.table import lines
from ryusa.model import Scene
from ryusa.model.groups import groups
from ryusa.model.near_pairs import near_pairs
from ryusa.printed import ByShape
from ryusa.spelling import known_word

FIT = (0.15, 0.85)  # of the heap's height
OTHER_FITS = ((0.1, 0.9), (0.2, 0.8), (0.25, 0.75))
BIN = 1.5  # mean diameters
LINK = 0.5  # gap across which two grains still belong together, in mean diameters: no grain fits through
STILL = 0.01  # speed below which a grain counts as still, over sqrt(g d)
STEEP = math.radians(60.0)  # a steeper surface stands like a wall
LEAST = 4  # bins in a fit
G = 9.80665  # [m/s2], where the case has no gravity

Side = Literal["right", "left"]


@dataclass(frozen=True, repr=False)
class HeapSurface(ByShape):
    """Free surface of a heap at one moment. Angles in radians, heights above z = 0.

    Attributes
    ----------
    t : time of the frame [s].
    side : the side the fitted slope falls to: "right" is +x.
    x, z : highest point of the heap in each bin along x [m], from left to right.
    fit : heights between which the slope is fitted, as shares of the heap's height above the floor.
    inside : bins the fit uses.
    angle : slope, positive where it falls towards `side` [rad]; nan where fewer than 4 bins can be used.
    error : its standard error from the scatter about the line [rad].
    line : x and z of the lower and upper end of the fitted line [m], shape (2, 2).
    angles : slope over other heights, by name [rad]; "upper half" and "lower half" are of the fit range.
    spread : largest less smallest of `angle` and those [rad].
    flags : what is wrong with the slope, in words; empty where nothing is.
    floor, crest : height of the floor and of the highest point [m].
    toe : x of the foot of the heap [m], the outermost point of any grain in it.
    start : x where the heap ended before it was let go [m]: the gate, or else the foot at the first frame.
    run_out : from there to the toe [m].
    grains : ids of the grains of the heap.
    away : number of free grains that are no part of it.
    speed, surface_speed : largest speed of its grains, and of their spinning surface |omega| d/2 [m/s].
    still : sum of both from which a grain counts as moving [m/s].
    moving : share of its grains that move [-].
    """

    t: float
    side: Side
    x: Floats
    z: Floats
    fit: tuple[float, float]
    inside: NDArray[np.bool_]
    angle: float
    error: float
    line: Floats
    angles: dict[str, float]
    spread: float
    flags: tuple[str, ...]
    floor: float
    crest: float
    toe: float
    start: float
    run_out: float
    grains: NDArray[np.int64]
    away: int
    speed: float
    surface_speed: float
    still: float
    moving: float

    @property
    def at_rest(self) -> bool:
        """True where no grain of the heap moves."""
        return self.moving == 0.0

    def quantities(self) -> list[tuple[str, float, str]]:
        """Slope, height and run-out: name, value, and unit of the value; nan where there is none."""
        low, high = self.fit
        angles = {
            f"slope, fitted from {low:g} to {high:g} of the height": self.angle,
            "± s.e. of the fit": self.error,
            **{f"slope, {name}": angle for name, angle in self.angles.items()},
            "range of these slopes": self.spread,
        }
        lengths = {
            "crest above the floor": self.crest - self.floor,
            "toe at x": self.toe,
            "run-out": self.run_out,
        }
        return [
            *((name, math.degrees(angle), "deg") for name, angle in angles.items()),
            *((name, 100.0 * length, "cm") for name, length in lengths.items()),
            ("largest speed", self.speed, "m/s"),
            ("largest surface speed by spin, |omega| d/2", self.surface_speed, "m/s"),
        ]

    def rows(self) -> list[dict[str, object]]:
        """One dictionary per quantity."""
        values: list[tuple[str, str, float]] = [
            ("time", "s", self.t),
            ("slope", "rad", self.angle),
            ("slope_error", "rad", self.error),
            *((f"slope, {name}", "rad", one) for name, one in self.angles.items()),
            ("slope_spread", "rad", self.spread),
            ("crest", "m", self.crest),
            ("floor", "m", self.floor),
            ("toe", "m", self.toe),
            ("run_out", "m", self.run_out),
            ("grains", "-", float(len(self.grains))),
            ("away", "-", float(self.away)),
            ("largest_speed", "m/s", self.speed),
            ("largest_surface_speed", "m/s", self.surface_speed),
            ("moving_share", "-", self.moving),
        ]
        return [{"quantity": name, "unit": unit, "value": value} for name, unit, value in values]

    def samples(self) -> list[dict[str, object]]:
        """One dictionary per bin."""
        return lines({"x_m": self.x, "z_m": self.z, "in_fit": self.inside})


def surface(
    run: Run,
    t: float | None = None,
    side: Side = "right",
    fit: tuple[float, float] = FIT,
    bin: float = BIN,
    link: float = LINK,
    still: float | None = None,
    floor: float | None = None,
    lane: int | None = None,
) -> HeapSurface:
    """Free surface of a heap and the slope of one side of it.

    Parameters
    ----------
    run : a run folder.
    t : [s], the nearest frame is taken; default the last one.
    side : which side of the crest; a CaseError where it is neither.
    fit : heights between which the slope is fitted, as shares of the heap's height above the floor.
    bin : width of a bin along x, in mean diameters.
    link : grains whose surfaces are up to this many mean diameters apart belong together; the heap is the
        largest such group of grains above the floor.
    still : a grain moves where its speed and that of its surface, |omega| d/2, sum up to more [m/s]; default
        0.01 sqrt(g d).
    floor : height of the floor [m]; default the group `floor` of the scene (its mean crest), else the lowest
        point of any grain.
    lane : lane of a plane scene.

    Notes
    -----
    The height of a bin is that of the highest point of any sphere within it, at the place where that is; rows
    in y count as one. The slope is a least-squares line through those points.
    """
    known_word(side, SIDES, "side")
    if not 0.0 <= fit[0] < fit[1] <= 1.0:
        raise ResultsError(f"fit {fit[0]:g} .. {fit[1]:g}: must be two shares of the height, 0 to 1, rising")
    seen = snapshot(run, t, lane)
    scene = _open_scene(run, seen.t)
    d = float(scene.whole_grains()[0].mean())
    level = _floor(scene, seen) if floor is None else floor
    chosen = _heap(seen, scene, level, link * d)
    if len(chosen) == 0:
        raise ResultsError(f"no grain above the floor at z = {level:g} m at t = {seen.t:g} s")
    sign = 1.0 if side == "right" else -1.0
    x, z, r = sign * seen.x[chosen, 0], seen.x[chosen, 2], 0.5 * seen.d[chosen]
    s, top = _profile(x, z, r, bin * d)
    inside, angle, error, line = _slope(s, top, level, fit)
    line[:, 0] *= sign
    angles = _other_slopes(s, top, level, fit)
    known = [one for one in (angle, *angles.values()) if math.isfinite(one)]
    start, toe = _start(run, sign, level, lane), float((x + r).max())
    ids = seen.grains[chosen]
    around = np.linalg.norm(np.asarray(run.frames.omega[frame_at(run, seen.t)])[ids], axis=1) * r
    limit = _still(scene, d) if still is None else still
    order = slice(None) if sign > 0.0 else slice(None, None, -1)
    return HeapSurface(
        t=seen.t,
        side=side,
        x=(sign * s)[order],
        z=top[order],
        fit=fit,
        inside=inside[order],
        angle=angle,
        error=error,
        line=line,
        angles=angles,
        spread=max(known) - min(known) if len(known) > 1 else math.nan,
        flags=_flags(s, top, level, fit, inside, angle, d),
        floor=level,
        crest=float(top.max()),
        toe=sign * toe,
        start=sign * start,
        run_out=toe - start,
        grains=ids,
        away=len(seen.grains) - len(ids),
        speed=float(seen.speed[chosen].max()),
        surface_speed=float(around.max()),
        still=limit,
        moving=float((seen.speed[chosen] + around > limit).mean()),
    )


def _open_scene(run: Run, t: float) -> Scene:
    """The scene at time t [s]; an error where it is periodic along x."""
    scene = scene_at(run, t)
    if math.isfinite(scene.period[0]):
        raise ResultsError(
            "the scene is periodic along x: it holds no heap with a foot to measure a slope of"
        )
    return scene


def _other_slopes(s: Floats, top: Floats, level: float, fit: tuple[float, float]) -> dict[str, float]:
    """Slope over other ranges of the height than `fit`, and over both halves of it [rad], by name."""
    middle = 0.5 * (fit[0] + fit[1])
    halves = {"upper half": (middle, fit[1]), "lower half": (fit[0], middle)}
    others = {f"{low:g} to {high:g}": (low, high) for low, high in OTHER_FITS if (low, high) != fit} | halves
    return {name: _slope(s, top, level, share)[1] for name, share in others.items()}


def _still(scene: Scene, d: float) -> float:
    """Speed below which a grain counts as still [m/s]."""
    gravity = float(np.linalg.norm(scene.gravity)) or G
    return STILL * math.sqrt(gravity * d)


def _floor(scene: Scene, seen: Snapshot) -> float:
    """Height of the floor [m]: mean crest of the fixed grains, or the plane, that the scene calls floor.

    Where walls are the floor, as in a flume, the lowest point of the grains stands for it.
    """
    first, end = scene.groups.get("floor", (0, 0))
    fixed = np.arange(first, end) - scene.n_grain
    if len(fixed) and fixed[-1] < scene.n_fixed:
        return float((scene.x_fixed[fixed, 2] + 0.5 * scene.d_fixed[fixed]).mean())
    if len(fixed) and fixed[-1] - scene.n_fixed < len(scene.plane_point):
        return float(scene.plane_point[fixed[0] - scene.n_fixed, 2])
    return float((seen.x[:, 2] - 0.5 * seen.d).min()) if len(seen.d) else 0.0


def _heap(seen: Snapshot, scene: Scene, level: float, gap: float) -> NDArray[np.int64]:
    """Largest group of grains above the floor that touch, or nearly so; places in the snapshot."""
    above = np.flatnonzero(seen.x[:, 2] > level)
    if len(above) < 2:
        return above
    x, r = seen.x[above], 0.5 * seen.d[above]
    period = np.array([*scene.period, 0.0])
    period = np.where(np.isfinite(period), period, 0.0)  # 0 means open
    pairs = near_pairs(x, 2.0 * r, period, gap=gap)
    away = x[pairs[:, 0]] - x[pairs[:, 1]]
    away -= period * np.round(np.divide(away, period, out=np.zeros_like(away), where=period > 0.0))
    touch = np.linalg.norm(away, axis=1) - r[pairs].sum(axis=1) <= gap
    group = groups(pairs[touch], len(above))
    return above[group == np.bincount(group).argmax()]


def _profile(x: Floats, z: Floats, r: Floats, width: float) -> tuple[Floats, Floats]:
    """Place and height of the highest point in each bin that holds any [m], from the left to the foot."""
    low, high = float((x - r).min()), float((x + r).max())
    count = max(math.ceil((high - low) / width), 1)
    first = np.clip(((x - r - low) / width).astype(np.int64), 0, count - 1)
    last = np.clip(((x + r - low) / width).astype(np.int64), 0, count - 1)
    bins: list[NDArray[np.int64]] = []
    places: list[Floats] = []
    heights: list[Floats] = []
    for step in range(int((last - first).max()) + 1):  # a sphere reaches into so many bins
        k = np.minimum(first + step, last)
        at = np.clip(x, low + k * width, low + (k + 1) * width)
        bins.append(k)
        places.append(at)
        heights.append(z + np.sqrt(np.maximum(r * r - (x - at) ** 2, 0.0)))
    k, place, height = np.concatenate(bins), np.concatenate(places), np.concatenate(heights)
    order = np.lexsort((height, k))
    highest = order[np.append(np.diff(k[order]) > 0, True)]  # the last of each bin
    return place[highest], height[highest]


def _slope(
    s: Floats, top: Floats, level: float, fit: tuple[float, float]
) -> tuple[NDArray[np.bool_], float, float, Floats]:
    """Bins in the fit, angle and its standard error [rad], and the ends of the line [m]; falls towards +s."""
    height = float(top.max()) - level
    share = (top - level) / height if height > 0.0 else np.zeros(len(top))
    inside = (share >= fit[0]) & (share <= fit[1]) & (s >= s[top.argmax()])
    nothing = np.full((2, 2), np.nan)
    n = int(inside.sum())
    if n < LEAST:
        return inside, math.nan, math.nan, nothing
    a, b = s[inside], top[inside]
    along = a - a.mean()
    tangent = float((along * b).sum() / (along * along).sum())
    rest = b - b.mean() - tangent * along
    error = math.sqrt(float((rest * rest).sum()) / (n - 2) / float((along * along).sum()))
    ends = np.array([a.max(), a.min()])
    line = np.column_stack([ends, b.mean() + tangent * (ends - a.mean())])
    return inside, math.atan(-tangent), error / (1.0 + tangent * tangent), line


def _flags(
    s: Floats,
    top: Floats,
    level: float,
    fit: tuple[float, float],
    inside: NDArray[np.bool_],
    angle: float,
    d: float,
) -> tuple[str, ...]:
    """What is wrong with a slope; `d` is the mean diameter [m]."""
    flags: list[str] = []
    height, crest = float(top.max()) - level, int(top.argmax())
    upper = s[(top - level >= fit[1] * height) & (np.arange(len(s)) >= crest)].max()
    down = s[(top - level <= fit[0] * height) & (s > upper)]
    way = (float(down.min()) if len(down) else float(s.max())) - float(upper)
    chord = math.atan2((fit[1] - fit[0]) * height, way)
    n = int(inside.sum())
    if n < LEAST:
        flags.append(f"too few bins: {n} in the fit, {LEAST} needed")
    if height > LEAST * d and (angle if math.isfinite(angle) else chord) > STEEP:
        flags.append(f"stands like a wall: steeper than {math.degrees(STEEP):g} deg")
    return tuple(flags)


def _start(run: Run, sign: float, level: float, lane: int | None) -> float:
    """Where the heap ended before it was let go [m], along the side's own axis."""
    scene, seen = run.scene, snapshot(run, float(run.frames.t[0]), lane)
    above = seen.x[:, 2] > level
    foot = float((sign * seen.x[above, 0] + 0.5 * seen.d[above]).max()) if above.any() else math.nan
    first, end = scene.groups.get("gate", (0, 0))
    wall = np.arange(first, end) - scene.n_grain
    if len(wall) == 0 or wall[-1] >= scene.n_fixed + scene.n_plane:  # no gate, or one of faces
        return foot
    if wall[-1] < scene.n_fixed:
        gate = float((sign * scene.x_fixed[wall, 0] - 0.5 * scene.d_fixed[wall]).min())
    else:
        gate = sign * float(scene.plane_point[wall[0] - scene.n_fixed, 0])
    return gate if gate > float(np.median(sign * seen.x[:, 0])) else foot  # a gate on the other side
