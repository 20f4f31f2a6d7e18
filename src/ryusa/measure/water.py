"""Water over height in a run that solved a column of it, and the shear stress it puts on its bed."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ryusa.errors import ResultsError
from ryusa.laws.transport import tau_star_from_stress
from ryusa.measure._run import Floats, Run, settle_time
from ryusa.measure.layers import Layers, layers_mean
from ryusa.measure.profiles import Profiles, profiles
from ryusa.measure.snapshot import scene_at
from ryusa.measure.statistics import average, begin_in_words
from ryusa.measure.table import Averaged, Averages, lines
from ryusa.model import Scene

CLEAR = 0.01  # concentration up to which water counts as clear
FEWEST = 3  # faces in clear water from which its stress is carried on to the bed
HALF = 0.5  # of `water.column.packed`: where the bed ends
LAYER = 0.25  # thickness of the layers of grain speed, in mean diameters


@dataclass(frozen=True, repr=False)
class WaterProfile(Averaged):
    """Means over the frames in a window.

    Attributes
    ----------
    t : times of the frames [s], shape (n_frame,).
    z, faces : heights of the middles and the faces of the cells above the datum [m], shapes (n,), (n + 1,).
    u : speed of the water along the bed [m/s], shape (n,).
    phi : concentration of grains, fixed ones included [-], shape (n,).
    tau : shear stress of the water, viscous and turbulent [Pa], at the faces, shape (n + 1,).
    nu_t : eddy viscosity [m2/s], at the faces.
    grains : speed of the free grains and the rest of their profile.
    bed : height of the bed [m]; nan where no grains lie as dense.
    surface : mean height of the surface [m].
    clear : faces whose stress is carried on to the bed, shape (n + 1,).
    tau_bed : shear stress at the bed [Pa]; nan where no water is clear or there is no bed.
    d : mean diameter of the free grains [m].
    averages : surface, bed, depth, tau_bed, tau_star, u_star, discharge, speed.
    """

    t: Floats
    z: Floats
    faces: Floats
    u: Layers
    phi: Layers
    tau: Layers
    nu_t: Layers
    grains: Profiles
    bed: float
    surface: float
    clear: NDArray[np.bool_]
    tau_bed: float
    d: float
    averages: Averages

    def series(self) -> list[dict[str, object]]:
        """No series is kept: empty."""
        return []

    def rows(self) -> list[dict[str, object]]:
        """One dictionary per cell, from below; stress and eddy viscosity are the mean of its two faces."""
        tau, nu_t = (0.5 * (one.value[1:] + one.value[:-1]) for one in (self.tau, self.nu_t))
        v = np.interp(self.z, self.grains.z, self.grains.v_x.value, math.nan, math.nan)
        columns = {
            "z_m": self.z, "u_m_per_s": self.u.value, "u_error": self.u.error, "v_x_m_per_s": v,
            "phi": self.phi.value, "phi_error": self.phi.error, "tau_Pa": tau, "nu_t_m2_per_s": nu_t,
            "in_water": self.z < self.surface,
        }  # fmt: skip
        return lines(columns)


def water(run: Run, begin: float | None = None, end: float = math.inf) -> WaterProfile:
    """Water over height, averaged over the frames in a window, and the stress at its bed.

    Parameters
    ----------
    run : a run folder with a column of water.
    begin, end : window [s]; `begin` defaults to the case's `record.settle`.

    Raises
    ------
    ResultsError : no column of water, or no frame in the window.

    Notes
    -----
    The bed ends where the mean concentration, averaged over the height of a grain, falls below half of
    `water.column.packed`, going down from the surface; over a rigid bed it is the bottom of the column. The
    stress at the bed, tau_bed, is the shear stress of clear water, viscous and turbulent, carried on to that
    height: the straight line of least squares through the faces between the surface and the highest moving
    grains (concentration up to 0.01) that is zero at the surface. So it holds what moving grains take from
    the water above the bed, as the stress of a flume's depth and slope does, and not what side walls take.
    tau_star = tau_bed/((rho_s - rho_w) g d).
    """
    found, span, since = _frames(run, begin, end)
    scene = scene_at(run, since)
    d = scene.d_mean
    keys: dict[str, Any] = (run.case.get("water") or {}).get("column") or {}
    packed = float(keys.get("packed") or math.nan)
    surfaces = found.z_surface[span]
    even = averaged_over_grain(found.phi[span].mean(axis=0), d / float(found.faces[1] - found.faces[0]))
    rigid = keys.get("bed") in {"rough", "smooth"}
    bed = float(found.faces[0]) if rigid else height_reached(found.z, even, HALF * packed)
    clear = _clear(found.faces, even, bed, float(surfaces.min()))
    tau = _stress_at_bed(found.tau[span], found.faces, surfaces, clear, bed)
    discharge = (found.content[: span.stop] * found.u[: span.stop]).sum(axis=1)
    suggested = begin_in_words("discharge", found.t[: span.stop], discharge, settle_time(run), begin)
    averages = _averages(found, span, scene, bed, tau, packed, suggested)
    return WaterProfile(
        t=found.t[span],
        z=found.z,
        faces=found.faces,
        u=layers_mean("u", "m/s", found.u[span]),
        phi=layers_mean("phi", "-", found.phi[span]),
        tau=layers_mean("tau", "Pa", found.tau[span]),
        nu_t=layers_mean("nu_t", "m2/s", found.nu_t[span]),
        grains=profiles(run, begin, end, LAYER),
        bed=bed,
        surface=float(surfaces.mean()),
        clear=clear,
        tau_bed=averages["tau_bed"].value,
        d=d,
        averages=averages,
    )


def _frames(run: Run, begin: float | None, end: float) -> tuple[Any, slice, float]:
    """Column of water of a run, its frames within a window, and the begin of the window [s]."""
    found = getattr(run, "water", None)
    if found is None and getattr(run, "row", None) is not None:
        raise ResultsError("the water is a row of columns; ryusa measure RUN long_section gives it")
    if found is None:
        raise ResultsError("the run solved no column of water (water.profile = 'column')")
    since = settle_time(run) if begin is None else begin
    first, last = int(np.searchsorted(found.t, since, "left")), int(np.searchsorted(found.t, end, "right"))
    if last <= first:
        raise ResultsError(f"no frame from t = {since:g} s to {end:g} s")
    return found, slice(first, last), since


def _clear(faces: Floats, phi: Floats, bed: float, surface: float) -> NDArray[np.bool_]:
    """Faces between clear cells, above the bed and below the lowest surface [m], shape (n + 1,)."""
    clear = np.zeros(len(faces), dtype=np.bool_)
    clear[1:-1] = (np.maximum(phi[1:], phi[:-1]) <= CLEAR) & (faces[1:-1] < surface)
    if math.isfinite(bed):
        clear &= faces > bed
    return clear


def _stress_at_bed(
    tau: Floats, faces: Floats, surfaces: Floats, clear: NDArray[np.bool_], bed: float
) -> Floats:
    """Shear stress of clear water, extrapolated to the bed [Pa], shape (n_frame,); nan where it is not known.

    The least-squares line through tau at the clear faces that is zero at the surface.
    """
    arm = surfaces[:, None] - faces[clear]
    enough = np.count_nonzero(clear) >= FEWEST and math.isfinite(bed)
    per_depth = (tau[:, clear] * arm).sum(axis=1) / (arm * arm).sum(axis=1) if enough else math.nan
    return np.broadcast_to(per_depth * (surfaces - bed), surfaces.shape)


def _averages(
    found: Any, span: slice, scene: Scene, bed: float, tau: Floats, packed: float, suggested: str
) -> Averages:
    """Averages over the frames of what is known in each; tau is the stress at the bed [Pa]."""
    window = (float(found.t[span][0]), float(found.t[span][-1]))
    surfaces, content, u = found.z_surface[span], found.content[span], found.u[span]
    d, g = scene.d_mean, float(np.linalg.norm(scene.gravity))
    rho_s = float(scene.m.sum() / scene.solid_volume.sum())
    rho_w = scene.water.rho_w
    per = tau_star_from_stress(1.0, rho_s, rho_w, g, d) if rho_s > rho_w and g > 0.0 else math.nan
    over = _over(content, found.faces, bed)
    speed = np.divide(
        _over(content * u, found.faces, bed), over, np.full(len(over), math.nan), where=over > 0
    )
    return Averages(
        "water",
        (
            average("surface", "m", [surfaces], window),
            average("bed", "m", [np.full(len(surfaces), bed)], window),
            average("depth", "m", [surfaces - bed], window),
            average("tau_bed", "Pa", [tau], window),
            average("tau_star", "-", [tau * per], window),
            average("u_star", "m/s", [np.sqrt(np.abs(tau) / rho_w)], window),
            average("discharge", "m2/s", [(content * u).sum(axis=1)], window),
            average("speed", "m/s", [speed], window),
        ),
        (
            f"bed: height where the concentration falls below {HALF:g} of packed, {packed:g}; depth: from "
            "the bed to the surface; speed: mean of the water above the bed",
            "tau_bed: shear stress of the clear water, extrapolated to the bed along a straight line; "
            f"tau_star = tau_bed/((rho_s - rho_w) g d), d = {d:.4g} m",
            suggested,
        ),
    )


def averaged_over_grain(phi: Floats, cells: float) -> Floats:
    """Mean over the height of a grain, which is as many cells."""
    reach = max(round(0.5 * cells - 0.5), 0)
    window = np.ones(2 * reach + 1)
    return np.convolve(phi, window, "same") / np.convolve(np.ones(len(phi)), window, "same")


def height_reached(z: Floats, phi: Floats, least: float) -> float:
    """Height at which a concentration is reached first, going down [m]; nan where it never is."""
    dense = np.flatnonzero(phi >= least)
    if not len(dense):
        return math.nan
    k = int(dense[-1])
    if k + 1 == len(z):
        return float(z[k])
    return float(z[k] + (z[k + 1] - z[k]) * (phi[k] - least) / (phi[k] - phi[k + 1]))


def _over(content: Floats, faces: Floats, bed: float) -> Floats:
    """Sum over the cells above the bed, of the cell it cuts in part, shape (n_frame,)."""
    share = np.clip((faces[1:] - bed) / (faces[1:] - faces[:-1]), 0.0, 1.0)
    return np.asarray(content @ share)
