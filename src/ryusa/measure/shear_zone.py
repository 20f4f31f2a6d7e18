"""Shear zone over a split bottom: angular velocity over the radius, and the error function fitted to it."""

import math
import warnings
from dataclasses import dataclass

import numpy as np

from ryusa.errors import ResultsError
from ryusa.measure._run import Floats, Run, settle_time
from ryusa.measure.layers import Layers, layers_quotient
from ryusa.measure.snapshot import scene_at
from ryusa.measure.statistics import average
from ryusa.measure.table import Averaged, Averages
from ryusa.measure.walls import walls
from ryusa.model.walls import AXIS_POINT, SPIN, FaceKind

RING = 0.5  # width of a ring in mean diameters
LAYER = 1.0  # thickness of a layer in mean diameters
SURFACE = 1.5  # depth of the grains that count as the surface, in mean diameters
TOP = 0.98  # quantile of the tops of the grains that is their height
BLOCKS = 25  # parts of the window, each with a fit of its own
LEAST = 6  # rings in a fit
MIDDLE = 0.3  # of the radius of the disc: the few grains closer to the axis are left out of fits
RINGS = 1000  # at most
FAINTEST = 0.05  # share of the rate of the disc with which the surface must turn
LEVEL = 1.0e-6  # sine of the angle up to which a direction is upright


@dataclass(frozen=True, repr=False)
class ShearZone(Averaged):
    """Where grains between a turning and a resting part of the floor are sheared.

    Attributes
    ----------
    wall : name of the disc that turns.
    rate : its angular velocity, without its sign [rad/s].
    r_s : its radius [m].
    height : of the grains above it [m].
    r : middle of each ring [m], shape (n_ring,).
    turning : angular velocity of the grains of the surface over that of the disc [-].
    centre, width, share : R_c [m], W [m] and A [-] of A erfc((r - R_c)/W)/2 fitted to it.
    misfit : largest difference from that curve, over A [-].
    z : middle of each layer above the disc [m], shape (n_layer,).
    centres, widths : of fits to each layer [m]; nan where there is none.
    torque : about the axis, of the grains on the disc and on all other walls, means over the window [N m].
    change : by how much the impulse of the walls about the axis differs from the change of the angular
        momentum of the grains, over the impulse of the disc [-].
    averages : centre, width and share.
    """

    wall: str
    rate: float
    r_s: float
    height: float
    r: Floats
    turning: Layers
    centre: float
    width: float
    share: float
    misfit: float
    z: Floats
    centres: Floats
    widths: Floats
    torque: tuple[float, float]
    change: float
    averages: Averages


def zone(r: Floats, centre: float, width: float, share: float) -> Floats:
    """Angular velocity over that of the disc: an error function [-].

    >>> [float(one) for one in zone(np.array([0.0, 1.0, 2.0]), 1.0, 0.1, 1.0).round(6)]
    [1.0, 0.5, 0.0]
    """
    from scipy.special import erfc

    return np.asarray(0.5 * share * erfc((r - centre) / width))


def shear_zone(run: Run, begin: float | None = None, end: float = math.inf) -> ShearZone:
    """Fit an error function to the angular velocity of grains over a floor whose middle turns.

    Parameters
    ----------
    run : a run folder with a disc, level, that turns about its own upright axis.
    begin, end : window [s]; `begin` defaults to the case's `record.settle`.

    Raises
    ------
    ResultsError : no such disc, too few frames in the window, or no zone in the grains.

    Notes
    -----
    The angular velocity of a ring, half a diameter wide, is the angular momentum of its grains about the axis
    over their moment of inertia, both summed over the frames; the surface is the uppermost 1.5 diameters.
    Fenistein & van Hecke 2003, Nature 425, 256: at the surface it is an error function of the radius.
    Averages are over fits to 25 parts of the window. Torques are from impulses summed at every step; on
    all walls together they are the loss of the angular momentum of the grains, spin included.
    """
    number, axis, rate, r_s, low = _disc(run)
    since, every = settle_time(run) if begin is None else begin, np.asarray(run.frames.t, dtype=np.float64)
    first, last = int(np.searchsorted(every, since, "left")), int(np.searchsorted(every, end, "right"))
    if last - first < 2 * BLOCKS:
        raise ResultsError(
            f"{last - first} frames from t = {since:g} s to {end:g} s; {2 * BLOCKS} are needed"
        )
    scene = scene_at(run, since)
    d, tops = float(scene.d_mean), np.array([_top(run, k, 0.5 * scene.d) for k in range(first, last)])
    height = float(tops.mean()) - low
    n_layer = max(int(height / (LAYER * d)), 1)
    sums = np.stack([
        _rings(run, first + n, axis, float(top) - SURFACE * d, low, n_layer) for n, top in enumerate(tops)
    ])  # fmt: skip
    n_ring = int(np.flatnonzero(sums[:, 0, 1].sum(axis=0) > 0.0).max()) + 1
    above, below = sums[:, :, 0, :n_ring] / rate, sums[:, :, 1, :n_ring]
    r = np.asarray((np.arange(n_ring) + 0.5) * (RING * d), dtype=np.float64)
    turning = layers_quotient("turning", "-", above[:, 0], below[:, 0])
    best = _fit(r, above[:, 0], below[:, 0], r_s, d)
    if not (np.isfinite(best).all() and best[2] > FAINTEST):
        raise ResultsError(
            "no shear zone at the surface: an error function does not fit the angular velocity"
        )
    curve = zone(r, *best.tolist())
    parts = np.array_split(np.arange(last - first), BLOCKS)
    fits = np.array([_fit(r, above[one, 0], below[one, 0], r_s, d) for one in parts])
    layers = np.array([_fit(r, above[:, 1 + k], below[:, 1 + k], r_s, d) for k in range(n_layer)])
    torque, change = _torques(run, first, last, number, axis)
    window = (float(every[first]), float(every[last - 1]))
    items = tuple(
        average(name, unit, [fits[:, k]], window)
        for k, (name, unit) in enumerate((("centre", "m"), ("width", "m"), ("share", "-")))
    )
    assert run.scene.walls is not None
    name = run.scene.walls.names[number]
    notes = (
        f"disc {name!r}: {rate:.4g} rad/s, radius {r_s:.4g} m; grains {height:.4g} m high, "
        f"{height / r_s:.3g} of it",
        f"torque of the grains on the disc {torque[0]:.4g} N m, on the other walls {torque[1]:.4g} N m; the "
        "impulse of all walls and the change of the angular momentum of the grains differ by "
        f"{change:.1e} of the impulse of the disc",
    )
    known = np.isfinite(turning.value) & (below[:, 0].sum(axis=0) > 0.0)
    return ShearZone(
        wall=name, rate=rate, r_s=r_s, height=height, r=r, turning=turning,
        centre=float(best[0]), width=float(best[1]), share=float(best[2]),
        misfit=float(np.abs(turning.value - curve)[known & (r > MIDDLE * r_s)].max() / best[2]),
        z=np.asarray((np.arange(n_layer) + 0.5) * (LAYER * d), dtype=np.float64),
        centres=layers[:, 0], widths=layers[:, 1], torque=torque, change=change,
        averages=Averages("shear_zone", items, notes),
    )  # fmt: skip


def _disc(run: Run) -> tuple[int, Floats, float, float, float]:
    """Number of the disc that turns, its centre [m], (2,), rate [rad/s], radius and height [m]."""
    walls_ = run.scene.walls
    if walls_ is None:
        raise ResultsError("the run has no walls, so no disc that turns")
    for f in np.flatnonzero(walls_.kind == FaceKind.DISC):
        w = int(walls_.wall[f])
        spin, normal, centre = walls_.motion[w, SPIN : SPIN + 3], walls_.face[f, 3:6], walls_.face[f, :3]
        size = float(np.linalg.norm(spin))
        point = walls_.motion[w, AXIS_POINT : AXIS_POINT + 2]
        upright = (
            size > 0.0 and abs(float(spin[2])) > (1.0 - LEVEL) * size and abs(float(normal[2])) > 1.0 - LEVEL
        )
        if upright and np.allclose(point, centre[:2], atol=LEVEL * float(walls_.face[f, 6])):
            return w, centre[:2].copy(), float(spin[2]), float(walls_.face[f, 6]), float(centre[2])
    raise ResultsError("the run has no level disc that turns about its own upright axis")


def _top(run: Run, k: int, radius: Floats) -> float:
    """Height of the surface in one frame [m]."""
    return float(np.quantile(np.asarray(run.frames.x[k], dtype=np.float64)[:, 2] + radius, TOP))


def _rings(run: Run, k: int, axis: Floats, surface: float, low: float, n_layer: int) -> Floats:
    """Angular momentum and moment of inertia about the axis by ring, (1 + n_layer, 2, RINGS).

    First those of the surface, then of the layers. Spins and moments of inertia of the grains about
    themselves are left out of both.
    """
    scene = run.scene
    x, v = (np.asarray(one[k], dtype=np.float64) for one in (run.frames.x, run.frames.v))
    off = x[:, :2] - axis
    r2 = (off**2).sum(axis=1)
    ring = (np.sqrt(r2) / (RING * scene.d_mean)).astype(np.int64)
    layer = np.floor((x[:, 2] - low) / (LAYER * scene.d_mean)).astype(np.int64)
    carried = np.stack([scene.m * (off[:, 0] * v[:, 1] - off[:, 1] * v[:, 0]), scene.m * r2])
    found = np.zeros((1 + n_layer, 2, RINGS))
    for level, chosen in [
        (0, x[:, 2] + 0.5 * scene.d > surface),
        *((1 + n, layer == n) for n in range(n_layer)),
    ]:
        keep = chosen & (ring < RINGS)
        for what in range(2):
            found[level, what] = np.bincount(ring[keep], carried[what, keep], RINGS)
    return found


def _fit(r: Floats, above: Floats, below: Floats, r_s: float, d: float) -> Floats:
    """Centre [m], width [m] and share of an error function, rings weighted by mass; or nan."""
    from scipy.optimize import OptimizeWarning, curve_fit

    inertia = below.sum(axis=0)
    known = inertia > 0.0
    value = np.divide(above.sum(axis=0), inertia, np.zeros(len(r)), where=known)
    known &= r > MIDDLE * r_s
    if known.sum() < LEAST:
        return np.full(3, math.nan)
    sigma = 1.0 / np.sqrt(inertia[known] / r[known] ** 2)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", OptimizeWarning)
            best, _ = curve_fit(zone, r[known], value[known], (r_s, d, 1.0), sigma)
    except (RuntimeError, OptimizeWarning):
        return np.full(3, math.nan)
    best[1] = abs(best[1])
    return np.asarray(best, dtype=np.float64)


def _torques(run: Run, first: int, last: int, number: int, axis: Floats) -> tuple[tuple[float, float], float]:
    """Mean torques about the axis on the disc and on other walls [N m], what the balance lacks [-]."""
    t = np.asarray(run.tally["t"], dtype=np.float64)[first:last]
    found = walls(run, float(t[0]), float(t[-1]))
    assert run.scene.walls is not None
    arm = run.scene.walls.motion[:, AXIS_POINT : AXIS_POINT + 2] - axis
    about = found.torque[:, :, 2] + arm[:, 0] * found.force[:, :, 1] - arm[:, 1] * found.force[:, :, 0]
    each = np.diff(t) @ about
    gained = _spin(run, last - 1, axis) - _spin(run, first, axis)
    time = float(t[-1] - t[0])
    others = float(each.sum() - each[number])
    return (float(each[number]) / time, others / time), abs(float(each.sum()) + gained) / abs(
        float(each[number])
    )


def _spin(run: Run, k: int, axis: Floats) -> float:
    """Angular momentum of the grains about the axis, spin included [N m s]."""
    x, v, omega = (
        np.asarray(one[k], dtype=np.float64) for one in (run.frames.x, run.frames.v, run.frames.omega)
    )
    off, scene = x[:, :2] - axis, run.scene
    return float((scene.m * (off[:, 0] * v[:, 1] - off[:, 1] * v[:, 0]) + scene.inertia * omega[:, 2]).sum())
