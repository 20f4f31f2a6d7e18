"""Water over height in a run that solved a column of it, and the shear stress it puts on its bed."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from ryusa.errors import ResultsError
from ryusa.laws.transport import tau_star_from_stress
from ryusa.measure._run import Floats, Run, settle_time
from ryusa.measure.profiles import Layers, Profiles, profiles
from ryusa.measure.snapshot import scene_at
from ryusa.measure.statistics import average, block_errors
from ryusa.measure.table import Averages

CLEAR = 0.01  # concentration up to which water counts as clear
FEWEST = 3  # faces in clear water from which its stress is carried on to the bed
HALF = 0.5  # of `water.column.packed`: where the bed ends
LAYER = 0.25  # thickness of the layers of grain speed, in mean diameters


@dataclass(frozen=True)
class WaterProfile:
    """Means over the frames in a window.

    Attributes
    ----------
    t : times of the frames [s], shape (n_frame,).
    z, faces : heights of the middles and the faces of the cells [m], shapes (n,) and (n + 1,).
    u : speed of the water along the bed [m/s], shape (n,).
    phi : concentration of grains, fixed ones included [-], shape (n,).
    tau : shear stress of the water, viscous and turbulent [Pa], at the faces, shape (n + 1,).
    nu_t : eddy viscosity [m2/s], at the faces.
    grains : speed of the free grains and the rest of their profile, heights as in the scene.
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
    clear: np.ndarray[Any, np.dtype[np.bool_]]
    tau_bed: float
    d: float
    averages: Averages

    def rows(self) -> list[dict[str, object]]:
        """One dictionary per cell, from below; stress and eddy viscosity are the mean of its two faces."""
        tau, nu_t = (0.5 * (one.value[1:] + one.value[:-1]) for one in (self.tau, self.nu_t))
        at = self.grains.z + self.grains.origin
        v = np.interp(self.z, at, self.grains.v_x.value, math.nan, math.nan) if len(at) else 0.0 * self.z
        return [
            {
                "z_m": float(self.z[k]),
                "u_m_per_s": float(self.u.value[k]),
                "u_error": float(self.u.error[k]),
                "v_x_m_per_s": float(v[k]),
                "phi": float(self.phi.value[k]),
                "phi_error": float(self.phi.error[k]),
                "tau_Pa": float(tau[k]),
                "nu_t_m2_per_s": float(nu_t[k]),
                "in_water": bool(self.z[k] < self.surface),
            }
            for k in range(len(self.z))
        ]


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
    found = getattr(run, "water", None)
    if found is None:
        raise ResultsError("the run solved no column of water (water.profile = 'column')")
    since = settle_time(run) if begin is None else begin
    first, last = int(np.searchsorted(found.t, since, "left")), int(np.searchsorted(found.t, end, "right"))
    if last <= first:
        raise ResultsError(f"no frame from t = {since:g} s to {end:g} s")
    span = slice(first, last)
    scene = scene_at(run, since)
    d, g = float(scene.d.mean()), float(np.linalg.norm(scene.gravity))
    window = (float(found.t[first]), float(found.t[last - 1]))
    keys: dict[str, Any] = (run.case.get("water") or {}).get("column") or {}
    z, faces = found.z, found.faces
    phi, surfaces = found.phi[span], found.z_surface[span]
    surface, even = float(surfaces.mean()), _averaged(phi.mean(axis=0), d / float(faces[1] - faces[0]))
    packed = float(keys.get("packed") or math.nan)
    bed = float(faces[0]) if keys.get("bed") in {"rough", "smooth"} else _top(z, even, HALF * packed)
    clear = np.zeros(len(faces), dtype=np.bool_)
    full = float(surfaces.min())
    clear[1:-1] = (np.maximum(even[1:], even[:-1]) <= CLEAR) & (faces[1:-1] < full)
    if math.isfinite(bed):
        clear &= faces > bed
    arm = surfaces[:, None] - faces[clear]
    enough = np.count_nonzero(clear) >= FEWEST and math.isfinite(bed)
    per_depth = (
        (found.tau[span][:, clear] * arm).sum(axis=1) / (arm * arm).sum(axis=1) if enough else math.nan
    )
    tau = np.broadcast_to(per_depth * (surfaces - bed), surfaces.shape)
    rho_s = float(scene.m.sum() / (np.pi / 6.0 * scene.d**3).sum())
    rho_w = scene.water.rho_w
    per = tau_star_from_stress(1.0, rho_s, rho_w, g, d) if rho_s > rho_w and g > 0.0 else math.nan
    discharge = (found.content[span] * found.u[span]).sum(axis=1)
    over = _over(found.content[span], faces, bed)
    speed = np.divide(
        _over(found.content[span] * found.u[span], faces, bed),
        over,
        np.full(len(over), math.nan),
        where=over > 0,
    )
    tau_bed = average("tau_bed", "Pa", [tau], window)
    return WaterProfile(
        t=found.t[span],
        z=z,
        faces=faces,
        u=_mean("u", "m/s", found.u[span]),
        phi=_mean("phi", "-", phi),
        tau=_mean("tau", "Pa", found.tau[span]),
        nu_t=_mean("nu_t", "m2/s", found.nu_t[span]),
        grains=profiles(run, begin, end, LAYER),
        bed=bed,
        surface=surface,
        clear=clear,
        tau_bed=tau_bed.value,
        d=d,
        averages=Averages(
            "water",
            (
                average("surface", "m", [surfaces], window),
                average("bed", "m", [np.full(len(surfaces), bed)], window),
                average("depth", "m", [surfaces - bed], window),
                tau_bed,
                average("tau_star", "-", [tau * per], window),
                average("u_star", "m/s", [np.sqrt(np.abs(tau) / rho_w)], window),
                average("discharge", "m2/s", [discharge], window),
                average("speed", "m/s", [speed], window),
            ),
            (
                f"bed: where concentration falls below {HALF:g} of packed, {packed:g}; depth: from there to "
                "the surface, speed: mean of the water over the bed",
                "tau_bed: stress of clear water, carried on to the bed in a straight line; "
                f"tau_star = tau_bed/((rho_s - rho_w) g d), d = {d:.4g} m",
            ),
        ),
    )


def _mean(name: str, unit: str, frames: Floats) -> Layers:
    return Layers(name, unit, frames.mean(axis=0), block_errors(frames))


def _averaged(phi: Floats, cells: float) -> Floats:
    """Mean over the height of a grain, which is as many cells."""
    reach = max(round(0.5 * cells - 0.5), 0)
    window = np.ones(2 * reach + 1)
    return np.convolve(phi, window, "same") / np.convolve(np.ones(len(phi)), window, "same")


def _top(z: Floats, phi: Floats, least: float) -> float:
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
