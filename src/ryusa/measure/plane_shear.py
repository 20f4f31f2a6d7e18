"""Plane shear between a base and a lid that a servo presses: friction over inertial number, and profiles."""

import math
from dataclasses import dataclass

import numpy as np

from ryusa.errors import ResultsError
from ryusa.laws.dense_flow import inertial_number
from ryusa.measure._run import Floats, Run
from ryusa.measure.layers import Layers, layers_mean, layers_quotient
from ryusa.measure.slices_in_layers import U_X, V, sums_in_layers
from ryusa.measure.statistics import average, ratio
from ryusa.measure.table import Averaged, Averages, lines
from ryusa.measure.transport import window_of
from ryusa.measure.walls import pressed_lid, walls
from ryusa.model import Scene
from ryusa.model.walls import SPIN, VELOCITY

LAYER = 0.5  # thickness of a layer in mean diameters
CORE = (0.2, 0.8)  # shares of the volume of the grains below and above which plates matter
LEAST = 4  # layers in the core


@dataclass(frozen=True, repr=False)
class PlaneShear(Averaged):
    """Steady shear of grains between a base and a lid.

    Attributes
    ----------
    lid : name of the wall that a servo presses.
    speed : of the lid along x, without its sign [m/s].
    t : middle of the time between two frames [s], shape (n,).
    normal, shear : stress of the grains on the lid, against its servo and against its velocity [Pa], (n,).
    base : force on all other walls along x over that on the lid [-]; -1 in steady flow.
    z : heights above the datum [m], shape (n_layer,).
    v_x : velocity along the motion of the lid [m/s].
    phi : concentration [-].
    core : lowest and highest of the heights of the middle 60 % of the grains [m], on which a line is fitted.
    shear_rate : slope of that line [1/s]; negative where the lid is below.
    at_datum : its velocity at z = 0 [m/s].
    mu : friction on the lid [-], with its standard error in `averages`.
    inertial : inertial number of the core [-].
    curvature : largest distance of the mean velocity from the line, over its range in the core [-].
    averages : mu, inertial_number, phi, shear_rate, normal, shear.
    """

    lid: str
    speed: float
    t: Floats
    normal: Floats
    shear: Floats
    base: float
    z: Floats
    v_x: Layers
    phi: Layers
    core: tuple[float, float]
    shear_rate: float
    at_datum: float
    mu: float
    inertial: float
    curvature: float
    averages: Averages

    def series(self) -> list[dict[str, object]]:
        """One dictionary per time between two frames."""
        return lines({"t_s": self.t, "normal_Pa": self.normal, "shear_Pa": self.shear})


def plane_shear(run: Run, begin: float | None = None, end: float = math.inf) -> PlaneShear:
    """Friction on a lid that is drawn along, with the inertial number and concentration of the grains below.

    Parameters
    ----------
    run : a run folder, periodic along x and y, with one wall that a servo presses along z and that moves
        along x.
    begin, end : window [s]; `begin` defaults to the case's `record.settle`.

    Raises
    ------
    ResultsError : no such wall, fewer than three frames in the window, or too few layers of grains.

    Notes
    -----
    Friction is the mean force on the lid along x over that along z, from impulses summed at every step. The
    shear rate is the slope of a least-squares line through the velocities of the middle 60 % of the grains,
    so that slip at the plates does not enter, and the inertial number (GDR MiDi 2004) takes it and the
    pressure on the lid. Without gravity both are the same at all heights. Layers are half a diameter thick.
    """
    number, along, towards, speed = _lid(run.scene)
    forces = walls(run, begin, end)
    t, first, last, scene, area = window_of(run, begin, end, least=3)
    thickness = LAYER * scene.d_mean
    sums, low = sums_in_layers(run, first, last, scene, 0.0, thickness, None, False)
    z = (low + np.arange(sums.shape[1]) + 0.5) * thickness
    normal = -forces.force[:, number, 2] * towards / area
    shear = -forces.force[:, number, 0] * along / area
    volume = sums[:, :, V]
    below = np.cumsum(volume.sum(axis=0)) / volume.sum()
    core = (below > CORE[0]) & (below < CORE[1])
    if core.sum() < LEAST:
        raise ResultsError(
            f"{int(core.sum())} layers of half a diameter in the core; {LEAST} or more are needed"
        )
    v_x = layers_quotient("v_x", "m/s", along * sums[:, :, U_X], volume)
    phi = layers_mean("phi", "-", volume / (area * thickness))
    with np.errstate(invalid="ignore"):
        rates = -towards * np.polyfit(z[core], (along * sums[:, core, U_X] / volume[:, core]).T, 1)[0]
    rate, at_datum = (float(one) for one in np.polyfit(z[core], v_x.value[core], 1))
    line = at_datum + rate * z[core]
    curvature = float(np.abs(v_x.value[core] - line).max() / np.ptp(line))
    density = float(scene.m.sum() / scene.solid_volume.sum())
    scale = inertial_number(1.0, scene.d_mean, density, float(normal.mean()))
    window, of_frames = (float(forces.t[0]), float(forces.t[-1])), (float(t[0]), float(t[-1]))
    items = (
        ratio("mu", "-", [shear], [normal], window),
        average("inertial_number", "-", [rates * scale], of_frames),
        average("phi", "-", [volume[:, core].mean(axis=1) / (area * thickness)], of_frames),
        average("shear_rate", "1/s", [rates], of_frames),
        average("normal", "Pa", [normal], window),
        average("shear", "Pa", [shear], window),
    )
    others = float(np.delete(forces.force[:, :, 0], number, axis=1).sum(axis=1).mean())
    base = others / float(forces.force[:, number, 0].mean())
    notes = (
        f"lid {forces.names[number]!r}: {speed:.4g} m/s; shear force on the other walls over that on it: "
        f"{base:.4f}",
        f"core: z = {z[core][0]:.4g} to {z[core][-1]:.4g} m; velocity differs from a line by at most "
        f"{curvature:.1%} of its range there",
    )
    return PlaneShear(
        lid=forces.names[number], speed=speed, t=forces.t, normal=normal, shear=shear, base=base,
        z=z, v_x=v_x, phi=phi, core=(float(z[core][0]), float(z[core][-1])),
        shear_rate=rate, at_datum=at_datum, mu=items[0].value, inertial=abs(rate) * scale,
        curvature=curvature, averages=Averages("shear", items, notes),
    )  # fmt: skip


def _lid(scene: Scene) -> tuple[int, float, float, float]:
    """Number of the lid, sign of its velocity, sign of the direction in which it presses, and speed [m/s]."""
    number, towards = pressed_lid(scene)
    assert scene.walls is not None  # it has a lid
    name, motion = scene.walls.names[number], scene.walls.motion[number]
    velocity = motion[VELOCITY : VELOCITY + 3]
    if velocity[0] == 0.0 or velocity[1] != 0.0 or motion[SPIN : SPIN + 3].any():
        raise ResultsError(f"wall {name!r} is not drawn along x alone; plane shear needs a lid that is")
    return number, math.copysign(1.0, velocity[0]), towards, abs(float(velocity[0]))
