"""Profiles over height of a flow of grains: concentration, velocity, spin, granular temperature, flux."""

import math
from dataclasses import dataclass

import numpy as np

from ryusa.compiled.function import compiled
from ryusa.errors import ResultsError
from ryusa.laws.slices import circle_slice, sphere_slice
from ryusa.measure._run import Above, Floats, Run, level_of, settle_time
from ryusa.measure.snapshot import lanes_of, scene_at
from ryusa.measure.statistics import average, standard_errors
from ryusa.measure.table import Averaged, Averages
from ryusa.model import Scene
from ryusa.model.plane_section import rim_of, section_area
from ryusa.model.scene import Bools
from ryusa.printed import ByShape

CHUNK = 400_000  # places of grains held in memory at once
MOST = 100_000  # layers; more come from a grain that was thrown away
LEAST = 10  # grains from which their hull tells how far they reach
TENTHS = (0.1, 0.9)  # shares of the grains below whose heights walls must be upright, to
UPRIGHT = 0.01  # this share of the area of a section
V, A, U_X, U_Z, SPIN, U_XX, U_ZZ = range(7)  # what is summed over the slices in a layer


@dataclass(frozen=True, repr=False)
class Layers(ByShape):
    """One quantity over height, with the standard error of its mean over time.

    Attributes
    ----------
    name, unit : what it is.
    value : one number per layer, shape (n_layer,); nan where no grain ever was.
    error : standard error from block averages over the frames, the same shape; nan for a single frame.
    """

    name: str
    unit: str
    value: Floats
    error: Floats


@dataclass(frozen=True, repr=False)
class Profiles(Averaged):
    """Means over a time window in layers parallel to the bed.

    Attributes
    ----------
    z : height of the middle of each layer [m], shape (n_layer,).
    thickness : of a layer [m].
    above : what the heights are counted from.
    origin : its height above the datum [m].
    d : mean diameter of the free grains [m].
    phi : concentration, volume of sphere slices over volume of the layer [-].
    area_fraction : area of circle slices over area of the layer seen from the side [-]; nan in 3D.
    v_x, v_z : velocity along the bed and normal to it, weighted with volume [m/s].
    spin : about y, weighted with volume [rad/s]; positive rolls downstream.
    temperature_x, temperature_z : variance of v_x and v_z about the profile's mean [m2/s2].
    flux : volume of grains that crosses a unit of area in a second, phi v_x [m/s].
    bed : concentration of the fixed grains [-], shape (n_layer,); nan unless asked for.
    t : times of the frames [s], shape (n_frame,).
    q : flux over the whole depth per unit width [m2/s], shape (n_frame,).
    speed : v_x averaged over all grains by volume [m/s], shape (n_frame,).
    volume : volume of grains per unit area of bed [m], shape (n_frame,).
    density : mass over volume of the free grains [kg/m3]; turns volume flux into mass flux.
    area : area of bed the grains stand on, all lanes together [m2].
    lanes : copies of a plane scene that were averaged.
    averages : of q and speed, with errors and steadiness.
    """

    z: Floats
    thickness: float
    above: Above
    origin: float
    d: float
    phi: Layers
    area_fraction: Layers
    v_x: Layers
    v_z: Layers
    spin: Layers
    temperature_x: Layers
    temperature_z: Layers
    flux: Layers
    bed: Floats
    t: Floats
    q: Floats
    speed: Floats
    volume: Floats
    density: float
    area: float
    lanes: int
    averages: Averages

    @property
    def columns(self) -> tuple[Layers, ...]:
        """All quantities over height."""
        return (
            self.phi, self.area_fraction, self.v_x, self.v_z, self.spin, self.temperature_x,
            self.temperature_z, self.flux,
        )  # fmt: skip

    @property
    def mass_flux(self) -> Floats:
        """Mass of grains that crosses a unit of area in a second [kg/(m2 s)], shape (n_layer,)."""
        return self.density * self.flux.value

    def top(self, share: float = 0.99) -> float:
        """Height below which so large a share of all grain volume lies [m]."""
        below = np.cumsum(self.phi.value)
        edges = self.z + 0.5 * self.thickness
        if below[-1] <= 0.0:
            return float(edges[0])
        whole = np.concatenate([[0.0], below / below[-1]])
        return float(np.interp(share, whole, np.concatenate([[edges[0] - self.thickness], edges])))

    def rows(self) -> list[dict[str, object]]:
        """One dictionary per layer."""
        names = [(f"{one.name}_{_plain(one.unit)}".rstrip("_"), one) for one in self.columns]
        return [
            dict[str, object](z_m=float(z), z_over_d=float(z) / self.d)
            | {name: float(one.value[k]) for name, one in names}
            | {f"{one.name}_error": float(one.error[k]) for _, one in names}
            | {"phi_bed": float(self.bed[k])}
            for k, z in enumerate(self.z)
        ]

    def series(self) -> list[dict[str, object]]:
        """One dictionary per frame."""
        return [
            {"t_s": float(t), "q_m2_per_s": float(q), "speed_m_per_s": float(u), "volume_m": float(h)}
            for t, q, u, h in zip(self.t, self.q, self.speed, self.volume, strict=True)
        ]


def profiles(
    run: Run,
    begin: float | None = None,
    end: float = math.inf,
    layer: float = 0.5,
    above: Above = "datum",
    between: tuple[float, float] | None = None,
    bed: bool = False,
) -> Profiles:
    """Concentration, velocity and flux over height, averaged over the frames in a window.

    Parameters
    ----------
    run : a run folder.
    begin, end : window [s]; `begin` defaults to the case's `record.settle`.
    layer : thickness of a layer in mean diameters.
    above : what heights are counted from, and where a layer begins: "datum", z = 0 of the case; "bed crest",
        the top of the highest fixed grain; "mean crest", the mean of all their tops.
    between : count only grains whose centre lies in this range of x [m], inside the period; default the
        whole period, or all between upright walls. A scene that is open along x otherwise needs it.
    bed : give the concentration of the fixed grains too; they never count as moving ones.

    Raises
    ------
    ResultsError : no frame in the window, or an area of bed that is not bounded.

    Notes
    -----
    Every grain is cut by the layers' planes, and each slice gives its exact volume; so phi times thickness
    adds up to the volume of all grains per area, and flux times thickness to the sum of V v_x per area. A
    grain gives its velocity to all layers it reaches into: over less than one diameter the profiles are
    smooth, and the temperature holds the shear across a grain. Mean velocities are ratios of sums over all
    frames, temperatures variances about that mean, over grains and time. Frames hold `v` half a step behind
    `x`, which no profile can tell. In a plane scene the width is `slab_width`, and lanes are averaged.
    """
    t, first, last, scene, since = _frames(run, begin, end)
    z_0, thickness = level_of(scene, above), layer * scene.d_mean
    _, lanes = lanes_of(np.asarray(run.frames.x[first], dtype=np.float64)[:, 1], scene)
    area = area_of(run, first, scene, lanes) if between is None else _stretch(scene, lanes, between)
    if not math.isfinite(area):
        raise ResultsError(
            f"the scene is open along {'y' if math.isfinite(scene.period[0]) else 'x'}: a profile is a mean "
            "over periods or between upright walls, and there are none. In Python, "
            "ryusa.measure.profiles(run, between=(x_0, x_1)) takes a stretch"
        )
    sums, edge = _sums(run, first, last, scene, z_0, thickness, between, bed)
    n_layer, space = sums.shape[1], area * thickness
    length = float(scene.period[0]) if between is None else between[1] - between[0]
    side = length * thickness * lanes if scene.plane_case else math.nan
    volume, weight = sums[:, :, V], sums[:, :, V].sum(axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        speed = sums[:, :, U_X].sum(axis=1) / weight
    q = sums[:, :, U_X].sum(axis=1) / area
    fixed = _bed(scene, edge, n_layer, z_0, thickness, between) / space if bed else None
    return Profiles(
        z=(edge + np.arange(n_layer) + 0.5) * thickness,
        thickness=thickness,
        above=above,
        origin=z_0,
        d=scene.d_mean,
        phi=_mean("phi", "-", volume / space),
        area_fraction=_mean("area_fraction", "-", sums[:, :, A] / side),
        v_x=_quotient("v_x", "m/s", sums[:, :, U_X], volume),
        v_z=_quotient("v_z", "m/s", sums[:, :, U_Z], volume),
        spin=_quotient("spin", "rad/s", sums[:, :, SPIN], volume),
        temperature_x=_variance("temperature_x", sums[:, :, U_XX], sums[:, :, U_X], volume),
        temperature_z=_variance("temperature_z", sums[:, :, U_ZZ], sums[:, :, U_Z], volume),
        flux=_mean("flux", "m/s", sums[:, :, U_X] / space),
        bed=np.full(n_layer, math.nan) if fixed is None else fixed,
        t=t,
        q=q,
        speed=speed,
        volume=weight / area,
        density=float(scene.m.sum() / scene.solid_volume.sum()),
        area=area,
        lanes=lanes,
        averages=_averages(q, speed, weight / area, n_layer, thickness, (since, float(t[-1]))),
    )


def _frames(run: Run, begin: float | None, end: float) -> tuple[Floats, int, int, Scene, float]:
    """Times of the frames in a window [s], the first and one beyond the last, scene and begin [s]."""
    since = settle_time(run) if begin is None else begin
    t, scene = np.asarray(run.frames.t, dtype=np.float64), scene_at(run, since)
    first, last = int(np.searchsorted(t, since, "left")), int(np.searchsorted(t, end, "right"))
    if last <= first or scene.n_grain == 0:
        raise ResultsError(f"no frame of free grains from t = {since:g} s to {end:g} s")
    return t[first:last], first, last, scene, since


def _averages(
    q: Floats, speed: Floats, volume: Floats, n_layer: int, thickness: float, window: tuple[float, float]
) -> Averages:
    """Averages of flux and speed, with the solid volume per area of bed [m] as a note."""
    return Averages(
        "profile",
        (
            average("flux", "m2/s", [q], window),
            average("speed", "m/s", [speed], window),
        ),
        (
            f"solid volume per area of bed: {float(volume.mean()):.4g} m, in {n_layer} layers of "
            f"{thickness:.3g} m, mean of {len(volume)} frames",
        ),
    )


@compiled()
def _cut(
    z: Floats, r: Floats, solid: Floats, counted: Bools, carried: Floats, bottom: int, thickness: float,
    sums: Floats,
) -> None:  # fmt: skip
    """Add every grain's slices to the layers they lie in.

    solid : (n_grain,) volume of matter over that of the sphere [-]; below 1 where spheres of a clump overlap.

    z, counted : (n_frame, n_grain) heights above the origin [m], and whether the grain counts.
    carried : (n_frame, n_grain, 5) what a slice carries along, per volume.
    bottom : number of the lowest layer, from the origin. sums : (n_frame, n_layer, 7), added to.
    """
    n_layer = sums.shape[1]
    for f in range(z.shape[0]):
        for g in range(z.shape[1]):
            if not counted[f, g]:
                continue
            low = int(np.floor((z[f, g] - r[g]) / thickness)) - bottom
            high = int(np.floor((z[f, g] + r[g]) / thickness)) - bottom
            low, high = min(max(low, 0), n_layer - 1), min(max(high, 0), n_layer - 1)
            for k in range(low, high + 1):  # the outermost slices reach to the poles, whatever the rounding
                a = -r[g] if k == low else (bottom + k) * thickness - z[f, g]
                b = r[g] if k == high else (bottom + k + 1) * thickness - z[f, g]
                part = solid[g] * sphere_slice(r[g], a, b)
                sums[f, k, 0] += part
                sums[f, k, 1] += circle_slice(r[g], a, b)
                for c in range(carried.shape[2]):
                    sums[f, k, 2 + c] += part * carried[f, g, c]


def _sums(
    run: Run, first: int, last: int, scene: Scene, z_0: float, thickness: float,
    between: tuple[float, float] | None, bed: bool,
) -> tuple[Floats, int]:  # fmt: skip
    """Sums over slices, (n_frame, n_layer, 7), and the number of the lowest layer counted from the origin."""
    r, solid = 0.5 * scene.d, scene.solid_volume / (np.pi / 6.0 * scene.d**3)
    step = max(CHUNK // scene.n_grain, 1)
    spans = [slice(a, min(a + step, last)) for a in range(first, last, step)]
    pieces: list[tuple[int, Floats]] = []
    reached = (
        [_reach(scene.x_fixed[:, 2] - z_0, 0.5 * scene.d_fixed, thickness)] if bed and scene.n_fixed else []
    )
    for span in spans:
        x = np.asarray(run.frames.x[span], dtype=np.float64)
        v = np.asarray(run.frames.v[span], dtype=np.float64)
        omega = np.asarray(run.frames.omega[span], dtype=np.float64)
        z = np.ascontiguousarray(x[:, :, 2] - z_0)
        counted = _inside(x[:, :, 0], scene, between)
        bottom, top = _reach(z, r, thickness)
        reached.append((bottom, top))
        if top - bottom > MOST:
            raise ResultsError(
                f"the grains reach over {top - bottom} layers of {thickness:g} m; one flew off"
            )
        carried = np.stack([v[:, :, 0], v[:, :, 2], omega[:, :, 1], v[:, :, 0] ** 2, v[:, :, 2] ** 2], axis=2)
        part = np.zeros((len(x), top - bottom, 7))
        _cut(z, r, solid, counted, carried, bottom, thickness, part)
        pieces.append((bottom, part))
    low, high = min(low for low, _ in reached), max(high for _, high in reached)
    sums = np.zeros((last - first, high - low, 7))
    for span, (bottom, part) in zip(spans, pieces, strict=True):
        sums[span.start - first : span.stop - first, bottom - low : bottom - low + part.shape[1]] = part
    return sums, low


def _bed(
    scene: Scene, edge: int, n_layer: int, z_0: float, thickness: float, between: tuple[float, float] | None
) -> Floats:
    """Volume of the fixed grains in each layer [m3], as they stand at the begin of the window."""
    there = scene.fixed_active & _inside(scene.x_fixed[None, :, 0], scene, between)[0]
    z = np.ascontiguousarray(scene.x_fixed[None, :, 2] - z_0)
    sums = np.zeros((1, n_layer, 7))
    none = np.zeros((*z.shape, 0))
    _cut(z, 0.5 * scene.d_fixed, np.ones(scene.n_fixed), there[None, :], none, edge, thickness, sums)
    return sums[0, :, V]


def _reach(z: Floats, r: Floats, thickness: float) -> tuple[int, int]:
    """Lowest layer reached, and one beyond the highest, counted from the origin."""
    return math.floor(float((z - r).min()) / thickness), math.ceil(float((z + r).max()) / thickness)


def _inside(x: Floats, scene: Scene, between: tuple[float, float] | None) -> Bools:
    if between is None:
        return np.ones(x.shape, dtype=np.bool_)
    period = float(scene.period[0])
    x = x - between[0]
    if math.isfinite(period):
        x = np.mod(x, period)
    return (x >= 0.0) & (x < between[1] - between[0])


def area_of(run: Run, first: int, scene: Scene, lanes: int) -> float:
    """Area of bed, all lanes together, or of the sample between upright walls [m2]; inf where it is open.

    Between walls it is that of the section at the middle height of the grains in frame `first`, seen from
    their middle; inf where those at the heights of the lowest and highest tenth differ by 1 % or more, or
    where grains lie round more than is seen, as in a ring.
    """
    along, across = float(scene.period[0]), _width(scene, lanes)
    if scene.plane_case or math.isfinite(along * across):
        return along * across
    x = np.asarray(run.frames.x[first], dtype=np.float64)
    heights = np.nanquantile(x[:, 2], (0.5, *TENTHS))
    middle, up, t = np.nanmean(x, axis=0), np.array([0.0, 0.0, 1.0]), float(run.frames.t[first])
    area, *others = [section_area(scene, np.array([*middle[:2], z]), up, t) for z in heights]
    if not all(abs(one - area) < UPRIGHT * area for one in others):
        return math.inf
    there = x[np.isfinite(x[:, 0])]
    return math.inf if len(there) > LEAST and rim_of(there, up)[1] > area else area


def _stretch(scene: Scene, lanes: int, between: tuple[float, float]) -> float:
    """Area of a stretch of bed [m2]; inf where it has no width or no length."""
    length = between[1] - between[0]
    return length * _width(scene, lanes) if length > 0.0 else math.inf


def _width(scene: Scene, lanes: int) -> float:
    """Width of bed across the flow, in a period or between planes [m]; inf where there is none."""
    if scene.plane_case:
        return lanes * (scene.slab_width if math.isfinite(scene.slab_width) else float(scene.d.mean()))
    if math.isfinite(scene.period[1]):
        return float(scene.period[1])
    sides = side_planes(scene)
    return math.inf if sides is None else sides[1] - sides[0]


def side_planes(scene: Scene) -> tuple[float, float] | None:
    """Places y of the planes that face each other across the flow [m]; None without two of them."""
    facing = scene.plane_normal[:, 1] * scene.plane_active
    right, left = (scene.plane_point[facing == side, 1] for side in (1.0, -1.0))
    return (float(right.max()), float(left.min())) if len(right) and len(left) else None


def _mean(name: str, unit: str, series: Floats) -> Layers:
    return Layers(name, unit, series.mean(axis=0), standard_errors(series))


def _quotient(name: str, unit: str, above: Floats, below: Floats) -> Layers:
    """Sum over sum; to first order its error is that of the mean of above - value below over mean below."""
    with np.errstate(invalid="ignore", divide="ignore"):
        value = above.sum(axis=0) / below.sum(axis=0)
        error = standard_errors((above - value * below) / below.mean(axis=0))
    return Layers(name, unit, value, error)


def _variance(name: str, square: Floats, once: Floats, below: Floats) -> Layers:
    """Mean of the square less square of the mean, never below zero."""
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = once.sum(axis=0) / below.sum(axis=0)
        value = np.maximum(square.sum(axis=0) / below.sum(axis=0) - mean**2, 0.0)
        rest = square - 2.0 * mean * once + (mean**2 - value) * below
        error = standard_errors(rest / below.mean(axis=0))
    return Layers(name, "m2/s2", value, error)


def _plain(unit: str) -> str:
    """A unit as part of a column's name."""
    return "" if unit == "-" else unit.replace("/", "_per_").replace(" ", "_")
