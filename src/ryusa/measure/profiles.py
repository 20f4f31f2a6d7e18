"""Profiles over height of a flow of grains: concentration, velocity, spin, granular temperature, flux."""

import math
from dataclasses import dataclass

import numpy as np

from ryusa.errors import ResultsError
from ryusa.measure._run import Above, Floats, Run, level_of
from ryusa.measure.bed_area import area_of, area_of_stretch
from ryusa.measure.layers import Layers, layers_mean, layers_quotient, layers_variance, plain_unit
from ryusa.measure.slices_in_layers import (
    SPIN,
    U_X,
    U_XX,
    U_Z,
    U_ZZ,
    A,
    V,
    bed_in_layers,
    frames_of_grains,
    sums_in_layers,
)
from ryusa.measure.snapshot import lanes_of
from ryusa.measure.statistics import average
from ryusa.measure.table import Averaged, Averages, lines


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
        names = [(f"{one.name}_{plain_unit(one.unit)}".rstrip("_"), one) for one in self.columns]
        columns = {"z_m": self.z, "z_over_d": self.z / self.d}
        columns |= {name: one.value for name, one in names}
        columns |= {f"{one.name}_error": one.error for _, one in names}
        return lines(columns | {"phi_bed": self.bed})

    def series(self) -> list[dict[str, object]]:
        """One dictionary per frame."""
        columns = {
            "t_s": self.t, "q_m2_per_s": self.q, "speed_m_per_s": self.speed, "volume_m": self.volume
        }  # fmt: skip
        return lines(columns)


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
    t, first, last, scene, since = frames_of_grains(run, begin, end)
    z_0, thickness = level_of(scene, above), layer * scene.d_mean
    _, lanes = lanes_of(np.asarray(run.frames.x[first], dtype=np.float64)[:, 1], scene)
    area = area_of(run, first, scene, lanes) if between is None else area_of_stretch(scene, lanes, between)
    if not math.isfinite(area):
        raise ResultsError(
            f"the scene is open along {'y' if math.isfinite(scene.period[0]) else 'x'}: a profile is a mean "
            "over periods or between upright walls, and there are none. In Python, "
            "ryusa.measure.profiles(run, between=(x_0, x_1)) takes a stretch"
        )
    sums, edge = sums_in_layers(run, first, last, scene, z_0, thickness, between, bed)
    n_layer, space = sums.shape[1], area * thickness
    length = float(scene.period[0]) if between is None else between[1] - between[0]
    side = length * thickness * lanes if scene.plane_case else math.nan
    volume, weight = sums[:, :, V], sums[:, :, V].sum(axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        speed = sums[:, :, U_X].sum(axis=1) / weight
    q = sums[:, :, U_X].sum(axis=1) / area
    fixed = bed_in_layers(scene, edge, n_layer, z_0, thickness, between) / space if bed else None
    return Profiles(
        z=(edge + np.arange(n_layer) + 0.5) * thickness,
        thickness=thickness,
        above=above,
        origin=z_0,
        d=scene.d_mean,
        phi=layers_mean("phi", "-", volume / space),
        area_fraction=layers_mean("area_fraction", "-", sums[:, :, A] / side),
        v_x=layers_quotient("v_x", "m/s", sums[:, :, U_X], volume),
        v_z=layers_quotient("v_z", "m/s", sums[:, :, U_Z], volume),
        spin=layers_quotient("spin", "rad/s", sums[:, :, SPIN], volume),
        temperature_x=layers_variance("temperature_x", sums[:, :, U_XX], sums[:, :, U_X], volume),
        temperature_z=layers_variance("temperature_z", sums[:, :, U_ZZ], sums[:, :, U_Z], volume),
        flux=layers_mean("flux", "m/s", sums[:, :, U_X] / space),
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
