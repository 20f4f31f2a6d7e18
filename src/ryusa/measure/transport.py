"""Sediment transport: its rate, the layer that carries it, and the kinetic stress of the grains."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from ryusa.errors import ResultsError
from ryusa.laws.water import tau_star_from_u_star
from ryusa.measure._run import Floats, Run, crest_of, settle_time
from ryusa.measure.bed_area import area_of
from ryusa.measure.formulae import predicted
from ryusa.measure.layers import Layers, layers_mean, layers_quotient
from ryusa.measure.profiles import Profiles, profiles
from ryusa.measure.slices_in_layers import CHUNK, U_X, cut_by_layers, sums_in_layers
from ryusa.measure.snapshot import lanes_of, scene_at
from ryusa.measure.statistics import Average, average, begin_in_words, ratio, standard_errors
from ryusa.measure.table import Averaged, Averages, lines
from ryusa.measure.water import water
from ryusa.model import Scene
from ryusa.printed import ByShape

MIDDLE = 0.9  # share of the flux between the levels of the transport layer


@dataclass(frozen=True, repr=False)
class Transport(Averaged):
    """Sediment transport rate, and the layer that carries it.

    Attributes
    ----------
    t, dt : middle and length of the time between two frames [s], shape (n,).
    q : volume of grains that crosses a unit of width in a second [m2/s], shape (n,).
    q_star : q/scale [-], shape (n,).
    z : height of the middle of each layer above the datum [m], shape (n_layer,).
    thickness : of a layer [m].
    flux : volume of grains that crosses a unit of area in a second, over height [m/s].
    scale : sqrt(R g d**3) that makes q dimensionless [m2/s].
    excess : R, density of grains over water less 1; 1 in a dry flow, nan where grains do not sink [-].
    tau_star : dimensionless shear stress at the bed [-]: of the water of the run where it solved a column
        (`measure.water`), else the one the case asks for, or the one handed in; nan where there is none.
    tau_error : its standard error [-]; nan where it is not measured.
    bed : height of the bed above the datum at which it is measured [m]; nan where it is not.
    d, g : mean diameter of the free grains [m] and length of the gravity vector [m/s2].
    averages : q, q_mass, q_star, layer_low, layer_high, layer_thickness, with errors and steadiness.
    """

    t: Floats
    dt: Floats
    q: Floats
    q_star: Floats
    z: Floats
    thickness: float
    flux: Layers
    scale: float
    excess: float
    tau_star: float
    tau_error: float
    bed: float
    d: float
    g: float
    averages: Averages

    def rows(self) -> list[dict[str, object]]:
        """One dictionary per time between two frames."""
        return lines({"t_s": self.t, "dt_s": self.dt, "q_m2_per_s": self.q, "q_star": self.q_star})


@dataclass(frozen=True, repr=False)
class KineticStress(ByShape):
    """Stress that the fluctuations of grains carry, sigma phi <v'v'>, over height.

    Attributes
    ----------
    profiles : means over the same frames and layers.
    temperature : granular temperature, a third of <v'.v'>, in a plane scene half of it [m2/s2].
    xx, yy, zz : normal stresses [Pa], >= 0.
    xz : sigma phi <v_x' v_z'> [Pa]; negative where fast grains sink: the shear stress it adds is -xz.
    """

    profiles: Profiles
    temperature: Layers
    xx: Layers
    yy: Layers
    zz: Layers
    xz: Layers

    def rows(self) -> list[dict[str, object]]:
        """One dictionary per layer."""
        layers = {"temperature_m2_per_s2": self.temperature}
        layers |= {f"stress_{one.name}_Pa": one for one in (self.xx, self.yy, self.zz, self.xz)}
        z, d = self.profiles.z, self.profiles.d
        columns = {"z_m": z, "z_over_d": z / d, "phi": self.profiles.phi.value}
        columns |= {name: one.value for name, one in layers.items()}
        return lines(columns | {f"{name}_error": one.error for name, one in layers.items()})


def transport(
    run: Run,
    begin: float | None = None,
    end: float = math.inf,
    layer: float = 0.25,
    rho_w: float | None = None,
    tau_star: float | None = None,
) -> Transport:
    """Sediment transport rate over time, its mean, and the layer that carries it.

    Parameters
    ----------
    run : a run folder, periodic along x.
    begin, end : window [s]; `begin` defaults to the case's `record.settle`.
    layer : thickness of the layers of the flux, in mean diameters.
    rho_w : density of water in q_star [kg/m3]; default that of the case; 0 for a dry flow.
    tau_star : what to put beside q_star [-]; default that of the run's water at the bed (`measure.water`), or
        where no column was solved from the friction velocity of the case.

    Raises
    ------
    ResultsError : fewer than two frames in the window, or an area of bed that is not bounded.

    Notes
    -----
    Between two frames every grain moves by some dx, so that sum V dx / (A dt) is the volume that crosses a
    line over the bed per width and time, averaged over all such lines: no grain is missed between frames.
    q_star = q / sqrt(R g d**3) with R = rho_s/rho_w - 1 (Einstein 1950); in a dry flow R is taken as 1. The
    transport layer lies between the levels below which 5 % and 95 % of the flux pass; layers whose mean flux
    is backwards are left out. Errors of the levels are to first order in the flux of the frames.
    """
    t, first, last, scene, area = window_of(run, begin, end, least=2)
    since, thickness = float(t[0]), layer * scene.d_mean
    ball, dt = scene.solid_volume, np.diff(t)
    ever = _moved(run, last, ball) / area
    moved, times = ever[first:], np.asarray(run.frames.t[:last], dtype=np.float64)
    sums, edge = sums_in_layers(run, first, last, scene, 0.0, thickness, None, False)
    carried = sums[:, :, U_X] / area
    d, g = scene.d_mean, float(np.linalg.norm(scene.gravity))
    rho_s = float(scene.m.sum() / ball.sum())
    excess = _excess(run, scene, rho_s, rho_w)
    scale = math.sqrt(excess * g * d**3)
    window = (since, float(t[-1]))
    q = ratio("q", "m2/s", [moved], [dt], window)
    stress, bed = _measured(run, since, end) if tau_star is None and rho_w is None else (None, math.nan)
    if tau_star is None:
        tau_star = _tau_star(scene, excess, d, g) if stress is None else stress.value
    return Transport(
        t=0.5 * (t[1:] + t[:-1]),
        dt=dt,
        q=moved / dt,
        q_star=moved / dt / scale,
        z=(edge + np.arange(sums.shape[1]) + 0.5) * thickness,
        thickness=thickness,
        flux=layers_mean("flux", "m/s", carried / thickness),
        scale=scale,
        excess=excess,
        tau_star=tau_star,
        tau_error=math.nan if stress is None else stress.error,
        bed=bed,
        d=d,
        g=g,
        averages=Averages(
            "transport",
            (
                q,
                _scaled(q, "q_mass", "kg/s/m", rho_s),
                _scaled(q, "q_star", "-", 1.0 / scale),
                *_layer(carried, edge * thickness, thickness, window),
                *([] if stress is None else [stress]),
            ),
            (
                *_of_stress(tau_star, bed, q.value / scale),
                f"q_star = q/sqrt(R g d^3), R = {excess:.4g}, g = {g:.4g} m/s2, d = {d:.4g} m",
                begin_in_words("q_star", times[1:], ever / np.diff(times), settle_time(run), begin),
                f"transport layer: the middle {MIDDLE:.0%} of the flux; heights above datum, z = 0 of the "
                f"case{_crest(scene)}",
            ),
        ),
    )


def kinetic_stress(
    run: Run,
    begin: float | None = None,
    end: float = math.inf,
    layer: float = 0.5,
) -> KineticStress:
    """Granular temperature and the stress sigma phi <v'v'> over height.

    Parameters
    ----------
    run, begin, end, layer : as in `profiles`.

    Notes
    -----
    v' is the velocity of a grain less the mean of its layer over grains and time, so slow swings of the whole
    flow count as motion, and so does the shear across a grain, of the order of (d dv_x/dz)**2/20 in xx.
    Stresses are volume averages with sphere slices. Contacts carry the rest of the grains' stress.
    """
    found = profiles(run, begin, end, layer)
    t, first, last, scene, _ = window_of(run, begin, end, least=1)
    n_layer, thickness = len(found.z), found.thickness
    bottom, r = round(float(found.z[0]) / thickness - 0.5), 0.5 * scene.d
    sums = np.zeros((len(t), n_layer, 9))
    step = max(CHUNK // scene.n_grain, 1)
    for a in range(first, last, step):
        span = slice(a, min(a + step, last))
        z = np.ascontiguousarray(np.asarray(run.frames.x[span], dtype=np.float64)[:, :, 2])
        v = np.asarray(run.frames.v[span], dtype=np.float64)
        carried = np.concatenate([v, v**2, v[:, :, :1] * v[:, :, 2:]], axis=2)
        part = sums[a - first : span.stop - first]
        every = np.ones(z.shape, dtype=np.bool_)
        cut_by_layers(z, r, np.ones(len(r)), every, carried, bottom, thickness, part)
    volume, once = sums[:, :, 0], sums[:, :, 2:5]
    weight = volume.sum(axis=0)
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = np.where(weight[:, None] > 0.0, once.sum(axis=0) / weight[:, None], 0.0)

    def about(square: Floats, a: int, b: int) -> Floats:
        """Sum of V v_a' v_b', shape (n_frame, n_layer)."""
        cross = mean[:, a] * once[:, :, b] + mean[:, b] * once[:, :, a]
        return square - cross + mean[:, a] * mean[:, b] * volume

    terms = {
        name: about(sums[:, :, 5 + c], a, b)
        for c, (name, a, b) in enumerate((("xx", 0, 0), ("yy", 1, 1), ("zz", 2, 2), ("xz", 0, 2)))
    }
    trace = terms["xx"] + terms["yy"] + terms["zz"]
    unit = found.density / (found.area * thickness)
    stress = {
        name: Layers(name, "Pa", unit * one.mean(axis=0), standard_errors(unit * one))
        for name, one in terms.items()
    }
    return KineticStress(
        profiles=found,
        temperature=layers_quotient(
            "temperature", "m2/s2", trace / (2.0 if scene.plane_case else 3.0), volume
        ),
        **stress,
    )


def window_of(
    run: Run, begin: float | None, end: float, least: int,
    plan: Callable[[Run, int, int, Scene], float] | None = None,
) -> tuple[Floats, int, int, Scene, float]:  # fmt: skip
    """Times of the frames in a window [s], the first and one beyond the last, the scene, the area [m2].

    `plan` finds the area of a scene that is open along x; without it such a scene is refused.
    """
    since = settle_time(run) if begin is None else begin
    t = np.asarray(run.frames.t, dtype=np.float64)
    first, last = int(np.searchsorted(t, since, "left")), int(np.searchsorted(t, end, "right"))
    scene = scene_at(run, since)
    if last - first < least or scene.n_grain == 0:
        few = f"{max(last - first, 0)} frames" if scene.n_grain else "no free grains"
        raise ResultsError(f"{few} from t = {since:g} s to {end:g} s; {least} frames or more are needed")
    if plan is not None:
        return t[first:last], first, last, scene, plan(run, first, last, scene)
    _, lanes = lanes_of(np.asarray(run.frames.x[first], dtype=np.float64)[:, 1], scene)
    if not math.isfinite(scene.period[0]):
        raise ResultsError("the scene is open along x: it has no area of bed to divide by")
    area = area_of(run, first, scene, lanes)
    if not math.isfinite(area):
        raise ResultsError("the scene is open along y: it has no width to divide by")
    return t[first:last], first, last, scene, area


def places_of(run: Run, first: int, last: int) -> Iterator[Floats]:
    """Centres in chunks (n_frame, n_grain, 3) that share their outermost frames, unwrapped [m]."""
    step = max(CHUNK // run.scene.n_grain, 1)
    for a in range(first, last - 1, step):
        yield np.asarray(run.frames.x[a : min(a + step, last - 1) + 1], dtype=np.float64)


def _moved(run: Run, last: int, ball: Floats) -> Floats:
    """Volume times displacement along x between frames, summed over all grains [m4], shape (last - 1,)."""
    ways = (np.diff(x[:, :, 0], axis=0) * ball for x in places_of(run, 0, last))
    return np.concatenate([one.sum(axis=1) for one in ways])


def _layer(carried: Floats, bottom: float, thickness: float, window: tuple[float, float]) -> list[Average]:
    """Levels of the transport layer and what lies between them, from the flux (n_frame, n_layer) [m2/s].

    Where the flux of one frame differs from the mean, the level where a share p of it has passed moves by
    -(its flux below the level - p times its whole flux) over the mean flux per height there.
    """
    mean = carried.mean(axis=0)
    forward = np.where(mean > 0.0, mean, 0.0)
    edges = bottom + np.arange(len(mean) + 1) * thickness
    passed = np.concatenate([[0.0], np.cumsum(forward)])
    if passed[-1] <= 0.0:
        return [average(name, "m", [], window) for name in ("layer_low", "layer_high", "layer_thickness")]
    frames = np.where(mean > 0.0, carried, 0.0)
    levels: list[Floats] = []
    for share in (0.5 * (1.0 - MIDDLE), 0.5 * (1.0 + MIDDLE)):
        j = int(np.searchsorted(passed, share * passed[-1], "left")) - 1
        part = (share * passed[-1] - passed[j]) / forward[j]
        below = frames[:, :j].sum(axis=1) + part * frames[:, j]
        moved = -(below - share * frames.sum(axis=1)) * thickness / forward[j]
        levels.append(edges[j] + part * thickness + moved)
    low, high = levels
    return [
        average("layer_low", "m", [low], window),
        average("layer_high", "m", [high], window),
        average("layer_thickness", "m", [high - low], window),
    ]


def _excess(run: Run, scene: Scene, rho_s: float, rho_w: float | None) -> float:
    """R = rho_s/rho_w - 1 [-]; 1 in a dry flow, nan where grains do not sink."""
    if rho_w is None:
        rho_w = scene.water.rho_w if run.case.get("water") else 0.0
    if rho_w == 0.0:
        return 1.0
    excess = rho_s / rho_w - 1.0
    return excess if excess > 0.0 else math.nan


def _measured(run: Run, begin: float, end: float) -> tuple[Average | None, float]:
    """Shear stress of the water at the bed [-] and the height of that [m], where a run solved a column."""
    if getattr(run, "water", None) is None:
        return None, math.nan
    found = water(run, begin, end)
    return found.averages["tau_star"], found.bed


def _of_stress(tau_star: float, bed: float, q_star: float) -> list[str]:
    """Where tau_star comes from, and what the classical formulae give at it."""
    unit = "q counts the volume of the grains: 1 m2/s is 1 m3/s for each metre of width"
    if math.isnan(tau_star):
        return ["tau_star: none, without a friction velocity or a column with clear water above a bed", unit]
    if math.isnan(bed):
        return [f"tau_star = {tau_star:.4g}, as the case asks for", *_beside(tau_star, q_star), unit]
    said = f"tau_star: shear stress of the clear water, extrapolated to the bed at z = {bed:.4g} m"
    return [said, *_beside(tau_star, q_star), unit]


def _scaled(one: Average, name: str, unit: str, factor: float) -> Average:
    """An average in another unit."""
    value, error, drift = one.value * factor, one.error * factor, one.drift * factor
    return replace(one, name=name, unit=unit, value=value, error=error, drift=drift)


def _beside(tau_star: float, q_star: float) -> list[str]:
    """The classical formulae at the stress of the run, and what was measured over them."""
    if not tau_star > 0.0:
        return []
    return [
        f"{name}, plane bed: q_star = {rate:.3g} at tau_star = {tau_star:.3g}"
        + (f"; measured over it {q_star / rate:.2g}" if rate > 0.0 else "")
        for name, rate in predicted(tau_star).items()
    ]


def _crest(scene: Scene) -> str:
    """Where the fixed bed ends, if there is one."""
    return f"; crest of the fixed bed at z = {crest_of(scene):.4g} m" if scene.n_fixed else ""


def _tau_star(scene: Scene, excess: float, d: float, g: float) -> float:
    """Of the water the case asks for [-]; nan where it names no friction velocity."""
    u_star = scene.water.u_star
    known = u_star > 0.0 and g > 0.0 and math.isfinite(excess)
    return tau_star_from_u_star(u_star, 1.0 + excess, 1.0, g, d) if known else math.nan
