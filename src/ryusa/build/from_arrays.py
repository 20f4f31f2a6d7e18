"""A scene from arrays, without a case file."""

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike

from ryusa.build.assemble import Laws, assemble, masses
from ryusa.build.overlaps import refuse_overlaps
from ryusa.build.placement import Placement, Wall
from ryusa.build.walls import SolidWall, refuse_overlaps_with_walls, with_room, with_walls
from ryusa.casefile.time import STEPS_OF_HERTZ, STEPS_PER_CONTACT
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
    stiffness: float = 1.0e4,
    shear_ratio: float = 2.0 / 7.0,
    restitution: float = 0.7,
    restitution_shear: float | None = None,
    friction: float = math.tan(math.radians(30.0)),
    slip: Slip = Slip.SPRING,
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
    x, d : centres [m], shape (n, 3), and diameters [m], a number or shape (n,), of the free grains.
    density : of the grains [kg/m3].
    v, omega : velocities [m/s] and spins [rad/s], shape (n, 3); at rest when not given.
    x_fixed, d_fixed : fixed grains, as x and d; d_fixed is the mean of d when not given.
    planes : (name, point [m], normal) of each flat wall without an end.
    walls : of `rectangle`, `ridges`, `disc`, `cylinder` and `triangles`, each at rest or with a `WallMotion`.
    stiffness, shear_ratio, restitution, restitution_shear, friction, slip, tension,
        timing : the contact law; friction is mu = tan(phi). `contact` replaces them by a complete law.
    gravity, slope : g [m/s2] and bed slope [rad], down towards +x.
    plane_case : motion in x-z only; grains interact only if their y is exactly equal (a lane).
    period : periods in x and y [m]; inf where open, as y must be in a plane scene.
    dt : time step [s]; by default the shortest contact over `steps_per_contact`: 10 if exact, else 50.

    Returns
    -------
    scene, state : what `Engine.load` takes.

    Raises
    ------
    CaseError : shapes that do not fit, a number that is not finite or out of its range, overlapping first
        grains, lanes of a plane scene closer than the largest diameter, a wall that crosses a period or
        overlaps a first grain.

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
    _refuse_walls(placement, plane_case)
    refuse_overlaps(placement, "x", plane_case)
    refuse_overlaps_with_walls(placement, walls, "walls")
    fluid = water or Water()
    e_s = restitution if restitution_shear is None else restitution_shear
    law = contact or _contact_law(stiffness, shear_ratio, friction, restitution, e_s, slip, tension, timing)
    step = _step(placement.d, density, fluid, law, steps_per_contact) if dt is None else dt
    slab_width = float(placement.d.mean()) if plane_case else math.nan
    laws = Laws(
        density=density, contact=law, dt=step, rolling=rolling or RollingLaw(), water=fluid, g=gravity,
        slope=slope, rotation=rotation, plane_case=plane_case, slab_width=slab_width, events=events,
    )  # fmt: skip
    made, state = assemble(placement, laws)
    return with_room(with_walls(made, walls), low=True, high=True), state


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
    if n == 0:
        raise CaseError("x", None, "needs at least one grain")
    sizes = _sizes(d, "d", n)
    bed = _rows(x_fixed, "x_fixed", None) if x_fixed is not None else np.zeros((0, 3))
    return Placement(
        d=sizes,
        x=centres,
        v=_rows(v, "v", n) if v is not None else np.zeros((n, 3)),
        omega=_rows(omega, "omega", n) if omega is not None else np.zeros((n, 3)),
        d_fixed=_sizes(float(sizes.mean()) if d_fixed is None else d_fixed, "d_fixed", len(bed)),
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
    d: Floats, density: float, water: Water, contact: ContactLaw, steps_per_contact: float | None
) -> float:
    """Time step [s]: the shortest contact that can occur over its number of steps."""
    m, m_added, _, _ = masses(d, density, math.pi / 6, water)
    lightest = float(np.min(m + m_added)) / (2.0 if len(d) > 1 else 1.0)
    if contact.force == ContactForce.HERTZ_MINDLIN:
        r = 0.25 * float(np.min(d)) if len(d) > 1 else 0.5 * float(np.min(d))  # alone on a wall
        return shortest_contact_of(contact, lightest, r) / (steps_per_contact or STEPS_OF_HERTZ)
    shortest = collision.shortest_contact(lightest, contact.k_n, contact.zeta_n, contact.tension)
    return shortest / (steps_per_contact or STEPS_PER_CONTACT[ContactTiming(contact.timing)])


def _refuse(numbers: Mapping[str, float | None], fits: Callable[[float], bool], allowed: str) -> None:
    for name, one in numbers.items():
        if one is not None and not (math.isfinite(one) and fits(one)):
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
