"""A scene from arrays, without a case file."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from ryusa.build.array_materials import ArrayMaterials, MadeOf, Material, MaterialPair, array_materials
from ryusa.build.array_traffic import (
    FedGrains,
    Outlet,
    array_traffic,
    refuse_crowded_feeds,
    refuse_traffic,
    with_array_feeds,
)
from ryusa.build.assemble import Laws, assemble, masses
from ryusa.build.feeds import before_feeding, moving_with, steps_between
from ryusa.build.overlaps import refuse_overlaps, refuse_overlaps_with_walls
from ryusa.build.placement import Placement, Wall
from ryusa.build.walls import SolidWall, with_room, with_walls
from ryusa.casefile.record.time import steps_of_law
from ryusa.errors import CaseError
from ryusa.laws import collision
from ryusa.laws.families import Cap, ContactForce, ContactTiming, Slip
from ryusa.model import ContactLaw, RollingLaw, Scene, State, Water
from ryusa.model.contact_law import shortest_contact_of
from ryusa.model.scene import EventRule, Floats


def scene(
    x: ArrayLike,
    d: ArrayLike,
    *,
    density: float = 2650.0,
    v: ArrayLike | None = None,
    omega: ArrayLike | None = None,
    x_fixed: ArrayLike | None = None,
    d_fixed: ArrayLike | None = None,
    planes: Sequence[tuple[str, Sequence[float], Sequence[float]]] = (),
    walls: Sequence[SolidWall] = (),
    feeds: Sequence[FedGrains] = (),
    exits: Sequence[Outlet] = (),
    seed: int = 1,
    materials: Sequence[Material] = (),
    pairs: Sequence[MaterialPair] = (),
    made_of: MadeOf | None = None,
    stiffness: float = 1.0e4,
    shear_ratio: float = 2.0 / 7.0,
    restitution: float = 0.7,
    restitution_shear: float | None = None,
    friction: float = math.tan(math.radians(30.0)),
    slip: Slip = Slip.TOTAL,
    tension: bool = False,
    timing: ContactTiming = ContactTiming.EXACT,
    contact: ContactLaw | None = None,
    rolling: RollingLaw | None = None,
    water: Water | None = None,
    gravity: float = 9.80665,
    slope: float = 0.0,
    rotation: bool = True,
    plane_case: bool = False,
    period: tuple[float, float] = (math.inf, math.inf),
    dt: float | None = None,
    steps_per_contact: float | None = None,
    events: EventRule = EventRule.ALL,
    allow_overlap: bool = False,
) -> tuple[Scene, State]:
    """Build a scene from arrays, in SI units and radians.

    Parameters
    ----------
    x, d : centres [m], shape (n, 3), and diameters [m], a number or shape (n,), of the first free grains;
        none of them, x = (), where feeds bring all.
    density : of the grains [kg/m3].
    v, omega : velocities [m/s] and spins [rad/s], shape (n, 3); at rest when not given.
    x_fixed, d_fixed : fixed grains, as x and d; d_fixed is the mean of d when not given.
    planes : (name, point [m], normal) of each flat wall without an end.
    walls : of `rectangle`, `ridges`, `disc`, `cylinder` and `triangles`, at rest, with a `WallMotion` or a
        `Servo`.
    feeds, exits : of `feed_disc`, `feed_box`, `exit_plane` and `exit_box`. Grains of feeds have ids after the
        first ones; `seed` draws their places.
    materials, pairs, made_of : materials beside that of the contact law, "grains"; what belongs to two of
        them; and which plane, wall or group of grains is of which, by name: {"drum": "steel"}. For a feed,
        "bed" and "grains", which are the first ones, also one name for each grain.
    stiffness, shear_ratio, restitution, restitution_shear, friction, slip, tension,
        timing : the contact law; friction is mu = tan(phi). `contact` replaces them by a complete law.
    gravity, slope : g [m/s2] and bed slope [rad], down towards +x.
    plane_case : motion in x-z only; grains interact only if their y is exactly equal (a lane).
    period : periods in x and y [m]; inf where open, as y must be in a plane scene.
    dt : time step [s]; by default the shortest contact over `steps_per_contact`, 10 of them if exact
        (16 where the restitution is 1), else 50.

    Returns
    -------
    scene, state : what `Engine.load` takes.

    Raises
    ------
    CaseError : shapes that do not fit, a number that is not finite or out of its range, overlapping first
        grains, lanes of a plane scene closer than the largest diameter, a wall that crosses a period or
        overlaps a first grain, a feed or an exit that cannot do what it is asked, materials that are unknown
        or lack what belongs to a pair.

    >>> fixed, first = scene(x=[[0.0, 0.0, 0.011]], d=0.002, planes=[("floor", (0, 0, 0), (0, 0, 1))])
    >>> fixed.n_grain, fixed.n_plane, first.n_grain
    (1, 1, 1)
    """
    # One function: four lines of five are its signature, and what the arguments mean.
    _refuse_numbers(
        {"density": density, "stiffness": stiffness, "steps_per_contact": steps_per_contact, "dt": dt},
        {"shear_ratio": shear_ratio, "friction": friction, "gravity": gravity},
        slope,
        {"restitution": restitution, "restitution_shear": restitution_shear},
    )
    placement = _placement(x, d, v, omega, x_fixed, d_fixed, planes, period, allow_overlap)
    if not len(placement.d) and not any(len(one.d) for one in feeds):
        raise CaseError("x", None, "needs at least one grain, here or in a feed")
    _refuse_walls(placement, plane_case)
    refuse_overlaps(placement, "x", plane_case)
    refuse_overlaps_with_walls(placement, walls, "walls")
    n_first, named = len(placement.d), [wall.name for wall in walls]
    _refuse_names([*placement.groups(), *named], "walls")
    refuse_traffic(feeds, exits, [*placement.groups(), *named], named, plane_case, period)
    placement = with_array_feeds(placement, feeds)
    fluid = water or Water()
    e_s = restitution if restitution_shear is None else restitution_shear
    law = contact or _contact_law(stiffness, shear_ratio, friction, restitution, e_s, slip, tension, timing)
    roll, count = rolling or RollingLaw(), len(placement.d)
    made = array_materials(
        materials, pairs, made_of or {}, {**placement.groups(), "grains": (0, n_first)}, named,
        (count, count + len(placement.d_fixed) + len(placement.walls)), density, law, roll,
    )  # fmt: skip
    heavy_as = density if made is None else made.density
    step = _step(placement.d, heavy_as, fluid, law, steps_per_contact, made) if dt is None else dt
    slab_width = float(placement.d.mean()) if plane_case else math.nan
    laws = Laws(
        density=heavy_as, contact=law, dt=step, rolling=roll, water=fluid, g=gravity,
        slope=slope, rotation=rotation, plane_case=plane_case, slab_width=slab_width, events=events,
    )  # fmt: skip
    traffic = array_traffic(feeds, exits, named, n_first, seed, plane_case)
    if traffic is not None:
        apart = steps_between(traffic.feeds, float(placement.d.min()), gravity, step)
        traffic = replace(traffic, interval=apart)
    built, state = before_feeding(*assemble(placement, laws), traffic)
    refuse_crowded_feeds(built)
    built = moving_with(with_room(with_walls(built, walls), low=True, high=True))
    return (built if made is None else made.on(built)), state


def _refuse_numbers(
    above_zero: Mapping[str, float | None],
    at_least_zero: Mapping[str, float],
    slope: float,
    restitutions: Mapping[str, float | None],
) -> None:
    _refuse(above_zero, lambda one: one > 0.0, "must be finite and greater than 0")
    _refuse(at_least_zero, lambda one: one >= 0.0, "must be finite and at least 0")
    _refuse({"slope": slope}, lambda one: abs(one) < math.pi / 2, "must lie between -pi/2 and pi/2 rad")
    _refuse(restitutions, lambda one: 0.0 < one <= 1.0, "must be greater than 0 and at most 1")


def _refuse_names(names: Sequence[str], key: str) -> None:
    twice = [name for k, name in enumerate(names) if name in names[:k]]
    if twice:
        raise CaseError(key, twice[0], "is the name of another wall, plane or group already")


def _placement(
    x: ArrayLike,
    d: ArrayLike,
    v: ArrayLike | None,
    omega: ArrayLike | None,
    x_fixed: ArrayLike | None,
    d_fixed: ArrayLike | None,
    planes: Sequence[tuple[str, Sequence[float], Sequence[float]]],
    period: tuple[float, float],
    allow_overlap: bool,
) -> Placement:
    """First grains and walls from the arguments of `scene`, every shape checked."""
    if not all(one > 0.0 for one in period):
        raise CaseError("period", period, "must be greater than 0 in x and y, or inf where open")
    centres = _rows(x, "x", None)
    n = len(centres)
    sizes, given = _sizes(d, "d", n), np.asarray(d, np.float64)
    usual = float(given.mean()) if given.size else math.nan
    bed = _rows(x_fixed, "x_fixed", None) if x_fixed is not None else np.zeros((0, 3))
    return Placement(
        d=sizes,
        x=centres,
        v=_rows(v, "v", n) if v is not None else np.zeros((n, 3)),
        omega=_rows(omega, "omega", n) if omega is not None else np.zeros((n, 3)),
        d_fixed=_sizes(usual if d_fixed is None else d_fixed, "d_fixed", len(bed)),
        x_fixed=bed,
        walls=tuple(Wall(name, _point(point), _point(normal)) for name, point, normal in planes),
        period=period,
        allow_overlap=allow_overlap,
    )


def _contact_law(
    k_n: float,
    shear_ratio: float,
    mu: float,
    e_n: float,
    e_s: float,
    slip: Slip,
    tension: bool,
    timing: ContactTiming,
) -> ContactLaw:
    return ContactLaw(
        k_n=k_n,
        k_s=shear_ratio * k_n,
        mu=mu,
        e_n=e_n,
        e_s=e_s,
        zeta_n=collision.zeta_for_restitution(e_n, tension),
        zeta_s=collision.zeta_tension(e_s),
        slip=slip,
        cap=Cap.TOTAL if "total" in slip.marks else Cap.SPRING,
        tension=tension,
        timing=timing,
    )


def _step(
    d: Floats,
    density: float | Floats,
    water: Water,
    contact: ContactLaw,
    steps_per_contact: float | None,
    materials: ArrayMaterials | None,
) -> float:
    """Time step [s]: the shortest contact that can occur over its number of steps."""
    m, m_added, _, _ = masses(d, density, math.pi / 6, water)
    heavy, alone = m + m_added, len(d) == 1
    hertz, lossless = contact.force == ContactForce.HERTZ_MINDLIN, contact.e_n == 1.0
    default = steps_of_law(hertz, ContactTiming(contact.timing), lossless)
    r = (0.5 if alone else 0.25) * float(np.min(d))  # alone on a wall
    if materials is None:
        shortest = _shortest(contact, float(np.min(heavy)) / (1.0 if alone else 2.0), r)
    else:
        n, of = len(materials.names), materials.of[: len(d)]
        least = [float(np.min(heavy[of == k], initial=math.inf)) for k in range(n)]
        times: list[float] = []
        for (a, b), both in materials.meeting().items():
            m_e = 1.0 / (1.0 / least[a] + 1.0 / least[b]) if both else min(least[a], least[b])
            times.append(_shortest(materials.contact[a * n + b], m_e, r))
        shortest = min(times, default=math.inf)
        if not math.isfinite(shortest):
            shortest = _shortest(contact, float(np.min(heavy)), r)  # a grain alone, which touches nothing
    return shortest / (steps_per_contact or default)


def _shortest(contact: ContactLaw, m: float, r: float) -> float:
    """Duration of a contact of an effective mass [kg] and a reduced radius [m], in [s]."""
    if contact.force == ContactForce.HERTZ_MINDLIN:
        return shortest_contact_of(contact, m, r)
    return collision.shortest_contact(m, contact.k_n, contact.zeta_n, contact.tension)


def _refuse(numbers: Mapping[str, float | None], fits: Callable[[float], bool], allowed: str) -> None:
    for name, one in numbers.items():
        if one is None:
            continue
        if np.ndim(one) > 0:
            raise CaseError(name, one, "must be one number for all grains; see `materials` for several")
        if not (math.isfinite(one) and fits(one)):
            raise CaseError(name, one, allowed)


def _refuse_walls(placement: Placement, plane_case: bool) -> None:
    if plane_case and math.isfinite(placement.period[1]):
        raise CaseError("period", placement.period, "has no meaning in y in a plane scene; leave it inf")
    for wall in placement.walls:
        if not (np.all(np.isfinite([wall.point, wall.normal])) and any(wall.normal)):
            raise CaseError("planes", wall.name, "needs a finite point and a finite normal other than zero")
        if plane_case and wall.normal[1] != 0.0:
            raise CaseError("planes", wall.name, "must have a normal with y = 0 in a plane scene")
        for axis, one in enumerate("xy"):
            if math.isfinite(placement.period[axis]) and wall.normal[axis] != 0.0:
                raise CaseError("planes", wall.name, f"must have a normal with {one} = 0: {one} is periodic")


def _rows(values: ArrayLike, name: str, n: int | None) -> Floats:
    rows = np.array(values, dtype=np.float64)
    if rows.size == 0:
        rows = rows.reshape(0, 3)
    if rows.ndim == 1 and rows.size == 3:
        rows = rows.reshape(1, 3)
    if rows.ndim != 2 or rows.shape[1] != 3 or (n is not None and len(rows) != n):
        raise CaseError(name, None, f"must have shape ({'n' if n is None else n}, 3), not {rows.shape}")
    if not np.all(np.isfinite(rows)):
        raise CaseError(
            name, None, f"must be finite; row {int(np.argmin(np.isfinite(rows).all(axis=1)))} is not"
        )
    return rows


def _sizes(values: ArrayLike, name: str, n: int) -> Floats:
    sizes = np.array(values, dtype=np.float64)
    if sizes.ndim == 0:
        sizes = np.full(n, float(sizes))
    if sizes.shape != (n,):
        raise CaseError(name, None, f"must be one number or have shape ({n},), not {sizes.shape}")
    if not np.all(np.isfinite(sizes) & (sizes > 0.0)):
        raise CaseError(name, None, "must be finite and greater than 0")
    return sizes


def _point(values: Sequence[float]) -> tuple[float, float, float]:
    x, y, z = (float(value) for value in values)
    return x, y, z
