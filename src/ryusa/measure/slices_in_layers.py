"""Grains cut by the planes of layers: volume, area, velocity and spin of the slices, summed by layer."""

import math

import numpy as np

from ryusa.compiled.function import compiled
from ryusa.errors import ResultsError
from ryusa.laws.slices import circle_slice, sphere_slice
from ryusa.measure._run import Floats, Run, settle_time
from ryusa.measure.snapshot import scene_at
from ryusa.model import Scene
from ryusa.model.scene import Bools

CHUNK = 400_000  # places of grains held in memory at once
MOST = 100_000  # layers; more come from a grain that was thrown away
V, A, U_X, U_Z, SPIN, U_XX, U_ZZ = range(7)  # what is summed over the slices in a layer


def frames_of_grains(run: Run, begin: float | None, end: float) -> tuple[Floats, int, int, Scene, float]:
    """Times of the frames in a window [s], the first and one beyond the last, scene and begin [s]."""
    since = settle_time(run) if begin is None else begin
    t, scene = np.asarray(run.frames.t, dtype=np.float64), scene_at(run, since)
    first, last = int(np.searchsorted(t, since, "left")), int(np.searchsorted(t, end, "right"))
    if last <= first or scene.n_grain == 0:
        raise ResultsError(f"no frame of free grains from t = {since:g} s to {end:g} s")
    return t[first:last], first, last, scene, since


@compiled()
def cut_by_layers(
    z: Floats, r: Floats, solid: Floats, counted: Bools, carried: Floats, bottom: int, thickness: float,
    sums: Floats,
) -> None:  # fmt: skip
    """Add every grain's slices to the layers they lie in.

    Parameters
    ----------
    z, counted : heights above the origin [m], and whether the grain counts, shape (n_frame, n_grain).
    r : radii [m], shape (n_grain,).
    solid : volume of matter over that of the sphere [-], shape (n_grain,); below 1 where spheres of a clump
        overlap.
    carried : what a slice carries along, per volume, shape (n_frame, n_grain, 5 or fewer).
    bottom, thickness : number of the lowest layer, from the origin, and thickness of a layer [m].
    sums : added to, shape (n_frame, n_layer, 7).
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


def sums_in_layers(
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
        cut_by_layers(z, r, solid, counted, carried, bottom, thickness, part)
        pieces.append((bottom, part))
    low, high = min(low for low, _ in reached), max(high for _, high in reached)
    sums = np.zeros((last - first, high - low, 7))
    for span, (bottom, part) in zip(spans, pieces, strict=True):
        sums[span.start - first : span.stop - first, bottom - low : bottom - low + part.shape[1]] = part
    return sums, low


def bed_in_layers(
    scene: Scene, edge: int, n_layer: int, z_0: float, thickness: float, between: tuple[float, float] | None
) -> Floats:
    """Volume of the fixed grains in each layer [m3], as they stand at the begin of the window."""
    there = scene.fixed_active & _inside(scene.x_fixed[None, :, 0], scene, between)[0]
    z = np.ascontiguousarray(scene.x_fixed[None, :, 2] - z_0)
    sums = np.zeros((1, n_layer, 7))
    none = np.zeros((*z.shape, 0))
    cut_by_layers(z, 0.5 * scene.d_fixed, np.ones(scene.n_fixed), there[None, :], none, edge, thickness, sums)
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
