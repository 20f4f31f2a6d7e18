"""The shear stress that water puts on the bed, from its own profiles."""

import math
from dataclasses import dataclass, replace

import numpy as np

from ryusa.errors import ResultsError
from ryusa.laws.transport import tau_star_from_stress
from ryusa.measure._run import Floats, Run
from ryusa.measure.statistics import Average, average
from ryusa.measure.table import Averages
from ryusa.measure.transport import window_of

HALF = 0.5  # of the densest place: the level of the bed
CLEAR = 1.0e-3  # concentration below which water is clear of grains [-]


@dataclass(frozen=True)
class BedStress:
    """Shear stress of the water on the bed over time, and where that bed is.

    Attributes
    ----------
    t : times of the frames [s], shape (n_frame,).
    tau : stress on the bed [Pa], shape (n_frame,).
    z_bed : level of the bed [m].
    z_clear : height above which the water is clear of grains [m].
    z_surface : mean height of the surface [m].
    densest : highest concentration, averaged over the height of a grain [-].
    averages : tau_bed and tau_star, with errors and steadiness.
    """

    t: Floats
    tau: Floats
    z_bed: float
    z_clear: float
    z_surface: float
    densest: float
    averages: Averages


def bed_stress(run: Run, begin: float | None = None, end: float = math.inf) -> BedStress:
    """Stress of the water on the bed, at the level where grains become half as dense as deep in the bed.

    Parameters
    ----------
    run : a run folder with a column of water.
    begin, end : window [s]; `begin` defaults to the case's `record.settle`.

    Raises
    ------
    ResultsError : no frame in the window, no column of water, or no grains in it.

    Notes
    -----
    Defined as the shear stress of the water at the level of the bed and what the water above gives to the
    grains there. Both together are the stress where the water is clear of grains (mean concentration below
    0.001), which the column records, plus the downslope weight and driving force of the water from the bed
    up to there; the weight of grains is not in it. In steady uniform flow without side walls that is rho g
    sin(slope) times the water above the bed, per area: what a flume reports. Between bed and clear water
    the flow is taken as steady, and side walls do not count.
    """
    water = getattr(run, "water", None)
    if water is None:
        raise ResultsError("the run has no column of water, and so no stress on the bed")
    t, first, last, scene, _ = window_of(run, begin, end, least=1)
    span = slice(first, last)
    phi, content = np.asarray(water.phi[span]), np.asarray(water.content[span])
    faces, surface = np.asarray(water.faces, dtype=np.float64), np.asarray(water.z_surface[span])
    d = float(scene.d.mean())
    smooth = _over_a_grain(phi.mean(axis=0), float(faces[1] - faces[0]), d)
    densest = float(smooth.max())
    if densest < CLEAR:
        raise ResultsError("there are no grains in the water, and so no bed")
    bed = int(np.flatnonzero(smooth >= HALF * densest)[-1]) + 1
    clear = max(int(np.flatnonzero(phi.mean(axis=0) >= CLEAR)[-1]) + 1, bed)
    weight = scene.water.rho_w * float(scene.gravity[0]) * content[:, bed:clear].sum(axis=1)
    between = np.maximum(np.minimum(faces[clear], surface) - faces[bed], 0.0)
    tau = np.asarray(water.tau[span])[:, clear] + weight + np.asarray(water.gradient[span]) * between
    window = (float(t[0]), float(t[-1]))
    stress = average("tau_bed", "Pa", [tau], window)
    rho_s = float(scene.m.sum() / (np.pi / 6.0 * scene.d**3).sum())
    unit = tau_star_from_stress(1.0, rho_s, scene.water.rho_w, float(np.linalg.norm(scene.gravity)), d)
    return BedStress(
        t=t,
        tau=tau,
        z_bed=float(faces[bed]),
        z_clear=float(faces[clear]),
        z_surface=float(surface.mean()),
        densest=densest,
        averages=Averages(
            "bed stress",
            (stress, _scaled(stress, "tau_star", unit)),
            (
                f"bed at z = {faces[bed]:.4g} m, where the concentration is half of {densest:.3g}",
                f"water clear of grains above z = {faces[clear]:.4g} m",
            ),
        ),
    )


def _scaled(one: Average, name: str, unit: float) -> Average:
    return replace(one, name=name, unit="-", value=one.value * unit, error=one.error * unit)


def _over_a_grain(phi: Floats, dz: float, d: float) -> Floats:
    """Concentration averaged over the height of a grain [-], the part of it that lies in the column."""
    n = max(round(d / dz), 1) | 1  # odd: as far up as down
    ones = np.ones(n)
    return np.convolve(phi, ones, "same") / np.convolve(np.ones(len(phi)), ones, "same")
